"""NC text and, beside it, what the axes do: the nominal path as nodes in time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Path3", "ProgramWriter", "Tool"]

#: chords of an arc in the record of the path (positions at contacts are exact, not chorded)
CHORD_RAD = np.deg2rad(1.0)


@dataclass(frozen=True)
class Tool:
    """A flat end mill, mm."""

    number: int
    diameter_mm: float
    length_mm: float
    rpm: float


@dataclass(frozen=True)
class Path3:
    """Nodes of the nominal tip's path.

    Attributes
    ----------
    tip_mm : (K, 3) workpiece coordinates
    nose_mm : (K, 3) machine coordinates
    time_s : (K,)
    cutting : (K,) True where the way to this node removes material
    rpm : (K,) spindle speed on the way to this node
    """

    tip_mm: np.ndarray
    nose_mm: np.ndarray
    time_s: np.ndarray
    cutting: np.ndarray
    rpm: np.ndarray

    @property
    def velocity_mm_s(self) -> np.ndarray:
        """(K, 3) on the way to each node; at rest where no time passes."""
        step = np.diff(self.nose_mm, axis=0, prepend=self.nose_mm[:1])
        time = np.diff(self.time_s, prepend=0.0)[:, None]
        return np.divide(step, time, out=np.zeros_like(step), where=time > 1e-9)


class ProgramWriter:
    """Writes moves as G-code and keeps the same moves as nodes."""

    def __init__(self, offset_mm: np.ndarray, *, rapid_mm_min: float, tool_change_s: float):
        self.offset_mm, self.rapid, self.tool_change_s = offset_mm, rapid_mm_min, tool_change_s
        self.lines = ["%", "O1000", "G21 G17 G90 G94 G40 G80"]
        self.tool: Tool | None = None
        self.set_up, self.datum_mm = "G54", np.zeros(3)
        self._tip, self._nose, self._time, self._cut, self._rpm = [], [], [], [], []
        self._clock, self._spindle, self._block = 0.0, 0.0, 0

    @property
    def tip_mm(self) -> np.ndarray:
        """Where the tip is."""
        return self._tip[-1]

    @property
    def node(self) -> int:
        """Index of the last node."""
        return len(self._tip) - 1

    def write(self, text: str) -> None:
        """One block of text without motion."""
        self._block += 10
        self.lines.append(f"N{self._block} {text}")

    def change(self, tool: Tool, *, clamp: tuple[str, np.ndarray] | None = None) -> None:
        """Tool change, spindle on, length offset.

        clamp : the part is taken out, set again, and from now on programmed from another datum:
            name of the work offset, place of that datum on the part
        """
        if self._tip:  # high enough that a longer tool hangs clear of the part
            self.rapid_to(z=100.0)
        if clamp:
            self.set_up, self.datum_mm = clamp
        self.write(f"T{tool.number} M6")
        self._clock += self.tool_change_s
        self.tool = tool
        self.spindle(True)
        self.write(f"{self.set_up} G43 H{tool.number}")
        if self._tip:  # the tip of the new tool is elsewhere, the axes have not moved
            nose = self._nose[-1]
            self._put(nose - self.offset_mm - [0, 0, tool.length_mm], cutting=False)
            self.rapid_to(z=60.0)
        else:  # the way from where the machine stood before is nobody's knowledge
            self._put(np.array([0.0, 0.0, 60.0]), cutting=False)
            self.rapid_to(0.0, 0.0, 60.0)

    def spindle(self, on: bool) -> None:
        """Spindle on at the tool's speed, or off."""
        self._spindle = self.tool.rpm if on else 0.0
        self.write(f"S{self.tool.rpm:.0f} M3" if on else "M5")

    def dwell(self, seconds: int) -> None:
        """Stand still."""
        self.write(f"G4 P{seconds}")
        self._clock += seconds
        self._put(self._tip[-1], cutting=False)

    def rapid_to(self, x: float | None = None, y: float | None = None, z: float | None = None):
        """G0 to a point; coordinates not given stay."""
        self._straight("G0", (x, y, z), self.rapid, cutting=False)

    def line_to(self, x=None, y=None, z=None, *, feed: float, cutting: bool = True) -> int:
        """G1; gives back the node at which the line starts."""
        return self._straight("G1", (x, y, z), feed, cutting=cutting)

    def _straight(self, code: str, target: tuple, feed: float, *, cutting: bool) -> int:
        here = self._tip[-1]
        goal = np.array([here[k] if v is None else round(v, 4) for k, v in enumerate(target)])
        words = "".join(
            f" {a}{goal[k] - self.datum_mm[k]:.4f}"
            for k, (a, v) in enumerate(zip("XYZ", target, strict=True))
            if v is not None
        )
        self.write(f"{code}{words}" + (f" F{feed:g}" if code == "G1" else ""))
        start = self.node
        self._clock += float(np.linalg.norm(goal - here)) / feed * 60
        self._put(goal, cutting=cutting)
        return start

    def arc_to(self, end_xy: tuple, centre_xy: tuple, *, turn: int, feed: float) -> tuple[int, int]:
        """G2 (turn -1) or G3 (turn +1) to a point; first and last node of it."""
        here = self._tip[-1]
        end, centre = np.round(end_xy, 4), np.round(centre_xy, 4)
        arm = here[:2] - centre
        sweep = np.arctan2(*(end - centre)[::-1]) - np.arctan2(*arm[::-1])
        sweep = turn * (np.mod(turn * sweep, 2 * np.pi))
        if abs(sweep) < 1e-9:
            sweep = turn * 2 * np.pi
        code = "G3" if turn > 0 else "G2"
        offset = -arm
        self.write(
            f"{code} X{end[0] - self.datum_mm[0]:.4f} Y{end[1] - self.datum_mm[1]:.4f}"
            f" I{offset[0]:.4f} J{offset[1]:.4f} F{feed:g}"
        )
        start, count = self.node, max(4, int(np.ceil(abs(sweep) / CHORD_RAD)))
        radius = np.hypot(*arm)
        for k in range(1, count + 1):
            c, s = np.cos(sweep * k / count), np.sin(sweep * k / count)
            xy = centre + np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]])
            self._clock += radius * abs(sweep) / count / feed * 60
            self._put(np.array([*xy, here[2]]), cutting=True)
        return start, self.node

    def finish(self) -> tuple[str, Path3]:
        """End of program: its text and its path."""
        self.rapid_to(z=60.0)
        self.write("M5")
        self.write("M30")
        path = Path3(
            np.array(self._tip),
            np.array(self._nose),
            np.array(self._time),
            np.array(self._cut),
            np.array(self._rpm),
        )
        return "\n".join([*self.lines, "%"]) + "\n", path

    def _put(self, tip: np.ndarray, *, cutting: bool) -> None:
        tip = np.asarray(tip, float)
        self._tip.append(tip)
        self._nose.append(tip + self.offset_mm + [0, 0, self.tool.length_mm])
        self._time.append(self._clock)
        self._cut.append(cutting)
        self._rpm.append(self._spindle)
