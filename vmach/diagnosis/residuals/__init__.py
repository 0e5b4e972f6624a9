"""Measured minus predicted, before and after the effects that a diagnosis found."""

from vmach.diagnosis.residuals.residuals import Residuals

__all__ = [
    "Residuals",
]
