"""What a residual may depend on: feature, axis position, direction, feed, time, tool, normal."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vmach.effects import Circumstances
from vmach.fit.survey import Survey
from vmach.machine import LINEAR_AXES
from vmach.measurements import Measurement

__all__ = ["Covariate", "covariates"]

_ZONES = 8
#: a direction nearer than this to square with an axis does not face it: sine of 22.5 degrees
_FACES = 0.38


@dataclass(frozen=True)
class Covariate:
    """One quantity that sorts n readings into classes.

    Attributes
    ----------
    by : str
        Its kind: "feature", "axis position", "direction", "feed", "time", "tool", "normal".
    title : str
        Its name for people.
    number : (n,) int
        The class of each reading.
    words : tuple of str
        What the readings of each class have in common; for zones of a `value` its limits.
    value : (n,) float64 or None
        The quantity itself where it is a number.
    """

    by: str
    title: str
    number: np.ndarray
    words: tuple[str, ...]
    value: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.words)

    @property
    def is_in(self) -> np.ndarray:
        """Whether a reading belongs to a class, (n, classes) of 0 and 1."""
        return np.eye(len(self))[self.number]

    def means(self, values: np.ndarray) -> np.ndarray:
        """Mean of values (n,) or (n, k) over the readings of each class."""
        return (self.is_in / self.counts).T @ values

    @property
    def counts(self) -> np.ndarray:
        """Readings of each class, (C,)."""
        return np.bincount(self.number)


def covariates(survey: Survey) -> Iterator[Covariate]:
    """Everything that tells readings of a survey apart; those that are all alike are left out."""
    for covariate in (
        _features(survey),
        *_axes(survey),
        _feed(survey),
        _time(survey),
        _classes("tool", "tool", _gathered(survey, lambda path: path.tool), "tool {}"),
        _classes("normal", "direction of the surface or reading", _seen_as(survey), "{}"),
    ):
        if len(covariate) > 1:
            yield covariate


def _gathered(survey: Survey, of_path) -> np.ndarray:
    """A quantity of every reading, measurement after measurement."""
    return np.concatenate([np.asarray(of_path(path)) for path in survey.paths])


def _classes(by: str, title: str, label: np.ndarray, words: str) -> Covariate:
    names, number = np.unique(label, return_inverse=True)
    return Covariate(by, title, number, tuple(words.format(name) for name in names.tolist()))


def _features(survey: Survey) -> Covariate:
    several = len(survey.measurements) > 1
    names = [
        np.char.add(m.group.astype(str), f" of {m.name}" if several else "")
        for m in survey.measurements
    ]
    return _classes("feature", "feature", np.concatenate(names), "feature {}")


def _axes(survey: Survey) -> Iterator[Covariate]:
    seen_as = _seen_as(survey)
    for k, axis in enumerate(LINEAR_AXES):
        position = _gathered(survey, lambda path, k=k: path.nose_mm[:, k])
        yield _zones(
            "axis position", f"position of {axis}, mm", position, axis + " from {} to {} mm"
        )
        # what a reversal does depends on the side of the wall: sort by both
        side = np.sign(np.round(_gathered(survey, lambda path, k=k: path.play_side[:, k])))
        label = np.char.add(np.char.mod("%+d ", side), seen_as)
        names, number = np.unique(label, return_inverse=True)
        moved = tuple(_moved(axis, *name.split(" ", 1)) for name in names.tolist())
        yield Covariate("direction", f"direction of {axis}", number, moved)


def _moved(axis: str, side: str, seen_as: str) -> str:
    moved = f"before {axis} moved" if side == "+0" else f"after {axis} moved {side[0]}"
    return f"{moved}, {seen_as}"


def _feed(survey: Survey) -> Covariate:
    def per_min(path: Circumstances) -> np.ndarray:
        return np.round(60 * np.linalg.norm(path.velocity_mm_per_s, axis=1))

    return _classes("feed", "feed", _gathered(survey, per_min).astype(int), "at {} mm/min")


def _time(survey: Survey) -> Covariate:
    minutes = _gathered(survey, lambda path: path.time_s) / 60
    return _zones("time", "time, min", minutes, "{} to {} min after the start", digits=1)


def _zones(by: str, title: str, value: np.ndarray, words: str, *, digits: int = 0) -> Covariate:
    """Zones of equal counts."""
    edges = np.unique(np.quantile(value, np.linspace(0.0, 1.0, _ZONES + 1)))
    zone = np.clip(np.searchsorted(edges, value, side="right") - 1, 0, max(len(edges) - 2, 0))
    used, number = np.unique(zone, return_inverse=True)
    limits = [(edges[z], edges[min(z + 1, len(edges) - 1)]) for z in used]
    named = [words.format(f"{low:.{digits}f}", f"{high:.{digits}f}") for low, high in limits]
    return Covariate(by, title, number, tuple(named), value)


def _seen_as(survey: Survey) -> np.ndarray:
    """What each reading is of, and along what: its direction is nearest to +X, -X, or +X-Y."""
    sensing = np.round(survey.sensing, 9)
    signs = np.where(np.abs(sensing) > _FACES, np.where(sensing > 0, "+", "-"), "")
    parts = np.where(signs != "", np.char.add(signs, np.array(LINEAR_AXES)), "")
    along = np.char.add(np.char.add(parts[:, 0], parts[:, 1]), parts[:, 2])
    words = [np.full(len(m), _words_of(m)) for m in survey.measurements]
    # what is read of a hole along no axis is its diameter
    return np.where(along == "", "diameters", np.char.add(np.concatenate(words), along))


def _words_of(measurement: Measurement) -> str:
    is_surface = measurement.on_part and measurement.contacts is None
    return "surfaces facing " if is_surface else "readings along "
