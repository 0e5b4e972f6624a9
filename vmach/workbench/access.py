"""Who may ask: this page alone, from this machine, with the token of this start."""

from __future__ import annotations

import secrets
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from urllib.parse import parse_qs

from starlette.datastructures import Headers
from starlette.responses import JSONResponse, RedirectResponse
from starlette.types import ASGIApp, Receive, Scope, Send

__all__ = ["Access", "Guard"]

#: what every answer forbids the browser: nothing from elsewhere, nothing in a frame of others
_HEADERS = [
    (b"content-security-policy",
     b"default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
     b"connect-src 'self'; frame-src 'self'; form-action 'none'; base-uri 'none'; "
     b"frame-ancestors 'self'"),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
]  # fmt: skip
_SAFE_METHODS = ("GET", "HEAD")


@dataclass(frozen=True)
class Access:
    """Where the server listens, and the token that a request has to bring.

    Attributes
    ----------
    port : int
    token : str
    """

    port: int
    token: str

    @classmethod
    def new(cls, port: int) -> Access:
        """With a token of 256 random bits."""
        return cls(port, secrets.token_urlsafe(32))

    @property
    def address(self) -> str:
        """What the user opens; the token is then kept in a cookie and leaves the address."""
        return f"http://127.0.0.1:{self.port}/?token={self.token}"

    @property
    def cookie(self) -> str:
        """Name of the cookie; browsers do not keep those of two ports apart."""
        return f"vmach_{self.port}"

    @property
    def hosts(self) -> tuple[str, ...]:
        """What the Host header may say; anything else is another site's name for this machine."""
        return f"127.0.0.1:{self.port}", f"localhost:{self.port}"

    def refusal(self, method: str, headers: Headers, cookies: dict[str, str]) -> str | None:
        """Why a request is refused, or None."""
        if headers.get("host") not in self.hosts:
            return "this server answers to 127.0.0.1 and localhost only"
        origin = headers.get("origin")
        if origin is not None and origin not in [f"http://{host}" for host in self.hosts]:
            return "another site asks"
        if headers.get("sec-fetch-site", "none") not in ("none", "same-origin"):
            return "another site asks"
        brought = headers.get("x-vmach-token") or cookies.get(self.cookie, "")
        if not self._is_token(brought):
            return "the token is missing: open the address that vmach open printed"
        if method not in _SAFE_METHODS and headers.get("x-vmach") != "1":
            return "the request does not come from the page"
        return None

    def _is_token(self, brought: str) -> bool:
        return secrets.compare_digest(brought.encode(), self.token.encode())

    def opens(self, method: str, path: str, query: bytes, headers: Headers) -> bool:
        """Whether this is the address that the user was given."""
        if method != "GET" or path != "/" or headers.get("host") not in self.hosts:
            return False
        try:
            brought = parse_qs(query.decode("ascii"), max_num_fields=8).get("token", [""])[0]
        except ValueError:
            return False
        return self._is_token(brought)


class Guard:
    """Lets in what `Access` lets in, and adds the headers of every answer."""

    def __init__(self, app: ASGIApp, access: Access) -> None:
        self._app, self._access = app, access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        headers, method, path = Headers(scope=scope), scope["method"], scope["path"]
        guarded = _with_headers(send)
        if self._access.opens(method, path, scope["query_string"], headers):
            answer = RedirectResponse("/", status_code=303)
            answer.set_cookie(self._access.cookie, self._access.token, httponly=True,
                              samesite="strict")  # fmt: skip
            await answer(scope, receive, guarded)
            return
        refusal = self._access.refusal(method, headers, _cookies(headers))
        if refusal is not None:
            await JSONResponse({"error": refusal}, status_code=403)(scope, receive, guarded)
            return
        await self._app(scope, receive, guarded)


def _cookies(headers: Headers) -> dict[str, str]:
    pairs = (part.partition("=") for part in headers.get("cookie", "").split(";"))
    return {name.strip(): value.strip() for name, _, value in pairs}


def _with_headers(send: Send) -> Callable[[dict], Awaitable[None]]:
    async def guarded(message: dict) -> None:
        if message["type"] == "http.response.start":
            own = {name.lower() for name, _ in message.get("headers", [])}
            more = [pair for pair in _HEADERS if pair[0] not in own]
            message = {**message, "headers": [*message.get("headers", []), *more]}
        await send(message)

    return guarded
