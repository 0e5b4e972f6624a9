"""The server of the workbench: routes, what goes wrong, and who is let in."""

from __future__ import annotations

import asyncio
import contextlib
import socket
from collections.abc import AsyncIterator, Callable

import uvicorn
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import Response

from vmach.errors import VmachError
from vmach.workbench.access import Access, Guard
from vmach.workbench.bounded_http import BoundedHttp
from vmach.workbench.exchange import refused
from vmach.workbench.model.remote import ModelStopped
from vmach.workbench.routes import diagnosis, files, pages, part, report, state, work
from vmach.workbench.session import Session

__all__ = ["build_server", "serve"]

#: time that open requests have to end when the server does
_TO_END_S = 2


def serve(session: Session, access: Access, listening: socket.socket, *, backlog: int) -> None:
    """Answer on a socket that listens already, until Ctrl-C or until the page ends it."""
    server = _Server(uvicorn.Config(
        app=build_server(session, access, shut_down=lambda: server.end()),
        http=BoundedHttp, ws="none", loop="asyncio", log_level="error", access_log=False,
        server_header=False, date_header=False, timeout_graceful_shutdown=_TO_END_S,
        backlog=backlog,
    ))  # fmt: skip
    server.session = session
    server.run(sockets=[listening])


class _Server(uvicorn.Server):
    """Ends what tabs and questions wait for before it waits for its connections to end."""

    session: Session

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        self.session.close()
        await super().shutdown(sockets)

    def end(self) -> None:
        """End it soon, as Ctrl-C does."""
        self.should_exit = True


def build_server(
    session: Session, access: Access, *, shut_down: Callable[[], object] = lambda: None
) -> Starlette:
    """The application; `shut_down` ends the server that it runs in."""

    @contextlib.asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        watch = asyncio.create_task(session.keep_watch(lambda: diagnosis.evaluate_again(session)))
        if session.job is not None:
            first = asyncio.create_task(session.watch_files())
            first.add_done_callback(lambda task: None)
        yield
        watch.cancel()
        session.close()

    app = Starlette(
        routes=[
            *pages.routes,
            *state.routes,
            *part.routes,
            *diagnosis.routes,
            *work.routes,
            *report.routes,
            *files.routes,
        ],
        middleware=[Middleware(Guard, access=access)],
        exception_handlers={
            VmachError: _refuse,
            ModelStopped: _stopped,
            OSError: _system,
            404: _unknown,
            405: _unknown,
            Exception: _fault,
        },
        lifespan=lifespan,
    )
    app.state.session, app.state.shut_down = session, shut_down
    return app


async def _refuse(request: Request, error: Exception) -> Response:
    return refused(str(error))


async def _stopped(request: Request, error: Exception) -> Response:
    return refused(f"{error} (hint: read the job again)", 503)


async def _system(request: Request, error: Exception) -> Response:
    name, why = getattr(error, "filename", None), getattr(error, "strerror", None)
    return refused(f"{name}: {why}" if name else str(error))


async def _fault(request: Request, error: Exception) -> Response:
    what = f"{type(error).__name__}: {' '.join(str(error).split())}"
    return refused(f"a fault of the program itself: {what}", 500)


async def _unknown(request: Request, error: Exception) -> Response:
    return refused("there is no such address", 404)
