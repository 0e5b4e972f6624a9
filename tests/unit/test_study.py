"""Studies: the same bits however they are worked on, whole results, and one lost case at most."""

from __future__ import annotations

import io
import json
import os
import re
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from typer.testing import CliRunner

from tests.small_job import write_job
from vmach.cli import app
from vmach.errors import InputError
from vmach.run.pipeline import predict_points
from vmach.study.printing import print_performance
from vmach.study.run_study import Shard, merge_study, run_study
from vmach.study.study import read_study
from vmach.uncertainty.first_order import prediction_u_mm

ROOT = Path(__file__).parents[2]

FUNCTION = '''
import os, signal, time
from pathlib import Path

def draw(case, random):
    """Random numbers, and a line for everybody who worked on it."""
    log = case.folder / "log.txt"
    with log.open("a") as file:
        file.write(f"{case.key} {os.getpid()}\\n")
    number = case.values["number"]
    if number == 7 and not (case.folder / "spared").exists():
        if not (case.folder / "always").exists():
            (case.folder / "spared").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return {"sum": float(random.standard_normal(50).sum()), "list": random.random(2),
            "half": None if number % 2 else number // 2, "name": case.values["name"]}

def slow(case, random):
    time.sleep(0.05)
    return {"sum": float(random.standard_normal(50).sum()), "pid": 0}

def refuses(case, random):
    if case.values["number"] == 2:
        raise RuntimeError("two is refused")
    return {"number": float("nan") if case.values["number"] == 3 else 1.0}
'''
STUDY = """schema = 1
seed = 5
function = "{module}:{function}"
[cases]
name = ["a", "b"]
number = [{numbers}]
"""


def write_study(folder, numbers, function="draw"):
    folder.mkdir(exist_ok=True)
    module = f"study_functions_{abs(hash(str(folder)))}"  # modules are found by name once
    (folder / f"{module}.py").write_text(FUNCTION)
    text = STUDY.format(module=module, function=function, numbers=", ".join(map(str, numbers)))
    (folder / "study.toml").write_text(text)
    return folder / "study.toml"


def merged(path, out):
    table = Path(out) / "all.csv"
    merge_study(read_study(path), out, table)
    return table.read_bytes()


def runs_of(folder):
    return [line.split()[0] for line in (folder / "log.txt").read_text().splitlines()]


def test_serial_processes_and_shards_give_the_same_bits(tmp_path):
    (tmp_path / "spared").touch()
    path = write_study(tmp_path, range(20))
    study = read_study(path)
    run_study(study, tmp_path / "one", processes=1)
    run_study(study, tmp_path / "two", processes=2)
    for number in (3, 1, 2, 4, 5):
        found = run_study(study, tmp_path / "shards", shard=Shard(number, 5), processes=1)
        assert (found.cases, found.there, found.done) == (8, 0, 8)
    same = {merged(path, tmp_path / name) for name in ("one", "two", "shards")}
    assert len(same) == 1
    names = sorted(p.name for p in (tmp_path / "one" / "cases").iterdir())
    assert len(names) == 40 and all(re.fullmatch(r"[0-9a-f]{16}\.json", name) for name in names)
    for name in names:
        texts = {(tmp_path / w / "cases" / name).read_bytes() for w in ("one", "two", "shards")}
        assert len(texts) == 1


def test_a_killed_worker_loses_its_case_and_no_other(tmp_path):
    path = write_study(tmp_path, range(10))
    found = run_study(read_study(path), tmp_path / "killed", processes=2)
    assert (found.done, found.failed) == (20, 0)
    runs = runs_of(tmp_path)
    assert len(runs) == 21 and len(set(runs)) == 20
    run_study(read_study(path), tmp_path / "one", processes=1)
    assert merged(path, tmp_path / "killed") == merged(path, tmp_path / "one")


def test_a_case_that_always_kills_has_failed_and_the_others_are_there(tmp_path):
    path = write_study(tmp_path, range(5, 9))
    (tmp_path / "always").touch()
    out = tmp_path / "out"
    found = run_study(read_study(path), out, processes=2)
    assert (found.done, found.failed) == (6, 2)
    failed = sorted((out / "failed").iterdir())
    assert len(failed) == 2 and "its process ended 2 times" in failed[0].read_text()
    with pytest.raises(InputError, match="2 of 8 cases have no result"):
        merged(path, out)
    (tmp_path / "spared").touch()
    again = run_study(read_study(path), out, processes=2)
    assert (again.there, again.done) == (6, 2)
    assert not list((out / "failed").iterdir())


