"""Predicted deviation of surface points: the displaced path, swept exactly."""

from vmach.prediction.displaced_path import (
    ActingEffect,
    displaced_sweeps,
    displacement_of,
    of_machine,
)
from vmach.prediction.prediction import Prediction, predict, predict_surface

__all__ = [
    "ActingEffect",
    "Prediction",
    "displaced_sweeps",
    "displacement_of",
    "of_machine",
    "predict",
    "predict_surface",
]
