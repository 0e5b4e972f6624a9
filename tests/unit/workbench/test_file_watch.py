"""Files that change are noticed once, when they rest, and also while they are being read."""

import os
import time

from vmach.workbench.file_watch import FileWatch


def write(path, text, at_ns):
    path.write_text(text)
    os.utime(path, ns=(at_ns, at_ns))


def test_a_file_counts_as_changed_when_it_rests(tmp_path):
    file, watch, now = tmp_path / "a.nc", FileWatch(), time.time_ns()
    write(file, "G0", now - 5 * 10**9)
    watch.watch([file], since_ns=now - 10**9)
    assert watch.changed() == [] and watch.changed() == []
    write(file, "", now)  # emptied, and not yet written
    assert watch.changed() == []
    write(file, "G1 X1", now)
    assert watch.changed() == []
    assert watch.changed() == [file]
    assert watch.changed() == []
    file.unlink()
    assert [watch.changed(), watch.changed(), watch.changed()] == [[], [file], []]


def test_a_file_that_changed_while_it_was_read_is_read_again(tmp_path):
    file, watch, now = tmp_path / "a.nc", FileWatch(), time.time_ns()
    write(file, "G0", now - 10**8)
    watch.watch([file], since_ns=now - 10**9)
    assert [watch.changed(), watch.changed(), watch.changed()] == [[], [file], []]


def test_a_time_to_come_is_no_change(tmp_path):
    file, watch, now = tmp_path / "a.nc", FileWatch(), time.time_ns()
    write(file, "G0", now + 10**12)
    watch.watch([file], since_ns=now)
    assert [watch.changed(), watch.changed()] == [[], []]
