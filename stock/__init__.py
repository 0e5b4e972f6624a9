"""Stock removal: what tools that sweep along (displaced) paths leave of the material.

Knows neither NC programs nor machines.
"""

from stock.collision import Collision, find_collisions
from stock.compile_ahead import compile_ahead
from stock.errors import StockError
from stock.exact.edge import Edges, EdgeStatus, Material, find_edges
from stock.exact.generating import Generation, find_generating
from stock.exact.left_surface import LeftSurface, find_left_surface
from stock.solid import BLANK, VirtualPart, cut_part
from stock.solid.cut_aside import CutAside
from stock.solid.difference import Difference, Surface, find_differences
from stock.solid.export import write_part
from stock.sweeps import Sweeps
from stock.tools import TOOL_SHAPES, Corner, Tool, make_tool

__all__ = [
    "BLANK",
    "TOOL_SHAPES",
    "Collision",
    "Corner",
    "CutAside",
    "Difference",
    "EdgeStatus",
    "Edges",
    "Generation",
    "LeftSurface",
    "Material",
    "StockError",
    "Surface",
    "Sweeps",
    "Tool",
    "VirtualPart",
    "compile_ahead",
    "cut_part",
    "find_collisions",
    "find_differences",
    "find_edges",
    "find_generating",
    "find_left_surface",
    "make_tool",
    "write_part",
]
