"""What the model's process answers: one function a question, a record and at most one array."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from gcode import readable
from vmach.base.units import mm_from_um, um_from_mm
from vmach.job import Job, job_name
from vmach.machine import Variant
from vmach.machine.variant_name import variant_called
from vmach.report import ReportView
from vmach.report.page.payload import pack_mesh
from vmach.workbench.model.effect_cards import effect_cards
from vmach.workbench.model.machine_changes import (
    MachineChange,
    drawn_table_text,
    machine_cards,
)
from vmach.workbench.model.part_model import load_part
from vmach.workbench.model.playback import playback
from vmach.workbench.model.point_facts import point_facts, points_of_line
from vmach.workbench.model.quantities import figures_of, quantities, values_mm
from vmach.workbench.model.screen_report import (
    Shown,
    less_of_other,
    sliders_in_words,
    write_screen_report,
)
from vmach.workbench.model.what_if import read_changes

__all__ = ["QUESTIONS", "Answer", "Answers"]

#: share of a vertex's points without a value at which it has none
_SOME = 0.01

#: a record that becomes JSON, and bytes that go beside it
Answer = tuple[dict[str, Any], bytes]


class Answers:
    """Answers about one job, which is read when the first question comes."""

    def __init__(self, job: str, effect_files: Sequence[str] = ()) -> None:
        self._model = load_part(Path(job), [Path(file) for file in effect_files])
        self._on_mesh: dict[str, Any] = {}

    def about(self) -> Answer:
        """What was opened."""
        model, job = self._model, self._model.job
        moves = model.preparation.program.moves
        return {
            "name": job_name(job.path),
            "machine": job.machine.name,
            "chain": str(job.machine.chain),
            "program": job.program.name,
            "lines": len(model.preparation.program.source.lines),
            "moves": len(moves),
            "duration_s": float(moves.start_s[-1] + moves.duration_s[-1]) if len(moves) else 0.0,
            "tolerance_um": um_from_mm(job.inspection.tolerance_mm),
            "points": len(model.surface),
            "triangles": len(model.mesh.triangles),
            "is_measured": model.is_measured,
            "has_measured_part": model.has_measured_part,
            "measured_file": None if job.measured is None else job.measured.name,
            "missing": model.missing,
            "has_blank": job.blank is not None,
            "effects": [effect.label for effect in model.effects],
            "quantities": [vars(one) for one in quantities(model)],
            "models": [str(v) for v in (Variant.ABBE, Variant.HTM, Variant.NONE)],
            "notes": [str(note) for note in model.notes],
            "files": [str(path) for path in (*(p for _, p in job.files()), *_read_by(job))],
        }, b""

    def measured(self) -> Answer:
        """What was measured, and how far the model is from it."""
        survey = self._model.survey
        if survey is None:
            return {"readings": 0}, b""
        from vmach.history import rms_um

        return {
            "readings": len(survey),
            "rms_um": rms_um(survey),
            "measurements": [{"name": m.name, "kind": m.instrument.name, "readings": len(m)}
                             for m in survey.measurements],
            "notes": [str(note) for note in survey.notes],
        }, b""  # fmt: skip

    def mesh(self) -> Answer:
        """The packed mesh."""
        return {}, pack_mesh(self._model.mesh)

    def values(
        self, quantity: str = "deviation", model: str = "abbe", changes: Sequence[Mapping] = (),
        tolerance_um: float | None = None,
    ) -> Answer:  # fmt: skip
        """Figures of a quantity, and its value at every vertex (V,) float32 um, NaN unknown."""
        part = self._model
        wanted = read_changes(changes, part.job, part.effects)
        points, value_mm = values_mm(part, quantity, variant_called(model), wanted)
        tolerance_mm = part.job.inspection.tolerance_mm
        if tolerance_um is not None:
            tolerance_mm = mm_from_um(tolerance_um)
        figures = figures_of(points, value_mm, tolerance_mm)
        return figures | {"quantity": quantity, "model": model}, self._at_vertices(points, value_mm)

    def difference(
        self, minus: tuple[Mapping[str, Any], bytes], quantity: str = "deviation",
        model: str = "abbe", changes: Sequence[Mapping] = (), tolerance_um: float | None = None,
    ) -> Answer:  # fmt: skip
        """As `values`, less what another job answered, at the points that both have."""
        part = self._model
        wanted = read_changes(changes, part.job, part.effects)
        points, value_mm = values_mm(part, quantity, variant_called(model), wanted)
        left_mm = less_of_other(points, value_mm, *minus)
        of_both = np.isfinite(left_mm)
        tolerance_mm = part.job.inspection.tolerance_mm
        if tolerance_um is not None:
            tolerance_mm = mm_from_um(tolerance_um)
        figures = figures_of(points.only(of_both), left_mm[of_both], tolerance_mm)
        return figures | {"quantity": quantity, "model": model}, self._at_vertices(points, left_mm)

    def exact(self, changes: Sequence[Mapping] = ()) -> Answer:
        """The deviation with changes, cut anew: another move may make a point then.

        Figures and values as `values` has them; and how far the first order was off, um.
        """
        part = self._model
        wanted = read_changes(changes, part.job, part.effects)
        points, first_order_mm = values_mm(part, "deviation", Variant.ABBE, wanted)
        machines = [c.now for c in wanted if isinstance(c, MachineChange)]
        effects = [c.now for c in wanted if not isinstance(c, MachineChange)]
        value_mm = points.align(part.cut_anew(effects, *machines))
        figures = figures_of(points, value_mm, part.job.inspection.tolerance_mm)
        off_um = float(um_from_mm(np.abs(value_mm - first_order_mm).max(initial=0.0)))
        figures |= {"quantity": "deviation", "model": "abbe", "first_order_off_um": off_um}
        return figures, self._at_vertices(points, value_mm)

    def screen_report(
        self, path: str, picture: str | None, view: Mapping[str, Any], tolerance_um: float,
        quantity: str = "deviation", model: str = "abbe", changes: Sequence[Mapping] = (),
        minus: tuple[Mapping[str, Any], bytes] | None = None,
    ) -> Answer:  # fmt: skip
        """Write the one-file report of what is shown; `minus` is what another job answered."""
        part = self._model
        wanted = read_changes(changes, part.job, part.effects)
        points, value_mm = values_mm(part, quantity, variant_called(model), wanted)
        asked = next(one for one in quantities(part) if one.name == quantity)
        facts = {"shown": asked.label, "sliders": sliders_in_words(changes)}
        facts |= {"error model": model} if asked.has_models else {}
        label = asked.label + (", with the sliders" if changes else "")
        if minus is not None:
            value_mm, label = (
                less_of_other(points, value_mm, *minus),
                f"{label}, minus that of {minus[0]['name']}",
            )
            facts |= {"minus": str(minus[0]["name"])}
        is_signed = asked.is_signed or minus is not None
        shown = Shown(points, value_mm, label, facts, mm_from_um(tolerance_um), is_signed)
        still = None if picture is None else Path(picture)
        write_screen_report(Path(path), part, shown, ReportView(**view), picture=still)
        return {}, b""

    def residual(self, changes: Sequence[Mapping] = ()) -> Answer:
        """RMS of measured minus predicted with changes, um; None where no part was measured."""
        part = self._model
        if part.measured is None:
            return {"rms_um": None}, b""
        wanted = read_changes(changes, part.job, part.effects)
        _, left = values_mm(part, "residual", Variant.ABBE, wanted)
        return {"rms_um": float(um_from_mm(np.sqrt(np.mean(left**2))))}, b""

    def point(self, points: str, at: Sequence[float], normal: Sequence[float]) -> Answer:
        """The point nearest to a place on a face of its direction."""
        found = self._model.point_set(points)
        row = found.nearest(np.array(at, float), np.array(normal, float))
        return ({} if row is None else point_facts(found, row)), b""

    def line(self, line: int) -> Answer:
        """What a line of the program makes: figures, and places (N, 3) float32."""
        figures, places = points_of_line(self._model.surface, line)
        return figures, places.astype("<f4").tobytes()

    def program(self, first: int, count: int) -> Answer:
        """Lines of the program's text, from the 1-based `first` on."""
        lines = self._model.preparation.program.source.lines
        shown = [readable(line) for line in lines[first - 1 : first - 1 + count]]
        return {"first": first, "total": len(lines), "lines": shown}, b""

    def effects(self) -> Answer:
        """Cards of all effects, and of the machine's tables."""
        machine = machine_cards(self._model.job.machine)
        return {"cards": effect_cards(self._model), "machine": machine}, b""

    def drawn_table(self, wanted: Mapping[str, Any]) -> Answer:
        """The file of a table that was drawn by hand."""
        return {}, drawn_table_text(self._model.job.machine, wanted).encode()

    def point_values(self, quantity: str, model: str) -> Answer:
        """A quantity at its points: their names, and (C,) float64 mm."""
        points, value_mm = values_mm(self._model, quantity, variant_called(model))
        return {"name": job_name(self._model.job.path), "ids": points.id.tolist()}, (
            value_mm.astype("<f8").tobytes()
        )

    def instruments(self) -> Answer:
        """Forms for readings."""
        from vmach.workbench.model.instrument_forms import instrument_forms

        return {"forms": instrument_forms()}, b""

    def check_job(self, job: str) -> Answer:
        """Read all that was measured for another job; refused where that cannot be."""
        from vmach.diagnosis.residuals.job_survey import survey_job

        return {"readings": len(survey_job(job))}, b""

    def playback(self) -> Answer:
        """Nodes of the path."""
        facts, rows = playback(self._model)
        return facts, rows.tobytes()

    def _at_vertices(self, points: Any, value_mm: np.ndarray) -> bytes:
        if points.name not in self._on_mesh:
            self._on_mesh[points.name] = points.on_mesh(self._model.mesh)
        onto = self._on_mesh[points.name]
        value = um_from_mm(onto.at_vertices(value_mm))
        is_known = onto.known & (onto.matrix @ np.isnan(value_mm) < _SOME)
        return np.where(is_known, value, np.nan).astype("<f4").tobytes()


def _read_by(job: Job) -> list[Path]:
    """Files of readings that a job names; those that cannot be are refused when they are read."""
    names = [one.get("file") for one in job.measurements]
    return [job.folder / name for name in names if isinstance(name, str)]


#: what may be asked
QUESTIONS: dict[str, Callable[..., Answer]] = {
    name: getattr(Answers, name)
    for name in ("about", "measured", "mesh", "values", "difference", "exact", "residual", "point",
                 "line", "program", "effects", "drawn_table", "point_values", "instruments",
                 "check_job", "playback", "screen_report")
}  # fmt: skip
