"""Measured minus predicted, before and after the effects that a diagnosis found."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vmach.base.units import um_from_mm
from vmach.diagnosis.gates.absorbing import absorbing, slack_of
from vmach.fit.marginal_likelihood import Posterior
from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.survey import Survey
from vmach.fit.terms import JointFit
from vmach.fit.whitening import Whitening

__all__ = ["Residuals"]


@dataclass(frozen=True)
class Residuals:
    """What the model misses in each of n readings, alone and with the effects of a fit.

    Attributes
    ----------
    survey : Survey
    noise : Posterior
        Of what counts as noise beside the effects.
    fit : JointFit or None
        Of the effects found.
    """

    survey: Survey
    noise: Posterior
    fit: JointFit | None

    @property
    def states(self) -> tuple[str, ...]:
        """What there is to look at: "before", and "after" where effects were fitted."""
        return ("before",) if self.fit is None else ("before", "after")

    def of(self, state: str) -> np.ndarray:
        """Measured minus predicted, aligned, "before" or "after", (n,) mm."""
        return self.before_mm if state == "before" else self.after_mm

    @cached_property
    def explained_mm(self) -> np.ndarray:
        """What the effects do to the readings, (n,)."""
        if self.fit is None:
            return np.zeros(len(self.survey))
        return np.sum([self.fit.explained_mm(k) for k in range(len(self.fit.terms))], axis=0)

    @property
    def left_mm(self) -> np.ndarray:
        """Measured minus predicted with the effects, nothing aligned, (n,)."""
        return self.survey.residual_mm - self.explained_mm

    @cached_property
    def before_mm(self) -> np.ndarray:
        """Measured minus predicted, alignment and zeros taken off, (n,)."""
        return self.aligned(self.survey.residual_mm)

    @cached_property
    def after_mm(self) -> np.ndarray:
        """The same with the effects in the prediction, (n,)."""
        return self.aligned(self.left_mm)

    def aligned(self, values_mm: np.ndarray) -> np.ndarray:
        """Values (n,) or (n, k) without what the instruments leave free."""
        columns = values_mm if values_mm.ndim == 2 else values_mm[:, None]
        return (columns - self.survey.aligned(columns)).reshape(values_mm.shape)

    @cached_property
    def _slack_mm(self) -> np.ndarray:
        """Signatures of unit variance of what the effects' laws leave open, (n, k)."""
        return (
            np.zeros((len(self.survey), 0)) if self.fit is None else slack_of(self.survey, self.fit)
        )

    @property
    def open_mm(self) -> np.ndarray:
        """Standard uncertainty that the effects' laws leave each aligned reading, (n,)."""
        return np.sqrt((self.aligned(self._slack_mm) ** 2).sum(axis=1))

    @cached_property
    def causes_mm(self) -> np.ndarray:
        """Signatures of unit variance of what several readings have in common as noise, (n, q)."""
        members, base = self.noise.members, self.noise.base
        size = self.noise.sizes.each[base.member_of[members.here]]
        return base.members.every_mm[:, members.here] * size

    def class_u_mm(self, mean: np.ndarray, *, after: bool) -> np.ndarray:
        """Standard uncertainty of weighted sums of the aligned residual, (c,).

        Parameters
        ----------
        mean : (c, n) float64
            A row of weights for each sum, such as the mean over a class of readings.
        after : bool
            Whether what the effects' laws leave open counts.
        """
        squared, single = self.survey.u_mm**2, self.noise.base.noise
        assert isinstance(single, FeatureNoise)
        # an alignment is symmetric in readings divided by their uncertainty
        rows = self.aligned((mean * squared).T).T / squared
        causes = np.hstack([self.causes_mm, self._slack_mm]) if after else self.causes_mm
        alone = self.noise.sizes.factor * single.deviations(rows.T)
        return np.sqrt((alone**2).sum(axis=0) + ((rows @ causes) ** 2).sum(axis=1))

    @cached_property
    def _absorb(self) -> Whitening | None:
        return None if self.fit is None else absorbing(self.survey, self.noise.whiten, self.fit)

    def white(self, values_mm: np.ndarray, *, after: bool) -> np.ndarray:
        """Values (n,) or (n, k) in unit noise without what is free: zeros, and after the effects.

        Parameters
        ----------
        values_mm : (n,) or (n, k) float64
        after : bool
            Whether the effects found are taken out too, with all that is open about them.
        """
        white = self.noise.whiten(values_mm)
        return self._absorb(white) if after and self._absorb is not None else white

    @cached_property
    def _squares_mm2(self) -> dict[str, np.ndarray]:
        """Of every reading before, after, and of what noise and the tables' uncertainty make."""
        factors = self.aligned(self.survey.factors)
        noise = self.survey.u_mm**2 + (factors**2).sum(axis=1)
        return {"before": self.before_mm**2, "after": self.after_mm**2, "expected_noise": noise}

    @property
    def rms_um(self) -> dict[str, float]:
        """RMS before, after, and what noise and the tables' uncertainty make."""
        return self._rms_um(slice(None))

    @property
    def rms_um_by_measurement(self) -> list[tuple[str, dict[str, float]]]:
        """The same of every measurement, with the name of its file."""
        pairs = zip(self.survey.measurements, self.survey.rows, strict=True)
        return [(m.name, self._rms_um(rows)) for m, rows in pairs]

    def _rms_um(self, rows: slice) -> dict[str, float]:
        squares = self._squares_mm2.items()
        return {k: float(um_from_mm(np.sqrt(np.mean(v[rows])))) for k, v in squares}
