"""What happens at one moment: which moments the points tell apart, and how likely each is.

Source: M. Abramowitz and I. Stegun, Handbook of Mathematical Functions (1964), table 25.4:
Gauss-Legendre rule of three points.
"""

import math

import numpy as np

from vmach.effects.effect import Effect
from vmach.effects.parameter import inner

__all__ = ["Sudden", "moment"]

#: pauses between points in which a search begins
_LONGEST = 60
#: moments within a pause and their shares: all fit alike, together they are as spread as it is
_WITHIN = ((0.0, 8 / 18), (-0.5 * math.sqrt(0.6), 5 / 18), (0.5 * math.sqrt(0.6), 5 / 18))


def moment(meaning: str):
    """The parameter ``time_s``: any moment is as good as another."""
    return inner("time_s", meaning, (0.0, 1e6), usual=1000.0, spread=math.inf)


class Sudden(Effect):
    """Base of the effects that begin at one moment, their inner parameter ``time_s``."""

    is_sudden = True

    def sees(self, path, target) -> np.ndarray:
        """Which states could show it, (P,) bool."""
        return np.ones(len(path), dtype=bool)

    def not_testable(self, path, target):
        time = path.time_s[self.sees(path, target)]
        few = f"no two places at different times show {target or 'it'}"
        return None if len(np.unique(time)) > 1 else few

    def inner_grid(self, path, target):
        """Moments in the longest pauses between points."""
        middle, _, longest = self._pauses(path, target)
        for when in middle[longest]:
            yield {"time_s": float(when)}

    def places(self, path, target, inner_values):
        """The longest pauses, and every one between the two beside a moment.

        It may have happened at any time, so that a pause is as likely as it is long, and three
        moments stand for all of it.
        """
        middle, length, longest = self._pauses(path, target)
        tried = np.append(middle[longest], (-np.inf, np.inf))
        here = inner_values["time_s"]
        low, high = tried[tried < here].max(), tried[tried > here].min()
        chosen = ((middle > low) & (middle < high)) | np.isin(middle, tried)
        pairs = zip(middle[chosen].tolist(), length[chosen].tolist(), strict=True)
        return [
            ({"time_s": when + where * seconds}, share * seconds)
            for when, seconds in pairs
            for where, share in _WITHIN
        ]

    def moments_like(self, path, target, inner_values):
        """How often the pause around the moment goes into all of them."""
        time = np.unique(path.time_s[self.sees(path, target)])
        last = np.clip(np.searchsorted(time, inner_values["time_s"]), 1, len(time) - 1)
        return float((time[-1] - time[0]) / (time[last] - time[last - 1]))

    def _pauses(self, path, target) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Middle and length of every pause between points, and the indices of the longest."""
        time = np.unique(path.time_s[self.sees(path, target)])
        length = np.diff(time)
        longest = np.sort(np.argsort(length)[::-1][:_LONGEST])
        return 0.5 * (time[:-1] + time[1:]), length, longest
