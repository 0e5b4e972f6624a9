"""Ctrl-C in a call from a library, where Python passes over exceptions."""

import multiprocessing
import signal
import subprocess
import sys
import time
from multiprocessing import resource_tracker

import pytest

from vmach.base.interrupt import interrupts_are_not_for_children

PROGRAM = """
import ctypes, signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # as a terminal's, whoever started us
{repeat}

@ctypes.CFUNCTYPE(None)
def called_by_a_library():
    raise KeyboardInterrupt

try:
    called_by_a_library()
    for _ in range(200):
        time.sleep(0.01)
    print("went on")
except KeyboardInterrupt:
    print("ended")
"""
REPEAT = "from vmach.base.interrupt import repeat_lost_interrupts\nrepeat_lost_interrupts()"


def said(repeat: str) -> subprocess.CompletedProcess:
    command = [sys.executable, "-P", "-c", PROGRAM.format(repeat=repeat)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60)


def test_an_interrupt_that_python_passed_over_comes_again():
    found = said(REPEAT)
    assert (found.stdout, found.stderr) == ("ended\n", "")


def test_other_exceptions_there_are_reported_as_ever():
    found = said(f"{REPEAT}\nKeyboardInterrupt = ZeroDivisionError")
    assert found.stdout == "went on\n"
    assert "ZeroDivisionError" in found.stderr


WRITER = """
import sys, time
from pathlib import Path
from vmach import __main__, cli
from vmach.files.atomic import atomic_folder

def write():
    with atomic_folder(Path(sys.argv[1])) as folder:
        (folder / "half").write_text("half")
        print("writing", flush=True)
        try:
            time.sleep(60)
        finally:
            time.sleep(0.5)

cli.main = write
__main__.main()
"""


def test_who_is_told_to_end_says_so_and_leaves_nothing(tmp_path):
    command = [sys.executable, "-P", "-c", WRITER, str(tmp_path / "out")]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert run.stdout.readline() == "writing\n"
    run.terminate()
    time.sleep(0.2)
    run.terminate()  # as timeout does, while it clears away
    assert run.communicate(timeout=60)[1] == "vmach: ended by SIGTERM; no file is half-written\n"
    assert run.returncode == 143
    assert not list(tmp_path.iterdir())


def hears(told):
    """What a new process does: say whether Ctrl-C is kept from it."""
    told.send(signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, []))


@pytest.mark.parametrize("is_first", [True, False])
def test_a_process_that_is_not_meant_never_hears_an_interrupt(is_first):
    if is_first:  # with the process that multiprocessing starts for itself
        resource_tracker._resource_tracker._stop()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [])
    spawn = multiprocessing.get_context("spawn")
    mine, its = spawn.Pipe()
    process = spawn.Process(target=hears, args=(its,))
    with interrupts_are_not_for_children():
        process.start()
    assert signal.pthread_sigmask(signal.SIG_BLOCK, []) == before
    assert mine.poll(60) and mine.recv() is True
    process.join()