def test_what_is_there_is_not_done_again(tmp_path):
    (tmp_path / "spared").touch()
    path = write_study(tmp_path, range(5))
    study, out = read_study(path), tmp_path / "out"
    run_study(study, out, processes=1)
    before = merged(path, out)
    lost = study.cases[3]
    (out / "cases" / f"{lost.key}.json").unlink()
    (tmp_path / "log.txt").unlink()
    found = run_study(study, out, processes=1)
    assert (found.there, found.done) == (9, 1)
    assert runs_of(tmp_path) == [lost.key]
    assert merged(path, out) == before


def test_errors_are_kept_beside_the_results(tmp_path):
    path = write_study(tmp_path, range(4), "refuses")
    result = CliRunner().invoke(
        app, ["batch", str(path), "--out", str(tmp_path / "out"), "--processes", "1", "--json"]
    )
    assert result.exit_code == 1
    told = [p.read_text() for p in (tmp_path / "out" / "failed").iterdir()]
    assert sum("two is refused" in text and "number = 2" in text for text in told) == 2
    assert sum("accepted: finite numbers, text, None" in text for text in told) == 2
    assert json.loads(result.stdout)["failed"] == 4


@pytest.mark.parametrize("processes", ["1", "2"])
def test_a_program_that_cannot_be_read_is_told_in_its_own_words(processes, tmp_path):
    """As ``vmach predict`` tells it: file, line and block, no class and no place of the code."""
    job = write_job(tmp_path)
    lines = job.with_name("part.nc").read_text().splitlines()
    job.with_name("wrong.nc").write_text("\n".join([*lines[:2], "G1 X1 X2", *lines[2:]]) + "\n")
    (tmp_path / "study.toml").write_text(
        'schema = 1\n[cases]\njob = "job.toml"\npoints = "points.csv"\n'
        'program = ["wrong.nc", "part.nc"]\n'
    )
    words = ["batch", str(tmp_path / "study.toml"), "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(app, [*words, "--processes", processes])
    assert result.exit_code == 1
    (told,) = (tmp_path / "out" / "failed").iterdir()
    first, second = told.read_text().splitlines()
    assert "program = wrong.nc" in first
    assert re.match(r".*wrong\.nc:3(:\d+)?: ", second) and "'G1 X1 X2'" in second
    assert result.stderr.rstrip().endswith(second)
    for code in ("Error", "Traceback", ".py"):
        assert code not in told.read_text() + result.stderr


def test_a_case_does_not_depend_on_the_others(tmp_path):
    """Its random numbers are those of its values and the seed."""
    (tmp_path / "spared").touch()
    few, many = (read_study(write_study(tmp_path, n)) for n in (range(3), range(9)))
    texts = {c.key: c.random().random() for c in many.cases}
    assert all(texts[c.key] == c.random().random() for c in few.cases)
    assert len(set(texts.values())) == len(many.cases)


def test_another_study_does_not_go_on_in_the_same_folder(tmp_path):
    (tmp_path / "spared").touch()
    path = write_study(tmp_path, range(3))
    run_study(read_study(path), tmp_path / "out", processes=1)
    path.write_text(path.read_text().replace("seed = 5", "seed = 6"))
    with pytest.raises(InputError, match="of the study before 'seed' changed"):
        run_study(read_study(path), tmp_path / "out", processes=1)
    with pytest.raises(InputError, match="holds files, and no study"):
        run_study(read_study(path), tmp_path, processes=1)


@pytest.mark.parametrize(
    ("change", "line", "message"),
    [
        (("draw", "no_such"), 3, "has no function 'no_such'"),
        (('"a", "b"', ""), 5, "cases.name is empty"),
        (('"a", "b"', '"a", "a"'), None, "occurs 2 times"),
        (("seed = 5", "seed = -5"), 2, "seed"),
        (("[cases]", "draws = 0\n[cases]"), 4, "draws"),
        (("[cases]", 'table = "none.csv"\n[cases]'), None, "none.csv"),
    ],
)
def test_mistakes_are_told_with_line_and_value(tmp_path, change, line, message):
    path = write_study(tmp_path, range(2))
    text = path.read_text()
    old = change[0] if change[0] != "draw" else ":draw"
    path.write_text(text.replace(old, (":" if old == ":draw" else "") + change[1], 1))
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        read_study(path)
    assert caught.value.line == line


@pytest.mark.parametrize("text", ["0/3", "4/3", "3", "a/b", "1/0"])
def test_a_shard_is_one_of_them(text):
    with pytest.raises(InputError, match="--shard"):
        Shard.of_text(text)


def test_a_table_of_cases_is_read_with_numbers(tmp_path):
    (tmp_path / "cases.csv").write_text("kind,size\nsmall,1\nlarge,2.5\n")
    (tmp_path / "study.toml").write_text(
        'schema = 1\nfunction = "math:sqrt"\ntable = "cases.csv"\ndraws = 2\n'
    )
    found = [dict(case.values) for case in read_study(tmp_path / "study.toml").cases]
    assert found[0] == {"kind": "small", "size": 1, "draw": 1}
    assert found[3] == {"kind": "large", "size": 2.5, "draw": 2}


def test_predicted_draws_scatter_as_first_order_says(tmp_path):
    """120 machines with drawn corrections, each cut anew, beside u_um of the job."""
    errors = {"EXX": (lambda x: 0.02 * x, (0, 0, 0)), "EBX": (lambda x: 0.1 * x, None)}
    job = write_job(tmp_path, errors, squareness="\n[uncertainty]\nreading_um = 3.0\n")
    (tmp_path / "study.toml").write_text(
        'schema = 1\ndraws = 120\n[cases]\njob = "job.toml"\npoints = "points.csv"\n'
    )
    study = read_study(tmp_path / "study.toml")
    assert run_study(study, tmp_path / "out", processes=1).done == 120
    points, prediction = predict_points(job, tmp_path / "points.csv")
    files = (tmp_path / "out" / "cases").iterdir()
    results = [json.loads(path.read_text())["result"]["deviation_um"] for path in files]
    drawn = np.array([[one[point] for point in points.id] for one in results])
    u = 1e3 * prediction_u_mm(prediction)
    seen = u > 1e-6
    ratio = drawn.std(axis=0, ddof=1)[seen] / u[seen]
    # a standard deviation of 120 draws has a standard deviation of 1 / sqrt(240) of itself
    assert np.abs(ratio - 1.0).max() < 3.5 / np.sqrt(240)
    off = (drawn.mean(axis=0) - 1e3 * prediction.deviation_mm)[seen] / u[seen]
    assert np.abs(off).max() < 4.0 / np.sqrt(120)


def test_files_elsewhere_are_watched_too(tmp_path):
    (tmp_path / "spared").touch()
    path = write_study(tmp_path / "study", [1])
    (tmp_path / "study" / "spared").touch()
    other = tmp_path / "other.txt"
    other.write_text("before")
    path.write_text(path.read_text().replace('"a", "b"', f'"{other}"'))
    assert run_study(read_study(path), tmp_path / "out", processes=1).done == 1
    other.write_text("after")
    with pytest.raises(InputError, match=r"before '.*other\.txt' changed"):
        run_study(read_study(path), tmp_path / "out", processes=1)


def test_a_value_that_a_prediction_does_not_know_is_refused(tmp_path):
    (tmp_path / "study.toml").write_text('schema = 1\n[cases]\njob = "a"\nspeed = [1, 2]\n')
    with pytest.raises(InputError, match="no value 'speed'; accepted: job, points") as caught:
        read_study(tmp_path / "study.toml")
    assert caught.value.line == 4


@contextmanager
def cluster(folder, workers):
    """A dask scheduler and workers on the loopback; gives address and worker processes."""
    place = folder / "scheduler.json"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    env = os.environ | {"PYTHONPATH": str(ROOT)}

    def start(*words):
        command = [sys.executable, "-m", *words, "--scheduler-file", str(place), "--no-dashboard"]
        return subprocess.Popen(command, env=env, cwd=folder, **quiet)

    started = [start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0")]
    started += [
        start("distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny", "--death-timeout",
              "60") for _ in range(workers)
    ]  # fmt: skip
    try:
        until = time.monotonic() + 60
        while not place.exists() or not place.read_text():
            assert time.monotonic() < until, "no scheduler"
            time.sleep(0.1)
        yield json.loads(place.read_text())["address"], started[1:]
    finally:
        for process in started:
            process.kill()
        for process in started:
            process.wait()


def test_a_cluster_that_loses_a_worker_gives_the_same_bits(tmp_path):
    pytest.importorskip("distributed")
    path = write_study(tmp_path, range(60), "slow")
    run_study(read_study(path), tmp_path / "here", processes=2)
    with cluster(tmp_path, 2) as (address, workers):
        words = ["batch", str(path), "--out", str(tmp_path / "there"), "--scheduler", address]
        log = tmp_path / "log.txt"
        with log.open("w") as file:
            command = subprocess.Popen(
                [sys.executable, "-m", "vmach", *words],
                env=os.environ | {"PYTHONPATH": str(ROOT)},
                stderr=file,
            )
        cases = tmp_path / "there" / "cases"
        until = time.monotonic() + 60
        while not cases.exists() or len(list(cases.glob("*.json"))) < 10:
            assert time.monotonic() < until and command.poll() is None, log.read_text()
            time.sleep(0.02)
        workers[0].send_signal(signal.SIGKILL)
        assert command.wait(60) == 0, log.read_text()
    assert merged(path, tmp_path / "there") == merged(path, tmp_path / "here")


def test_nobody_at_the_address_is_said(tmp_path):
    pytest.importorskip("distributed")
    path = write_study(tmp_path, range(1), "slow")
    words = ["batch", str(path), "--out", str(tmp_path / "out"), "--scheduler", "tcp://127.0.0.1:1"]
    run = subprocess.run(
        [sys.executable, "-m", "vmach", *words], env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True, text=True,
    )  # fmt: skip
    assert run.returncode == 1
    assert "vmach: --scheduler tcp://127.0.0.1:1" in run.stderr and "Traceback" not in run.stderr


WITH_FILES = 'schema = 1\n[cases]\njob = "job.toml"\npoints = "points.csv"\n'


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        (WITH_FILES + 'model = ["q"]\n', 5, "model = 'q'; accepted: none, "),
        (WITH_FILES + 'machine = ["machine.toml", "nope.toml"]\n', 5, "nope.toml': no such file"),
        (WITH_FILES + "program = 3\n", 5, "program = 3: no such file"),
        # false drew one machine all the same, as did any text
        (WITH_FILES + "draw = false\n", 5, "draw = False; accepted: a whole number from 1"),
        (WITH_FILES + 'draw = ["one"]\n', 5, "draw = 'one'; accepted: a whole number from 1"),
        ('schema = 1\n[cases]\npoints = "points.csv"\n', 2, "the cases have no 'job'"),
        ('schema = 1\ntable = "c.csv"\n', 2, "model = 'q'"),
        (WITH_FILES.replace("[cases]", "draws = 1000000000\n[cases]"), 2, "1000000000 cases"),
        (WITH_FILES.replace("[cases]", f"draws = {10**30}\n[cases]"), 2, f"{10**30} cases"),
    ],
)
def test_what_no_case_could_do_is_told_before_the_work(tmp_path, text, line, message):
    write_job(tmp_path)
    (tmp_path / "c.csv").write_text("job,points,model\njob.toml,points.csv,q\n")
    (tmp_path / "study.toml").write_text(text)
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        read_study(tmp_path / "study.toml")
    assert (caught.value.file, caught.value.line) == (tmp_path / "study.toml", line)


