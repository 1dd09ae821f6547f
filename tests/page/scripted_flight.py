"""A flight whose every tick a test writes, served as a page: what the browser sends is kept."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any

from missionkit.engine.clock import date
from missionkit.page.server.board import Board, BoardReader
from missionkit.page.server.page_source import PageError, StaticFacts
from missionkit.page.server.sessions import Session

STATES = ("climb", "cruise", "look", "home")
NEARBY = [{"name": "trunk", "at": [12.0, 3.0, -2.0], "sd": 0.4, "seen_ago": 0.2}]


def box(name: str, x: float, y: float) -> str:
    return (
        f'<g data-state="{name}"><rect class="box" x="{x}" y="{y}" width="110" height="44" rx="9"'
        f' fill="#d9e8f6"/><text class="name" x="{x + 55}" y="{y + 20}" text-anchor="middle">'
        f"{name}</text></g>"
    )


def arrow(number: int, y: float) -> str:
    return (
        f'<g data-transition="t{number}"><path class="arrow" d="M80 {y + 44}L80 {y + 90}"'
        f' fill="none"/></g><g data-transition="t{number}"><text class="small" x="120"'
        f' y="{y + 70}">when sure</text></g>'
    )


def chart(names: tuple[str, ...]) -> str:
    boxes = "".join(box(name, 25, 20 + 90 * at) for at, name in enumerate(names))
    arrows = "".join(arrow(at + 1, 20 + 90 * at) for at in range(len(names) - 1))
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" class="chart" role="img" aria-label="the chart"'
        f' width="200" height="420" viewBox="0 0 200 420"><g>{arrows}{boxes}</g></svg>'
    )


def mission(title: str = "scripted", states: tuple[str, ...] = STATES) -> dict[str, Any]:
    ways = [
        {
            "id": f"t{at}",
            "source": source,
            "to": to,
            "text": "when sure for 1 s",
            "guards": ["sure"],
            "event": None,
            "kind": "transition",
            "priority": at,
        }
        for at, (source, to) in enumerate(pairwise(states), 1)
    ]
    failsafe = {**ways[0], "id": "t9", "source": None, "to": "home", "kind": "failsafe"}
    return {
        "source": "live",
        "title": title,
        "version": "test",
        "dialect": "px4",
        "over_ground": True,
        "states": [{"name": it, "kind": "gps", "parent": None, "behaviour": ""} for it in states],
        "transitions": [*ways, {**failsafe, "text": "failsafe battery"}],
        "guards": {"sure": {"text": "marker seen", "unit": "m", "quantity": None, "for": 1.0}},
        "requirements": [{"name": "ends", "text": "it ends within 900 s"}],
        "events": ["go"],
        "duration": None,
        "tick": 0.05,
        "parameters": {},
        "map": {
            "obstacles": [{"shape": "round", "at": [6, 1], "radius": 1, "bottom": 0, "top": 5}],
            "markers": [{"name": "trunk", "at": [12, 3, -2], "size": 0.4}],
            "places": [],
            "fences": [{"outline": [[-9, -9], [30, -9], [30, 9], [-9, 9]], "holes": [], "top": 9}],
            "known": None,
        },
        "origin": None,
        "tiles": None,
    }


def first_tick() -> dict[str, Any]:
    return {
        "tick": 1,
        "now": 0.05,
        "state": STATES[0],
        "active": [STATES[0]],
        "reason": "",
        "entered_at": 0.0,
        "note": "climbing",
        "mode": "velocity",
        "in_control": True,
        "pilot_flies": False,
        "paused": "",
        "position": [1.0, 2.0, -3.0],
        "velocity": [1.0, 0.0, 0.0],
        "yaw": 0.4,
        "position_sd": 0.3,
        "goal": [12.0, 3.0, -4.0],
        "home": [0.0, 0.0, 0.0],
        "targets": NEARBY,
        "obstacles": [[5.5, 0.5], [5.6, 0.6]],
        "battery": {"charge": 0.8, "failsafe_in": 140.0, "failsafe": "battery"},
        "link_age": 0.1,
        "recorder": "recording",
        "cycle_ms": 3.2,
        "guards": [guard("sure", 0.4, 0.5, held_for=0.0, needs=1.0), unknown("battery low")],
        "requirements": [
            {"name": "ends", "verdict": "open", "robustness": None, "deadline_in": 899.0}
        ],
        "detections": [],
        "image": None,
        "offered": OFFERED,
        "actions": [],
        "pilot": {"you": True, "name": "pilot 1", "asked_by": None, "silent_for": 0.0},
        "playback": None,
        "play": None,
        "ended": None,
    }


OFFERED = [
    {"action": "hold"},
    {"action": "return"},
    {"action": "land", "dangerous": True},
    {"action": "event", "event": "go"},
]


def guard(name: str, value: float, threshold: float, **more: Any) -> dict[str, Any]:
    margin = threshold - value
    numbers = {"value": value, "threshold": threshold, "margin": margin, "normal": margin / 0.5}
    return {"name": name, "holds": margin > 0, "why": "", "held_for": None, "needs": None} | (
        numbers | more
    )


def unknown(name: str) -> dict[str, Any]:
    numbers = dict.fromkeys(("value", "threshold", "margin", "normal", "held_for", "needs"))
    return {"name": name, "holds": None, "why": "no battery reading yet", **numbers}


class ScriptedFlight:
    """A live page's source that shows what it is given."""

    def __init__(self, about: dict[str, Any] | None = None, picture: str | None = None) -> None:
        self.about = about or mission()
        self.picture = picture or chart(STATES)
        self.values = first_tick()
        self.received: list[tuple[str, Mapping[str, Any]]] = []
        self.refusal: PageError | None = None
        self._board: Board | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self.stamp: Callable[[], float] = date  # s, the clock of the vehicle

    def facts(self) -> StaticFacts:
        return StaticFacts(self.about, self.picture)

    def timeline(self) -> Mapping[str, object]:
        lanes = [{"state": self.values["state"], "from": 0.0, "to": None}]
        return {"lanes": lanes, "fired": [], "problems": [], "requirements": {}, "end": 0.05}

    def series(self, guard: str, since: float) -> Mapping[str, object]:
        return {"at": [], "value": [], "threshold": [], "holds": []}

    def track(self) -> Mapping[str, object]:
        return {"at": [0.0], "points": [[0.0, 0.0, 0.0]]}

    def image(self, number: int) -> bytes | None:
        return None

    def why(self, transition: str, at: float | None = None) -> Mapping[str, object]:
        return {"text": "sure does not hold", "fired": False, "conjuncts": [], "before": []}

    def feed(self, session: Session) -> ScriptedFeed:
        if self._board is None:
            self._loop, self._board = asyncio.get_running_loop(), Board()
            self._board.post({**self.values, "at_ms": 1000.0 * self.stamp()})
        return ScriptedFeed(self._board.reader())

    async def posted(
        self, what: str, body: Mapping[str, Any], session: Session
    ) -> Mapping[str, object]:
        self.received.append((what, body))
        if self.refusal is not None:
            raise self.refusal
        return {"id": body.get("id")}

    def show(self, **values: Any) -> None:
        """Show one more tick, from the test's thread."""
        number = self.values["tick"] + 1
        self.values |= {"tick": number, "now": round(0.05 * number, 6)} | values
        happened = {key: self.values.pop(key, []) for key in ("fired", "problems")}
        facts = {**self.values, **happened, "at_ms": 1000.0 * self.stamp()}
        if self._loop is not None and self._board is not None:
            self._loop.call_soon_threadsafe(self._board.post, facts)

    def sent(self, what: str = "action") -> list[Mapping[str, Any]]:
        return [body for kind, body in self.received if kind == what]


class ScriptedFeed:
    """One browser's view of it."""

    def __init__(self, reader: BoardReader) -> None:
        self._reader = reader
        self.changed = reader.changed
        self.read = reader.read
        self.close = reader.close

    def heard(self, message: Mapping[str, Any]) -> None:
        pass
