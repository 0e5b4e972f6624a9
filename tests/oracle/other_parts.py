"""Jobs with hidden causes from a second maker, which shares no code with the library or the first.

Two parts that are unlike the first maker's: a plate of pockets, and a contour of squares, bosses
and bores as test pieces have it. A walk along the program keeps what each reading depends on: where
the axes stand and from which side they came, velocity, time, tool. The laws are written from their
definitions in standards and textbooks. Displacements are those of the tool against the workpiece,
um; lengths mm, times s. The machine has tables of positions and straightness, without angles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

__all__ = ["FOREIGN", "KNOWN", "NOISES", "PARTS", "Hidden", "write_job"]

#: machine coordinates of the workpiece zero, and ends of the travel
ZERO_MM = np.array([-700.0, -420.0, -330.0])
TRAVEL_MM = {"X": -990.0, "Y": -600.0, "Z": -450.0}
#: diameter, length, flutes, speed
TOOLS = {1: (16.0, 120.0, 3, 4000), 2: (10.0, 95.0, 4, 7000)}
RAPID_MM_S, TOOL_CHANGE_S = 20000.0 / 60.0, 8.0
#: motion that does not count as a reversal
DEAD_BAND_MM = 0.002
U_UM = 0.9


@dataclass(frozen=True)
class Reading:
    """A measured point of a wall or floor, and the state in which it was cut."""

    feature: str
    normal: np.ndarray
    tip_mm: np.ndarray
    point_mm: np.ndarray
    velocity_mm_s: np.ndarray
    towards_centre_mm_s2: np.ndarray
    time_s: float
    in_use_s: float  #: since the tool change
    cut_mm: float  #: way that the tool has cut
    side: np.ndarray  #: sign of the last motion of each axis
    tool: int

    @property
    def axes_mm(self) -> np.ndarray:
        return self.tip_mm + ZERO_MM

    @property
    def nose_mm(self) -> np.ndarray:
        return self.axes_mm + TOOLS[self.tool][1] * np.eye(3)[2]


@dataclass
class Walk:
    """A program as it is written, and the machine that follows it."""

    lines: list[str] = field(default_factory=lambda: ["%", "O2000", "G21 G17 G90 G94 G40 G80"])
    readings: list[Reading] = field(default_factory=list)
    spindle: list[tuple[float, int]] = field(default_factory=list)  #: from when on which speed
    time_s: float = 0.0
    tool: int = 0
    changed_s: float = 0.0

    def __post_init__(self) -> None:
        self.at = np.array([0.0, 0.0, 60.0])
        self.side, self.turned = np.zeros(3), self.at.copy()
        self.cut_mm = dict.fromkeys(TOOLS, 0.0)

    def change(self, tool: int) -> None:
        if self.tool:
            self.rapid(z=60.0)
        self.spindle.append((self.time_s, 0))
        self.time_s += TOOL_CHANGE_S
        rpm = TOOLS[tool][3]
        self.lines += [f"T{tool} M6", f"S{rpm} M3", f"G54 G43 H{tool}"]
        self.spindle.append((self.time_s, rpm))
        self.tool, self.changed_s = tool, self.time_s
        self.rapid(0.0, 0.0, 60.0)

    def wait(self, seconds: float) -> None:
        self.lines.append(f"G4 P{round(seconds)}")
        self.time_s += round(seconds)

    def rapid(self, x=None, y=None, z=None) -> None:
        end = self._write("G0", x, y, z)
        self.time_s += np.linalg.norm(end - self.at) / RAPID_MM_S
        self._reach(end)

    def cut(
        self, x=None, y=None, z=None, *, feed=300.0, count=0, feature="", normal=(0, 0, 1)
    ) -> None:
        """A line; readings on the wall or floor with that normal, 2 mm above the tip on walls."""
        start, end = self.at.copy(), self._write("G1", x, y, z, feed)
        way = float(np.linalg.norm(end - start))
        velocity = (end - start) / max(way, 1e-9) * feed / 60.0
        for share in [*np.linspace(0.08, 0.92, count)] if count else []:
            self._go(start + share * (end - start), feed)
            self._read(feature, np.array(normal, float), velocity, np.zeros(3))
        self._go(end, feed)

    def circle(self, x, y, radius, *, left, feed, count, feature, inside) -> None:
        """A full circle of the tip about (x, y), from its point of largest X."""
        self.lines.append(
            f"G{3 if left else 2} X{x + radius:.4f} Y{y:.4f} I{-radius:.4f} J0 F{feed:.0f}"
        )
        turn, steps = 1.0 if left else -1.0, 720
        wanted = set(np.round(np.linspace(0.03, 0.97, count) * steps).astype(int))
        for k in range(1, steps + 1):
            angle = turn * 2.0 * np.pi * k / steps
            out = np.array([np.cos(angle), np.sin(angle), 0.0])
            self._go(np.array([x, y, self.at[2]]) + radius * out, feed)
            if k in wanted:
                along = turn * np.array([-out[1], out[0], 0.0]) * feed / 60.0
                pull = -((feed / 60.0) ** 2) / radius * out
                self._read(feature, -out if inside else out, along, pull)

    def end(self) -> None:
        self.rapid(z=60.0)
        self.lines += ["M30", "%"]

    def warmth(self, time_s: float, constant_s: float, exponent: float) -> float:
        """First-order response to the spindle's speed, 1 when warm at 8000 rpm."""
        warm = 0.0
        ends = [*(start for start, _ in self.spindle[1:]), np.inf]
        for (start, rpm), stop in zip(self.spindle, ends, strict=True):
            if start < time_s:
                drive = (rpm / 8000.0) ** exponent
                warm = drive + (warm - drive) * np.exp(-(min(stop, time_s) - start) / constant_s)
        return warm

    def _write(self, word: str, x, y, z, feed: float | None = None) -> np.ndarray:
        end = np.array(
            [a if b is None else round(b, 4) for a, b in zip(self.at, (x, y, z), strict=True)]
        )
        given = [
            f"{n}{v:.4f}" for n, v, b in zip("XYZ", end, (x, y, z), strict=True) if b is not None
        ]
        self.lines.append(" ".join([word, *given, *([f"F{feed:.0f}"] if feed else [])]))
        return end

    def _go(self, end: np.ndarray, feed: float) -> None:
        way = float(np.linalg.norm(end - self.at))
        self.time_s += way / feed * 60.0
        self.cut_mm[self.tool] += way
        self._reach(end)

    def _reach(self, end: np.ndarray) -> None:
        for axis in range(3):
            moved = end[axis] - self.turned[axis]
            if moved * self.side[axis] > 0.0 or abs(moved) > DEAD_BAND_MM:
                self.side[axis] = np.sign(moved)
                self.turned[axis] = end[axis]
        self.at = np.array(end, float)

    def _read(self, feature, normal, velocity, pull) -> None:
        wall = abs(normal[2]) < 0.5
        radius = 0.5 * TOOLS[self.tool][0] if wall else 0.0
        point = self.at - radius * normal + [0.0, 0.0, 2.0 * wall]
        in_use = self.time_s - self.changed_s
        self.readings.append(Reading(
            feature, normal, self.at.copy(), point, velocity, pull, self.time_s, in_use,
            self.cut_mm[self.tool], self.side.copy(), self.tool,
        ))  # fmt: skip


