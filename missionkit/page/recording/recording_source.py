"""The page of a recorded flight."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from pathlib import Path
from typing import Any

from typing_extensions import override

from missionkit.errors import MissionkitError
from missionkit.page.facts.mission_facts import chart_picture, mission_facts
from missionkit.page.recording.playback import Playback
from missionkit.page.recording.recorded_run import RecordedRun
from missionkit.page.recording.what_if_answer import what_if_answer
from missionkit.page.server.page_source import PageError, PageSource, StaticFacts
from missionkit.page.server.sessions import Session
from missionkit.page.server.why_desk import WhyDesk
from missionkit.version import __version__


class RecordingSource(PageSource):
    """Answers the requests of a page of a recording.

    Args:
        run: that was recorded.
        plugins: files that the flight used.
    """

    def __init__(self, run: RecordedRun, plugins: Sequence[Path] = ()) -> None:
        self._run = run
        self._plugins = plugins
        self._working = ThreadPoolExecutor(1, "replay")
        self._why = WhyDesk(run.path, plugins, growing=False)

    @cached_property
    def _facts(self) -> StaticFacts:
        mission = mission_facts(self._run.mission, "recording", __version__)
        return StaticFacts({**mission, "duration": self._run.end}, chart_picture(self._run.mission))

    @override
    def facts(self) -> StaticFacts:
        """Return mission and chart."""
        return self._facts

    @override
    def timeline(self) -> Mapping[str, object]:
        """Return what has happened."""
        return self._run.timeline.as_value()

    @override
    def series(self, guard: str, since: float) -> Mapping[str, object]:
        """Return the values of a guard from a time (s) on."""
        return self._run.series.since(guard, since)

    @override
    def track(self) -> Mapping[str, object]:
        """Return where the vehicle has been."""
        return self._run.track.as_value()

    @override
    def image(self, number: int) -> bytes | None:
        """Return a camera image (JPEG) by its number."""
        return self._run.images.jpeg(number)

    @override
    async def why(self, transition: str, at: float | None) -> Mapping[str, object]:
        return await self._why.answer(self._facts.mission, self.timeline(), transition, at)

    @override
    def feed(self, session: Session) -> Playback:
        """Return what one browser is shown."""
        return Playback(self._run, self._working)

    @override
    async def posted(
        self, what: str, body: Mapping[str, Any], session: Session
    ) -> Mapping[str, object]:
        """Refuse: a flight that is over cannot be changed."""
        if what != "what-if":
            raise PageError(f"this is a recording: it knows no {what}", 409)
        loop, run = asyncio.get_running_loop(), self._run.path
        try:
            return await loop.run_in_executor(
                self._working, what_if_answer, run, body, self._plugins
            )
        except MissionkitError as error:
            raise PageError(str(error), 409) from error
