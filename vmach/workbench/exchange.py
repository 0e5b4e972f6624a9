"""How the page and the server speak: bounded JSON in, JSON or framed arrays out."""

from __future__ import annotations

import json
from typing import Any

from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response

from vmach.errors import InputError
from vmach.workbench.session import Session

__all__ = ["framed", "number_of", "read_content", "read_json", "session_of"]

#: bytes of JSON that the page may send
_MOST_JSON = 1_000_000


def session_of(request: Request) -> Session:
    """What is open."""
    return request.app.state.session


async def read_content(request: Request, most: int) -> bytes:
    """What a request brings, read no further than allowed.

    Raises
    ------
    InputError
    """
    stated = request.headers.get("content-length", "")
    if stated and (not stated.isdecimal() or int(stated) > most):
        raise InputError(f"{stated[:20]} bytes", accepted=f"up to {most}")
    chunks, size = [], 0
    try:
        async for chunk in request.stream():
            size += len(chunk)
            if size > most:
                raise InputError(f"more than {most} bytes", accepted=f"up to {most}")
            chunks.append(chunk)
    except ClientDisconnect:
        raise InputError("the page went away before it had sent everything") from None
    return b"".join(chunks)


async def read_json(request: Request, most: int = _MOST_JSON) -> dict[str, Any]:
    """The JSON object that a request brings, of at most so many bytes.

    Raises
    ------
    InputError
    """
    content = await read_content(request, most)
    try:
        found = json.loads(content or b"{}", parse_constant=_refuse_constant)
    except (ValueError, RecursionError):
        raise InputError("the request is not JSON", accepted="an object of JSON") from None
    if not isinstance(found, dict):
        raise InputError("the request is not an object of JSON")
    return found


def _refuse_constant(word: str) -> float:
    raise ValueError(word)


def number_of(text: str | None, name: str, *, default: int, most: int) -> int:
    """A whole number from the address.

    Raises
    ------
    InputError
    """
    if text is None:
        return default
    if not text.isdecimal() or not 0 < int(text[:12]) <= most:
        raise InputError(f"{name} = {text[:20]!r}", accepted=f"1 .. {most}")
    return int(text)


def framed(record: dict[str, Any], content: bytes) -> Response:
    """A record and an array: the length of the record, the record in JSON, and the array.

    The length is uint32, little-endian. The record is filled up with blanks, so that the array
    begins at a multiple of four bytes.
    """
    text = json.dumps(record, allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    head = len(text).to_bytes(4, "little")
    return Response(head + text + content, media_type="application/octet-stream")


def refused(message: str, status: int = 400) -> JSONResponse:
    """What went wrong, in the words of the command line."""
    return JSONResponse({"error": message}, status_code=status)
