"""``vmach`` and ``python -m vmach``: the way in, and out of it whatever happens."""

from __future__ import annotations

import os
import signal
import sys
import traceback
from pathlib import Path

__all__ = ["main"]


def main() -> None:
    """Run the command line; Ctrl-C, SIGTERM and faults of the program end it with one line.

    Exit status 130 after Ctrl-C, 143 after SIGTERM, 70 after a fault of the program itself; with
    ``VMACH_TRACEBACK=1`` in the environment such a fault shows where it comes from.
    """
    try:
        _run()
    except KeyboardInterrupt:
        _interrupted()
    except SystemExit as stop:
        if stop.code == 130:  # typer has seen the signal
            _interrupted()
        raise
    except BrokenPipeError:
        from vmach.base.broken_pipe import end_by_broken_pipe

        end_by_broken_pipe()
    except MemoryError as error:
        _end(1, f"not enough memory: {error}")
    except Exception as error:
        if isinstance(error.__cause__, KeyboardInterrupt):  # the signal came in compiled code
            _interrupted()
        if os.environ.get("VMACH_TRACEBACK"):
            raise
        _end_if_a_cache_is_damaged(error)
        place = traceback.extract_tb(error.__traceback__)[-1]
        what = f"{type(error).__name__}: {' '.join(str(error).split())}"
        _end(
            70,
            f"a fault of the program itself: {what} "
            f"({Path(place.filename).name}:{place.lineno}; VMACH_TRACEBACK=1 shows more)",
        )


def _run() -> None:
    # loaded here, so that Ctrl-C meanwhile is caught too
    from vmach.base.broken_pipe import end_when_the_reader_leaves
    from vmach.base.interrupt import interrupt_on_termination, repeat_lost_interrupts
    from vmach.base.memory import keep_small_arrays
    from vmach.base.terminal import protect_terminal

    if sys.stdout is sys.__stdout__:  # not called by a program
        end_when_the_reader_leaves()
        repeat_lost_interrupts()
        interrupt_on_termination()
    protect_terminal()
    keep_small_arrays()
    from vmach.cli import main as command_line

    command_line()


def _end_if_a_cache_is_damaged(error: Exception) -> None:
    from vmach.base.damaged_cache import drop_damaged

    dropped = drop_damaged(error)
    if dropped:
        what = "was cut short or damaged, and is deleted; start the command again"
        _end(1, f"{dropped[0]}: a file that is kept to start faster {what}")


def _interrupted() -> None:
    from vmach.base.interrupt import was_terminated

    if was_terminated():
        _end(128 + signal.SIGTERM, "ended by SIGTERM; no file is half-written")
    _end(128 + signal.SIGINT, "interrupted; no file is half-written")


def _end(status: int, text: str) -> None:
    print(f"vmach: {text}", file=sys.stderr)
    sys.exit(status)


if __name__ == "__main__":
    main()
