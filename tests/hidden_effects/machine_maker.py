"""A random three-axis machine: error curves, reflectors, squareness, exact displacement, files."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

__all__ = [
    "CHAINS",
    "ErrorCurve",
    "TrueMachine",
    "random_machine",
    "rotation_matrices",
    "write_machine",
]

CHAINS = (
    "t (C) Z Y b X' w",
    "t (C) Z b Y' X' w",
    "t (C) Z X b Y' w",
    "t (C) Z Y X b w",
    "t (C) Z b X' Y' w",
)
AXES = "XYZ"
#: noise of the calibration: linear um, angular urad, squareness urad
TABLE_NOISE_UM, TABLE_NOISE_URAD, SQUARENESS_NOISE_URAD = 0.3, 0.4, 1.0


@dataclass(frozen=True)
class ErrorCurve:
    """Smooth random function of one axis position: slope and five half waves over the travel.

    `amplitude` (5,) and `slope` in um or urad; positions in mm.
    """

    low_mm: float
    high_mm: float
    slope: float
    amplitude: np.ndarray
    phase: np.ndarray

    def __call__(self, position_mm: np.ndarray) -> np.ndarray:
        u = (np.asarray(position_mm) - self.low_mm) / (self.high_mm - self.low_mm)
        waves = np.arange(1, 6) * np.pi * u[..., None] + self.phase
        return self.slope * (u - 0.5) + np.sin(waves) @ self.amplitude


@dataclass
class TrueMachine:
    """What the machine is: nature's own record.

    `curves` maps "EXX" ... to the error (um, urad) at the origin of the carriage frame, tool
    relative to workpiece; `reflector_mm` to where its reading was taken, in that same frame.
    `squareness_urad` maps "C0Y", "B0X", "A0Y".
    """

    chain: str
    travel_mm: dict[str, tuple[float, float]]
    curves: dict[str, ErrorCurve]
    reflector_mm: dict[str, np.ndarray]
    squareness_urad: dict[str, float]
    rapid_mm_min: float = 20000.0
    tool_change_s: float = 8.0
    extra: dict[str, object] = field(default_factory=dict)

    @property
    def tool_side(self) -> list[str]:
        """Axes from the bed to the tool."""
        left = self.chain.split("b")[0]
        return [c for c in reversed(left) if c in AXES]

    @property
    def work_side(self) -> list[str]:
        """Axes from the bed to the workpiece."""
        return [c for c in self.chain.split("b")[1] if c in AXES]

    def component(self, name: str, position_mm: np.ndarray) -> np.ndarray:
        """Error at the carriage frame's origin, with what nature changed since: um or urad."""
        value = self.curves[name](position_mm)
        change = self.extra.get(name)
        return value if change is None else value + change(position_mm)

    def displacement_mm(self, nose_mm: np.ndarray, contact_mm: np.ndarray) -> np.ndarray:
        """Tool point against workpiece, actual minus nominal, by products of exact matrices.

        Parameters
        ----------
        nose_mm : (N, 3)
            Programmed position of the spindle nose.
        contact_mm : (N, 3)
            From the nose to the point of the tool that is asked for.
        """
        tool = _product([self._joint(axis, nose_mm, +1) for axis in self.tool_side], len(nose_mm))
        work = _product([self._joint(axis, nose_mm, -1) for axis in self.work_side], len(nose_mm))
        point = np.concatenate([contact_mm, np.ones((len(nose_mm), 1))], axis=1)
        seen = np.linalg.solve(work, tool @ point[:, :, None])[:, :3, 0]
        return seen - (nose_mm + contact_mm)

    def _joint(self, axis: str, nose_mm: np.ndarray, side: int) -> np.ndarray:
        """S Tr S^-1 E of one carriage, (N, 4, 4); side -1: the axis carries the workpiece."""
        index = AXES.index(axis)
        q = nose_mm[:, index]
        shift = np.stack([self.component(f"E{c}{axis}", q) for c in "XYZ"], axis=1) * 1e-3
        turn = np.stack([self.component(f"E{c}{axis}", q) for c in "ABC"], axis=1) * 1e-6
        square = {
            "X": (0.0, self.squareness_urad["B0X"], 0.0),
            "Y": (self.squareness_urad["A0Y"], 0.0, self.squareness_urad["C0Y"]),
            "Z": (0.0, 0.0, 0.0),
        }[axis]
        direction = rotation_matrices(np.array([square]) * 1e-6)[0][:, index]
        travel = np.tile(np.eye(4), (len(q), 1, 1))
        travel[:, :3, 3] = side * q[:, None] * direction
        error = np.tile(np.eye(4), (len(q), 1, 1))
        error[:, :3, :3] = rotation_matrices(side * turn)
        error[:, :3, 3] = side * shift
        return travel @ error