def pockets(random: np.random.Generator) -> Walk:
    """A plate of twelve pockets in any order, by two tools in turn."""
    walk = Walk()
    cells = [(x, y) for x in range(0, 480, 120) for y in range(0, 300, 100)]
    random.shuffle(cells)
    for k, (x, y) in enumerate(cells):
        tool = 1 + k % 2
        walk.change(tool)
        radius = 0.5 * TOOLS[tool][0]
        a, b = random.uniform(30, 50) - radius, random.uniform(24, 40) - radius
        feed, depth = random.choice([400.0, 900.0, 1800.0]), random.choice([5.0, 12.0, 20.0])
        corners = [(a, b), (-a, b), (-a, -b), (a, -b)]
        normals = [(0, -1, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0)]
        if random.integers(2):  # the other way round
            corners = [(-a, b), (a, b), (a, -b), (-a, -b)]
            normals = [(0, -1, 0), (-1, 0, 0), (0, 1, 0), (1, 0, 0)]
        walk.rapid(x, y)
        walk.rapid(z=3.0)
        walk.cut(z=-depth)
        walk.cut(x + corners[-1][0], y + corners[-1][1], feed=feed)
        for n, ((cx, cy), normal) in enumerate(zip(corners, normals, strict=True)):
            walk.cut(
                x + cx, y + cy, feed=feed, count=8, feature=f"pocket {k} wall {n}", normal=normal
            )
        walk.cut(x - 0.6 * a, y - 0.5 * b, feed=feed)
        walk.cut(x + 0.6 * a, y + 0.5 * b, feed=feed, count=6, feature=f"pocket {k} floor")
        walk.rapid(z=20.0)
        walk.wait(random.uniform(30, 400))
    walk.end()
    return walk


