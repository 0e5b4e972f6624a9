"""What shops measure with a machine file that holds no table: holes, runs of an axis, circles.

Nothing of the library makes the readings. Causes and what nobody models lie one upon another:
chance of a hole or stop, what neighbours share, what drifts, what repeats in every run.

Source: closed forms written here; ISO 230-2 for the runs of an axis, ISO 230-4 for circles.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from tests.small_job import measurement, write_job

__all__ = [
    "circle_um",
    "make_axis",
    "make_ballbar",
    "make_level",
    "make_measured_plate",
    "make_plate",
]

#: zero of the part, and travel, of the machine that is written, mm
_ZERO, _TRAVEL = [-350, -350, -200], 700
#: holes lie no closer than this, mm; height of a row of holes that are drilled in one go, mm
_APART_MM, _ROW_MM = 5.0, 40.0


def make_plate(folder: Path, seed: int) -> None:
    """A round plate of 120 to 700 drilled holes in one clamping, and `truth.json`."""
    folder.mkdir(parents=True)
    random = np.random.default_rng(seed)
    radius = random.uniform(120.0, 330.0)
    place = _holes(random, radius)
    row = np.floor((place[:, 1] + radius) / _ROW_MM).astype(int)
    in_rows = np.lexsort((place[:, 0] * np.where(row % 2, -1, 1), row))
    order = in_rows if random.random() < 0.7 else random.permutation(len(place))
    place, row = place[order], row[order]
    strain, hidden = _strain(random)
    scatter_um, has_pitch = _scatter_um(random, place, row, radius)
    hidden += [["cyclic_pitch X"], ["cyclic_pitch Y"]] * has_pitch
    turned = place @ (strain + np.array([[0.0, -2e-5], [2e-5, 0.0]])).T
    read = np.round(place + turned + [0.03, -0.02] + 1e-3 * scatter_um, random.integers(3, 6))
    u_um = float(random.choice([0.5, 1.0, 2.0, 3.0]))
    listed = {0: np.lexsort(place.T), 1: np.lexsort(place.T[::-1]), 2: np.arange(len(place))}
    rows = np.hstack([place, read])[listed.get(seed % 4, random.permutation(len(place)))]
    _write(folder, measurement("holes", u_um=u_um), _drilled(place))
    header = "x,y,mx,my"
    if seed % 2:
        # another stream: the plates stay what they were without diameters
        rows = np.hstack([rows, _sizes(np.random.default_rng([seed, 1]), len(rows))])
        header, hidden = (
            f"{header},d,md",
            [*hidden, ["tool_radius T1", "runout T1", "probe_radius"]],
        )
    np.savetxt(folder / "holes.csv", rows, delimiter=",", header=header, comments="", fmt="%.5f")
    numbers = {"u_um": u_um, "scatter_um": float(scatter_um.std()), "strain": strain.tolist()}
    _tell(folder, hidden, numbers)


def make_measured_plate(folder: Path, seed: int, *, by_rows: bool) -> None:
    """A plate of 9 rows of 12 holes, out of square, whose measuring machine drifts as it warms.

    It measures row by row, each along X, or in an order of chance. And `truth.json`.
    """
    folder.mkdir(parents=True)
    random = np.random.default_rng(seed)
    place = 30.0 * np.stack(np.meshgrid(np.arange(12), np.arange(9)), axis=-1).reshape(-1, 2)
    lean_urad = random.uniform(30.0, 60.0) * random.choice([-1, 1])
    order = np.arange(len(place)) if by_rows else random.permutation(len(place))
    warmed = 1.0 - np.exp(-order / len(place) / random.uniform(0.4, 1.5))
    drift_um = random.choice([-1, 1]) * random.uniform(1.0, 4.0) * warmed / warmed.max()
    away_um = 2.5 * random.standard_normal(place.shape)
    away_um[:, 0] += drift_um - 1e-3 * lean_urad * place[:, 1]
    _write(folder, measurement("holes", u_um=2.0), _drilled(place[random.permutation(len(place))]))
    np.savetxt(
        folder / "holes.csv", np.column_stack([place, place + 1e-3 * away_um, order]),
        delimiter=",", header="x,y,mx,my,order", comments="", fmt="%.3f,%.3f,%.4f,%.4f,%d",
    )  # fmt: skip
    _tell(folder, [["squareness C0Y"]], {"lean_urad": lean_urad})


def _holes(random: np.random.Generator, radius: float) -> np.ndarray:
    """Places by chance in a circle, (count, 2)."""
    place = np.zeros((0, 2))
    for _ in range(random.integers(400, 2500)):
        trial = np.round(random.uniform(-radius, radius, 2), 3)
        apart = np.linalg.norm(place - trial, axis=1)
        if np.hypot(*trial) < radius and apart.min(initial=np.inf) > _APART_MM:
            place = np.vstack([place, trial])
    return place[: random.integers(120, 700)]


def _sizes(random: np.random.Generator, count: int) -> np.ndarray:
    """Nominal and measured diameters: a drill cuts too large, and not the same everywhere, mm."""
    over_um = random.uniform(2.0, 20.0) + random.uniform(1.0, 3.0) * random.standard_normal(count)
    return np.column_stack([np.full(count, 10.0), 10.0 + 1e-3 * over_um])


def _strain(random: np.random.Generator) -> tuple[np.ndarray, list[list[str]]]:
    """Linear part of what the machine did, (2, 2), and the effects that are said of it."""
    lean = random.uniform(20e-6, 80e-6) * random.choice([-1, 1])
    strain = np.array([[0.0, -lean], [0.0, 0.0]])
    if random.random() < 0.6:
        strain -= random.uniform(12e-6, 40e-6) * np.eye(2)
        return strain, [["workpiece_temperature"], ["squareness C0Y"]]
    k = random.integers(2)
    strain[k, k] = random.uniform(12e-6, 40e-6) * random.choice([-1, 1])
    return strain, [[f"scale {'XY'[k]}"], ["squareness C0Y"]]


def _scatter_um(random, place, row, radius) -> tuple[np.ndarray, bool]:
    """About 2 to 4 um along X and Y, and whether the screws have a pitch error.

    A quarter to two thirds of the square of the size is chance, half of it are one to three kinds.
    """
    size, count = random.uniform(2.0, 4.0), len(place)
    tails = random.random() < 0.4
    chance = (
        random.standard_t(3, (count, 2)) / np.sqrt(3.0)
        if tails
        else random.standard_normal((count, 2))
    )
    kinds = [_smooth, _drifting, _of_neighbours, _of_rows, _of_screw, _bending]
    chosen = random.choice(len(kinds), size=random.integers(1, 4), replace=False)
    found = random.uniform(0.5, 0.8) * size * chance
    for k in chosen:
        one = kinds[k](random, place, row, radius)
        found += size * np.sqrt(0.5 / len(chosen)) * one / one.std()
    return found, kinds.index(_of_screw) in chosen


def _smooth(random, place, row, radius):
    square = (
        np.sum((place[:, None] - place) ** 2, axis=2) / (random.uniform(0.3, 0.8) * radius) ** 2
    )
    root = np.linalg.cholesky(np.exp(-0.5 * square) + 1e-6 * np.eye(len(place)))
    return root @ random.standard_normal((len(place), 2))


def _drifting(random, place, row, radius):
    share = np.linspace(0.0, 1.0, len(place))[:, None]
    return (1.0 - np.exp(-share / random.uniform(0.1, 0.8))) @ random.standard_normal((1, 2))


def _of_neighbours(random, place, row, radius):
    found, kept = random.standard_normal((len(place), 2)), random.uniform(0.6, 0.95)
    for k in range(1, len(place)):
        found[k] += kept * found[k - 1]
    return found


def _of_rows(random, place, row, radius):
    return random.standard_normal((row.max() + 1, 2))[row]


def _of_screw(random, place, row, radius):
    pitch = random.choice([5.0, 10.0, 12.0, 16.0])
    return np.sin(2.0 * np.pi * place / pitch + random.uniform(0.0, 6.0, 2))


def _bending(random, place, row, radius):
    x, y = place.T / radius
    found = np.column_stack([x * y, x * x - y * y]) @ random.standard_normal((2, 2))
    return found - found.mean(axis=0)


def make_axis(folder: Path, seed: int) -> None:
    """Three to six bidirectional runs of a laser along X, Y or Z, and `truth.json`."""
    folder.mkdir(parents=True)
    random = np.random.default_rng(seed)
    axis, u_um = str(random.choice(list("XYZ"))), float(random.choice([0.5, 1, 2, 3, 5]))
    count, runs = int(random.integers(5, 40)), int(random.integers(3, 7))
    share = np.linspace(0.0, 1.0, count)
    share[1:-1] += random.choice([0.0, 0.2]) * random.uniform(-1, 1, count - 2) / count
    place = np.round((share - 1.0) * (380.0 if axis == "X" else 280.0), 3)
    slow_um = random.uniform(10.0, 60.0) * (
        np.stack([share, share**2, 0.2 * np.sin(2.0 * np.pi * share * random.uniform(0.5, 2.0))]).T
        @ random.standard_normal(3)
    )
    lost_um = random.uniform(6.0, 30.0) * random.choice([-1, 1])
    varies = random.uniform(0.0, 0.25) * np.sin(np.pi * share * random.uniform(0.5, 2.0))
    reversal_um = lost_um * (1.0 + varies)
    local_um = random.uniform(0.0, 2.5) * random.standard_normal(count)
    of_side_um = random.uniform(0.0, 1.5) * random.standard_normal((count, 2))
    drift_um = random.uniform(0.0, 5.0) * _of_runs(random, runs)
    stop_um = random.uniform(0.3, 2.0)
    rows: list[tuple[float, ...]] = []
    for run in range(runs):
        for side in (1, -1):
            for i in range(count)[::side]:
                chance = random.standard_t(3) / np.sqrt(3.0) if seed % 3 == 0 else random.normal()
                value = slow_um[i] - side * reversal_um[i] / 2 + drift_um[run] + local_um[i]
                value += of_side_um[i, (side + 1) // 2] + stop_um * chance
                rows.append((run + 1, place[i], side, 8.0 * len(rows), value))
    table = np.array(rows)
    table[:, 4] -= table[0, 4]
    laser = measurement("laser", axis=axis, at_mm=[-200, -150, -150], u_um=u_um)
    _write(folder, laser)
    np.savetxt(
        folder / "laser.csv", table, delimiter=",", comments="", fmt="%g,%.3f,%d,%g,%.2f",
        header="run,position_mm,approach,t_s,deviation_um",
    )  # fmt: skip
    rest = [local_um, of_side_um, (reversal_um - lost_um) / 2, drift_um]
    _tell(
        folder,
        [[f"backlash {axis}"], [f"component E{axis}{axis}", f"scale {axis}"]],
        {
            "u_um": u_um,
            # of the axis as it is at its stops: the mean reversal value of ISO 230-2
            "reversal_um": float(np.mean(reversal_um - of_side_um @ [-1.0, 1.0])),
            "rest_um": float(np.sqrt(stop_um**2 + sum(np.var(one) for one in rest))),
        },
    )


def _of_runs(random: np.random.Generator, runs: int) -> np.ndarray:
    """How runs differ: a drift that slows, a walk, or chance."""
    kinds = (
        np.linspace(0.0, 1.0, runs) ** 0.7,
        np.cumsum(random.standard_normal(runs)) / np.sqrt(runs),
        random.standard_normal(runs),
    )
    return kinds[random.integers(3)]


def make_ballbar(folder: Path, seed: int) -> None:
    """Circles in XY at two or three feeds, both ways round, and `truth.json`.

    Lost motion along X and Y, a squareness, and where a truth says so how the drives follow
    unequally. The ballbar warms: its radius wanders while the runs are made.
    """
    folder.mkdir(parents=True)
    random = np.random.default_rng(seed)
    radius = float(random.choice([100.0, 150.0]))
    u_um = float(random.choice([0.3, 0.5, 1.0]))
    lost_um = random.uniform(3.0, 15.0, 2) * random.choice([-1, 1], 2)
    lean_urad = random.uniform(12.0, 45.0) * random.choice([-1, 1])
    unequal_s = random.uniform(2e-4, 6e-4) * (random.random() < 0.5) * random.choice([-1, 1])
    take_up_mm = random.uniform(0.005, 0.03, 2)
    warms_um_per_s = random.uniform(-1.5, 1.5) / 100.0
    noise_um = u_um * random.uniform(0.7, 1.4)
    rows, begins_s = [], 0.0
    for feed in random.choice(
        [500.0, 1000.0, 2000.0, 3000.0], random.integers(2, 4), replace=False
    ):
        for way, name in ((1, "ccw"), (-1, "cw")):
            turn_s = 120.0 * np.pi * radius / feed
            share = np.arange(240) / 240.0
            angle = way * (2.0 * np.pi * share + np.radians(0.5))
            begins_s += 0.5 * turn_s
            deviation_um = circle_um(
                angle, way, radius, lost_um, take_up_mm, lean_urad, unequal_s * feed / 60.0 / radius
            )
            seconds = begins_s + share * turn_s
            value = deviation_um + warms_um_per_s * seconds + noise_um * random.standard_normal(240)
            angle_deg = np.degrees(angle) % 360.0
            rows += [
                f"{name},{feed:g},{a:.4f},{t:.3f},{v:.2f}"
                for a, t, v in zip(angle_deg, seconds, value + 7.0, strict=True)
            ]
            begins_s += 1.5 * turn_s + random.uniform(1.0, 10.0)
    ballbar = measurement(
        "ballbar", plane="XY", centre_mm=[-200, -150, -150], radius_mm=radius, u_um=u_um
    )
    _write(folder, ballbar)
    head = "run,feed_mm_min,angle_deg,t_s,radius_um"
    (folder / "ballbar.csv").write_text("\n".join([head, *rows]) + "\n")
    hidden = [["backlash X"], ["backlash Y"], ["squareness C0Y"]]
    hidden += [["servo_mismatch XY"]] * bool(unequal_s)
    _tell(folder, hidden, {"u_um": u_um, "lost_um": lost_um.tolist(), "lean_urad": lean_urad})


def circle_um(
    angle: np.ndarray,
    way: int,
    radius: float,
    lost_um: np.ndarray,
    take_up_mm: np.ndarray,
    lean_urad: float,
    lag_rad: float,
) -> np.ndarray:
    """How far a circle is run too wide, (n,) um, after a turn in which both axes have reversed.

    Half the lost motion lags behind each direction, taken up over some travel; Y that leans moves
    X by its way; and where one drive lags by an angle more than the other the circle is an ellipse.
    """
    place = np.stack([np.cos(angle), np.sin(angle)])
    side = way * np.array([-np.sin(angle), np.cos(angle)])
    away_um = np.zeros_like(place)
    for k in (0, 1):
        # from where an axis turned: at the ends of its own stroke
        since_mm = radius * (1.0 - np.abs(place[k]))
        since_mm = np.where(place[k] * side[k] > 0.0, 2.0 * radius - since_mm, since_mm)
        taken_up = 1.0 - 2.0 * np.exp(-since_mm / take_up_mm[k])
        away_um[k] -= 0.5 * lost_um[k] * np.sign(side[k]) * taken_up
    away_um[0] -= 1e-3 * lean_urad * radius * place[1]
    away_um += 1e3 * radius * 0.5 * lag_rad * np.array([[1.0], [-1.0]]) * side
    return np.sum(away_um * place, axis=0)


def make_level(folder: Path, seed: int) -> None:
    """Six passes of a level along X: pitch that is straight or bumps, or none; and `truth.json`."""
    folder.mkdir(parents=True)
    random = np.random.default_rng(seed)
    place = np.linspace(-380.0, -20.0, int(random.integers(9, 22)))
    share = np.linspace(-0.5, 0.5, len(place))
    size = random.uniform(10.0, 30.0) * random.choice([-1, 1])
    bump = np.exp(-(((share - random.uniform(-0.3, 0.3)) / random.uniform(0.08, 0.2)) ** 2))
    kind = ("straight", "bump", "none")[seed % 3]
    pitch = {"straight": size * share, "bump": size * bump, "none": 0.0 * share}[kind]
    noise, wanders = random.uniform(0.7, 1.3), random.uniform(0.0, 1.0)
    rows = []
    for run in range(3):
        zero = wanders * random.standard_normal()
        for side in (1, -1):
            for i in range(len(place))[::side]:
                value = pitch[i] + zero + noise * random.standard_normal()
                rows.append(f"{run + 1},{place[i]:.3f},{side},{value:.2f}")
    level = measurement("level", axis="X", about="B", at_mm=[-200, -150, -150], u_um=1.0)
    _write(folder, level)
    head = "run,position_mm,approach,tilt_um_per_m"
    (folder / "level.csv").write_text("\n".join([head, *rows]) + "\n")
    _tell(folder, [["component EBX"]] if kind != "none" else [], {"kind": kind, "size": size})


def _write(folder: Path, instrument: str, program: str | None = None) -> None:
    """A job of a machine without tables, and one instrument."""
    job = write_job(folder, more=instrument)
    kept = [line for line in job.read_text().splitlines() if not line.startswith("measured")]
    text = "\n".join(kept) + "\n"
    if program:
        text = text.replace("tool_length_mm = 100\n", "")
        text = text.replace("[-200, -150, -200]", str(_ZERO))
        (folder / "part.nc").write_text(program)
        machine = (folder / "machine.toml").read_text()
        for axis in ("[-400, 0]", "[-300, 0]"):
            machine = machine.replace(axis, f"[-{_TRAVEL}, 0]", 1)
        (folder / "machine.toml").write_text(machine)
    job.write_text(text)


def _drilled(place: np.ndarray) -> str:
    head = ["%", "G21 G17 G90", "T1 M6", "S3000 M3", "G54 G43 H1", "G0 X0 Y0 Z20"]
    first, *more = [f"X{x:.4f} Y{y:.4f}" for x, y in place]
    end = ["G80", "G0 Z20", "M5", "M30", "%", ""]
    return "\n".join([*head, f"G81 Z-10 R2 F300 {first}", *more, *end])


def _tell(folder: Path, hidden: list[list[str]], numbers: dict[str, object]) -> None:
    (folder / "truth.json").write_text(json.dumps({"hidden": hidden, **numbers}, indent=1))
