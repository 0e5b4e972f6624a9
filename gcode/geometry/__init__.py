"""Arcs in a plane, and how exact a control wants them."""
