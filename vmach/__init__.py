"""vmach: predict the part that a real machine tool makes from an NC program.

Everything below is reached as ``vmach.NAME``; docs/api.md describes it, docs/gallery has one
script a question.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vmach.api.comparison import ModelComparison, compare
    from vmach.api.features import evaluate_features
    from vmach.api.machining import (
        accuracy,
        compensate,
        control_tables,
        evaluate_axis,
        read_machine,
    )
    from vmach.api.measuring import add, diagnose
    from vmach.api.path import PathErrors, path_errors
    from vmach.api.points import PointDeviations, predict, surface_points
    from vmach.api.uncertainty import PointIntervals, accuracy_interval, predict_intervals
    from vmach.compensation.compensate import Compensation
    from vmach.diagnosis.diagnose import Diagnosis
    from vmach.effects import Effect, along, inner, linear
    from vmach.effects.catalogue import add_effect
    from vmach.errors import InputError, VmachError
    from vmach.job import Job, read_job
    from vmach.machine import Machine, Variant, displacement
    from vmach.machine.from_arrays import machine_from_arrays
    from vmach.nominal.points import SurfacePoints
    from vmach.run.pipeline import MachinedPart, machine_part
    from vmach.study.run_study import merge_study, run_study
    from vmach.study.study import Study, read_study
    from vmach.volumetric.volumetric import VolumetricAccuracy

__all__ = [
    "Compensation",
    "Diagnosis",
    "Effect",
    "InputError",
    "Job",
    "Machine",
    "MachinedPart",
    "ModelComparison",
    "PathErrors",
    "PointDeviations",
    "PointIntervals",
    "Study",
    "SurfacePoints",
    "Variant",
    "VmachError",
    "VolumetricAccuracy",
    "__version__",
    "accuracy",
    "accuracy_interval",
    "add",
    "add_effect",
    "along",
    "compare",
    "compensate",
    "control_tables",
    "diagnose",
    "displacement",
    "evaluate_axis",
    "evaluate_features",
    "inner",
    "linear",
    "machine_from_arrays",
    "machine_part",
    "merge_study",
    "path_errors",
    "predict",
    "predict_intervals",
    "read_job",
    "read_machine",
    "read_study",
    "run_study",
    "surface_points",
]

__version__ = "0.1.0"

#: where each public name lives; loaded when it is first asked for
_HOMES = {
    "Compensation": "vmach.compensation.compensate",
    "Diagnosis": "vmach.diagnosis.diagnose",
    "Effect": "vmach.effects",
    "InputError": "vmach.errors",
    "Job": "vmach.job",
    "Machine": "vmach.machine",
    "MachinedPart": "vmach.run.pipeline",
    "ModelComparison": "vmach.api.comparison",
    "PathErrors": "vmach.api.path",
    "PointDeviations": "vmach.api.points",
    "PointIntervals": "vmach.api.uncertainty",
    "Study": "vmach.study.study",
    "SurfacePoints": "vmach.nominal.points",
    "Variant": "vmach.machine",
    "VmachError": "vmach.errors",
    "VolumetricAccuracy": "vmach.volumetric.volumetric",
    "accuracy": "vmach.api.machining",
    "accuracy_interval": "vmach.api.uncertainty",
    "add": "vmach.api.measuring",
    "add_effect": "vmach.effects.catalogue",
    "along": "vmach.effects",
    "compare": "vmach.api.comparison",
    "compensate": "vmach.api.machining",
    "control_tables": "vmach.api.machining",
    "diagnose": "vmach.api.measuring",
    "displacement": "vmach.machine",
    "evaluate_axis": "vmach.api.machining",
    "evaluate_features": "vmach.api.features",
    "inner": "vmach.effects",
    "linear": "vmach.effects",
    "machine_from_arrays": "vmach.machine.from_arrays",
    "machine_part": "vmach.run.pipeline",
    "merge_study": "vmach.study.run_study",
    "path_errors": "vmach.api.path",
    "predict": "vmach.api.points",
    "predict_intervals": "vmach.api.uncertainty",
    "read_job": "vmach.job",
    "read_machine": "vmach.api.machining",
    "read_study": "vmach.study.study",
    "run_study": "vmach.study.run_study",
    "surface_points": "vmach.api.points",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'vmach' has no attribute '{name}'")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
