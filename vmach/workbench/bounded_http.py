"""HTTP over a bounded number of sockets, each with a bounded time to say what it wants."""

from __future__ import annotations

import asyncio

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

__all__ = ["BoundedHttp"]

#: sockets at a time; a page needs about seven, so that many tabs find room
_MOST_SOCKETS = 200
#: time from opening a socket, or from a request's first byte, to its last header
_TO_ASK_S = 10.0
#: how long the content of a request may take
_TO_SEND_S = 60.0


class BoundedHttp(H11Protocol):
    """uvicorn's protocol on `h11`, that closes sockets which ask nothing, or ask too slowly.

    Without it, a thousand sockets that send one byte a minute would keep every other out.
    """

    _deadline: asyncio.TimerHandle | None = None
    _takes_content = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self._give(_TO_ASK_S)
        self._make_room()

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        their = self.conn.their_state
        if their is h11.SEND_BODY and not self._takes_content:
            self._give(_TO_SEND_S)
        elif their not in (h11.SEND_BODY, h11.IDLE):
            self._give(None)
        self._takes_content = their is h11.SEND_BODY

    def on_response_complete(self) -> None:
        super().on_response_complete()
        if not self.transport.is_closing():
            self._give(_TO_ASK_S)

    def connection_lost(self, exc: Exception | None) -> None:
        self._give(None)
        super().connection_lost(exc)

    @property
    def is_idle(self) -> bool:
        """Whether no request of it is being answered."""
        return self.cycle is None or self.cycle.response_complete

    def _give(self, seconds: float | None) -> None:
        """Give the other side so long, or any time that it wants."""
        if self._deadline is not None:
            self._deadline.cancel()
        self._deadline = None if seconds is None else self.loop.call_later(seconds, self._time_out)

    def _time_out(self) -> None:
        if not self.transport.is_closing():
            self.transport.abort()

    def _make_room(self) -> None:
        """Where there are too many, the one that waits longest goes; where none waits, this one."""
        there = [c for c in self.connections if not c.transport.is_closing()]
        if len(there) <= _MOST_SOCKETS:
            return
        waiting = [c for c in there if c is not self and c.is_idle and c._deadline is not None]
        oldest = min(waiting, key=lambda c: c._deadline.when(), default=self)
        oldest.transport.abort()
