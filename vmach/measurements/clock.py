"""A clock that nobody noted: at which pace, and in which order, the places of a test were reached.

Tables after ISO 230-2 hold no times, and not which side a run began from. What warms while such a
test lasts depends on both.

Source: M. Abramowitz and I. Stegun, Handbook of Mathematical Functions (1964), 25.4.46, the nodes
and weights of Gauss and Hermite.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vmach.measurements.measurement import Measurement

__all__ = ["FORWARD", "AssumedClock", "Clock"]

#: s that an axis stands at a place; chosen: a laser takes its reading once the axis has settled, a
#: few seconds after it stopped
_STOP_S = 5.0
#: times as quick or as slow as that; chosen: two seconds where a program triggers the reading, a
#: dozen where a person does
_PACE = 2.5
#: of each beside the pace that is taken: the nodes of a normal distribution of the logarithm, of
#: weight 1/6 and 2/3 (Gauss and Hermite, three nodes)
_OTHER_PACE = 0.25
#: sign of the motion that a run is taken to begin with
FORWARD = 1.0
#: that a run begins forward; chosen: custom, and what ISO 230-2 draws
_CUSTOM = 0.75


@dataclass(frozen=True)
class Clock:
    """How long the axis stands at each place, s, and the sign of the motion that runs begin with.

    `weight` is how likely it is beforehand, up to what all clocks of a test share.
    """

    stop_s: float = _STOP_S
    first: float = FORWARD
    weight: float = _CUSTOM

    @property
    def turned(self) -> Clock:
        """Runs that begin from the other side."""
        return replace(self, first=-self.first, weight=1.0 - self.weight)

    @property
    def paces(self) -> tuple[Clock, Clock]:
        """The same runs, quicker and slower."""
        quick, slow, weight = self.stop_s / _PACE, self.stop_s * _PACE, _OTHER_PACE * self.weight
        return replace(self, stop_s=quick, weight=weight), replace(self, stop_s=slow, weight=weight)


@dataclass(frozen=True)
class AssumedClock:
    """The clock of a measurement that states none.

    Attributes
    ----------
    clock : Clock
        The one that is taken.
    order_is_stated : bool
        Whether the file tells the order of its readings.
    read : callable
        The same file by another clock.
    """

    clock: Clock
    order_is_stated: bool
    read: Callable[[Clock], Measurement]

    def turned(self) -> AssumedClock | None:
        """That with runs from the other side, where the file does not tell."""
        return None if self.order_is_stated else replace(self, clock=self.clock.turned)

    def measurement(self) -> Measurement:
        """The file by this clock."""
        return self.read(self.clock)

    def others(self) -> Iterator[AssumedClock]:
        """Other clocks that are possible."""
        for clock in (*self.clock.paces, *([] if self.order_is_stated else [self.clock.turned])):
            yield replace(self, clock=clock)
