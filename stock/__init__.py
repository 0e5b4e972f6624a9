"""Stock removal: what tools that sweep along (displaced) paths leave of the material.

Knows neither NC programs nor machines.
"""

from stock.export import write_part
from stock.solid import BLANK, VirtualPart, cut_part
from stock.sweeps import Sweeps

__all__ = ["BLANK", "Sweeps", "VirtualPart", "cut_part", "write_part"]