ENDS = """
import sys

def leaves(case, random):
    sys.exit(0)

def counts(case, random):
    return {"count": [1, 10**400]}
"""


@pytest.mark.parametrize("processes", ["1", "2"])
@pytest.mark.parametrize(
    ("function", "said"), [("leaves", "sys.exit(0)"), ("counts", "a whole number beyond 1.8e308")]
)
def test_a_function_that_leaves_or_counts_without_end(tmp_path, processes, function, said):
    path = write_study(tmp_path, range(2), function)
    module = next(tmp_path.glob("study_functions_*.py"))
    module.write_text(ENDS)
    words = ["batch", str(path), "--out", str(tmp_path / "out"), "--processes", processes]
    found = CliRunner().invoke(app, [*words, "--merge", str(tmp_path / "all.csv")])
    assert found.exit_code == 1
    assert "4 cases failed" in found.output and said in found.output


@pytest.mark.parametrize("text", ["import sys\nsys.exit(0)\n", "\n1 / 0\n", "\ndef draw(:\n"])
def test_a_module_that_cannot_be_loaded_is_told_with_the_line_that_names_it(tmp_path, text):
    path = write_study(tmp_path, range(2))
    next(tmp_path.glob("study_functions_*.py")).write_text(text)
    with pytest.raises(InputError, match=r"study\.toml:3: function = 'study_fun.*\.py:2|line 2"):
        read_study(path)


def test_what_every_case_has_alike_is_no_column_of_the_performance():
    row = {
        "feature": "bore", "callout": "35 H7", "draws": 1000, "Pp": 1.5, "Ppk": None,
        "quantiles_mm": [35.0, 35.01, 35.02],
    }  # fmt: skip
    rows = [row | {"case": {"job": "/far/job.toml", "model": m}} for m in ("abbe", "htm")]
    for some, columns in ((rows, ["model", "feature"]), (rows[:1], ["feature"])):
        told = io.StringIO()
        print_performance(Console(file=told, width=120), some)
        heading = next(line for line in told.getvalue().splitlines() if "feature" in line)
        assert [cell.strip() for cell in heading.strip("┃").split("┃")][: len(columns)] == columns
        assert "job.toml" not in told.getvalue()
