"""Start the workbench: a socket on this machine alone, an address with a token, a browser."""

from __future__ import annotations

import socket
import webbrowser
from pathlib import Path

from vmach.base.broken_pipe import live_on_when_the_reader_leaves
from vmach.errors import InputError
from vmach.workbench.opened_folder import OpenedFolder
from vmach.workbench.session import Session

__all__ = ["launch"]

#: connections that wait to be taken
_BACKLOG = 64


def launch(
    job: Path | None, *, port: int = 0, with_browser: bool = True, control: str | None = None
) -> None:
    """Serve until Ctrl-C, or until the page says so.

    Parameters
    ----------
    job : Path or None
        The job to open; without one the page begins with a choice.
    port : int
        0 for any that is free.
    with_browser : bool
        Open the user's browser on it.
    control : str, optional
        The control that the program is written for, in place of the job's.

    Raises
    ------
    InputError
        There is no such job, or the port is taken.
    """
    live_on_when_the_reader_leaves()
    with _listen(port) as listening:  # closed whatever becomes of the job
        session = Session(control)
        if job is None:
            session.open_folder(OpenedFolder(Path.cwd().resolve()))
        else:
            session.open(job)
        # the process that holds the part is at work by now, and the server is loaded beside it
        from vmach.workbench.access import Access
        from vmach.workbench.server import serve

        access = Access.new(listening.getsockname()[1])
        print(f"vmach is open at {access.address}", flush=True)
        print("Ctrl-C ends it", flush=True)
        if with_browser:
            webbrowser.open(access.address)
        try:
            serve(session, access, listening, backlog=_BACKLOG)
        except KeyboardInterrupt:
            print("closed")
        finally:
            session.close()


def _listen(port: int) -> socket.socket:
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind(("127.0.0.1", port))
        found.listen(_BACKLOG)  # so that who has the address waits until the server is there
    except OSError as error:
        found.close()
        raise InputError(
            f"--port {port}: {error.strerror}", accepted="a port that is free, or none at all"
        ) from None
    return found
