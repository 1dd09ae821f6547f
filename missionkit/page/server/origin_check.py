"""The outermost layer of the server: whose requests are let in, and what every answer says.

A page of another site cannot read or send anything: a request must name this server as its host
(which defeats names that are made to point here), one that changes something, and every WebSocket,
must come from a page of this server.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from missionkit.page.server.binding import is_loopback

POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; frame-ancestors 'none'; base-uri 'none'; "
    "form-action 'none'; object-src 'none'"
)
HEADERS = (
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
)
SAFE_METHODS = frozenset(("GET", "HEAD"))


class Addresses(NamedTuple):
    """The addresses under which the page is served."""

    scheme: str  # http or https
    hosts: frozenset[str]  # as browsers name them: "127.0.0.1:8123"

    @classmethod
    def of(cls, host: str, port: int, *, secure: bool) -> Addresses:
        """Return those of a server.

        Args:
            host: name or address that it is bound to.
            port: that it is bound to.
            secure: over TLS.
        """
        shown = f"[{host}]" if ":" in host else host
        loopback = ("127.0.0.1", "localhost", "[::1]") if is_loopback(host) else ()
        names = {shown.lower(), *loopback}
        scheme, usual = ("https", 443) if secure else ("http", 80)
        hosts = {f"{name}:{port}" for name in names} | (names if port == usual else set())
        return cls(scheme, frozenset(hosts))

    @property
    def origins(self) -> frozenset[str]:
        """The origins of its pages."""
        return frozenset(f"{self.scheme}://{host}" for host in self.hosts)


class OriginCheck:
    """Lets through what may come in; the rest is answered here and reaches nothing."""

    def __init__(self, app: ASGIApp, addresses: Addresses) -> None:
        self._app = app
        self._addresses = addresses

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] not in {"http", "websocket"}:
            await self._app(scope, receive, send)
            return
        refused = self._refused(scope)
        if not refused:
            await self._app(scope, receive, _with_headers(scope, send))
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008, "reason": "refused"})
        else:
            answer = JSONResponse({"error": refused}, 403)
            await answer(scope, receive, _with_headers(scope, send))

    def _refused(self, scope: Scope) -> str:
        """Say why a request is not let in; "" if it is."""
        headers = _single(scope)
        if headers.get(b"host", "").lower() not in self._addresses.hosts:
            known = " or ".join(sorted(self._addresses.hosts))
            return f"this page is served as {known} only: open that address"
        if scope["type"] == "http" and scope["method"] in SAFE_METHODS:
            return ""
        if headers.get(b"origin", "").lower() not in self._addresses.origins:
            return "only a page of this server may do that: the request comes from elsewhere"
        return ""


def _single(scope: Scope) -> Mapping[bytes, str]:
    """Return the headers; one that comes twice with different values fits nothing."""
    found: dict[bytes, str] = {}
    for name, value in scope["headers"]:
        text = value.decode("latin-1")
        found[name] = text if found.get(name, text) == text else "\0"
    return found


def _with_headers(scope: Scope, send: Send) -> Send:
    uncached = ((b"cache-control", b"no-store"),) if scope["path"].startswith("/api") else ()

    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            message["headers"] = [*message.get("headers", ()), *HEADERS, *uncached]
        await send(message)

    return sending
