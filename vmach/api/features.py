"""What the drawing asks for, from Python."""

from __future__ import annotations

from pathlib import Path

from vmach.errors import InputError
from vmach.features.result import FeatureResult
from vmach.job import Job, read_job
from vmach.machine import Variant
from vmach.machine.variant_name import variant_called
from vmach.run.pipeline import machine_part

__all__ = ["evaluate_features"]


def evaluate_features(
    job: Job | str | Path, *, model: str = Variant.ABBE
) -> tuple[FeatureResult, ...]:
    """Values and verdicts of everything that a job's drawing asks for.

    Parameters
    ----------
    job : Job or path
        With ``[tolerances]``, or tolerances in its STEP file.
    model : {"abbe", "htm", "none"}

    Returns
    -------
    tuple of FeatureResult
        `values` has the predicted value by the model's name, and ``measured`` where the part was:
        value and standard uncertainty in mm, verdict after ISO 14253-1.

    Raises
    ------
    InputError, gcode.ProgramError
        Anything wrong with the files; or the job asks for nothing.

    Examples
    --------
    >>> import vmach
    >>> first, *_ = vmach.evaluate_features("samples/iso10791_7")
    >>> first.feature, first.characteristic, str(first.values["abbe"].verdict)
    ('centre hole', 'cylindricity', 'conforms')
    """
    read, variant = read_job(job), variant_called(model)
    made = machine_part(read, model=variant, variants=(variant,), prefer_measured=True, solid=False)
    if not made.features:
        raise InputError(
            "the job asks for no feature",
            file=read.path,
            accepted='[tolerances], as bore = "35 H7", or tolerances in the STEP file',
        )
    return made.features
