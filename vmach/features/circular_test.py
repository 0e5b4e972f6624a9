"""Circular test: what the path of a circle, made both ways round, says of two axes.

Source: ISO 230-4 (circular deviation G, bidirectional circular deviation G(b), mean bidirectional
radial deviation D, radial deviation F).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.features.association.linear_program import least_width

__all__ = ["CircularFigures", "CircularLimits", "CircularTest", "circular_figures",
           "circular_weights"]  # fmt: skip


@dataclass(frozen=True)
class CircularFigures:
    """Figures of a pair of circles, mm.

    Attributes
    ----------
    G_ccw, G_cw : float
        Circular deviation of each way: least radial distance of two concentric circles that hold
        the path.
    G_b : float
        The same of both paths together.
    D : float
        Radius of both paths on average, by least squares, minus the programmed one.
    F_min, F_max : float
        Radial deviation of both paths from the programmed circle about the least squares centre.
    """

    G_ccw: float
    G_cw: float
    G_b: float
    D: float
    F_min: float
    F_max: float


@dataclass(frozen=True)
class CircularLimits:
    """Largest figures that are accepted, mm; None where none is stated.

    `G` is for both ways, `D` and `F` are for absolute values.
    """

    G: float | None = None
    G_b: float | None = None
    D: float | None = None
    F: float | None = None


@dataclass(frozen=True)
class CircularTest:
    """A pair of circles of a program.

    Attributes
    ----------
    plane : str
        ``XY``, ``YZ`` or ``ZX``.
    centre_mm : (3,) float64
        Machine coordinates of the spindle nose.
    radius_mm, feed_mm_min : float
    lines : (int, int)
        Lines of the program: counter-clockwise, clockwise.
    figures : CircularFigures
    limits : CircularLimits
    angle_rad, radial_mm : pair of (N,) float64
        The paths, counter-clockwise and clockwise, as `circular_figures` takes them.
    u : CircularFigures, optional
        Standard uncertainties of the figures, to first order.
    """

    plane: str
    centre_mm: np.ndarray
    radius_mm: float
    feed_mm_min: float
    lines: tuple[int, int]
    figures: CircularFigures
    limits: CircularLimits
    angle_rad: tuple[np.ndarray, np.ndarray]
    radial_mm: tuple[np.ndarray, np.ndarray]
    u: CircularFigures | None = None


def circular_figures(
    angle_rad: tuple[np.ndarray, np.ndarray], radial_mm: tuple[np.ndarray, np.ndarray]
) -> CircularFigures:
    """Figures from radial deviations about the programmed centre.

    Parameters
    ----------
    angle_rad, radial_mm : pair of (N,) array
        Counter-clockwise and clockwise: where on the circle, and how far outside it the tool is.

    Examples
    --------
    >>> import numpy as np
    >>> angle = np.linspace(0.0, 2.0 * np.pi, 361)
    >>> found = circular_figures((angle, angle), (0.01 + 0.0 * angle, 0.03 + 0.0 * angle))
    >>> round(found.G_b, 9), round(found.D, 9)
    (0.02, 0.02)
    """
    radial = np.concatenate(radial_mm)
    values = {name: float(row @ radial) for name, row in _weights(angle_rad, radial_mm).items()}
    return CircularFigures(**values)


def circular_weights(
    angle_rad: tuple[np.ndarray, np.ndarray], radial_mm: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Weights of the radial deviations in every figure, (6, 2N): to first order a figure is a sum.

    The order is that of `CircularFigures`; counter-clockwise comes first in a row.
    """
    return np.array(list(_weights(angle_rad, radial_mm).values()))


def _weights(
    angle_rad: tuple[np.ndarray, np.ndarray], radial_mm: tuple[np.ndarray, np.ndarray]
) -> dict[str, np.ndarray]:
    ccw, cw = (np.column_stack([np.cos(a), np.sin(a)]) for a in angle_rad)
    rows, radial = np.vstack([ccw, cw]), np.concatenate(radial_mm)
    nothing_ccw, nothing_cw = np.zeros(len(ccw)), np.zeros(len(cw))
    fit = np.linalg.pinv(np.hstack([rows, np.ones((len(rows), 1))]))  # centre and mean radius
    about_centre = radial - rows @ (fit[:2] @ radial)
    of_deviation = lambda k: np.eye(1, len(rows), k)[0] - rows[k] @ fit[:2]  # noqa: E731
    return {
        "G_ccw": np.r_[least_width(radial_mm[0], ccw)[2], nothing_cw],
        "G_cw": np.r_[nothing_ccw, least_width(radial_mm[1], cw)[2]],
        "G_b": least_width(radial, rows)[2],
        "D": fit[2],
        "F_min": of_deviation(int(about_centre.argmin())),
        "F_max": of_deviation(int(about_centre.argmax())),
    }
