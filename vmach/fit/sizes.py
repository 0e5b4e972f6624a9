"""Sizes of what stands beside the effects: the factor on u, and each member's, with their prior.

Source: closed form derived here: slope and information of the prior by the logarithms.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["ABSENT", "LOG_FACTOR", "USUAL_SIZE", "Sizes"]

#: prior of the logarithm of the factor on u: stated uncertainties are right within a factor of 2
LOG_FACTOR = float(np.log(2.0))
#: prior of a member's size, in u: falls off as the fifth power beyond this. What nobody models is
#: of the order of u; a lighter tail would leave it what slow effects do to a few floors. Imitations
#: of something larger are told by their size and by forms, not by this
USUAL_SIZE, _POWER = 0.6, 2.5
#: smallest size of a member, in u, which counts as absent
ABSENT = 0.02


@dataclass(frozen=True)
class Sizes:
    """Factor on u, and the size of each member of unknown size, in median u."""

    factor: float
    members: tuple[float, ...]

    @property
    def each(self) -> np.ndarray:
        """Of the members of known size, which is one, and of each other member, (q,)."""
        return np.array([1.0, *self.members])

    @property
    def logarithms(self) -> np.ndarray:
        """Of the factor and of each member, (q,); a member that is absent has a finite one."""
        return np.log(np.maximum([self.factor, *self.members], 1.01 * ABSENT))

    @classmethod
    def at(cls, logarithms: np.ndarray) -> Sizes:
        """Sizes of given logarithms, (q,)."""
        factor, *members = np.exp(logarithms).tolist()
        return cls(factor, tuple(members))

    def log_prior(self, usual: np.ndarray, limits: np.ndarray) -> float:
        """Logarithm of how likely they are beforehand, up to a constant.

        Parameters
        ----------
        usual : (q - 1,) float64
            Size of each member beyond which it is less likely, in u. May be infinite.
        limits : (q - 1,) float64
            Size of each member from which on it falls off as a normal one, in uncertainties as
            they are: factor times u. May be infinite.
        """
        of_factor = -0.5 * (np.log(self.factor) / LOG_FACTOR) ** 2
        ratio, beyond = self._squared_ratios(usual, limits)
        return float(of_factor - (_POWER * np.log1p(ratio) + 0.5 * beyond).sum())

    def slope_of_prior(self, usual: np.ndarray, limits: np.ndarray) -> np.ndarray:
        """Derivative of `log_prior` by the logarithms, (q,)."""
        ratio, beyond = self._squared_ratios(usual, limits)
        of_factor = beyond.sum() - np.log(self.factor) / LOG_FACTOR**2
        return np.array([of_factor, *(-2 * _POWER * ratio / (1 + ratio) - beyond)])

    def information_of_prior(self, usual: np.ndarray, limits: np.ndarray) -> np.ndarray:
        """Second derivative of minus `log_prior` by the logarithms, (q, q)."""
        ratio, beyond = self._squared_ratios(usual, limits)
        of_members = 4 * _POWER * ratio / (1 + ratio) ** 2 + 2 * beyond
        information = np.diag([1.0 / LOG_FACTOR**2 + 2 * beyond.sum(), *of_members])
        information[0, 1:] = information[1:, 0] = -2 * beyond
        return information

    def _squared_ratios(
        self, usual: np.ndarray, limits: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Of the members' sizes to the usual one, and to their limits."""
        members = np.array(self.members)
        return (members / usual) ** 2, (members / (self.factor * limits)) ** 2
