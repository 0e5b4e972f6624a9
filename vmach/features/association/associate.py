"""Lay a nominal surface through points: least squares, minimum zone, contacting surfaces.

The surface is carried to the points by a rigid motion, and its own sizes may change. Motions
that leave the surface as it is (along a cylinder, within a plane) are left out by the rank of the
equations. Every criterion is solved by linear steps from the nominal surface until they vanish.

Source: ISO 17450-3 (association), ISO 14405-1 (inscribed and circumscribed); Gauss-Newton steps
for least squares; successive linear programs for the minimum zone (Anthony, Anthony, Cox, Forbes,
Reference software for finding Chebyshev best-fit geometric elements, 1996).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vmach.errors import InputError
from vmach.features.association.criteria import PROBLEMS
from vmach.features.association.linear_program import solve
from vmach.features.association.pose import Pose, motion_rows
from vmach.features.surface import Compound, Surface

__all__ = ["CRITERIA", "Association", "associate", "row_space"]

#: what may be asked of the associated surface
CRITERIA = ("least squares", "minimum zone", "tangent", "inscribed", "circumscribed")

#: steps below this share of the size of the feature end the iteration
_STILL = 1e-14
#: singular values below this share of the largest belong to motions that change nothing
RANK = 1e-7
_ITERATIONS = 100
_ROUND = ("inscribed", "circumscribed")
#: points lie on one side where a direction has at least this share of all that point to them
_ONE_SIDED = 1e-9
#: a radius that still gains this much in the last step has no end; a flat optimum gains less, mm
_OPEN_MM = 1e-7


@dataclass(frozen=True)
class Association:
    """A surface laid through N points.

    Attributes
    ----------
    pose : Pose
        Carries the nominal surface to the points.
    surface : Surface
        The nominal surface with its sizes as found, before `pose`.
    residual_mm : (N,) float64
        Distances of the points from the surface, positive outside the material.
    value_mm : float
        What the criterion makes small or large: sum of squares, width of the zone, radius.
    weight : (N,) float64
        Change of `value_mm` with the distance of each point; zero for least squares.
    gain : (6 + K, N) float64
        Change of the motion about `about_mm`, and of the sizes, with the distance of each point.
    rows : (N, 6 + K) float64
        Distance that a unit motion or size gives to each point.
    about_mm : (3,) float64
    """

    pose: Pose
    surface: Surface
    residual_mm: np.ndarray
    value_mm: float
    weight: np.ndarray
    gain: np.ndarray
    rows: np.ndarray
    about_mm: np.ndarray

    @property
    def placed(self) -> Surface:
        """The surface as found, in workpiece coordinates."""
        point = self.pose.apply(self.surface.point_mm[None])[0]
        return replace(self.surface, point_mm=point, axis=self.pose.turn @ self.surface.axis)


def associate(
    surface: Surface | Compound,
    points: np.ndarray,
    *,
    criterion: str = "least squares",
    pose: Pose | None = None,
    basis: np.ndarray | None = None,
    about_mm: np.ndarray | None = None,
    is_sized: bool = True,
) -> Association:
    """Lay a surface through points.

    Parameters
    ----------
    surface : Surface
        Nominal; the points lie near it.
    points : (N, 3) array
        mm.
    criterion : str
        One of `CRITERIA`. ``tangent`` stays outside the material, with the least largest
        distance; ``inscribed`` and ``circumscribed`` are for cylinders and spheres.
    pose : Pose, optional
        Where to begin.
    basis : (6, F) array, optional
        Motions that are allowed, about `about_mm`; all where left out.
    about_mm : (3,) array, optional
        Point that the motions turn about; the middle of the points where left out.
    is_sized : bool
        Whether the sizes of the surface may change.

    Raises
    ------
    InputError
        Fewer points than unknowns, or a criterion that the surface does not have.
    """
    _check(surface, points, criterion)
    pose = pose or Pose()
    about = pose.undo(points).mean(axis=0) if about_mm is None else about_mm
    length = _length_mm(pose.undo(points), about)
    state = _State(surface, pose, points, about, length, is_sized)
    allowed = state.allowed(basis)
    if criterion == "least squares":
        return _least_squares(state, allowed)
    return _extremal(state, allowed, criterion)


def _check(surface: Surface, points: np.ndarray, criterion: str) -> None:
    if criterion not in CRITERIA:
        raise InputError(f"association {criterion!r}", accepted=", ".join(CRITERIA))
    if criterion in _ROUND and surface.kind not in ("cylinder", "sphere"):
        raise InputError(
            f"{criterion} association of a {surface.kind}", accepted="a cylinder or a sphere"
        )
    if not len(points):
        raise InputError("no points to associate a feature with")


def _length_mm(points: np.ndarray, about: np.ndarray) -> float:
    return float(np.sqrt(((points - about) ** 2).sum(axis=1).mean())) or 1.0


@dataclass(frozen=True)
class _State:
    """Where the iteration stands."""

    surface: Surface
    pose: Pose
    points: np.ndarray
    about_mm: np.ndarray
    length_mm: float
    is_sized: bool

    @property
    def sizes(self) -> int:
        return len(self.surface.sizes) if self.is_sized else 0

    @property
    def scale(self) -> np.ndarray:
        """Unit of every unknown: mm for shifts and lengths, turns at the points' distance."""
        turn = 1.0 / self.length_mm
        names = self.surface.sizes if self.is_sized else ()
        own = [turn if name.endswith("_rad") else 1.0 for name in names]
        return np.array([1.0, 1.0, 1.0, turn, turn, turn, *own])

    def allowed(self, basis: np.ndarray | None) -> np.ndarray:
        """Allowed motions and the sizes, in units of `scale`, (6 + K, F + K)."""
        motions = np.eye(6) if basis is None else basis / self.scale[:6, None]
        if motions.shape[1]:
            motions = np.linalg.qr(motions)[0]
        free = np.zeros((6 + self.sizes, motions.shape[1] + self.sizes))
        free[:6, : motions.shape[1]] = motions
        free[6:, motions.shape[1] :] = np.eye(self.sizes)
        return free

    def look(self) -> tuple[np.ndarray, np.ndarray]:
        """Distances (N,), and what a unit of every unknown takes from them, (N, 6 + K)."""
        seen = self.pose.undo(self.points)
        distance, normals, own = self.surface.rows(seen)
        rows = motion_rows(seen, normals, self.about_mm)
        rows = np.hstack([rows, own]) if self.sizes else rows
        return distance, rows * self.scale

    def moved(self, step: np.ndarray) -> _State:
        """One step on, (6 + K,) in units of `scale`."""
        step = step * self.scale
        pose = self.pose.after(step[:6], self.about_mm)
        surface = self.surface.resized(step[6:]) if self.sizes else self.surface
        return replace(self, pose=pose, surface=surface)

    def result(self, value: float, weight: np.ndarray, gain: np.ndarray) -> Association:
        distance, rows = self.look()
        return Association(
            self.pose, self.surface, distance, value, weight, gain * self.scale[:, None],
            rows / self.scale, self.about_mm,
        )  # fmt: skip


