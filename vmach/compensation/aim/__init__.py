"""Aiming at the part: what its surface asks of the path."""
