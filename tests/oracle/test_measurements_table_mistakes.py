"""Files of a healthy machine, spoiled as people spoil them: what is asked about them.

Machine, part and readings are of a generator that shares no code with the program.
"""

from __future__ import annotations

import shutil

import numpy as np
import pytest

from tests.hidden_effects.experiment import make_experiment
from vmach.base.note import Kind
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.measurements.plausibility.part_alternatives import part_alternatives

ARCSECOND_URAD = 4.84814
ANGLES = [f"E{kind}{axis}" for axis in "XYZ" for kind in "ABC"]


@pytest.fixture(scope="module")
def healthy(tmp_path_factory):
    folder = tmp_path_factory.mktemp("healthy") / "job"
    make_experiment(folder, effects=[], seed=61600001)
    return folder


def rewrite(folder, name, change):
    """The columns position, forward, backward of a table, changed."""
    path = folder / "errors" / f"{name}.csv"
    header = "position_mm,forward,backward"
    rows = change(np.loadtxt(path, delimiter=",", skiprows=1))
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.6f")


def from_the_other_end(folder):
    rewrite(folder, "EXX", lambda t: np.column_stack([t[:, 0], t[::-1, 1:]]))


def from_the_other_end_with_its_sign(folder):
    rewrite(folder, "EXX", lambda t: np.column_stack([t[:, 0], -t[::-1, 1:]]))


def exchanged_names(folder):
    one, other = (folder / "errors" / f"{name}.csv" for name in ("EYX", "EZX"))
    text = one.read_text()
    one.write_text(other.read_text())
    other.write_text(text)


def arcseconds(folder):
    for name in ANGLES:
        rewrite(folder, name, lambda t: np.column_stack([t[:, 0], t[:, 1:] / ARCSECOND_URAD]))


def exchanged_places(folder):
    path = folder / "part_measured.csv"
    header, *rows = path.read_text().splitlines()
    cells = [row.split(",") for row in rows]
    nominal, measured = slice(2, 5), slice(8, 11)
    for row in cells:
        row[nominal], row[measured] = row[measured], row[nominal]
    path.write_text("\n".join([header, *map(",".join, cells)]) + "\n")


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (from_the_other_end, "with EXX counted from the other end the readings"),
        (
            from_the_other_end_with_its_sign,
            "with EXX counted from the other end, its deviations too the readings",
        ),
        (exchanged_names, "with EYX and EZX exchanged the readings"),
        (arcseconds, "with all angles in arcseconds the readings"),
        (exchanged_places, "with the nominal and the measured places exchanged the readings"),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_what_was_spoiled_is_asked_about(healthy, tmp_path, spoil, said):
    folder = shutil.copytree(healthy, tmp_path / "job")
    spoil(folder)
    (note,) = questions(folder)
    assert note.startswith(f"part_measured.csv: {said} would agree with the model within 0.9")


def test_of_a_scan_some_points_tell(healthy, tmp_path, monkeypatch):
    asked_on = []

    def counted(part, preparation):
        asked_on.append(len(part))
        return part_alternatives(part, preparation)

    monkeypatch.setattr("vmach.instruments.kinds.part_points._ASKED", 200)
    monkeypatch.setattr("vmach.instruments.kinds.part_points.part_alternatives", counted)
    folder = shutil.copytree(healthy, tmp_path / "job")
    exchanged_names(folder)
    (note,) = questions(folder)
    assert "with EYX and EZX exchanged the readings" in note
    assert 200 <= asked_on[0] < 400


def test_files_that_are_right_are_not_asked_about(healthy):
    assert questions(healthy) == []


def questions(folder):
    (part,) = survey_job(folder / "job.toml").measurements
    return [str(note) for note in part.notes if note.kind is Kind.EXCHANGED]