def row_space(rows: np.ndarray, free: np.ndarray) -> np.ndarray:
    """The part of the span of `free` (U, F) that changes rows (N, U), (U, R)."""
    if free.shape[1] == 0:
        return free
    _, size, right = np.linalg.svd(rows @ free, full_matrices=False)
    return free @ right[size > RANK * max(float(np.linalg.norm(rows, 2)), 1e-300)].T


def _least_squares(state: _State, allowed: np.ndarray) -> Association:
    distance, rows = state.look()
    basis = row_space(rows, allowed)
    _check_count(state, allowed.shape[1])
    for _ in range(_ITERATIONS):
        step, *_ = np.linalg.lstsq(rows @ basis, distance, rcond=None)
        state = state.moved(basis @ step)
        distance, rows = state.look()
        if np.abs(step).max(initial=0.0) <= _STILL * state.length_mm:
            break
    gain = basis @ np.linalg.pinv(rows @ basis)
    return state.result(float(distance @ distance), np.zeros(len(distance)), gain)


def _check_count(state: _State, allowed: int) -> None:
    """Refuse fewer points than unknowns, of which the surface has its own and `allowed` some."""
    own = _UNKNOWNS.get(state.surface.kind, 0)
    needed = min(own - (0 if state.is_sized else len(state.surface.sizes)), allowed)
    if len(state.points) < needed:
        raise InputError(
            f"{len(state.points)} points for a {state.surface.kind}",
            accepted=f"at least {needed} points that are cut",
        )


