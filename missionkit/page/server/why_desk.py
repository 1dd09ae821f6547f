"""Why a transition was taken or not, as the page asks it: again and again while a panel is open.

An answer reads the whole journal. One is worked out at a time, on a thread of its own. While the
flight lasts, the next is worked out only after ten times as long as the last took: asking each
second costs a tenth of a processor at most. Of a recording, the smallest change is looked for once
the same was asked twice.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from missionkit.engine.clock import stopwatch
from missionkit.errors import MissionkitError
from missionkit.page.facts.asked_transition import state_at, transition_of
from missionkit.page.facts.plain_values import number
from missionkit.page.server.page_source import PageError

if TYPE_CHECKING:
    from missionkit.api.why import Why

REST = 10.0  # times as long as the last answer took
KEPT = 32  # answers


class AskedWhy(NamedTuple):
    """A transition, and when."""

    source: str
    to: str
    reason: str
    at: float | None  # s; None: now


class WhyDesk:
    """Answers for one run.

    Args:
        run: folder; its journal may still be written.
        plugins: files that the flight used.
        growing: the journal is still being written: answers grow old, and no change is looked for.
    """

    def __init__(self, run: Path, plugins: Sequence[Path] = (), *, growing: bool) -> None:
        self._run, self._plugins, self._growing = run, plugins, growing
        self._working = ThreadPoolExecutor(1, "why")
        self._answers: dict[AskedWhy, Mapping[str, object]] = {}
        self._whole: set[AskedWhy] = set()  # with the smallest change, or on its way
        self._rests_until = 0.0

    async def answer(
        self,
        mission: Mapping[str, Any],
        timeline: Mapping[str, Any],
        transition: str,
        at: float | None,
    ) -> Mapping[str, object]:
        """Return the answer, perhaps one of a moment ago.

        Args:
            mission: as `/api/mission` answers.
            timeline: as `/api/timeline` answers; it says what commanded where any state may.
            transition: its id.
            at: s; None: now.

        Raises:
            PageError: there is none.
        """
        way = transition_of(mission, transition)
        if way is None:
            raise PageError("there is no such transition", 404)
        source = way["source"] or state_at(timeline, at)
        return await self._answered(AskedWhy(source, way["to"], way["text"], at))

    async def _answered(self, asked: AskedWhy) -> Mapping[str, object]:
        known = self._answers.get(asked)
        if known is not None and (not self._growing or stopwatch() < self._rests_until):
            if not self._growing and asked not in self._whole:
                self._whole.add(asked)
                self._working.submit(self._work_out, asked, changes=True)
            return known
        loop = asyncio.get_running_loop()
        try:
            return await loop.run_in_executor(self._working, self._work_out, asked)
        except MissionkitError as error:
            raise PageError(str(error), 409) from error

    def _work_out(self, asked: AskedWhy, *, changes: bool = False) -> Mapping[str, object]:
        from missionkit.api.why import why  # noqa: PLC0415 - heavy

        begun = stopwatch()
        words = f"{asked.source}->{asked.to}"
        found = why(self._run, words, at=asked.at, changes=changes, plugins=self._plugins)
        chosen = next((it for it in found if it.reason == asked.reason), found[0])
        self._rests_until = stopwatch() + REST * (stopwatch() - begun)
        answer = self._answers[asked] = value_of(chosen)
        while len(self._answers) > KEPT:
            del self._answers[next(iter(self._answers))]
        return answer


def value_of(it: Why) -> dict[str, Any]:
    """Return an answer for JSON."""
    outlook, change = it.if_nothing_changes, it.smallest_change
    return {
        "text": it.text,
        "fired": it.fired,
        "at": it.at,
        "conjuncts": [
            {
                "guard": each.guard,
                "holds": each.holds,
                "value": number(each.value),
                "threshold": number(each.threshold),
                "margin": number(each.margin),
                "closest": None
                if each.closest is None
                else {"margin": number(each.closest.margin), "at": each.closest.at},
                "since": each.since,
                "why": each.why,
            }
            for each in it.conjuncts
        ],
        "before": list(it.before),
        "if_nothing_changes": None
        if outlook is None
        else {"in": outlook.after, "evidence": outlook.evidence},
        "smallest_change": None
        if change is None
        else {"text": change.text, "verified": change.verified},
        "notes": list(it.notes),
    }