def _product(joints: list[np.ndarray], count: int) -> np.ndarray:
    total = np.tile(np.eye(4), (count, 1, 1))
    for joint in joints:
        total = total @ joint
    return total


def rotation_matrices(vector_rad: np.ndarray) -> np.ndarray:
    """Rodrigues' formula, (N, 3) -> (N, 3, 3)."""
    angle = np.linalg.norm(vector_rad, axis=1)[:, None, None]
    k = np.zeros((len(vector_rad), 3, 3))
    x, y, z = vector_rad.T
    k[:, 0, 1], k[:, 0, 2], k[:, 1, 2] = -z, y, -x
    k[:, 1, 0], k[:, 2, 0], k[:, 2, 1] = z, -y, x
    sine = np.sinc(angle / np.pi)
    half = 0.5 * np.sinc(angle / 2 / np.pi) ** 2
    return np.eye(3) + sine * k + half * (k @ k)


def random_machine(rng: np.random.Generator, chain: str | None = None) -> TrueMachine:
    """A machine drawn from the sizes that published calibrations show."""
    chain = chain or str(rng.choice(CHAINS))
    length = {"X": rng.integers(16, 21) * 50, "Y": rng.integers(10, 13) * 50, "Z": 460}
    travel = {axis: (-float(length[axis]), 0.0) for axis in AXES}
    curves, reflectors = {}, {}
    for axis in AXES:
        for kind in "XYZABC":
            name = f"E{kind}{axis}"
            curves[name] = _random_curve(rng, travel[axis], _size_of(kind, axis))
            if kind in "XYZ":
                reflectors[name] = _random_reflector(rng, chain, axis, travel)
    square = {name: float(rng.uniform(-30, 30)) for name in ("C0Y", "B0X", "A0Y")}
    return TrueMachine(chain, travel, curves, reflectors, square)


def _size_of(kind: str, axis: str) -> float:
    if kind == axis:
        return 8.0
    return 4.0 if kind in "XYZ" else 14.0


def _random_curve(rng: np.random.Generator, travel_mm: tuple, size: float) -> ErrorCurve:
    fall = np.array([1.0, 0.7, 0.35, 0.15, 0.07])
    return ErrorCurve(
        *travel_mm,
        slope=float(size * rng.normal()),
        amplitude=size * fall * rng.normal(size=5) * 0.7,
        phase=rng.uniform(0, 2 * np.pi, 5),
    )


def _random_reflector(rng: np.random.Generator, chain: str, axis: str, travel: dict) -> np.ndarray:
    """Where a laser's reflector sits in the frame of the body that the axis carries, mm."""
    carries_work = axis in chain.split("b")[1]
    low = np.array([travel[a][0] for a in AXES])
    if carries_work:  # on the table: about where a part stands, some 150 mm below the nose
        return low * rng.uniform(0.2, 0.8, 3) + np.array([0, 0, -150.0])
    place = np.array([rng.uniform(-120, 20), rng.uniform(-60, 60), rng.uniform(-260, -120)])
    nearer = _axes_nearer_the_tool(chain, axis)
    for other in nearer:  # the axes between were parked somewhere while the line was measured
        index = AXES.index(other)
        place[index] += low[index] * rng.uniform(0.2, 0.8)
    return place


