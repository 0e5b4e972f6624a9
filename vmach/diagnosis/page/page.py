"""diagnosis.html: the verdict, where the model fails, and what was looked for, in one file."""

from __future__ import annotations

from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import numpy as np
from markupsafe import Markup

from gcode import Source
from vmach.base.colour_ramp import COLOUR_STOPS, UNKNOWN_COLOUR
from vmach.base.units import um_from_mm, with_micro_sign
from vmach.diagnosis.diagnose import Diagnosis
from vmach.diagnosis.findings import Finding
from vmach.diagnosis.page.covariate_panels import covariate_panels
from vmach.diagnosis.page.heading import chance_words, headline, quantity, state_words
from vmach.diagnosis.page.instrument_pictures import instrument_pictures
from vmach.diagnosis.page.residual_map import ResidualMap, residual_map
from vmach.diagnosis.report import words_of_add
from vmach.diagnosis.words import RELATIVE, expected, title_of, weak_words
from vmach.files.atomic import atomic_file
from vmach.job import Job
from vmach.nominal import Mesh
from vmach.report import RunRecord
from vmach.report.page.kit import (
    asset,
    jpeg_data_uri,
    render_page,
    script_json,
    style_sheet,
    viewer_scripts,
)
from vmach.report.page.payload import encode_payload
from vmach.report.page.svg_plot import Frame, Plot, number_text

__all__ = ["write_diagnosis_page"]

_HERE = Path(__file__).parent
#: candidates and blind spots that are shown at once
_MOST = 10


def write_diagnosis_page(
    path: Path,
    found: Diagnosis,
    *,
    title: str,
    nominal: Mesh | None,
    command: str,
    job: str,
    program: str | None = None,
) -> None:
    """Write the page; it asks the network for nothing.

    Parameters
    ----------
    path : Path
    found : Diagnosis
    title : str
        Name of the job.
    nominal : Mesh or None
        The surface to show the residual on; without it the points are shown alone.
    command : str
        Command line as typed.
    job : str
        The job as typed, for the commands that the page proposes.
    program : str, optional
        File of the next measurement's program.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    residuals, read = found.residuals, found.residuals.survey.job
    part = residual_map(residuals, nominal)
    heading, summary = headline(found)
    tested = [c for c in found.candidates if c.is_tested]
    page = render_page(
        _HERE / "page.html.jinja",
        title=title,
        command=command,
        program=program,
        started_at=datetime.now(UTC).isoformat(timespec="seconds"),
        version=version("vmach"),
        found=found,
        heading=heading,
        summary=summary,
        cards=[_card(finding, found) for finding in found.findings],
        bars=_bars(found),
        states=state_words(found),
        relative=RELATIVE,
        add=words_of_add(found),
        weak_words=weak_words,
        job=job,
        map=None if part is None else _map_view(part, nominal is not None),
        panels=covariate_panels(residuals),
        instruments=instrument_pictures(residuals),
        tested=tested,
        excluded=[c for c in found.candidates if not c.is_tested],
        most=_MOST,
        blind=[spot for spot in found.blind_spots if spot.from_size is not None],
        unseen=[spot for spot in found.blind_spots if spot.from_size is None],
        measurements=residuals.survey.measurements,
        by_measurement=residuals.rms_um_by_measurement,
        chance=chance_words,
        css=style_sheet(asset("page.css", _HERE)),
        page_data=None if part is None else script_json(_page_data(part)),
        payload=None if part is None else encode_payload(part.mesh, part.points, _record(read)),
        scripts=[*viewer_scripts(), asset("page.js", _HERE)],
    )
    with atomic_file(path) as temporary:
        temporary.write_text(page, encoding="utf-8")


def _card(finding: Finding, found: Diagnosis) -> dict:
    """Everything that the template shows of one effect."""
    if finding.effect is None:
        return {"finding": finding, "rows": [], "rivals": [], "curve": None}
    own = finding.label
    meaning = {p.name: p.meaning for p in finding.effect.parameters}
    alone = {c.label: c.rms_after_um for c in found.candidates}
    rows = [
        {
            "name": name,
            "meaning": meaning[name],
            "hardly": name in finding.weakly_identified,
            "quantity": quantity(name, value, finding.interval_95[name]),
        }
        for name, value in finding.parameters.items()
        if name in finding.interval_95
    ]
    return {
        "finding": finding,
        "title": title_of(finding.effect, finding.target),
        "rows": rows,
        "rivals": [(words, alone.get(words)) for words in finding.indistinct],
        "alone": alone.get(own, found.rms_um["after"]),
        "curve": None if rows else _curve(finding),
    }


def _curve(finding: Finding) -> Markup:
    """The correction of a component over its axis, with its 95 % band."""
    key = next(iter(finding.u))
    position = np.array(finding.parameters["position_mm"])
    value, wide = np.array(finding.parameters[key]), 1.96 * np.array(finding.u[key])
    end = 1.05 * float(np.abs([value - wide, value + wide]).max())
    plot = Plot(Frame((position[0], position[-1]), (-end, end), width=520.0, top=18.0))
    plot.y_axis("correction, " + with_micro_sign(key.rsplit("_", 1)[1]))
    plot.x_axis(f"{finding.target[2]}, mm")
    plot.bands([(position, value - wide, value + wide)], "after")
    plot.line(position, value, "after")
    return plot.markup(f"Correction of {finding.target} with its 95 % band")


def _bars(found: Diagnosis) -> list[tuple[str, str, float, float]]:
    """Label, style, RMS in um and length in percent of each bar."""
    words = state_words(found) | {"expected_noise": expected(found.residuals)}
    largest = max(found.rms_um.values())
    rms = {name: found.rms_um[name] for name in words}
    return [(words[name], name, value, 100 * value / largest) for name, value in rms.items()]


def _map_view(part: ResidualMap, on_nominal: bool) -> dict:
    """What the template needs to show the part."""
    end_um = um_from_mm(part.range_mm)
    rms = {
        v.name: um_from_mm(float(np.sqrt(np.mean(v.deviation_mm**2)))) for v in part.points.columns
    }
    return {
        "stills": {name: jpeg_data_uri(still) for name, still in part.stills().items()},
        "rms_um": rms,
        "ticks": [number_text(end_um * k / 4, signed=True) for k in range(4, -5, -1)],
        "points": len(part.points),
        "on_nominal": on_nominal,
    }


def _page_data(part: ResidualMap) -> dict:
    return {
        "range_um": um_from_mm(part.range_mm),
        "colour_stops": COLOUR_STOPS,
        "unknown_colour": UNKNOWN_COLOUR,
    }


def _record(job: Job) -> RunRecord:
    """What the payload says of the run: the text of the program."""
    lines = tuple(Source.read(job.program).lines)
    return RunRecord("", "", "abbe", job.inspection.tolerance_mm, program_lines=lines)
