"""The page of a chart that is played with."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from typing_extensions import override

from missionkit.engine.clock import date
from missionkit.messages import is_event
from missionkit.page.facts.flight_follower import FlightFollower
from missionkit.page.facts.guard_series import SHOWN, GuardSeries
from missionkit.page.facts.mission_facts import FlownMission, chart_picture, mission_facts
from missionkit.page.facts.plain_values import given_number
from missionkit.page.facts.requirement_facts import requirement_rows
from missionkit.page.facts.timeline import Timeline
from missionkit.page.play.played_chart import PlayedChart
from missionkit.page.server.board import Board, BoardReader
from missionkit.page.server.page_source import Feed, PageError, PageSource, StaticFacts
from missionkit.page.server.sessions import Session
from missionkit.version import __version__

LONGEST_ADVANCE = 600.0  # s in one go
NO_PLACE = ("position", "velocity", "yaw", "position_sd", "goal", "home", "link_age", "image")


class PlaySource(PageSource):
    """Answers the requests of a page without a flight.

    Args:
        mission: that is played with.
    """

    def __init__(self, mission: FlownMission) -> None:
        self._played = PlayedChart(mission.model, mission.catalogue, mission.plan.period)
        facts = mission_facts(mission, "play", __version__)
        self._static = StaticFacts(facts, chart_picture(mission))
        self._board = Board()
        self._begin()

    def _begin(self) -> None:
        self._follower = FlightFollower(self._played.chart)
        self._timeline, self._series = Timeline(), GuardSeries(SHOWN)
        self._number = -1
        self._advance(1)

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
        return {"at": [], "points": []}

    @override
    def image(self, number: int) -> bytes | None:
        return None

    @override
    async def why(self, transition: str, at: float | None) -> Mapping[str, object]:
        raise PageError(
            "there is no journal of a chart that is played with: look at its guards", 409
        )

    @override
    def feed(self, session: Session) -> Feed:
        return PlayFeed(self._board)

    @override
    async def posted(
        self, what: str, body: Mapping[str, Any], session: Session
    ) -> Mapping[str, object]:
        if what != "play":
            raise PageError(f"a chart that is played with knows no {what}", 409)
        steps: dict[str, Callable[[Any], None]] = {
            "reset": self._reset,
            "quantity": self._set,
            "fault": self._lose,
            "event": self._hear,
            "advance": self._wait,
        }
        unknown = [key for key in body if key not in steps]
        if unknown:
            raise PageError(f"{unknown[0]!r} is unknown; known: {', '.join(steps)}")
        for key, step in steps.items():
            if key in body:
                step(body[key])
        return {"now": self._number * self._played.period}

    def _reset(self, wanted: object) -> None:
        if wanted is True:
            self._played.reset()
            self._begin()

    def _set(self, given: object) -> None:
        if not isinstance(given, dict):
            raise PageError("quantity: an object with names and values")
        for name in given:
            if name not in self._played.sliders:
                known = ", ".join(self._played.sliders)
                raise PageError(f"quantity {name!r} is unknown; known: {known}")
            if given[name] is not None and given_number(given[name]) is None:
                raise PageError(f"quantity {name!r}: a number, or null if it is not known")
        for name, value in given.items():
            self._played.set(name, given_number(value))
        self._advance(1)

    def _lose(self, name: object) -> None:
        if not isinstance(name, str) or name not in self._played.losses:
            known = ", ".join(self._played.losses)
            raise PageError(f"fault {name!r} is unknown; known: {known}")
        self._played.toggle(name)
        self._advance(1)

    def _hear(self, event: object) -> None:
        if not is_event(event):
            raise PageError("event: words joined by '.', such as 'go'")
        self._advance(1, (str(event),))

    def _wait(self, seconds: object) -> None:
        wanted = given_number(seconds)
        if wanted is None or not 0.0 < wanted <= LONGEST_ADVANCE:
            raise PageError(f"advance: seconds, up to {LONGEST_ADVANCE:g}")
        self._advance(max(1, round(wanted / self._played.period)))

    def _advance(self, ticks: int, events: tuple[str, ...] = ()) -> None:
        """Let the chart tick; events come with the first tick."""
        facts: Mapping[str, Any] = {}
        happened: dict[str, list[Any]] = {"fired": [], "problems": []}
        for _ in range(ticks):
            self._number += 1
            record, seen = self._played.tick(events)
            events = ()
            fired, problems = self._follower.follow(record, self._number)
            happened["fired"] += fired
            happened["problems"] += problems
            self._timeline.stands(record.now, record.state)
            facts = self._follower.facts(record, seen, self._number)
            self._timeline.required(record.now, requirement_rows(record))
            self._series.add(record.now, facts["guards"])
        self._timeline.happened(**happened)
        self._board.post({**facts, **happened, **self._fixed(), **dict.fromkeys(NO_PLACE)})

    def _fixed(self) -> dict[str, object]:
        played = self._played
        waited = self._static.mission["events"]
        events = waited if isinstance(waited, list) else []
        return {
            "at_ms": 1000.0 * date(),
            "recorder": "off",
            "offered": [{"action": "event", "event": it} for it in events if is_event(it)],
            "actions": [],
            "pilot": {"you": True, "name": None, "asked_by": None, "silent_for": None},
            "playback": None,
            "ended": None,
            "play": {
                "quantities": [
                    it.as_value(played.point.get(it.quantity)) for it in played.sliders.values()
                ],
                "faults": list(played.losses),
                "active_faults": list(played.faults),
                "clock": self._number * played.period + played.period,
            },
        }


class PlayFeed:
    """What one browser is shown.

    Args:
        board: with the latest.
    """

    def __init__(self, board: Board) -> None:
        self._reader: BoardReader = board.reader()

    async def changed(self) -> None:
        """Return once there is something new."""
        await self._reader.changed()

    def read(self) -> tuple[int, dict[str, str]]:
        """Return the number of the latest, and its values as JSON text by key."""
        return self._reader.read()

    def heard(self, _: Mapping[str, Any]) -> None:
        """Take nothing: what is played comes by requests."""

    def close(self) -> None:
        """The browser has gone."""
        self._reader.close()
