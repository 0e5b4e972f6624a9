"""A machine from arrays, for Python programs that measure, simulate or vary one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from vmach.errors import InputError
from vmach.machine.chain import LINEAR_AXES, Chain
from vmach.machine.component_errors import COMPONENT_NAMES, ComponentError, component_of
from vmach.machine.machine import Axis, Machine, Motion
from vmach.machine.squareness import squareness_vectors
from vmach.machine.tables.error_table import MM_PER, RAD_PER
from vmach.machine.tables.interpolation import Extrapolation

__all__ = ["machine_from_arrays"]

#: of a vertical machining centre whose work table moves in X
_USUAL_CHAIN = "t (C) Z Y b X' w"
_SQUARENESS = tuple(
    f"E{rotation}0{axis}"
    for axis in LINEAR_AXES
    for rotation, about in zip("ABC", LINEAR_AXES, strict=True)
    if about != axis
)


def machine_from_arrays(
    name: str,
    *,
    travel_mm: Mapping[str, tuple[float, float]],
    errors: Mapping[str, Sequence[np.ndarray]] | None = None,
    squareness_urad: Mapping[str, float] | None = None,
    measured_at_mm: Mapping[str, Sequence[float]] | None = None,
    chain: str = _USUAL_CHAIN,
    rapid_mm_per_min: float = 10_000.0,
    extrapolation: str = "refuse",
) -> Machine:
    """A machine whose errors are given as arrays.

    Parameters
    ----------
    name : str
    travel_mm : mapping of "X", "Y", "Z" to (low, high)
        Machine coordinates of the spindle nose.
    errors : mapping of ISO 230-1 symbol to (position_mm, value) or (position_mm, forward, backward)
        Arrays (K,), positions increasing. Positioning and straightness (``EXX``, ``EYX``) in um,
        angles (``EBX``) in urad, as displacement of the tool relative to the workpiece,
        right-handed.
    squareness_urad : mapping of ``EC0Y`` ... to float
    measured_at_mm : mapping of symbol to (3,)
        Where the reflector of a positioning or straightness error stood, in the frame of the body
        that the axis carries, origin at the spindle nose with every axis at home.
    chain : str
        ISO 10791-1, such as ``t (C) Z Y b X' w``.
    rapid_mm_per_min : float
    extrapolation : {"refuse", "hold", "linear"}
        What holds beyond the ends of a table.

    Raises
    ------
    InputError
        An unknown symbol, an axis without travel, arrays that do not fit.

    Examples
    --------
    >>> import numpy as np
    >>> x = np.linspace(-500.0, 0.0, 11)
    >>> machine = machine_from_arrays(
    ...     "my mill",
    ...     travel_mm={"X": (-500.0, 0.0), "Y": (-400.0, 0.0), "Z": (-300.0, 0.0)},
    ...     errors={"EXX": (x, 0.02 * x)},
    ...     squareness_urad={"EC0Y": 30.0},
    ... )
    >>> machine.components["EXX"].range_mm
    (-500.0, 0.0)
    """
    for axis in LINEAR_AXES:
        if axis not in travel_mm or not travel_mm[axis][0] < travel_mm[axis][1]:
            given = travel_mm.get(axis)
            raise InputError(
                f"machine '{name}': travel of {axis} is {given}", accepted="(low, high) in mm"
            )
    squareness = dict(squareness_urad or {})
    for symbol in squareness:
        if symbol not in _SQUARENESS:
            raise InputError(
                f"machine '{name}': squareness '{symbol}'", accepted=", ".join(_SQUARENESS)
            )
    places = dict(measured_at_mm or {})
    components = {
        symbol: _component(symbol, arrays, places.pop(symbol, None), Extrapolation(extrapolation))
        for symbol, arrays in (errors or {}).items()
    }
    if places:
        raise InputError(
            f"machine '{name}': measured_at_mm of {', '.join(places)}, which has no error given",
            accepted=", ".join(components) or "none",
        )
    return Machine(
        name=name,
        chain=Chain.parse(chain),
        axes={axis: Axis(*map(float, travel_mm[axis])) for axis in LINEAR_AXES},
        motion=Motion(rapid_mm_per_min),
        components=components,
        squareness_rad=squareness_vectors(
            {symbol: value * RAD_PER["urad"] for symbol, value in squareness.items()}
        ),
    )


def _component(
    symbol: str,
    arrays: Sequence[np.ndarray],
    measured_at_mm: Sequence[float] | None,
    extrapolation: Extrapolation,
) -> ComponentError:
    if symbol not in COMPONENT_NAMES:
        raise InputError(f"component error '{symbol}'", accepted=", ".join(COMPONENT_NAMES))
    unit = RAD_PER["urad"] if component_of(symbol)[2] else MM_PER["um"]
    position, forward, backward = _checked(symbol, arrays)
    return ComponentError(
        symbol,
        position,
        unit * forward,
        unit * backward,
        None if measured_at_mm is None else np.asarray(measured_at_mm, dtype=float).reshape(3),
        extrapolation=extrapolation,
    )


def _checked(symbol: str, arrays: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Positions, forward and backward values, (K,) each."""
    found = [np.asarray(values, dtype=float) for values in arrays]
    if len(found) == 2:
        found.append(found[1])
    shapes = [values.shape for values in found]
    fits = len(found) == 3 and len(set(shapes)) == 1 and found[0].ndim == 1 and len(found[0]) > 1
    if not fits:
        raise InputError(
            f"{symbol}: arrays of shapes {', '.join(map(str, shapes))}",
            accepted="(position_mm, value) or (position_mm, forward, backward), (K,) each, K > 1",
        )
    if not all(np.isfinite(values).all() for values in found):
        raise InputError(f"{symbol}: a value that is not finite", accepted="finite numbers")
    if not (np.diff(found[0]) > 0).all():
        row = int(np.argmax(np.diff(found[0]) <= 0))
        raise InputError(
            f"{symbol}: position {found[0][row + 1]:g} mm after {found[0][row]:g} mm",
            accepted="increasing positions",
        )
    return found
