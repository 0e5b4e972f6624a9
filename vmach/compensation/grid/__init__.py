"""Rounding to the control's grid."""
