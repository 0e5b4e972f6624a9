"""summary.json, deviations.csv and the terminal table."""

import io
import json
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from tests.report_case import HOSTILE, points, run
from vmach.errors import InputError
from vmach.report import (
    Column,
    columns_table,
    read_deviations_csv,
    write_deviations_csv,
    write_summary,
)


def strict_json(text):
    def refuse(constant):
        raise ValueError(constant)

    return json.loads(text, parse_constant=refuse)


def test_summary_is_strict_json_and_names_the_line_of_the_worst_point(tmp_path):
    case = points()
    write_summary(tmp_path / "summary.json", case, run(title=HOSTILE))
    summary = strict_json((tmp_path / "summary.json").read_text(encoding="utf-8"))
    abbe = summary["variants"]["abbe"]
    deviation_um = 1e3 * case["abbe"].deviation_mm[case["abbe"].is_cut]
    assert summary["title"] == HOSTILE
    assert summary["tolerance_um"] == pytest.approx(3.0)
    assert abbe["rms_um"] == pytest.approx(np.sqrt(np.mean(deviation_um**2)))
    assert abbe["outside_tolerance"] == (np.abs(deviation_um) > 3).sum()
    assert abbe["status"]["gouged away"] == 3
    assert len(abbe["worst"]) == 10
    worst = abbe["worst"][0]
    assert abs(worst["deviation_um"]) == pytest.approx(np.abs(deviation_um).max())
    assert worst["nc"] == f"N{worst['line']} G1 X{worst['line']}"


def test_summary_without_a_cut_point_has_null_instead_of_nan(tmp_path):
    case = points(20)
    uncut = Column("none", "none", np.full(20, np.nan), np.full(20, "uncut"))
    write_summary(tmp_path / "s.json", replace(case, columns=(uncut,)), run())
    figures = strict_json((tmp_path / "s.json").read_text())["variants"]["none"]
    assert figures["rms_um"] is None
    assert figures["worst"] == []


def test_csv_gives_back_what_was_written(tmp_path):
    case = points(name='walls, "quoted" \u00e4')
    write_deviations_csv(tmp_path / "d.csv", case)
    again = read_deviations_csv(tmp_path / "d.csv")
    np.testing.assert_allclose(again.point_mm, case.point_mm, rtol=1e-8, atol=1e-8)
    np.testing.assert_array_equal(again.feature, case.feature)
    np.testing.assert_array_equal(again.line, case.line)
    np.testing.assert_allclose(again.u_mm, case.u_mm)
    for column in case.columns:
        np.testing.assert_array_equal(again[column.name].status, column.status)
        np.testing.assert_allclose(
            again[column.name].deviation_mm, column.deviation_mm, rtol=0, atol=5.1e-10
        )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "not a table of deviations"),
        ("id,feature\nP1,top\n", "not a table of deviations"),
        (
            "id,feature,x,y,z,i,j,k,line,tool,move,time_s,u_um,a_deviation_um,a_status\n"
            "P1,top,1,2,oops,0,0,1,1,1,1,0,,0.5,cut\n",
            "oops",
        ),
    ],
)
def test_a_foreign_csv_is_refused_with_its_name(tmp_path, text, message):
    (tmp_path / "d.csv").write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        read_deviations_csv(tmp_path / "d.csv")
    assert str(tmp_path / "d.csv") in str(caught.value)


def test_a_missing_csv_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_deviations_csv(tmp_path / "d.csv")


def test_terminal_table_shows_every_variant_and_takes_names_literally():
    case = points()
    stream = io.StringIO()
    hostile = replace(case.columns[0], label="[red]program[/red]")
    table = columns_table(replace(case, columns=(hostile, *case.columns[1:])), run())
    Console(file=stream, width=160).print(table)
    text = stream.getvalue()
    assert "[red]program[/red]" in text
    assert "outside ±3 um" in text
    rms_um = 1e3 * np.sqrt(np.mean(case["measured"].deviation_mm ** 2))
    assert f"{rms_um:.3f}" in text