#: unknowns of a surface: the motions that change it, and its sizes
_UNKNOWNS = {"plane": 3, "cylinder": 5, "cone": 6, "sphere": 4, "torus": 7}


def _extremal(state: _State, allowed: np.ndarray, criterion: str) -> Association:
    """Linear programs from the least squares surface on, within a region that is trusted."""
    if not allowed.shape[1]:
        return _as_it_lies(state, criterion)
    start = _least_squares(state, allowed)
    state = replace(state, pose=start.pose, surface=start.surface)
    if criterion in _ROUND:
        _check_all_round(state, criterion)
        allowed = allowed[:, : allowed.shape[1] - state.sizes]
    distance, rows = state.look()
    basis = row_space(rows, allowed)
    if not basis.shape[1]:
        return _as_it_lies(state, criterion)
    problem = PROBLEMS[criterion]
    trust = max(float(np.abs(distance).max()), 1e-9) * 20.0
    best, weight = problem.value(state, distance), np.zeros(len(distance))
    active = np.zeros(len(distance), bool)
    for _ in range(_ITERATIONS):
        step, weight, promised = problem.step(state, distance, rows @ basis, trust)
        trial = state.moved(basis @ step)
        reached = problem.value(trial, trial.look()[0])
        hoped = best - promised
        active = np.abs(weight) > 1e-9
        if reached < best or criterion == "tangent":
            gained = best - reached
            state, best = trial, reached
            distance, rows = state.look()
            if np.abs(step).max(initial=0.0) < 0.5 * trust and abs(gained) < 1e-13:
                break
        else:
            trust /= 4.0
        if (hoped < 1e-12 and criterion != "tangent") or trust < 1e-13:
            break
    else:
        if criterion in _ROUND and hoped > _OPEN_MM:
            raise _not_all_round(state, criterion)
    gain = basis @ _active_gain(rows @ basis, active, problem.level(state, weight))
    return state.result(problem.reported(best), problem.reported_weight(weight), gain)


def _check_all_round(state: _State, criterion: str) -> None:
    """Refuse points on one side: an inscribed surface would grow, the other one shrink to them."""
    away = state.surface.rows(state.pose.undo(state.points))[1]
    # the direction d with the largest t for which away . d >= t, both within 1
    table = np.hstack([away, -np.ones((len(away), 1))])
    found = solve(np.array([0.0, 0.0, 0.0, -1.0]), table, np.zeros(len(away)), np.ones(4))
    if found.x[3] > _ONE_SIDED:
        raise _not_all_round(state, criterion)


def _not_all_round(state: _State, criterion: str) -> InputError:
    return InputError(
        f"{criterion} {state.surface.kind} of points that do not go all round",
        accepted="points on all sides",
        hint="least squares takes less than half a turn",
    )


def _as_it_lies(state: _State, criterion: str) -> Association:
    """The symmetrical zone about a surface that nothing may move."""
    distance, rows = state.look()
    if criterion != "minimum zone":
        raise InputError(f"{criterion} association with nothing free", accepted="minimum zone")
    weight = np.zeros(len(distance))
    worst = int(np.abs(distance).argmax())
    weight[worst] = np.sign(distance[worst]) or 1.0
    gain = np.zeros((rows.shape[1], len(rows)))
    return state.result(2.0 * float(np.abs(distance[worst])), 2.0 * weight, gain)


def _active_gain(rows: np.ndarray, active: np.ndarray, level: np.ndarray) -> np.ndarray:
    """How the unknowns follow the points that the surface touches, (R, N).

    At those points the distance is `level`, (N,), times the value that the criterion finds.
    """
    gain = np.zeros((rows.shape[1], len(rows)))
    if active.any():
        table = np.hstack([rows[active], level[active, None]])
        gain[:, active] = np.linalg.pinv(table)[:-1]
    return gain
