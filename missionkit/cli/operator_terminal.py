"""The person at the terminal while a mission flies: what is shown, what the keys do."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import closing, contextmanager, nullcontext
from functools import partial

from missionkit.api.journal_recording import JournaledFlight
from missionkit.chart.model.mission import Mission
from missionkit.cli.key_events import Keys, offered
from missionkit.cli.live_view import LineView, LiveView, live_view
from missionkit.cli.run_options import RunOptions
from missionkit.engine.clock import stopwatch
from missionkit.engine.flight_loop import Observer, Operator
from missionkit.engine.planned_events import PlannedEvents, planned
from missionkit.messages import CONTINUE, PAUSE, Observation, Record
from missionkit.page.live.flight_page import FlightPage
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.record_sinks import (
    JOURNAL,
    RECORD,
    Sink,
    Sinks,
    contained,
)
from missionkit.sim.ground_truth import TrueState
from missionkit.states import VEHICLES

DEEDS = {"p": "pauses", "c": "continues", "r": "gives control back"}  # by key


@contextmanager
def cockpit(
    order: RunOptions,
    operator: Operator,
    mission: Mission,
    recorder: FlightRecorder,
    journaled: JournaledFlight,
    sinks: Sinks,
    truth: Callable[[], TrueState | None] = lambda: None,
    give_back: Callable[[], None] | None = None,
    page: FlightPage | None = None,
) -> Iterator[tuple[Observer, ...]]:
    """Record and show a flight, and listen to the keys, while this context is open.

    It gives what is to be called after every tick.

    Args:
        order: says whether there is a live view, and keys with it.
        operator: gets what is requested at the keys.
        mission: that is flown.
        recorder: takes every tick.
        journaled: keeps every tick whole.
        sinks: what is shown goes to one of them; take reports of what fails.
        truth: of a simulated vehicle.
        give_back: gives control back after a pilot's takeover.
        page: of the flight, if it has one.
    """
    view = None
    events: dict[str, str] = {}
    deeds: dict[str, Callable[[], None]] = {}
    if not (order.headless or order.as_json):
        events = offered(mission)
        deeds = {"p": partial(operator.send, PAUSE), "c": partial(operator.send, CONTINUE)}
        if give_back is not None:
            deeds["r"] = give_back
        over_ground = VEHICLES[mission.vehicle.use].over_ground
        title = _title(mission.name, events, deeds)
        view = live_view(sys.stdout, stopwatch, title, over_ground=over_ground)
    elif not order.as_json:
        view = LineView(sys.stdout, logs_only=True)
    keys = Keys(sys.stdin, operator, events, deeds)
    watch = _KeyWatch(recorder, view, sinks.view, truth)
    due = [planned(text, mission.by_name()) for text in order.events]
    observers: dict[str, Observer] = {
        RECORD: watch,
        JOURNAL: journaled.observe,
        "keys": keys,
        "planned events": PlannedEvents(due, operator),
    }
    watched = nullcontext() if page is None else page.observing(operator, sinks.reports, give_back)
    with (
        view or nullcontext(),
        closing(sinks),
        recorder,
        closing(journaled.journal),
        keys,
        _giving_back(give_back),
        watched as publisher,
    ):
        if publisher is not None:
            observers["the page"] = publisher
        yield tuple(contained(what, call, sinks.reports) for what, call in observers.items())


class _KeyWatch:
    """Passes every tick on to the recorder and the view."""

    def __init__(
        self,
        recorder: FlightRecorder,
        view: LiveView | None,
        sink: Sink,
        truth: Callable[[], TrueState | None],
    ) -> None:
        self._recorder = recorder
        self._view = view
        self._sink = sink
        self._truth = truth

    def __call__(self, record: Record, observation: Observation) -> None:
        self._recorder.write(record, observation.frame, self._truth())
        view = self._view
        if view is not None:
            self._sink.put(lambda: view.update(record))


def _title(mission: str, events: Mapping[str, str], deeds: Collection[str]) -> str:
    """Return what stands above the live page: the mission, and which key does what."""
    hints = [f"{key} {event}" for key, event in events.items()]
    hints += [f"{key} {DEEDS[key]}" for key in deeds]
    keys = ", ".join(hints)
    return f"{mission} — keys: {keys}" if keys else mission


@contextmanager
def _giving_back(deed: Callable[[], None] | None) -> Iterator[None]:
    """Let SIGUSR1 give control back, as the key does where there is a terminal."""
    if deed is None:
        yield
        return
    before = signal.signal(signal.SIGUSR1, lambda *_: deed())
    try:
        yield
    finally:
        signal.signal(signal.SIGUSR1, before)
