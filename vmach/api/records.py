"""Records of a result with one row a point: arrays side by side, or a table of pandas."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from vmach.errors import VmachError

if TYPE_CHECKING:
    import pandas

__all__ = ["Rows"]


class Rows:
    """A frozen record whose arrays have one row a point, (P,) or (P, K)."""

    #: endings of the K columns of a two-dimensional array, by the array's name
    _PARTS: dict[str, tuple[str, ...]] = {}

    def columns(self) -> dict[str, np.ndarray]:
        """Every column (P,) by its name; an array (P, 3) becomes three.

        Examples
        --------
        ``point_mm`` becomes ``x_mm``, ``y_mm``, ``z_mm``.
        """
        found: dict[str, np.ndarray] = {}
        for field in fields(self):  # type: ignore[arg-type]
            value = getattr(self, field.name)
            if not isinstance(value, np.ndarray):
                continue
            if value.ndim == 1:
                found[field.name] = value
            else:
                found |= dict(zip(self._PARTS[field.name], value.T, strict=True))
        return found

    def to_dataframe(self) -> pandas.DataFrame:
        """The columns as a table of pandas, one row a point.

        Raises
        ------
        VmachError
            pandas is not installed.
        """
        try:
            import pandas
        except ImportError:
            raise VmachError(
                "to_dataframe needs pandas, which is not installed; accepted: pip install pandas, "
                "or columns() for the arrays themselves"
            ) from None
        return pandas.DataFrame(self.columns())
