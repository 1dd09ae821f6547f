"""Playing a recorded flight to one browser: its own time, its own speed."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from concurrent.futures import Executor
from typing import Any

from missionkit.engine.clock import date, stopwatch
from missionkit.errors import MissionkitError
from missionkit.page.facts.plain_values import given_number
from missionkit.page.recording.recorded_run import RecordedRun
from missionkit.page.recording.recorded_ticks import RecordedTicks
from missionkit.page.server.board import Board

PERIOD = 0.05  # s of the wall between two looks at the clock
SLOWEST, FASTEST = 0.05, 50.0  # times real time
NOBODY = {"you": False, "name": None, "asked_by": None, "silent_for": None}


class Playback:
    """What one browser sees of a recording: a feed of the page.

    Args:
        run: that was recorded.
        working: where ticks are computed.
    """

    def __init__(self, run: RecordedRun, working: Executor) -> None:
        self._run = run
        self._working = working
        self._ticks = RecordedTicks(run.mission.plan, run.journals)
        times = self._ticks.times
        self._begin, self._end = (times[0], times[-1]) if times else (0.0, 0.0)
        self._at = self._begin
        self._speed, self._playing = 1.0, False
        self._board = Board()
        self._reader = self._board.reader()
        self._wake = asyncio.Event()
        self._wake.set()
        self._moving = asyncio.create_task(self._move())

    async def changed(self) -> None:
        """Return once there is something new."""
        await self._reader.changed()

    def read(self) -> tuple[int, dict[str, str]]:
        """Return the number of the latest, and its values as JSON text by key."""
        return self._reader.read()

    def close(self) -> None:
        """The browser has gone."""
        self._moving.cancel()

    def heard(self, message: Mapping[str, Any]) -> None:
        """Seek, play, pause or step."""
        wanted, at = message.get("t"), given_number(message.get("at"))
        if wanted == "seek" and at is not None:
            self._at = min(max(at, self._begin), self._end)
        elif wanted == "play":
            speed = given_number(message.get("speed"))
            self._speed = 1.0 if speed is None else min(max(speed, SLOWEST), FASTEST)
            self._playing = True
            self._at = self._begin if self._at >= self._end else self._at
        elif wanted == "pause":
            self._playing = False
        elif wanted == "step":
            self._step(given_number(message.get("by")))
        self._wake.set()

    def _step(self, by: float | None) -> None:
        self._playing, times = False, self._ticks.times
        if by in {1.0, -1.0} and times:
            number = self._ticks.number_at(self._at) + int(by)
            self._at = times[min(max(number, 0), len(times) - 1)]

    async def _move(self) -> None:
        """Show the tick of the time that it is, again and again."""
        before = stopwatch()
        while True:
            if not self._playing:
                await self._wake.wait()
                before = stopwatch()
            self._wake.clear()
            now = stopwatch()
            if self._playing:
                self._at = min(self._end, self._at + self._speed * (now - before))
                self._playing = self._at < self._end
            before = now
            await self._show()
            await asyncio.sleep(PERIOD)

    async def _show(self) -> None:
        number = self._ticks.number_at(self._at)
        try:
            facts = await asyncio.get_running_loop().run_in_executor(
                self._working, self._facts, number
            )
        except MissionkitError as error:
            facts = {"problems": [{"at": self._at, "says": str(error), "times": 1}]}
            self._playing = False
        played = {"at": self._at, "speed": self._speed, "playing": self._playing, "end": self._end}
        self._board.post({**facts, "playback": played, "at_ms": 1000.0 * date()})

    def _facts(self, number: int) -> dict[str, Any]:
        shown = self._ticks.tick(number)
        if shown is None:
            return {}
        now, camera = shown.record.now, self._run.mission.plan.camera
        follower, image = self._ticks.follower, self._run.images.number_at(now)
        size = {"width": camera.width, "height": camera.height}
        return {
            **follower.facts(shown.record, shown.observation, shown.number),
            "image": None if image is None else {"n": image, **size},
            "recorder": "off",
            "offered": [],
            "actions": [],
            "pilot": NOBODY,
            "play": None,
            "ended": None,
        }
