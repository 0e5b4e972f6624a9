"""Laser interferometer along a diagonal that several axes make together.

Source: ISO 230-6, displacement tests on body and face diagonals.
"""

import numpy as np

from vmach.errors import InputError
from vmach.files.toml_file import NonNegative, Point
from vmach.instruments.line_plots import line_plots
from vmach.instruments.readings import along_line
from vmach.measurements.columns import Columns
from vmach.measurements.instrument import Instrument

__all__ = ["Diagonal"]

#: a place may lie so far beyond an end; chosen: ends are stated in whole mm
_ROUNDED_MM = 1.0


class Diagonal(Instrument):
    """Distances along a line that several axes make together (ISO 230-6)."""

    name = "diagonal"
    title = "Diagonal"
    columns = ("run", "distance_mm", "approach", "deviation_um")
    optional_columns = ("t_s",)
    has_runs = True
    readings = ("deviation_um",)
    signs = ("approach",)
    sign_meaning = (
        "deviation_um is positive where the tool is further towards to_mm than programmed"
    )
    left_free = "zero"
    shows_law_band = True
    exchanged_keys = ("from_mm", "to_mm")

    from_mm: Point
    to_mm: Point
    scale_u_ppm: NonNegative | None = None

    def read(self, table, model):
        start, end = np.array(self.from_mm), np.array(self.to_mm)
        length = float(np.linalg.norm(end - start))
        if length == 0.0:
            raise InputError(
                f"from_mm and to_mm are the same place, {start.tolist()}",
                file=table.path,
                accepted="two ends of a diagonal",
            )
        _check_between(table, length)
        direction = (end - start) / length
        nose = start + table.numbers["distance_mm"][:, None] * direction
        scale_u = self.scale_u_ppm
        return along_line(self, table, nose, direction=direction, scale_u_ppm=scale_u, model=model)

    @classmethod
    def plots(cls, curves):
        return tuple(line_plots(curves, curves.measurement.sensing[0]))


def _check_between(table: Columns, length_mm: float) -> None:
    """Refuse a distance that lies beyond an end of the diagonal: it is another one, or elsewhere.

    Raises
    ------
    InputError
        With the first line.
    """
    distance = table.numbers["distance_mm"]
    beyond = (distance < -_ROUNDED_MM) | (distance > length_mm + _ROUNDED_MM)
    if beyond.any():
        raise InputError(
            f"distance_mm is {distance[beyond][0]:.6g}, beyond an end of the diagonal",
            file=table.path,
            line=table.line_of(beyond),
            accepted=f"0 at from_mm to {length_mm:.6g} mm at to_mm",
            hint="are from_mm and to_mm those of this file, and the distances in mm?",
        )