def contour(random: np.random.Generator) -> Walk:
    """Squares, bosses and bores about one centre; floors beside them. Roughing leaves 0.4 mm."""
    walk = Walk()
    for left_mm in (0.4, 0.0):
        walk.change(1)
        for level, (half, feed) in enumerate([(75, 600.0), (65, 900.0), (55, 1500.0)]):
            h = half + 8.0 + left_mm
            walk.rapid(-h - 10.0, -h)
            walk.rapid(z=3.0)
            walk.cut(z=-30.0 + 10.0 * level)
            walk.cut(-h, -h, feed=feed)
            sides = [
                (-h, h, (-1, 0, 0)),
                (h, h, (0, 1, 0)),
                (h, -h, (1, 0, 0)),
                (-h, -h, (0, -1, 0)),
            ]
            for n, (x, y, normal) in enumerate(sides):
                count = 0 if left_mm else 9
                walk.cut(
                    x, y, feed=feed, count=count, feature=f"square {level} side {n}", normal=normal
                )
            walk.rapid(z=20.0)
        for level, (radius, feed) in enumerate([] if left_mm else [(46.0, 500.0), (38.0, 2000.0)]):
            walk.rapid(radius + 8.0, 0.0)
            walk.rapid(z=3.0)
            walk.cut(z=-7.0 + 3.5 * level)
            walk.circle(0.0, 0.0, radius + 8.0, left=False, feed=feed, count=24,
                        feature=f"boss {level}", inside=False)  # fmt: skip
            walk.rapid(z=20.0)
        walk.wait(random.uniform(200, 900))
        walk.change(2)
        away = 20.0 if left_mm else 110.0
        for k, (x, y) in enumerate([(-1, -1), (1, 1), (1, -1), (-1, 1)]):
            walk.rapid(away * x + 4.0, away * y)
            walk.rapid(z=3.0)
            walk.cut(z=-14.0, feed=200.0)
            walk.circle(away * x, away * y, 4.0, left=True, feed=(300.0, 800.0)[k % 2], count=10,
                        feature=f"bore {k} at {away:.0f}", inside=True)  # fmt: skip
            walk.rapid(z=20.0)
        walk.wait(random.uniform(200, 900))
    walk.change(1)
    for k in range(6):
        walk.rapid(-75.0, 125.0 + 8.0 * k if k % 2 else -125.0 - 8.0 * k)
        walk.rapid(z=3.0)
        walk.cut(z=-31.0)
        walk.cut(75.0, feed=1000.0, count=8, feature=f"floor {k}")
        walk.rapid(z=20.0)
    walk.end()
    return walk


PARTS = {"pockets": pockets, "contour": contour}
X, Y, Z = np.eye(3)


@dataclass(frozen=True)
class Hidden:
    """A cause: its name and target in the library's words, numbers that intervals have to hold.

    `seen_um` is what the readings show of it, RMS, beyond the part's alignment and other causes.
    """

    label: str
    law: Callable[[Reading], np.ndarray]
    numbers: dict[str, float] = field(default_factory=dict)
    seen_um: float = np.nan


def _either(random, low: float, high: float) -> float:
    return float(random.choice([-1.0, 1.0]) * random.uniform(low, high))


