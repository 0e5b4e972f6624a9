"""Diagrams as SVG inside a page: small, sharp at any zoom, in the colours of the page's style."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from markupsafe import Markup, escape

__all__ = ["Frame", "Plot", "number_text", "ticks"]


def ticks(low: float, high: float, *, most: int = 6) -> np.ndarray:
    """Round numbers within an interval, (N,), at most so many: steps of 1, 2 or 5 times 10^k."""
    span = max(high - low, 1e-12)
    decade = 10.0 ** np.floor(np.log10(span / most))
    step = next(s * decade for s in (1, 2, 5, 10, 20) if span / (s * decade) <= most)
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return step * np.arange(first, last + 1)


def number_text(value: float, *, signed: bool = False) -> str:
    """A number for people: no exponent unless it needs one, a real minus."""
    text = f"{value:{'+' if signed else ''}.4g}"
    return "0" if float(text) == 0 else text.replace("-", "−")


@dataclass(frozen=True)
class Frame:
    """Where the data lie in a picture of so many pixels; `left` ... are the margins."""

    x: tuple[float, float]
    y: tuple[float, float]
    width: float = 420.0
    height: float = 220.0
    left: float = 44.0
    right: float = 12.0
    top: float = 8.0
    bottom: float = 34.0

    def columns(self, x: np.ndarray) -> np.ndarray:
        """Pixels from the left, (N,); values beyond the frame lie on its edge."""
        share = np.clip((np.asarray(x) - self.x[0]) / (self.x[1] - self.x[0]), 0.0, 1.0)
        return self.left + share * (self.width - self.left - self.right)

    def rows(self, y: np.ndarray) -> np.ndarray:
        """Pixels from the top, (N,); values beyond the frame lie on its edge."""
        share = np.clip((np.asarray(y) - self.y[0]) / (self.y[1] - self.y[0]), 0.0, 1.0)
        return self.height - self.bottom - share * (self.height - self.top - self.bottom)


@dataclass
class Plot:
    """A diagram to which marks are added one after the other; `kind` names a style class."""

    frame: Frame
    parts: list[str] = field(default_factory=list)

    def dots(self, x: np.ndarray, y: np.ndarray, kind: str) -> None:
        """A round dot at every point, (N,) each; its size is the width of the stroke."""
        places = "".join(f"M{at}h0" for at in self._places(x, y))
        self.parts.append(f'<path class="dots {kind}" d="{places}"/>')

    def line(self, x: np.ndarray, y: np.ndarray, kind: str) -> None:
        """A line through all points, (N,) each."""
        self.parts.append(f'<path class="line {kind}" d="M{"L".join(self._places(x, y))}"/>')

    def bands(
        self, between: Sequence[tuple[np.ndarray, np.ndarray, np.ndarray]], kind: str
    ) -> None:
        """The area between pairs of curves (x, low, high), overlaps no darker than the rest."""
        outlines = [
            [*self._places(x, low), *list(self._places(x, high))[::-1]] for x, low, high in between
        ]
        self.shape("".join(f"M{'L'.join(outline)}Z" for outline in outlines), f"area {kind}")

    def error_bar(self, at: float, middle: float, half: float, kind: str, *, along: str) -> None:
        """A mean with its interval along "x" or "y"; `at` is its pixel on the other axis."""
        ends = np.array([middle, middle - half, middle + half])
        if along == "y":
            mean, low, high = self.frame.rows(ends)
            path = "".join(f"M{at - 3:.1f} {end:.1f}h6m-3 0" for end in (low, high))
            path, centre = f"{path}V{low:.1f}", (at, mean)
        else:
            mean, low, high = self.frame.columns(ends)
            path = "".join(f"M{end:.1f} {at - 3:.1f}v6m0 -3" for end in (low, high))
            path, centre = f"{path}H{low:.1f}", (mean, at)
        self.shape(path, f"bar-line {kind}")
        self.parts.append(
            f'<circle class="mean {kind}" cx="{centre[0]:.1f}" cy="{centre[1]:.1f}" r="3.2"/>'
        )

    def text(
        self, column: float, row: float, words: str, kind: str = "", *, title: str = ""
    ) -> None:
        """Words at a pixel; `title` shows when the pointer rests on them."""
        hint = f"<title>{escape(title)}</title>" if title else ""
        self.parts.append(
            f'<text class="{kind}" x="{column:.1f}" y="{row:.1f}">{hint}{escape(words)}</text>'
        )

    def shape(self, path: str, kind: str) -> None:
        """Any path in pixels."""
        self.parts.append(f'<path class="{kind}" d="{path}"/>')

    def x_axis(
        self, label: str, values: Sequence[float] | np.ndarray | None = None, *, zero: str = "grid"
    ) -> None:
        """Grid lines at values, (N,), with numbers and label; `zero` is the style at 0."""
        f = self.frame
        foot = f.height - f.bottom
        for value in ticks(*f.x) if values is None else values:
            at = float(f.columns(value))
            self.shape(f"M{at:.1f} {f.top:.1f}V{foot:.1f}", zero if value == 0 else "grid")
            self.text(at, foot + 13, number_text(value), "tick middle")
        self.text((f.left + f.width - f.right) / 2, foot + 28, label, "label middle")

    def y_axis(self, label: str = "") -> None:
        """Grid lines and signed numbers at the left, and above them what they are."""
        f = self.frame
        for value in ticks(*f.y, most=5):
            at = float(f.rows(value))
            self.shape(f"M{f.left:.1f} {at:.1f}H{f.width - f.right:.1f}",
                       "zero" if value == 0 else "grid")  # fmt: skip
            self.text(f.left - 5, at + 4, number_text(value, signed=True), "tick end")
        if label:
            self.text(2, f.top - 6, label, "label")

    def markup(self, label: str) -> Markup:
        """The finished diagram; `label` tells what it is to those who cannot see it."""
        f = self.frame
        return Markup(
            f'<svg class="plot" viewBox="0 0 {f.width:g} {f.height:g}" role="img" '
            f'aria-label="{escape(label)}">{"".join(self.parts)}</svg>'
        )

    def _places(self, x: np.ndarray, y: np.ndarray) -> Iterator[str]:
        columns, rows = np.broadcast_arrays(self.frame.columns(x), self.frame.rows(y))
        pairs = zip(columns.tolist(), rows.tolist(), strict=True)
        return (f"{column:.1f} {row:.1f}" for column, row in pairs)
