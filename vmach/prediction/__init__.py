"""Predicted deviation of surface points: the displaced path, swept exactly."""

from vmach.prediction.prediction import (
    ActingEffect,
    Prediction,
    displaced_sweeps,
    displacement_of,
    of_machine,
    predict,
    predict_surface,
)

__all__ = [
    "ActingEffect",
    "Prediction",
    "displaced_sweeps",
    "displacement_of",
    "of_machine",
    "predict",
    "predict_surface",
]
