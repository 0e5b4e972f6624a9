"""Collisions along the program: rapid moves in material, shank or holder in the stock."""

from stock.collision.collision import Collision, find_collisions

__all__ = [
    "Collision",
    "find_collisions",
]
