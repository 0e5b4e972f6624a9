"""What was done, one step after the other, and the way back; no file goes away by it."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace

__all__ = ["Step", "StepsBack"]

_MOST = 100


@dataclass(frozen=True)
class Step:
    """Something that was done.

    Attributes
    ----------
    label : str
        For people: "backlash Y", "+ scale X".
    back, again : callable
        Bring about how it was before, and how it was afterwards.
    gesture : hashable, optional
        Steps of one gesture, such as the dragging of a slider, are one step.
    """

    label: str
    back: Callable[[], object]
    again: Callable[[], object]
    gesture: Hashable = None


class StepsBack:
    """Steps that can be undone, and those that were.

    Parameters
    ----------
    tell : callable
        Called whenever that changes.
    """

    def __init__(self, tell: Callable[[], object]) -> None:
        self._done: list[Step] = []
        self._undone: list[Step] = []
        self._tell = tell
        self._is_at_work = False

    def record(self) -> dict[str, str | None]:
        """Labels of what would be undone, and done again."""
        return {
            "undo": self._done[-1].label if self._done else None,
            "redo": self._undone[-1].label if self._undone else None,
        }

    def did(self, step: Step) -> None:
        """Something was done; not told of what undoing itself does."""
        if self._is_at_work:
            return
        last = self._done[-1] if self._done else None
        if last is not None and step.gesture is not None and last.gesture == step.gesture:
            self._done[-1] = replace(last, again=step.again)
        else:
            self._done = [*self._done, step][-_MOST:]
        self._undone = []
        self._tell()

    def undo(self) -> None:
        """Go one step back, where there is one."""
        self._move(self._done, self._undone, lambda step: step.back)

    def redo(self) -> None:
        """Do again what was undone last."""
        self._move(self._undone, self._done, lambda step: step.again)

    def forget(self) -> None:
        """Another folder is open."""
        self._done, self._undone = [], []
        self._tell()

    def _move(self, source: list[Step], target: list[Step], work) -> None:
        if not source:
            return
        step = source[-1]
        self._is_at_work = True
        try:
            work(step)()
        finally:
            self._is_at_work = False
            source.pop()  # also where its file is gone: no way leads there any more
        target.append(step)
        self._tell()
