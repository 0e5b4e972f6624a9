"""Stock removal: what tools that sweep along (displaced) paths leave of the material.

Knows neither NC programs nor machines.
"""

from stock.sweeps import Sweeps

__all__ = ["Sweeps"]
