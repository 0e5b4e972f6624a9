"""``vmach`` and ``python -m vmach``: the way in, ready for Ctrl-C before anything is loaded."""

from __future__ import annotations

import sys

__all__ = ["main"]


def main() -> None:
    """Run the command line; Ctrl-C ends it with one line and exit status 130."""
    try:
        from vmach.cli import main as command_line

        command_line()
    except KeyboardInterrupt:
        _say_interrupted()
    except SystemError as error:  # a signal inside compiled code
        if not isinstance(error.__cause__, KeyboardInterrupt):
            raise
        _say_interrupted()
    except SystemExit as stop:
        if stop.code == 130:  # typer has seen the signal
            _say_interrupted()
        raise


def _say_interrupted() -> None:
    print("vmach: interrupted; no file is half-written", file=sys.stderr)
    sys.exit(130)


if __name__ == "__main__":
    main()
