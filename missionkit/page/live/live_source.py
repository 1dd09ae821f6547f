"""The page of a flight in progress, in the server's process."""

from __future__ import annotations

import asyncio
import math
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any

from typing_extensions import override

from missionkit.engine.clock import date, stopwatch
from missionkit.page.facts.flown_track import FlownTrack
from missionkit.page.facts.guard_series import SHOWN, GuardSeries
from missionkit.page.facts.plain_values import given_number, text_of
from missionkit.page.facts.timeline import Timeline
from missionkit.page.live.message_link import MessageLink
from missionkit.page.live.pilot_seat import PilotSeat
from missionkit.page.server.board import Board
from missionkit.page.server.page_source import Feed, PageError, PageSource, StaticFacts
from missionkit.page.server.sessions import Session
from missionkit.page.server.why_desk import WhyDesk

OLDEST_PRESS, OLDEST_SEEN, AHEAD = 1.0, 2.0, 0.5  # s
SHORTEST_HOLD, SHORTEST_DANGEROUS = 500.0, 1500.0  # ms
IMAGES_KEPT = 5
SEEN_KEPT = 200  # messages whose age is known
LONGEST_ID = 64
TAKEN_WITHIN = 1.5  # s in which the flight answers
PILOT_PERIOD = 0.5  # s between two looks at who pilots

LOST = {"outcome": "lost", "reason": "the process of the flight has gone"}