def backlash(random, walk):
    axis, lost = int(random.integers(2)), random.uniform(6, 14)
    return Hidden(f"backlash {'XY'[axis]}", lambda r: -0.5 * lost * r.side * np.eye(3)[axis],
                  {"reversal_um": lost})  # fmt: skip


def scale(random, walk):
    axis, ppm = int(random.integers(2)), _either(random, 15, 35)
    return Hidden(f"scale {'XY'[axis]}", lambda r: 1e-3 * ppm * r.nose_mm * np.eye(3)[axis],
                  {"scale_ppm": ppm})  # fmt: skip


def squareness(random, walk):
    urad = _either(random, 25, 60)
    return Hidden("squareness C0Y", lambda r: -1e-3 * urad * r.nose_mm[1] * X,
                  {"squareness_urad": urad})  # fmt: skip


def cyclic_pitch(random, walk):
    axis, high, pitch = (
        int(random.integers(2)),
        random.uniform(3, 6),
        random.choice([8.0, 10.0, 12.0]),
    )
    phase = random.uniform(0, 6)
    return Hidden(
        f"cyclic_pitch {'XY'[axis]}",
        lambda r: high * np.sin(2 * np.pi * r.nose_mm[axis] / pitch + phase) * np.eye(3)[axis],
        {"amplitude_um": high, "pitch_mm": pitch},
    )


def spindle_growth(random, walk):
    grown, share, exponent = random.uniform(15, 40), random.uniform(0.2, 0.5), random.uniform(1, 2)
    constant = share * walk.time_s
    return Hidden(
        "spindle_growth Z", lambda r: -grown * walk.warmth(r.time_s, constant, exponent) * Z
    )


def servo_mismatch(random, walk):
    half = _either(random, 0.25, 0.6)
    return Hidden("servo_mismatch XY", lambda r: half * r.velocity_mm_s * [1.0, -1.0, 0.0],
                  {"mismatch_ms": 2.0 * half})  # fmt: skip


def tool_radius(random, walk):
    tool, large = int(random.integers(1, 3)), _either(random, 5, 10)
    return Hidden(f"tool_radius T{tool}", lambda r: -large * _across(r) * (r.tool == tool),
                  {"radius_um": large})  # fmt: skip


def tool_length(random, walk):
    tool, longer = int(random.integers(1, 3)), _either(random, 5, 10)
    return Hidden(f"tool_length T{tool}", lambda r: -longer * Z * (r.tool == tool))


def tool_wear(random, walk):
    worn, whole = random.uniform(10, 16), walk.cut_mm[1]
    return Hidden("tool_wear T1", lambda r: worn * r.cut_mm / whole * _across(r) * (r.tool == 1))


def axis_expansion(random, walk):
    axis, ppm, constant = int(random.integers(2)), random.uniform(40, 80), 0.4 * walk.time_s
    return Hidden(
        f"axis_expansion {'XY'[axis]}",
        lambda r: 1e-3 * ppm * -np.expm1(-r.time_s / constant) * r.nose_mm * np.eye(3)[axis],
    )


def workpiece_temperature(random, walk):
    ppm = _either(random, 25, 50)
    return Hidden("workpiece_temperature", lambda r: -1e-3 * ppm * r.point_mm,
                  {"expansion_ppm": ppm})  # fmt: skip


def datum_shift(random, walk):
    when, shift = random.uniform(0.3, 0.7) * walk.time_s, random.normal(size=3) * 5.0
    return Hidden("datum_shift", lambda r: shift * (r.time_s > when))


def ambient_drift(random, walk):
    high = np.array([1.0, 0.6, 1.4]) * random.uniform(3, 6)
    period, phase = random.uniform(1.2, 2.0) * walk.time_s, random.uniform(0, 6, 3)
    return Hidden(
        "ambient_drift XYZ", lambda r: high * np.sin(2 * np.pi * r.time_s / period + phase)
    )


def sideways_with_speed(random, walk):
    """Y is pushed by the speed of X, as the torque of its motor does."""
    push = random.uniform(0.25, 0.5)
    return Hidden("speed of X", lambda r: push * abs(r.velocity_mm_s[0]) * Y)


def deeper_walls_lean(random, walk):
    """Walls stand off more the deeper they are, with the power 1.5."""
    off = random.uniform(4, 8)
    return Hidden("depth", lambda r: off * (abs(r.point_mm[2]) / 20.0) ** 1.5 * _across(r))


