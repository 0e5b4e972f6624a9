"""All measurements of a job side by side: what is to be explained, and with what uncertainty.

Source: JCGM 100:2008 (GUM), covariances of the readings as F F^T; closed form derived here: free
offsets are projected out.
"""

from __future__ import annotations

import itertools
import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag

from vmach.base.note import Note
from vmach.effects import Circumstances, Effect, EffectInstance, label_of
from vmach.effects.correlated import acting_together
from vmach.fit.whitening import Whitening, condensed, orthonormal
from vmach.job import Job
from vmach.machine import LINEAR_AXES
from vmach.measurements import Measurement
from vmach.path.preparation import job_doubts
from vmach.path.touched_zero import touched_zero
from vmach.prediction import ActingEffect
from vmach.uncertainty.tables import TableUncertainty

__all__ = ["Survey"]

#: share of u² that a direction of what a law leaves open has at least
_LEAST = 1e-3


@dataclass(frozen=True)
class Survey:
    """Measurements of one machine, n readings in all.

    Attributes
    ----------
    job : Job
    measurements : tuple of Measurement
    effects : tuple of EffectInstance
        Those of the job, which the measurements' predictions hold.
    """

    job: Job
    measurements: tuple[Measurement, ...]
    effects: tuple[EffectInstance, ...] = ()

    def __len__(self) -> int:
        return sum(len(m) for m in self.measurements)

    @cached_property
    def paths(self) -> tuple[Circumstances, ...]:
        """What each measurement's readings depend on."""
        return tuple(Circumstances(m.states, self.job) for m in self.measurements)

    @cached_property
    def seen_paths(self) -> tuple[Circumstances, ...]:
        """What the displacements depend on that each measurement's readings are taken over."""
        return tuple(
            path if m.contacts is None else Circumstances(m.seen_states, self.job)
            for path, m in zip(self.paths, self.measurements, strict=True)
        )

    def thinned(self, least: int) -> Survey:
        """The same with some readings of each measurement that has twice as many as that."""
        measurements = tuple(m.thinned(least) for m in self.measurements)
        is_same = all(map(operator.is_, measurements, self.measurements))
        return self if is_same else replace(self, measurements=measurements)

    def made_beside(self, others: Sequence[ActingEffect]) -> Survey:
        """The same readings, of the surface that is left while further effects act."""
        measurements = tuple(m.made_beside(others) for m in self.measurements)
        return replace(self, measurements=measurements)

    def foretold_mm(self, acting: Sequence[EffectInstance]) -> np.ndarray:
        """What the model and effects foretell of the readings, (n,)."""
        total = np.concatenate([m.predicted_mm for m in self.measurements])
        for effect in acting:
            parts = [
                m.sensed(effect.at(path, effect.parameters)[:, :, None])[:, 0]
                if effect.effect.shows_on(m.seen_states)
                else np.zeros(len(m))
                for path, m in zip(self.seen_paths, self.measurements, strict=True)
            ]
            total += np.concatenate(parts)
        return total

    @property
    def notes(self) -> tuple[Note, ...]:
        """What was noticed of the job and the measurements when they were read."""
        of_measurements = (note for m in self.measurements for note in m.notes)
        return tuple(dict.fromkeys((*job_doubts(self.job), *of_measurements)))

    @cached_property
    def rows(self) -> tuple[slice, ...]:
        """Where the readings of each measurement stand among the n."""
        ends = np.cumsum([0, *(len(m) for m in self.measurements)]).tolist()
        return tuple(itertools.starmap(slice, itertools.pairwise(ends)))

    @cached_property
    def residual_mm(self) -> np.ndarray:
        """Measured minus predicted, (n,)."""
        return np.concatenate([m.measured_mm - m.predicted_mm for m in self.measurements])

    @cached_property
    def u_mm(self) -> np.ndarray:
        """Standard uncertainty of each reading, (n,)."""
        return np.concatenate([m.u_mm for m in self.measurements])

    @cached_property
    def nuisance(self) -> np.ndarray:
        """What the instruments leave free, (n, p)."""
        return block_diag(*(m.nuisance for m in self.measurements))

    def aligned(self, columns: np.ndarray) -> np.ndarray:
        """What the nuisance takes up of columns (n, k), by least squares, (n, k)."""
        basis = self._nuisance_basis
        weight = 1.0 / self.u_mm[:, None]
        return basis @ (basis.T @ (columns * weight)) / weight

    @cached_property
    def _nuisance_basis(self) -> np.ndarray:
        return orthonormal(self.nuisance / self.u_mm[:, None])

    @cached_property
    def group(self) -> np.ndarray:
        """Measurement and group of each reading, (n,) str."""
        return np.concatenate(
            [np.char.add(f"{k}:", m.group.astype(str)) for k, m in enumerate(self.measurements)]
        )

    @cached_property
    def groups(self) -> tuple[np.ndarray, np.ndarray]:
        """Names of all groups, (G,) str, and the number of that of each reading, (n,) int."""
        names, number = np.unique(self.group, return_inverse=True)
        return names, number

    @property
    def has_part(self) -> bool:
        """Whether a machined part was measured."""
        return any(m.on_part for m in self.measurements)

    def zeros_of_runs(self, values: np.ndarray) -> np.ndarray:
        """Mean of values (n,) over the run of an instrument, for each reading; zero on parts."""
        _, number = self.groups
        mean = np.bincount(number, values) / np.bincount(number)
        on_part = np.concatenate([np.full(len(m), m.on_part) for m in self.measurements])
        return np.where(on_part, 0.0, mean[number])

    @cached_property
    def blocks(self) -> np.ndarray:
        """Readings that are held out together, (n,) str: features, runs, stretches of a test."""
        return np.concatenate(
            [
                np.char.add(f"{k}:", m.instrument.blocks(m).astype(str))
                for k, m in enumerate(self.measurements)
            ]
        )

    @cached_property
    def sensing(self) -> np.ndarray:
        """Direction of each reading, (n, 3)."""
        return np.vstack([m.sensing for m in self.measurements])

    @property
    def factors(self) -> np.ndarray:
        """Signatures of what is not known of the model, of unit variance, (n, q) mm; not kept.

        The tables' uncertainty and that of the parameters of the job's effects are the same
        causes in all measurements; what the effects' laws leave open is new in each.
        """
        pairs = list(zip(self.seen_paths, self.measurements, strict=True))
        tables = TableUncertainty.of(self.job.machine)
        parts = [np.vstack([_of_tables(tables, p, m) for p, m in pairs])]
        for group in acting_together(self.effects):
            shared = [np.vstack([m.sensed(e.of_parameters(p)) for p, m in pairs]) for e in group]
            parts.append(np.sum(shared, axis=0))
            parts += [block_diag(*(m.sensed(e.unforeseen(p)) for p, m in pairs)) for e in group]
        for k, part in enumerate(parts):
            parts[k] = part[:, np.abs(part).max(axis=0) > 1e-9]
        return parts[0] if len(parts) == 1 else np.hstack(parts)

    @cached_property
    def whiten(self) -> Whitening:
        """Turns readings into plain unit noise, the tables' uncertainty counted."""
        return Whitening(self.u_mm, self.factors, self.nuisance)

    def signature(
        self, effect: Effect, target: str, inner_values: Mapping[str, float]
    ) -> np.ndarray:
        """What one usual size of each coefficient of an effect does to the readings, (n, K) mm."""
        sensed = [
            m.sensed(_columns(effect, path, target, inner_values)) if _can_show(m, effect) else None
            for path, m in zip(self.seen_paths, self.measurements, strict=True)
        ]
        terms = next((s.shape[1] for s in sensed if s is not None), 0)
        blank = [np.zeros((len(m), terms)) for m in self.measurements]
        return np.vstack([b if s is None else s for s, b in zip(sensed, blank, strict=True)])

    def slack(self, effect: Effect, target: str, parameters: Mapping[str, float]) -> np.ndarray:
        """Signatures of unit variance of what an effect's law leaves open, (n, K) mm.

        Independent in every measurement.
        """
        if effect.slack_share == 0.0:
            return np.zeros((len(self), 0))
        blocks = [
            condensed(
                m.sensed(effect.slack(path, target, parameters)), self.u_mm[own], least=_LEAST
            )
            if _can_show(m, effect)
            else np.zeros((len(m), 0))
            for path, m, own in zip(self.seen_paths, self.measurements, self.rows, strict=True)
        ]
        return block_diag(*blocks)

    def is_tested(self, effect: Effect, target: str) -> bool:
        """Whether an effect is a result, by its standard, of a test that was made along an axis."""
        return label_of(effect.name, target) in self._results

    def is_defined(self, effect: Effect, target: str) -> bool:
        """Whether a test reads just that by definition, as a laser reads a positioning error."""
        return label_of(effect.name, target) in self._defined

    @cached_property
    def _results(self) -> set[str]:
        """Results of all tests, with the axis that each senses, or of whatever axis it turns."""
        along = {said.format(axis=a) for m, a in self._along_axes for said in m.instrument.results}
        whole = {said for m in self.measurements for said in m.instrument.results}
        return along | {said for said in whole if "{axis}" not in said}

    @cached_property
    def _defined(self) -> set[str]:
        """What all tests read by definition, with the axis that each senses."""
        return {said.format(axis=a) for m, a in self._along_axes for said in m.instrument.defines}

    @cached_property
    def _along_axes(self) -> list[tuple[Measurement, str]]:
        """Measurements that sense a single axis, and that axis."""
        axes = list(zip(LINEAR_AXES, np.eye(3), strict=True))
        return [(m, a) for m in self.measurements for a, e in axes if np.all(m.sensing == e)]

    def not_testable(self, effect: Effect, target: str) -> str | None:
        """Why none of the measurements can show the effect, or None."""
        reasons = [
            effect.not_testable(path, target)
            if _can_show(m, effect)
            else "no machined surface was measured"
            for path, m in zip(self.seen_paths, self.measurements, strict=True)
        ]
        return None if any(reason is None for reason in reasons) else reasons[0]

    def inner_grid(self, effect: Effect, target: str) -> list[dict[str, float]]:
        """Starting values of the inner parameters, of the measurement that needs the most."""
        grids = [list(effect.inner_grid(path, target)) for path in self._paths_of(effect)]
        return max(grids, key=len, default=[])

    def places(
        self, effect: Effect, target: str, inner_values: Mapping[str, float]
    ) -> tuple[list[dict[str, float]], np.ndarray]:
        """Inner values to choose among around given ones, (G,), and their log prior (G,).

        Empty for effects whose inner parameters move smoothly.
        """
        found = [effect.places(path, target, inner_values) for path in self._paths_of(effect)]
        pairs = max(found, key=len, default=[])
        weight = np.array([weight for _, weight in pairs])
        return [values for values, _ in pairs], np.log(weight / weight.sum())

    def moments_like(self, effect: Effect, target: str, inner_values: Mapping[str, float]) -> float:
        """How often the pause that a sudden effect fell into goes into all of the time.

        It may have happened at any moment: a pause is as likely as it is long.
        """
        key = effect.name, target, inner_values["time_s"]
        if key not in self._pauses:
            paths = self._paths_of(effect)
            every = [effect.moments_like(path, target, inner_values) for path in paths]
            self._pauses[key] = max(every, default=1.0)
        return self._pauses[key]

    @cached_property
    def _pauses(self) -> dict[tuple[str, str, float], float]:
        """What was asked of moments before."""
        return {}

    def told_apart(self, effect: Effect, inner: Sequence[Mapping[str, float]]) -> np.ndarray:
        """Whether readings may tell each of G places from the one before, (G,) bool.

        Two moments of a sudden effect with no reading between them have the same signature.
        """
        is_new = np.ones(len(inner), dtype=bool)
        if effect.is_sudden and effect.needs_surface:
            moment = [values["time_s"] for values in inner]
            is_new[1:] = np.diff(np.searchsorted(self._moments, moment, side="right")) != 0
        return is_new

    @cached_property
    def _moments(self) -> np.ndarray:
        """When what the readings are taken over was made, in order, (S,) s."""
        return np.sort(np.concatenate([path.time_s for path in self.seen_paths]))

    def _paths_of(self, effect: Effect) -> list[Circumstances]:
        """Of the measurements that could show an effect."""
        pairs = zip(self.seen_paths, self.measurements, strict=True)
        return [path for path, m in pairs if _can_show(m, effect)]


def _columns(
    effect: Effect, path: Circumstances, target: str, inner_values: Mapping[str, float]
) -> np.ndarray:
    """Columns of an effect, (P, 3, K) mm; on a part they count from the zero that was touched."""
    columns = effect.columns(path, target, inner_values)
    zero = None if path.states.normal is None else touched_zero(path.job, path.states)
    if zero is None or effect.needs_surface:
        return columns
    at_touch = Circumstances(zero.states, path.job, path.variant)
    return columns - zero.shift_mm(effect.columns(at_touch, target, inner_values))


def _can_show(measurement: Measurement, effect: Effect) -> bool:
    """Whether its readings can show the effect, as of a machined surface where it needs one."""
    return effect.shows_on(measurement.seen_states)


def _of_tables(tables: TableUncertainty, path: Circumstances, m: Measurement) -> np.ndarray:
    """Signatures of what is not known of the tables, (P, Q) mm."""
    if m.contacts is None:
        return tables.factors(path, m.sensing)
    along = [tables.factors(path, np.tile(axis, (len(path), 1))) for axis in np.eye(3)]
    return m.sensed(np.stack(along, axis=1))