class LiveSource(PageSource):
    """Answers the requests of the page of a flight.

    Args:
        static: mission and chart.
        link: to the flight.
        why: says why transitions were taken or not.
        ended: is called once the flight has gone.
    """

    def __init__(
        self, static: StaticFacts, link: MessageLink, why: WhyDesk, ended: Callable[[], None]
    ) -> None:
        self._why = why
        self._static, self._link, self._ended = static, link, ended
        self._timeline, self._track, self._series = Timeline(), FlownTrack(), GuardSeries(SHOWN)
        self._images: dict[int, bytes] = {}
        self._board = Board()
        self._seen: deque[tuple[int, float]] = deque(maxlen=SEEN_KEPT)  # number, s
        self._told_at = -math.inf  # s, of the wall: when the flight was last heard of
        self._offered: list[Mapping[str, Any]] = []
        self._sent: dict[str, tuple[float, dict[str, Any]]] = {}
        self._ids: set[str] = set()
        self.seat = PilotSeat(stopwatch, self._announce)

    # what the flight says

    def attach(self, loop: asyncio.AbstractEventLoop) -> None:
        """Listen to the flight from now on."""
        loop.add_reader(self._link.end.fileno(), self._receive, loop)

    def _receive(self, loop: asyncio.AbstractEventLoop) -> None:
        latest: dict[str, Any] = {}
        for message in self._link.received():
            if isinstance(message, tuple):
                self._keep_image(*message)
            else:
                facts = message["facts"]
                for key in ("fired", "problems"):
                    facts[key] = latest.get(key, []) + facts.get(key, [])
                latest |= facts
        if latest:
            self._take(latest)
        if self._link.broken:
            loop.remove_reader(self._link.end.fileno())
            if self._board.values.get("ended", "null") == "null":
                self._board.post({"ended": LOST, "offered": []})
            self._offered = []
            self._ended()

    def _keep_image(self, number: int, jpeg: bytes) -> None:
        self._images[number] = jpeg
        self._images.pop(number - IMAGES_KEPT, None)

    def _take(self, facts: dict[str, Any]) -> None:
        if "now" in facts:
            now, self._told_at = facts["now"], stopwatch()
            self._timeline.stands(now, facts["state"])
            self._timeline.required(now, facts["requirements"])
            self._series.add(now, facts["guards"])
            if facts["position"] is not None:
                self._track.add(now, facts["position"])
        self._timeline.happened(facts["fired"], facts["problems"])
        self._offered = facts.get("offered", self._offered)
        if "actions" in facts:
            facts["actions"] = self._merged(facts["actions"])
        self._post({"playback": None, "play": None, **facts})

    def _post(self, facts: Mapping[str, object]) -> None:
        """Show browsers what is new, and note when: an action says what it was taken in view of."""
        self._board.post(facts)
        self._seen.append((self._board.sequence, self._told_at))

    def _merged(self, taken: list[dict[str, Any]]) -> list[dict[str, Any]]:
        """Return the last actions, those too that the flight has not answered yet."""
        for it in taken:
            self._sent.pop(it["id"], None)
        now, waiting = stopwatch(), []
        for at, it in self._sent.values():
            if now - at > TAKEN_WITHIN:
                it = {**it, "stage": "expired", "says": "the flight did not answer"}  # noqa: PLW2901
            waiting.append(it)
        return [*taken, *waiting][-5:]

    # what browsers ask

    @override
    def facts(self) -> StaticFacts:
        return self._static

    @override
    def timeline(self) -> Mapping[str, object]:
        return self._timeline.as_value()

    @override
    def series(self, guard: str, since: float) -> Mapping[str, object]:
        return self._series.since(guard, since)

    @override
    def track(self) -> Mapping[str, object]:
        return self._track.as_value()

    @override
    def image(self, number: int) -> bytes | None:
        return self._images.get(number)

    @override
    async def why(self, transition: str, at: float | None) -> Mapping[str, object]:
        return await self._why.answer(self._static.mission, self.timeline(), transition, at)

    @override
    def feed(self, session: Session) -> Feed:
        self.seat.arrived(session)
        return LiveFeed(self._board, self.seat, session, self._alive)

    def _alive(self, session: Session) -> None:
        if self.seat.alive(session):
            self._link.send({"kind": "alive"})

    @override
    async def posted(
        self, what: str, body: Mapping[str, Any], session: Session
    ) -> Mapping[str, object]:
        if what == "pilot":
            self.seat.change(body.get("do"), session)
            return self.seat.as_value(session)
        if what == "action":
            return self._act(body, session)
        raise PageError(f"a flight knows no {what}", 409)

    def _announce(self, what: str, session: Session) -> None:
        self._link.send(
            {"kind": "pilot", "what": what, "who": session.name, "address": session.address}
        )
        self._post({})

    def _act(self, body: Mapping[str, Any], session: Session) -> Mapping[str, object]:
        if session is not self.seat.pilot:
            pilot = self.seat.pilot
            whose = "nobody has" if pilot is None else f"{pilot.name} has"
            raise PageError(f"{whose} the controls: ask for them first", 403)
        action = {key: body.get(key) for key in ("id", "action", "event")}
        self._check_id(action["id"])
        offer = self._offer(action)
        age = self._age(body)
        self._check_age(body, action, age)
        self._check_hold(body, offer)
        self._ids.add(str(action["id"]))
        message = {
            **action,
            "kind": "action",
            "who": session.name,
            "address": session.address,
            "age": max(0.0, age),
            "received": stopwatch(),
        }
        if not self._link.send(message):
            raise PageError("the flight cannot be reached", 503)
        shown = {**action, "who": session.name, "stage": "sent", "tick": None, "says": ""}
        self._sent[str(action["id"])] = (stopwatch(), shown)
        return {"id": action["id"]}

    def _check_id(self, given: object) -> None:
        if not isinstance(given, str) or not 0 < len(given) <= LONGEST_ID:
            raise PageError("id: a short text that is new with each action")
        if given in self._ids:
            raise PageError("this was sent before: press again", 409)

    def _offer(self, action: Mapping[str, Any]) -> Mapping[str, Any]:
        for it in self._offered:
            if it["action"] == action["action"] and it.get("event") == action["event"]:
                return it
        what = " ".join(str(it) for it in (action["action"], action["event"]) if it)
        raise PageError(f"{what or 'that'} is not possible now", 409)

    def _age(self, body: Mapping[str, Any]) -> float:
        pressed = given_number(body.get("at_ms"))
        if pressed is None:
            raise PageError("at_ms: the time of the release by the server's clock, ms")
        return date() - pressed / 1000.0

    def _check_age(self, body: Mapping[str, Any], action: Mapping[str, Any], age: float) -> None:
        if age < -AHEAD:
            raise PageError("the browser's clock is ahead of the server's: reload the page", 409)
        if age > OLDEST_PRESS:
            late = f"it arrived {age:.1f} s after the press, later than {OLDEST_PRESS:g} s"
            raise PageError(f"{late}: press again", 409)
        if action["action"] == "hold":
            return
        seen = [at for number, at in self._seen if number == body.get("seen")]
        if not seen or stopwatch() - seen[-1] > OLDEST_SEEN:
            raise PageError(
                f"what you saw is older than {OLDEST_SEEN:g} s: only hold is taken until the page "
                "is up to date",
                409,
            )

    def _check_hold(self, body: Mapping[str, Any], offer: Mapping[str, Any]) -> None:
        least = SHORTEST_DANGEROUS if offer.get("dangerous") else SHORTEST_HOLD
        held = given_number(body.get("held_ms"))
        if held is None or held < least:
            raise PageError(f"hold the button for {least / 1000:g} s to confirm", 409)


class LiveFeed:
    """What one browser is shown of a flight.

    Args:
        board: with the latest.
        seat: who pilots.
        session: of the browser.
        alive: takes a sign of life.
    """

    def __init__(
        self, board: Board, seat: PilotSeat, session: Session, alive: Callable[[Session], None]
    ) -> None:
        self._reader = board.reader()
        self._seat, self._session, self._alive = seat, session, alive

    async def changed(self) -> None:
        """Return once there is something new."""
        await self._reader.changed()

    def read(self) -> tuple[int, dict[str, str]]:
        """Return the number of the latest, and its values as JSON text by key."""
        number, values = self._reader.read()
        return number, {**values, "pilot": text_of(self._seat.as_value(self._session))}

    def heard(self, message: Mapping[str, Any]) -> None:
        """Take a message of the browser."""
        if message.get("t") == "alive":
            self._alive(self._session)

    def close(self) -> None:
        """The browser has gone."""
        self._reader.close()
