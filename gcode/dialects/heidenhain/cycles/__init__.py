"""Cycles of Klartext: which is called, and what each of them moves."""
