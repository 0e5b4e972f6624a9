"""Are the readings of a test in micrometres? By their scatter, and by what the model predicts.

Whatever a machine is like, readings scatter by their own uncertainty, and a model with measured
tables is not wrong a hundredfold. So readings in another unit betray themselves by their size,
after all that the instrument leaves free (zero, centre, pose) has been taken off.

Source: closed form derived here: a unit that is wrong by a factor f scales scatter and prediction
error by f.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vmach.base.units import um_from_mm
from vmach.errors import InputError
from vmach.measurements.measurement import Measurement

__all__ = ["check_unit"]

#: no instrument is finer, and none that is of use is coarser
_FINEST_MM, _COARSEST_MM = 5e-6, 0.1
#: a test that varies this many times less than model and uncertainty say is in a coarser unit
_TOO_SMALL = 50.0
#: a test that varies by more than this, and so many times more than the model says, in a finer
_LARGE_MM = 0.2
_TOO_LARGE = 20.0
#: readings beyond the number of what is free, below which nothing can be said
_FEWEST_LEFT = 4


def check_unit(test: Measurement, path: Path) -> None:
    """Refuse a test whose readings, or whose uncertainty, cannot be in micrometres.

    Parameters
    ----------
    test : Measurement
        Of one instrument; readings that are all zero are let through.
    path : Path
        Its file.

    Raises
    ------
    InputError
        Readings that look like mm, m or nm; an uncertainty that looks like mm.
    """
    u_mm = float(np.median(test.u_mm))
    if not _FINEST_MM <= u_mm <= _COARSEST_MM:
        raise InputError(
            f"u_um of this test is {um_from_mm(u_mm):g} um",
            file=path,
            accepted=f"{um_from_mm(_FINEST_MM):g} to {um_from_mm(_COARSEST_MM):g} um",
            hint=f"is u_um in {'mm' if u_mm < _FINEST_MM else 'nm'}? It has to be in um",
        )
    if test.degrees < _FEWEST_LEFT or not test.measured_mm.any():
        return
    seen = test.variation_mm(test.measured_mm)
    foretold = max(test.variation_mm(test.predicted_mm), u_mm)
    if seen < min(foretold / _TOO_SMALL, u_mm):
        unit = "mm" if seen > 3e-5 * foretold else "m"
        raise _refused(seen, foretold, path, f"are they in {unit}? They have to be in um")
    if seen > max(_TOO_LARGE * foretold, _LARGE_MM):
        hint = "are they in nm, or is this a test of another machine? They have to be in um"
        raise _refused(seen, foretold, path, hint)


def _refused(seen_mm: float, foretold_mm: float, path: Path, hint: str) -> InputError:
    return InputError(
        f"the readings, taken as um, vary by {um_from_mm(seen_mm):.4g} um (rms) where the model "
        f"and u_um say {um_from_mm(foretold_mm):.4g} um",
        file=path,
        accepted=f"readings in um, within {_TOO_SMALL:g} times of that",
        hint=hint,
    )
