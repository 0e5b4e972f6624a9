"""The models that led to a job, and how the error fell from one to the next."""

from vmach.history.history import Step, draw_history, history_of, rms_um

__all__ = [
    "Step",
    "draw_history",
    "history_of",
    "rms_um",
]
