"""Positioning figures of ISO 230-2 from bidirectional runs, with their uncertainty."""

from vmach.iso230.evaluation import Evaluation, evaluate
from vmach.iso230.uncertainty import Budget, expanded, parameter_uncertainties

__all__ = ["Budget", "Evaluation", "evaluate", "expanded", "parameter_uncertainties"]
