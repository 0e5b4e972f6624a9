"""Start the workbench: a socket on this machine alone, an address with a token, a browser."""

from __future__ import annotations

import socket
import webbrowser
from pathlib import Path

import uvicorn

from vmach.base.broken_pipe import live_on_when_the_reader_leaves
from vmach.errors import InputError
from vmach.workbench.access import Access
from vmach.workbench.bounded_http import BoundedHttp
from vmach.workbench.opened_folder import OpenedFolder
from vmach.workbench.server import build_server
from vmach.workbench.session import Session

__all__ = ["launch"]

#: time that open requests have to end when the server does
_TO_END_S = 2
#: connections that wait to be taken
_BACKLOG = 64


def launch(
    job: Path | None, *, port: int = 0, with_browser: bool = True, control: str | None = None
) -> None:
    """Serve until Ctrl-C, or until the page says so.

    Parameters
    ----------
    job : Path, optional
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
    session = Session(control)
    if job is None:
        session.open_folder(OpenedFolder(Path.cwd().resolve()))
    else:
        session.open(job)
    listening = _listen(port)
    access = Access.new(listening.getsockname()[1])
    server = _Server(uvicorn.Config(
        app=build_server(session, access, shut_down=lambda: _end(server)),
        http=BoundedHttp, ws="none", loop="asyncio", log_level="error", access_log=False,
        server_header=False, date_header=False, timeout_graceful_shutdown=_TO_END_S,
        backlog=_BACKLOG,
    ))  # fmt: skip
    server.session = session
    print(f"vmach is open at {access.address}", flush=True)
    print("Ctrl-C ends it", flush=True)
    if with_browser:
        webbrowser.open(access.address)
    try:
        server.run(sockets=[listening])
    except KeyboardInterrupt:
        print("closed")
    finally:
        session.close()


class _Server(uvicorn.Server):
    """Sends the tabs that listen away before it waits for its connections to end."""

    session: Session

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        self.session.events.close()
        await super().shutdown(sockets)


def _listen(port: int) -> socket.socket:
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind(("127.0.0.1", port))
        found.listen(_BACKLOG)  # so that who has the address waits until the server is there
    except OSError as error:
        raise InputError(
            f"--port {port}: {error.strerror}", accepted="a port that is free, or none at all"
        ) from None
    return found


def _end(server: uvicorn.Server) -> None:
    server.should_exit = True