def _axes_nearer_the_tool(chain: str, axis: str) -> list[str]:
    order = [c for c in chain.split("b")[0] if c in AXES]  # from the tool to the bed
    return order[: order.index(axis)]


def write_machine(
    folder: Path,
    machine: TrueMachine,
    rng: np.random.Generator,
    *,
    missing: tuple[str, ...] = (),
    misplaced: dict[str, np.ndarray] | None = None,
    turned_round: tuple[str, ...] = (),
    noisy: bool = True,
) -> None:
    """machine.toml and errors/*.csv as a calibration at health would have given them.

    Parameters
    ----------
    missing : names of tables that nobody measured
    misplaced : name -> where the record says that the reflector stood, mm, though it did not
    turned_round : names of tables that are written with the other sign
    """
    (folder / "errors").mkdir(parents=True, exist_ok=True)
    lines = _header(machine)
    for axis in AXES:
        for kind in "XABYCZ":
            name = f"E{kind}{axis}"
            if name in missing:
                lines.append(f"# {name}: not measured")
                continue
            sign = -1.0 if name in turned_round else 1.0
            noise = rng if noisy else None
            _write_table(folder / "errors" / f"{name}.csv", machine, name, rng=noise, sign=sign)
            lines += [f"[errors.{name}]", f'table = "errors/{name}.csv"']
            if kind in "XYZ":
                place = (misplaced or {}).get(name, machine.reflector_mm[name])
                lines.append(f"measured_at_mm = [{', '.join(f'{v:.1f}' for v in place)}]")
    lines += ["", "[squareness]  # urad; C0Y: dx = -C0Y*y, B0X: dz = -B0X*x, A0Y: dz = +A0Y*y"]
    for name, value in machine.squareness_urad.items():
        noise = SQUARENESS_NOISE_URAD * rng.normal() if noisy else 0.0
        lines.append(f"E{name} = {value + noise:.4f}")
    (folder / "machine.toml").write_text("\n".join(lines) + "\n")


def _header(machine: TrueMachine) -> list[str]:
    lines = [
        "schema = 1",
        'name = "machine"',
        f'chain = "{machine.chain}"',
        "[convention]",
        'origin = "spindle nose with every axis at home; axes as in ISO 841"',
        'sign = "displacement of the tool relative to the workpiece, rotations right-handed"',
        'length = "um"',
        'angle = "urad"',
        "[motion]",
        f"rapid_mm_min = {machine.rapid_mm_min:g}",
        f"tool_change_s = {machine.tool_change_s:g}",
    ]
    for axis, (low, high) in machine.travel_mm.items():
        lines += [f"[axes.{axis}]", f"travel_mm = [{low:g}, {high:g}]"]
    return lines


def _write_table(
    path: Path, machine: TrueMachine, name: str, *, rng: np.random.Generator | None, sign: float
) -> None:
    axis = name[2]
    low, high = machine.travel_mm[axis]
    step = 25.0 if high - low < 480 else 50.0
    position = np.unique(np.append(np.arange(low, high, step), high))
    reading = machine.curves[name](position)
    if name[1] in "XYZ":  # an Abbe offset of the reflector is in every reading
        turn = np.stack([machine.curves[f"E{c}{axis}"](position) for c in "ABC"], axis=1)
        arm = np.round(machine.reflector_mm[name], 1)
        reading = reading + 1e-3 * np.cross(turn, arm)[:, "XYZ".index(name[1])]
    sigma = TABLE_NOISE_UM if name[1] in "XYZ" else TABLE_NOISE_URAD
    noise = (
        np.zeros((2, len(position))) if rng is None else sigma * rng.normal(size=(2, len(position)))
    )
    rows = np.stack([position, *(sign * (reading + noise))], axis=1)
    np.savetxt(
        path, rows, delimiter=",", header="position_mm,forward,backward", comments="", fmt="%.6f"
    )
