"""Files that no user means to give: endless, huge, nested, with names that steer a terminal."""

import os
import re
import signal
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from gcode import ProgramError
from gcode.state.tools import read_tool_table
from gcode.text.source import Source
from vmach.base.terminal import printable
from vmach.cli import app
from vmach.errors import InputError
from vmach.files import toml_file
from vmach.files.text_file import read_bytes, read_text
from vmach.files.toml_file import FileSection, read_toml
from vmach.measurements.columns import read_columns
from vmach.nominal import read_nominal
from vmach.nominal.points import read_points_csv


class Schema(FileSection):
    known: int = 1


def vmach(*arguments):
    command = [sys.executable, "-m", "vmach", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, timeout=60)


def pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe.stl")
    return tmp_path / "pipe.stl"


@pytest.mark.parametrize(
    ("read", "error"),
    [
        (lambda path: read_text(path, what="table"), InputError),
        (lambda path: read_toml(path, Schema, what="job file"), InputError),
        (read_points_csv, InputError),
        (lambda path: read_columns(path, numbers=["x"]), InputError),
        (read_nominal, InputError),
        (Source.read, ProgramError),
        (read_tool_table, ProgramError),
    ],
)
def test_neither_a_device_nor_a_pipe_is_opened(tmp_path, read, error):
    endless = tmp_path / "zero.stl"
    endless.symlink_to("/dev/zero")
    for path in (endless, pipe(tmp_path)):
        with pytest.raises(error, match="device or"):
            read(path)


def test_a_file_too_large_a_loop_and_a_zero_byte(tmp_path):
    (tmp_path / "large").write_bytes(b"x" * 11)
    assert read_bytes(tmp_path / "large", what="table", largest_bytes=11) == b"x" * 11
    with pytest.raises(InputError, match="too large; accepted: at most"):
        read_bytes(tmp_path / "large", what="table", largest_bytes=10)
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(InputError, match=r"cannot be read: .*symbolic links"):
        read_bytes(tmp_path / "loop", what="table")
    with pytest.raises(InputError, match="zero byte in its name"):
        read_bytes(tmp_path / "a\0b", what="table")


@pytest.mark.parametrize("command", ["run", "path", "diagnose", "open", "batch"])
def test_a_job_that_is_a_loop_of_links(tmp_path, command):
    (tmp_path / "job.toml").symlink_to("job.toml")
    error = CliRunner().invoke(app, [command, str(tmp_path / "job.toml")]).exception
    assert isinstance(error, InputError)
    assert re.search("Too many levels of symbolic links|no such job file", str(error))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("known = " + "7" * 4301, "too many digits"),
        ("known = " + "[" * 100_000, "nested too deeply"),
        ("".join(f"key_{k} = {k}\n" for k in range(200_000)), "at most 1 MiB"),
    ],
)
def test_toml_that_python_itself_refuses(tmp_path, text, message):
    (tmp_path / "job.toml").write_text(text)
    with pytest.raises(InputError, match=message):
        read_toml(tmp_path / "job.toml", Schema, what="job file")


def test_thirty_thousand_unknown_keys_are_no_work(tmp_path, monkeypatch):
    """One line is looked for, not one a key: that took hours."""
    looked = []
    found = toml_file.line_of_key
    monkeypatch.setattr(toml_file, "line_of_key", lambda *a: looked.append(a) or found(*a))
    path = tmp_path / "job.toml"
    path.write_text("".join(f"key_{k} = {k}\n" for k in range(30_000)))
    with pytest.raises(InputError, match=r"job.toml:1: unknown key 'key_0'"):
        read_toml(path, Schema, what="job file")
    assert len(looked) == 1
    looked.clear()
    path.write_text("".join(f"key_{k} = {k}\n" for k in range(200)))
    assert len(toml_file.complaints(path, Schema, what="job file")) == len(looked) == 100


def test_a_file_that_is_no_toml_is_not_shown(tmp_path):
    (tmp_path / "shadow").write_text("root:$6$secret:19000:0:99999:7:::\n")
    with pytest.raises(InputError, match=r"shadow:1: machine file is not valid TOML") as caught:
        read_toml(tmp_path / "shadow", Schema, what="machine file")
    assert "secret" not in str(caught.value)


def test_a_cell_that_never_ends(tmp_path):
    (tmp_path / "table.csv").write_text('x\n1\n"' + 140_000 * "2")
    with pytest.raises(InputError, match=r"table.csv:\d+: no row of a CSV file: field larger"):
        read_columns(tmp_path / "table.csv", numbers=["x"])


def test_a_number_of_five_thousand_digits_in_a_program(tmp_path):
    (tmp_path / "part.nc").write_text("G0 X1\nM" + "9" * 5000 + "\n")
    with pytest.raises(ProgramError, match=r"part.nc:2: a number of 5000 digits"):
        Source.read(tmp_path / "part.nc")


def test_names_do_not_steer_the_terminal(tmp_path):
    assert printable("a\tb\n\x1b[31m\x07é\u202e") == "a\tb\n\\x1b[31m\\x07é\\u202e"
    ended = vmach("run", tmp_path / "no\x1b[2Jthing.toml")
    assert ended.returncode == 1
    assert b"no\\x1b[2Jthing.toml" in ended.stderr
    assert b"\x1b" not in ended.stderr + ended.stdout


def test_a_message_stays_readable_whatever_it_quotes(tmp_path):
    (tmp_path / "runs.csv").write_text("target_mm,run1_up\n0," + 100_000 * "x" + "\n")
    ended = vmach("iso230", tmp_path / "runs.csv")
    assert ended.returncode == 1
    assert len(ended.stderr) < 3000


def test_the_reader_of_a_pipe_may_leave(tmp_path):
    (tmp_path / "part.nc").write_text("G21 G90 G0 X1\nM2\n")
    read, write = os.pipe()
    os.close(read)
    command = [sys.executable, "-m", "vmach", "canon", str(tmp_path / "part.nc")]
    done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, timeout=60)
    os.close(write)
    assert done.returncode == -signal.SIGPIPE
    told = done.stderr.decode().splitlines()
    assert [line for line in told if not line.startswith("note: part.nc is read as")] == []


def test_a_full_disk_is_told_with_its_file():
    with open("/dev/full", "wb") as full:
        command = [sys.executable, "-m", "vmach", "effects", "list"]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, timeout=60)
    assert done.returncode == 1
    assert re.fullmatch(rb"vmach: standard output: No space left on device\n", done.stderr)
