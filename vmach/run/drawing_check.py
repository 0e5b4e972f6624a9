"""The drawing of a job against its CAD: every callout that has no sense there, not the first."""

from __future__ import annotations

from collections.abc import Iterator

from vmach.errors import InputError
from vmach.features.evaluation import Drawing, Requirement, evaluate
from vmach.features.feature import Feature, Points
from vmach.job import Job
from vmach.nominal import NominalPart
from vmach.nominal.points import SurfacePoints
from vmach.run.drawing import FeatureFinder, drawing_error
from vmach.run.pmi_drawing import PmiDrawing, pmi_drawing

__all__ = ["drawing_faults"]


def drawing_faults(
    job: Job, nominal: NominalPart | None, points: SurfacePoints
) -> Iterator[InputError]:
    """What is wrong with datums and tolerances, found on a part without deviations.

    Parameters
    ----------
    job : Job
    nominal : NominalPart or None
    points : SurfacePoints
        Where the part will be inspected.

    Yields
    ------
    InputError
        A name that nothing has, a datum that is not defined, a size that the CAD has not, an angle
        that contradicts the datum; each with its line.
    """
    asked = job.drawing
    told = pmi_drawing(nominal, asked.features) if asked.reads_pmi else PmiDrawing()
    finder = FeatureFinder(job, nominal, points)
    features: dict[str, Feature] = {
        name: finder.of_faces(name, faces) for name, faces in told.features.items()
    }
    datums = dict(told.datums)
    for letter, name in asked.datums.items():
        try:
            features[name] = finder.feature(name)
            datums[letter] = name
        except InputError as error:
            yield drawing_error(job, error, "datums", letter, f"datum {letter}")
    lost = asked.datums.keys() - datums.keys()
    part = Points.nominal(points.point_mm, points.normal)
    for name, callout in asked.tolerances:
        if lost & {letter for label in callout.datums for letter in label.split("-")}:
            continue  # said above
        try:
            for wanted in (name, callout.to):
                if wanted:
                    features.setdefault(wanted, finder.feature(wanted))
            requirement = Requirement(name, callout)
            drawing = Drawing(features, datums, (requirement,), asked.association)
            evaluate(drawing, requirement, part)
        except InputError as error:
            said = f"tolerance {callout.text!r} of {name!r}"
            yield drawing_error(job, error, "tolerances", name, said)
