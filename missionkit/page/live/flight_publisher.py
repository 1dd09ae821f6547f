"""What a flight tells its page: the latest tick, every transition, images; never waiting.

An observer follows every tick on the flight's own thread, which takes microseconds. A thread of its
own takes the newest tick once the one before is sent, and hands it to the server's process.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Mapping
from typing import Any, NamedTuple

from missionkit.engine.clock import date, stopwatch
from missionkit.messages import Frame, Observation, Record
from missionkit.page.facts.flight_follower import FlightFollower
from missionkit.page.facts.mission_facts import FlownMission
from missionkit.page.facts.tick_facts import Followed, tick_facts
from missionkit.page.live.action_desk import ActionDesk
from missionkit.page.live.message_link import MessageLink
from missionkit.page.live.offered_actions import Offer, offered, raised_events
from missionkit.perception.opencv_helpers import encode_jpeg
from missionkit.recorder.record_sinks import Reports
from missionkit.recorder.topic_bus import TopicBus, subscribe

PERIOD = 0.045  # s of the wall between two messages at least: every tick at 20 Hz
IMAGE_PERIOD = 0.2  # s of the wall between two images at least
KEPT = 500  # transitions and problems that wait while the server does not take them
AT_ONCE = 50  # of them in one message
PATIENCE = 2.0  # s that the end of a flight waits for the last message
GONE = "the page's server has ended"


class NewestTick(NamedTuple):
    """A tick, and what was known at it."""

    record: Record
    observation: Observation
    known: Followed
    offers: tuple[Offer, ...]
    frame: Frame | None  # the last with an image


class FlightPublisher:
    """Observes a flight for its page.

    Args:
        mission: that is flown.
        link: to the server.
        desk: takes what pilots want.
        reports: says once when the server has gone.
    """

    def __init__(
        self, mission: FlownMission, link: MessageLink, desk: ActionDesk, reports: Reports
    ) -> None:
        self._chart, self._raised = mission.plan.chart, raised_events(mission.model)
        self._link, self._desk, self._reports = link, desk, reports
        self._follower = FlightFollower(self._chart)
        self._tick = -1
        self._frame: Frame | None = None
        self._newest: NewestTick | None = None
        self._happened: deque[tuple[str, Mapping[str, Any]]] = deque(maxlen=KEPT)
        self._images = ImageSender(link)
        self._bus = TopicBus()
        self._ticks = subscribe(self._bus, "tick")
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="page", daemon=True)
        self._thread.start()

    def __call__(self, record: Record, observation: Observation) -> None:
        """Follow one tick, and hear what pilots want."""
        self._tick += 1
        fired, problems = self._follower.follow(record, self._tick)
        self._happened.extend(("fired", it) for it in fired)
        self._happened.extend(("problems", it) for it in problems)
        if observation.frame is not None and observation.frame.image is not None:
            self._frame = observation.frame
        self._serve_pilots(record, observation, fired)
        known = self._follower.followed(self._tick, record)
        self._newest = NewestTick(record, observation, known, self._desk.offers, self._frame)
        self._bus(record, observation)

    def _serve_pilots(
        self, record: Record, observation: Observation, fired: list[dict[str, Any]]
    ) -> None:
        desk = self._desk
        desk.follow(record, fired, in_control=observation.in_control)
        controls = desk.give_back is not None
        offers = offered(self._chart, self._raised, record, observation, controls=controls)
        desk.offers = tuple(offers)
        if self._link.broken:
            self._reports.add(GONE, "nobody can watch or act by it", "; the flight continues")
            return
        for message in self._link.received():
            if isinstance(message, dict):
                desk.heard(message, self._tick, record.now)

    def close(self) -> None:
        """Send the last tick."""
        self._closing.set()
        self._ticks.close()
        self._thread.join(PATIENCE)
        if self._newest is not None and not self._thread.is_alive():
            self._publish(self._newest)

    def _run(self) -> None:
        for _ in self._ticks:
            begun, newest = stopwatch(), self._newest
            if newest is not None:
                self._publish(newest)
            if self._link.broken:
                return
            self._closing.wait(max(0.0, PERIOD - (stopwatch() - begun)))

    def _publish(self, newest: NewestTick) -> None:
        count = min(AT_ONCE, len(self._happened))
        happened = [self._happened[at] for at in range(count)]
        image = self._images.send(newest.frame)
        facts = {
            **tick_facts(newest.record, newest.observation, newest.known),
            "at_ms": 1000.0 * date(),
            "image": image,
            "recorder": self._recorder(),
            "offered": [it.as_value() for it in newest.offers],
            "actions": [it.as_value() for it in self._desk.recent],
            "ended": None,
            **{key: [it for what, it in happened if what == key] for key in ("fired", "problems")},
        }
        if self._link.send({"kind": "tick", "facts": facts}):
            for _ in range(count):
                self._happened.popleft()

    def _recorder(self) -> str:
        failed = [it for it in self._reports.all if "flight record" in it]
        return f"failed: {failed[0]}" if failed else "recording"


class ImageSender:
    """Sends the newest image, not too often.

    Args:
        link: to the server.
    """

    def __init__(self, link: MessageLink) -> None:
        self._link = link
        self._sent_at = -IMAGE_PERIOD
        self._number = 0
        self._shown: Frame | None = None
        self._value: dict[str, int] | None = None

    def send(self, frame: Frame | None) -> dict[str, int] | None:
        """Send a frame if it is time; return number and size of the last that was sent."""
        now = stopwatch()
        fresh = frame is not None and frame is not self._shown and frame.image is not None
        if not fresh or now - self._sent_at < IMAGE_PERIOD:
            return self._value
        assert frame is not None and frame.image is not None  # noqa: S101, PT018 - fresh
        height, width = frame.image.shape[:2]
        if self._link.send_image(self._number + 1, encode_jpeg(frame.image)):
            self._number += 1
            self._shown, self._sent_at = frame, now
            self._value = {"n": self._number, "width": width, "height": height}
        return self._value
