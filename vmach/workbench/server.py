"""The server of the workbench: routes, what goes wrong, and who is let in."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import Response

from vmach.errors import VmachError
from vmach.workbench.access import Access, Guard
from vmach.workbench.exchange import refused
from vmach.workbench.model.remote import ModelStopped
from vmach.workbench.routes import files, pages, part, report, state, work
from vmach.workbench.session import Session

__all__ = ["build_server"]


def build_server(
    session: Session, access: Access, *, shut_down: Callable[[], object] = lambda: None
) -> Starlette:
    """The application; `shut_down` ends the server that it runs in."""

    @contextlib.asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        watch = asyncio.create_task(session.keep_watch())
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
