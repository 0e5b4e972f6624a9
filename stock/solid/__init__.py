"""The virtual part: the solid that displaced tools leave of a blank, with its moves."""

from stock.solid.solid import BLANK, VirtualPart, cut_part

__all__ = [
    "BLANK",
    "VirtualPart",
    "cut_part",
]
