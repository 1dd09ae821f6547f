"""The page's server as an application: its routes, and what each requires."""

from __future__ import annotations

import json
import math
from collections.abc import Awaitable, Callable, Mapping
from typing import Any

from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp
from starlette.websockets import WebSocket

from missionkit.page.server.live_socket import serve_live
from missionkit.page.server.origin_check import Addresses, OriginCheck
from missionkit.page.server.page_source import PageError, PageSource
from missionkit.page.server.sessions import Role, Session, Sessions
from missionkit.page.server.static_files import static_files
from missionkit.page.tiles.tile_file import TileFile, facts_of

LONGEST_BODY = 65536  # bytes
MOST_SOCKETS = 32
HOW_TO_ENTER = (
    "open the address that missionkit printed when it started: its token, behind #, lets you in"
)
Answer = Callable[[Request, Session], Awaitable[Response]]


class PageServer:
    """Answers the requests of one page.

    Args:
        source: what the page is of.
        sessions: who may do what.
        tiles: below the map, if there are any.
        cookie: name of the session's cookie.
        secure: the cookie goes over TLS alone.
    """

    def __init__(
        self,
        source: PageSource,
        sessions: Sessions,
        tiles: TileFile | None,
        *,
        cookie: str,
        secure: bool,
    ) -> None:
        self._tiles = tiles
        self._source = source
        self._sessions = sessions
        self._cookie = cookie
        self._secure = secure
        self._files = static_files()
        self._sockets = 0

    def routes(self) -> list[Route | WebSocketRoute]:
        """Return what the server answers."""
        entered, posted = self._entered, self._posted
        return [
            Route("/", self._index),
            Route("/web/{path:path}", self._file),
            Route("/api/session", self._enter, methods=["POST"]),
            Route("/api/mission", entered(self._mission)),
            Route("/api/chart.svg", entered(self._chart)),
            Route("/api/image.jpg", entered(self._image)),
            Route("/api/timeline", entered(self._timeline)),
            Route("/api/series", entered(self._series)),
            Route("/api/track", entered(self._track)),
            Route("/api/why", entered(self._why)),
            Route("/api/tiles/{zoom:int}/{column:int}/{row:int}", entered(self._tile)),
            *(
                Route(f"/api/{what}", entered(posted(what)), methods=["POST"])
                for what in ("action", "pilot", "play", "what-if")
            ),
            WebSocketRoute("/api/live", self._live),
        ]

    def _entered(self, answer: Answer) -> Callable[[Request], Awaitable[Response]]:
        """Return an answer that only a session gets; one that changes something needs its key."""

        async def answered(request: Request) -> Response:
            session = self._session(request)
            if session is None:
                return _refused(PageError(HOW_TO_ENTER, 401))
            if request.method == "POST" and request.headers.get("x-csrf") != session.csrf:
                return _refused(PageError("the request lacks this session's key: reload", 403))
            try:
                return await answer(request, session)
            except PageError as error:
                return _refused(error)

        return answered

    def _session(self, request: HTTPConnection) -> Session | None:
        return self._sessions.of(request.cookies, self._cookie)

    async def _index(self, request: Request) -> Response:
        return self._sent("index.html", request)

    async def _file(self, request: Request) -> Response:
        return self._sent(request.path_params["path"], request)

    def _sent(self, name: str, request: Request) -> Response:
        file = self._files.get(name)
        if file is None:
            return _refused(PageError("there is no such file", 404))
        headers = {"etag": file.tag, "cache-control": "no-cache", "vary": "accept-encoding"}
        if request.headers.get("if-none-match") == file.tag:
            return Response(status_code=304, headers=headers)
        if "gzip" in request.headers.get("accept-encoding", ""):
            headers["content-encoding"] = "gzip"
            return Response(file.packed, media_type=file.kind, headers=headers)
        return Response(file.data, media_type=file.kind, headers=headers)

    async def _enter(self, request: Request) -> Response:
        try:
            body = await _body(request)
        except PageError as error:
            return _refused(error)
        address = "" if request.client is None else request.client.host
        known = self._session(request) if body.get("token") is None else None
        session = known or self._sessions.enter(body.get("token"), address)
        if session is None:
            return _refused(PageError(HOW_TO_ENTER, 401))
        said = {"role": session.role.value, "csrf": session.csrf, "name": session.name}
        answer = JSONResponse(said)
        answer.set_cookie(
            self._cookie,
            session.key,
            path="/",
            secure=self._secure,
            httponly=True,
            samesite="strict",
        )
        return answer

    async def _mission(self, _: Request, __: Session) -> Response:
        return JSONResponse({**self._source.facts().mission, "tiles": facts_of(self._tiles)})

    async def _chart(self, _: Request, __: Session) -> Response:
        return Response(self._source.facts().chart, media_type="image/svg+xml")

    async def _image(self, request: Request, _: Session) -> Response:
        number = _number(request.query_params.get("n"), "n")
        jpeg = self._source.image(int(number))
        if jpeg is None:
            raise PageError("there is no image", 404)
        return Response(jpeg, media_type="image/jpeg")

    async def _timeline(self, _: Request, __: Session) -> Response:
        return JSONResponse(self._source.timeline())

    async def _series(self, request: Request, _: Session) -> Response:
        since = _number(request.query_params.get("since", "0"), "since")
        guard = request.query_params.get("guard", "")
        return JSONResponse(self._source.series(guard, since))

    async def _track(self, _: Request, __: Session) -> Response:
        return JSONResponse(self._source.track())

    async def _tile(self, request: Request, _: Session) -> Response:
        zoom, column, row = (request.path_params[key] for key in ("zoom", "column", "row"))
        tiles = self._tiles
        fits = tiles is not None and tiles.min_zoom <= zoom <= tiles.max_zoom
        inside = fits and max(column, row) < 1 << zoom
        image = tiles.tile(zoom, column, row) if tiles is not None and inside else None
        if tiles is None or image is None:
            raise PageError("there is no such tile", 404)
        return Response(image, media_type=f"image/{tiles.format.replace('jpg', 'jpeg')}")

    async def _why(self, request: Request, _: Session) -> Response:
        given = request.query_params
        at = _number(given["at"], "at") if given.get("at") else None
        return JSONResponse(await self._source.why(given.get("transition", ""), at))

    def _posted(self, what: str) -> Answer:
        async def answer(request: Request, session: Session) -> Response:
            body = await _body(request)
            if session.role is not Role.PILOT and what != "what-if":
                raise PageError("you are a viewer: only who has the pilot's token may do that", 403)
            said = await self._source.posted(what, body, session)
            return JSONResponse(said, 202 if what == "action" else 200)

        return answer

    async def _live(self, socket: WebSocket) -> None:
        session = self._session(socket)
        if session is None or self._sockets >= MOST_SOCKETS:
            await socket.close(1008)
            return
        self._sockets += 1
        try:
            await socket.accept()
            await serve_live(socket, self._source.feed(session))
        finally:
            self._sockets -= 1


def application(
    source: PageSource,
    sessions: Sessions,
    addresses: Addresses,
    cookie: str,
    tiles: TileFile | None = None,
) -> ASGIApp:
    """Return the server as an ASGI application.

    Args:
        source: what the page is of.
        sessions: who may do what.
        addresses: under which it is served.
        cookie: name of the session's cookie.
        tiles: below the map, if there are any.
    """
    server = PageServer(source, sessions, tiles, cookie=cookie, secure=addresses.scheme == "https")
    return OriginCheck(Starlette(routes=server.routes()), addresses)


def _refused(error: PageError) -> Response:
    return JSONResponse({"error": str(error)}, error.status)


def _number(text: str | None, name: str) -> float:
    try:
        value = float(text or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise PageError(f"{name} must be a number")
    return value


async def _body(request: Request) -> Mapping[str, Any]:
    data = b""
    async for part in request.stream():
        data += part
        if len(data) > LONGEST_BODY:
            raise PageError("the request is too long", 413)
    try:
        body = json.loads(data or b"{}")
    except (ValueError, RecursionError):
        body = None
    if not isinstance(body, dict):
        raise PageError("the request must be a JSON object")
    return body
