"""Do readings agree with the model once their sign is turned round?"""

from __future__ import annotations

import numpy as np

from vmach.measurements.measurement import Measurement
from vmach.units import um_from_mm

__all__ = ["sign_notes"]

#: readings that agree so many times better the other way round are suspicious
_BETTER = 2.0
#: and only where they are further away than so many standard uncertainties
_CLEAR_U = 2.0
#: readings beyond the number of what is free, below which nothing can be said
_FEWEST_LEFT = 12
_MEANING = {
    "part": "a deviation is (m - p) along i, j, k and positive where material is left",
    "ballbar": "radius_um is positive where the tool is further out than programmed",
    "laser": "deviation_um is positive where the tool is further along + than programmed",
    "diagonal": "deviation_um is positive where the tool is further towards to_mm than programmed",
}
_OTHERWISE = "a displacement is that of the tool relative to the workpiece"


def sign_notes(test: Measurement) -> tuple[str, ...]:
    """A note where measured minus predicted would be far smaller with the other sign.

    Parameters
    ----------
    test : Measurement

    Returns
    -------
    tuple of str
        Empty where the sign looks right, or where the model says too little to tell.
    """
    if test.degrees < _FEWEST_LEFT:
        return ()
    plain = test.variation_mm(test.measured_mm - test.predicted_mm)
    turned = test.variation_mm(test.measured_mm + test.predicted_mm)
    if plain < max(_BETTER * turned, _CLEAR_U * float(np.median(test.u_mm))):
        return ()
    return (
        f"{test.name}: with the other sign the readings would agree with the model within "
        f"{um_from_mm(turned):.2f} um instead of {um_from_mm(plain):.2f} um (rms): "
        f"{_MEANING.get(test.kind, _OTHERWISE)}, and so do the error tables count",
    )
