"""The page of a recorded flight."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from typing import Any

from typing_extensions import override

from missionkit.page.facts.mission_facts import chart_picture, mission_facts
from missionkit.page.recording.playback import Playback
from missionkit.page.recording.recorded_run import RecordedRun
from missionkit.page.server.page_source import PageError, PageSource, StaticFacts
from missionkit.page.server.sessions import Session
from missionkit.version import __version__


class RecordingSource(PageSource):
    """Answers the requests of a page of a recording.

    Args:
        run: that was recorded.
    """

    def __init__(self, run: RecordedRun) -> None:
        self._run = run
        self._working = ThreadPoolExecutor(1, "replay")

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
    def feed(self, session: Session) -> Playback:
        """Return what one browser is shown."""
        return Playback(self._run, self._working)

    @override
    async def posted(
        self, what: str, body: Mapping[str, Any], session: Session
    ) -> Mapping[str, object]:
        """Refuse: a flight that is over cannot be changed."""
        raise PageError(f"this is a recording: it knows no {what}", 409)
