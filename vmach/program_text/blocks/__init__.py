"""Blocks of a program: their text, their modes, and edits of one line."""