def tool_warms_in_use(random, walk):
    """A tool wears off its first edge within minutes after it came into the spindle."""
    off = random.uniform(8, 14)
    return Hidden(
        "time since the tool change", lambda r: off * -np.expm1(-r.in_use_s / 150.0) * _across(r)
    )


def chilled_part(random, walk):
    """Cold after each tool change, the part swells about its zero until the chips warm it."""
    ppm = random.uniform(150, 250)
    return Hidden(
        "time since the tool change",
        lambda r: 1e-3 * ppm * -np.expm1(-r.in_use_s / 75.0) * r.point_mm,
    )


def _across(reading: Reading) -> np.ndarray:
    """The normal of a wall; zero of a floor."""
    return reading.normal * [1.0, 1.0, 0.0]


KNOWN = (
    backlash, scale, squareness, cyclic_pitch, spindle_growth, servo_mismatch, tool_radius,
    tool_length, tool_wear, axis_expansion, workpiece_temperature, datum_shift, ambient_drift,
)  # fmt: skip
FOREIGN = (sideways_with_speed, deeper_walls_lean, tool_warms_in_use)
NOISES = ("white", "common", "correlated", "heavy tails", "rigid", "u half", "u double", "shuffled")


def write_job(
    folder: Path, seed: int, part: str, causes: Sequence[Callable], noise: str = "white"
) -> list[Hidden]:
    """A job that `vmach diagnose` reads, with what is hidden in it.

    Parameters
    ----------
    folder : Path
    seed : int
    part : str
        One of `PARTS`.
    causes : sequence of functions
        Of `KNOWN` and `FOREIGN`.
    noise : str
        One of `NOISES`. With `rigid` the part's alignment is another than the machine's.

    Returns
    -------
    list of Hidden
    """
    random = np.random.default_rng(seed)
    walk = PARTS[part](random)
    hidden = [cause(random, walk) for cause in causes]
    folder.mkdir(parents=True, exist_ok=True)
    tables = _write_machine(folder, random)
    normal = np.array([r.normal for r in walk.readings])
    shown_um = [_along_normal(cause.law, walk.readings) for cause in hidden]
    of_machine_um = _along_normal(lambda r: _of_tables(tables, r), walk.readings)
    off_um = of_machine_um + sum(shown_um) + _noise_um(noise, walk.readings, random)
    measured = np.array([r.point_mm for r in walk.readings]) + 1e-3 * off_um[:, None] * normal
    if noise == "rigid":
        turn, shift = random.normal(size=3) * 60e-6, random.normal(size=3) * 0.03
        measured += np.cross(turn, measured) + shift
    order = random.permutation(len(measured)) if noise == "shuffled" else range(len(measured))
    rows = ["id,feature,x,y,z,i,j,k,mx,my,mz,u_um"]
    u_um = U_UM * {"u half": 0.5, "u double": 2.0}.get(noise, 1.0)
    for number, k in enumerate(order):
        numbers = [*walk.readings[k].point_mm, *normal[k], *measured[k]]
        words = [str(number), walk.readings[k].feature, *(f"{v:.6f}" for v in numbers), f"{u_um:g}"]
        rows.append(",".join(words))
    (folder / "part.nc").write_text("\n".join(walk.lines) + "\n")
    (folder / "measured.csv").write_text("\n".join(rows) + "\n")
    (folder / "job.toml").write_text(_job_text())
    seen = _seen_um(walk.readings, shown_um)
    return [replace(cause, seen_um=own) for cause, own in zip(hidden, seen, strict=True)]


def _along_normal(law: Callable, readings: Sequence[Reading]) -> np.ndarray:
    return np.array([reading.normal @ law(reading) for reading in readings])


def _seen_um(readings: Sequence[Reading], shown_um: Sequence[np.ndarray]) -> list[float]:
    """RMS of what each cause shows beyond a rigid motion of the part and the other causes."""
    rigid = np.array([[*r.normal, *np.cross(r.point_mm, r.normal)] for r in readings])
    seen = []
    for k, own in enumerate(shown_um):
        beside = np.column_stack([rigid, *(other for j, other in enumerate(shown_um) if j != k)])
        left = own - beside @ np.linalg.lstsq(beside, own, rcond=None)[0]
        seen.append(float(np.sqrt(np.mean(left**2))))
    return seen


