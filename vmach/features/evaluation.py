"""From a drawing's callout and the points of a part to the values it speaks of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from vmach.errors import InputError
from vmach.features.characteristics.form import cylindricity, flatness, roundness, straightness
from vmach.features.characteristics.size import distance, size
from vmach.features.characteristics.zones import (
    coaxiality,
    line_profile,
    location,
    orientation,
    profile,
    runout,
)
from vmach.features.datum_system import DatumSystem, datum_system
from vmach.features.drawing.callout import Callout
from vmach.features.feature import Feature, Points
from vmach.features.measure import Measure

__all__ = ["Drawing", "Requirement", "evaluate"]

_FORM = {
    "flatness": flatness,
    "cylindricity": cylindricity,
    "roundness": roundness,
    "straightness": straightness,
}

#: characteristics whose zone may be a cylinder or a ball (ISO 1101), and elements that have one
_ROUND_ZONES = ("parallelism", "perpendicularity", "angularity", "position", "coaxiality")
_CENTRED = ("sphere",)
_WITH_AXIS = ("cylinder", "cone", "torus", *_CENTRED)


@dataclass(frozen=True)
class Requirement:
    """A callout on a feature, by the feature's name.

    Where it comes from the CAD, `source` says so, and what cannot be evaluated is said and does
    not stop the rest; `refused` is the reason where that is known beforehand.
    """

    feature: str
    callout: Callout
    source: str = ""
    refused: str = ""

    @property
    def limits_mm(self) -> tuple[float, float]:
        """Lower and upper limit of the value; geometrical tolerances begin at zero."""
        if self.callout.is_size:
            return self.callout.lower_mm, self.callout.upper_mm
        return float("-inf"), self.callout.tolerance_mm


@dataclass(frozen=True)
class Drawing:
    """All that is asked of a part.

    Attributes
    ----------
    features : mapping of str to Feature
    datums : mapping of str to str
        Feature of every letter.
    requirements : tuple of Requirement
    association : str
        How datums are laid, see `vmach.features.datum_system.ASSOCIATIONS`.
    """

    features: Mapping[str, Feature]
    datums: Mapping[str, str]
    requirements: tuple[Requirement, ...]
    association: str = "least squares"

    def feature(self, name: str) -> Feature:
        """The feature of a name.

        Raises
        ------
        InputError
            There is none.
        """
        if name not in self.features:
            raise InputError(f"there is no feature {name!r}", accepted=", ".join(self.features))
        return self.features[name]

    @property
    def datum_features(self) -> dict[str, Feature]:
        """The features of the datums by their letters."""
        return {letter: self.feature(name) for letter, name in self.datums.items()}


def evaluate(drawing: Drawing, requirement: Requirement, points: Points) -> list[Measure]:
    """The values of one requirement on one part.

    Returns
    -------
    list of Measure
        One; two, the smallest and the largest, for local sizes.

    Raises
    ------
    InputError
        The feature has no points, is of the wrong kind, or contradicts its datums.
    """
    feature, callout = drawing.feature(requirement.feature), requirement.callout
    name = callout.characteristic
    _check_not_its_own_datum(drawing, feature, callout)
    _check_zone(feature, callout)
    if name == "size":
        return size(feature, points, callout)
    if name == "distance":
        return distance(feature, drawing.feature(callout.to), points, callout)
    if name in _FORM:
        return [_FORM[name](feature, points, callout)]
    system = datum_system(callout.datums, drawing.datum_features, points, drawing.association)
    return [_in_frame(drawing, feature, callout, points, system)]


def _in_frame(
    drawing: Drawing, feature: Feature, callout: Callout, points: Points, system: DatumSystem
) -> Measure:
    name = callout.characteristic
    if name in ("parallelism", "perpendicularity", "angularity"):
        primary = drawing.datum_features[callout.datums[0].split("-")[0]]
        return orientation(feature, points, callout, system, primary)
    if name == "coaxiality":
        datum = drawing.datum_features[callout.datums[0].split("-")[0]]
        return coaxiality(feature, points, callout, system, datum)
    if name in ("position", "symmetry"):
        return location(feature, points, callout, system)
    if name == "profile":
        return profile(feature, points, system)
    if name == "profile of line":
        return line_profile(feature, points, callout, system)
    letters = [letter for label in callout.datums for letter in label.split("-")]
    datums = [drawing.datum_features[letter] for letter in letters]
    return runout(feature, points, callout, system, datums)


def _check_not_its_own_datum(drawing: Drawing, feature: Feature, callout: Callout) -> None:
    letters = [letter for label in callout.datums for letter in label.split("-")]
    for letter in letters:
        if drawing.datums.get(letter) == feature.name:
            raise InputError(
                f"tolerance {callout.text!r} of {feature.name!r}, which is datum {letter} itself",
                accepted="datums of other features",
            )


def _check_zone(feature: Feature, callout: Callout) -> None:
    """Refuse a round zone of what has no axis and no centre, or of a form that has none."""
    if callout.is_size or not callout.zone or callout.characteristic == "straightness":
        return
    round_of = _CENTRED if callout.zone == "SØ" else _WITH_AXIS
    if callout.characteristic in _ROUND_ZONES and feature.element in round_of:
        return
    which = feature.kind if callout.characteristic in _ROUND_ZONES else callout.characteristic
    said = f"tolerance {callout.text!r} of {feature.name!r}"
    raise InputError(
        f"{said}: a {which} has no zone with {callout.zone}",
        accepted="the value without it; Ø of an axis, SØ of the centre of a ball",
    )
