"""Pieces of corrected moves: where points are inserted, arcs that stay arcs."""