def _noise_um(noise: str, readings: Sequence[Reading], random: np.random.Generator) -> np.ndarray:
    own = random.normal(size=len(readings))
    if noise == "heavy tails":
        return U_UM * random.standard_t(3, size=len(readings)) / np.sqrt(3.0)
    names = [r.feature for r in readings]
    if noise == "common":
        of_feature = {name: random.normal() for name in dict.fromkeys(names)}
        return U_UM * (0.8 * own + 0.6 * np.array([of_feature[name] for name in names]))
    if noise == "correlated":
        for k in range(1, len(own)):
            if names[k] == names[k - 1]:
                own[k] = 0.7 * own[k - 1] + np.sqrt(1.0 - 0.49) * own[k]
    return U_UM * own


def _write_machine(folder: Path, random: np.random.Generator) -> dict[str, tuple]:
    """Tables of positions and straightness, measured to 0.15 um; the true ones are returned."""
    (folder / "errors").mkdir(exist_ok=True)
    text = [
        'schema = 1\nname = "second maker"\nchain = "t (C) Z Y b X\' w"\n[convention]',
        'origin = "spindle nose with every axis at home; axes as in ISO 841"',
        'sign = "displacement of the tool relative to the workpiece, rotations right-handed"',
        'length = "um"\nangle = "urad"\n[motion]\nrapid_mm_min = 20000\ntool_change_s = 8',
        *(f"[axes.{axis}]\ntravel_mm = [{low}, 0]" for axis, low in TRAVEL_MM.items()),
    ]
    true = {}
    for axis, low in TRAVEL_MM.items():
        place = np.arange(low, 1.0, 30.0)
        share = np.pi * (place - low) / -low
        for name in (*(f"E{d}{axis}" for d in "XYZ"), *(f"E{d}{axis}" for d in "ABC")):
            size = {True: 6.0, False: 3.0}[name[1] == axis] if name[1] in "XYZ" else 0.0
            waves = random.normal(size=4) * size / np.arange(1, 5)
            value = sum(w * np.cos((k + 1) * share + k) for k, w in enumerate(waves))
            true[name] = place, value - value[-1]
            read = true[name][1] + 0.15 * random.normal(size=len(place)) * (size > 0.0)
            rows = [f"{p},{v:.6f},{v:.6f}" for p, v in zip(place, read, strict=True)]
            file = folder / "errors" / f"{name}.csv"
            file.write_text("\n".join(["position_mm,forward,backward", *rows]) + "\n")
            text.append(f'[errors.{name}]\ntable = "errors/{name}.csv"')
            if name[1] in "XYZ":
                text.append("measured_at_mm = [0, 0, 0]")
    text.append("[squareness]\nEC0Y = 0.0\nEB0X = 0.0\nEA0Y = 0.0\n")
    (folder / "machine.toml").write_text("\n".join(text))
    return true


def _of_tables(true: dict[str, tuple], reading: Reading) -> np.ndarray:
    """Displacement by the machine's tables: no arms, as there are no angles."""
    return np.array([
        sum(np.interp(q, *true[f"E{d}{a}"]) for q, a in zip(reading.nose_mm, "XYZ", strict=True))
        for d in "XYZ"
    ])  # fmt: skip


def _job_text() -> str:
    x, y, z = ZERO_MM
    tools = "".join(
        f'[tools.{n}]\nshape = "flat"\ndiameter_mm = {d}\nlength_mm = {length}\nflutes = {flutes}\n'
        for n, (d, length, flutes, _) in TOOLS.items()
    )
    return (
        'schema = 1\nmachine = "machine.toml"\nprogram = "part.nc"\nmeasured = "measured.csv"\n'
        f"[work_offsets_mm]\nG54 = [{x}, {y}, {z}]\n"
        f"[stock]\nmin_mm = [-200, -260, -60]\nmax_mm = [600, 400, 0]\n{tools}"
    )
