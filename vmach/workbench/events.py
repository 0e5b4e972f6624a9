"""What happens, told to every tab that listens, as server-sent events."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Callable
from typing import Any

__all__ = ["Events"]

#: tabs that may listen, and events that one may lag behind before it has to ask anew
_MOST_LISTENERS, _BACKLOG = 32, 100
#: a comment so often keeps the connection, and shows when it is gone
_BEAT_S = 15.0


class Events:
    """Listeners and what they are told."""

    def __init__(self) -> None:
        self._queues: set[asyncio.Queue[str | None]] = set()
        self._is_closed = False

    @property
    def is_full(self) -> bool:
        """Whether no further tab may listen."""
        return len(self._queues) >= _MOST_LISTENERS

    def tell(self, kind: str, /, **what: Any) -> None:
        """Tell every tab; one that lags too far behind is dropped, and asks anew."""
        text = f"event: {kind}\ndata: {json.dumps(what)}\n\n"
        for queue in list(self._queues):
            if queue.qsize() >= _BACKLOG:
                self._queues.discard(queue)
                queue.put_nowait(None)
            else:
                queue.put_nowait(text)

    def close(self) -> None:
        """Send everybody away."""
        self._is_closed = True
        for queue in list(self._queues):
            queue.put_nowait(None)

    async def listen(self, state: Callable[[], dict[str, Any]]) -> AsyncIterator[str]:
        """The state as it is, and events from now on, until the server or the tab goes."""
        queue: asyncio.Queue[str | None] = asyncio.Queue()
        self._queues.add(queue)
        hello = json.dumps(state())  # at this moment: what is told later changes it
        try:
            yield f"retry: 1000\nevent: hello\ndata: {hello}\n\n"
            while not self._is_closed:
                try:
                    text = await asyncio.wait_for(queue.get(), _BEAT_S)
                except TimeoutError:
                    text = ": beat\n\n"
                if text is None:
                    return
                yield text
        finally:
            self._queues.discard(queue)
