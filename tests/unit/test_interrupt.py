"""Ctrl-C in a call from a library, where Python passes over exceptions."""

import subprocess
import sys

PROGRAM = """
import ctypes, sys, time
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
