"""The topics of the flight record inside the process: the latest value of each, for who wants it.

Rates follow P1 section 9.2, like those of the record: pose and command 20 Hz, goal and state 10 Hz,
status 1 Hz of mission time; a change of state is published at its own tick. A subscriber gets the
newest value and never an old one; publishing waits for nobody.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from missionkit.errors import UsageError, nearest
from missionkit.geometry import Quat, Vec3
from missionkit.messages import (
    Battery,
    Command,
    Fired,
    Goal,
    Health,
    Mode,
    Observation,
    Record,
    VehicleStatus,
)
from missionkit.recorder.flight_recorder import RateLimit


class PoseTopic(NamedTuple):
    """Where the vehicle is, by its estimate."""

    at: float  # s
    position: Vec3  # (3,), m, NED
    attitude: Quat  # (4,), body to world
    velocity: Vec3  # (3,), m/s, NED


class CommandTopic(NamedTuple):
    """What was sent to the vehicle."""

    at: float  # s
    command: Command


class GoalTopic(NamedTuple):
    """Where the behaviour is going."""

    at: float  # s
    goal: Goal | None


class StateTopic(NamedTuple):
    """Where the chart stands."""

    at: float  # s
    state: str
    active: tuple[str, ...]
    mode: Mode
    fired: tuple[Fired, ...]
    note: str


class StatusTopic(NamedTuple):
    """How the vehicle fares."""

    at: float  # s
    battery: Battery | None
    vehicle: VehicleStatus | None
    health: Health


class TickTopic(NamedTuple):
    """A whole tick."""

    at: float  # s
    record: Record
    observation: Observation


def _pose(record: Record, _: Observation) -> PoseTopic:
    seen = record.estimate
    return PoseTopic(record.now, seen.position, seen.attitude, seen.velocity)


def _command(record: Record, _: Observation) -> CommandTopic:
    return CommandTopic(record.now, record.command)


def _goal(record: Record, _: Observation) -> GoalTopic:
    return GoalTopic(record.now, record.estimate.goal)


def _state(record: Record, _: Observation) -> StateTopic:
    return StateTopic(
        record.now, record.state, record.active, record.mode, record.fired, record.step_note
    )


def _status(record: Record, _: Observation) -> StatusTopic:
    seen = record.estimate
    return StatusTopic(record.now, seen.battery, seen.status, seen.health)


def _tick(record: Record, observation: Observation) -> TickTopic:
    return TickTopic(record.now, record, observation)


class _Topic(NamedTuple):
    value: Callable[[Record, Observation], Any]
    rate: float  # Hz of mission time
    on_change: bool = False  # also when a transition was taken


TOPICS: Mapping[str, _Topic] = MappingProxyType(
    {
        "pose": _Topic(_pose, 20.0),
        "command": _Topic(_command, 20.0),
        "goal": _Topic(_goal, 10.0),
        "state": _Topic(_state, 10.0, on_change=True),
        "status": _Topic(_status, 1.0),
        "tick": _Topic(_tick, 100.0, on_change=True),
    }
)


class TopicBus:
    """Publishes the topics of a flight: an observer for `rehearse` and `fly`.

    Topics are `pose`, `command` (20 Hz), `goal`, `state` (10 Hz), `status` (1 Hz) and `tick`, the
    whole record and observation at every tick. `subscribe` gives access to the latest values.

    Example:
        >>> bus = missionkit.TopicBus()
        >>> poses = missionkit.subscribe(bus, "pose")
        >>> summary = missionkit.rehearse(mission, observers=[bus])
        >>> poses.latest("pose").position.shape
        (3,)
    """

    def __init__(self) -> None:
        self._subscriptions: tuple[Subscription, ...] = ()
        self._rates = {name: RateLimit(topic.rate) for name, topic in TOPICS.items()}

    def __call__(self, record: Record, observation: Observation) -> None:
        """Publish what is due at one tick."""
        for name, topic in TOPICS.items():
            changed = topic.on_change and bool(record.fired)
            takers = [it for it in self._subscriptions if name in it.topics]
            if takers and (self._rates[name].due(record.now) or changed):
                value = topic.value(record, observation)
                for taker in takers:
                    taker.put(name, value)

    def add(self, subscription: Subscription) -> None:
        """Let a subscription take part from now on."""
        self._subscriptions = (*self._subscriptions, subscription)

    def remove(self, subscription: Subscription) -> None:
        """Forget a subscription."""
        self._subscriptions = tuple(it for it in self._subscriptions if it is not subscription)


class Subscription:
    """The latest values of some topics; it may be read on any thread.

    `latest(topic)` returns the newest value, `news(timeout)` waits for values that were not
    returned yet, and a loop over the subscription goes on until it is closed.

    Example:
        >>> bus = missionkit.TopicBus()
        >>> with missionkit.subscribe(bus, "state", "status") as watching:
        ...     summary = missionkit.rehearse(mission, observers=[bus])
        ...     sorted(watching.news(timeout=0.0))
        ['state', 'status']
    """

    def __init__(self, bus: TopicBus, topics: frozenset[str]) -> None:
        self.topics = topics
        self._bus = bus
        self._latest: dict[str, Any] = {}
        self._fresh: dict[str, Any] = {}
        self._closed = False
        self._changed = threading.Condition()

    def __enter__(self) -> Subscription:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[Mapping[str, Any]]:
        """Yield what is new, as often as there is something."""
        while not self._closed:
            if news := self.news():
                yield news

    def put(self, topic: str, value: Any) -> None:
        """Take a value, in the place of the one before."""
        with self._changed:
            self._latest[topic] = self._fresh[topic] = value
            self._changed.notify_all()

    def latest(self, topic: str) -> Any:
        """Return the newest value of a topic; None: there is none yet."""
        return self._latest.get(topic)

    def news(self, timeout: float | None = None) -> Mapping[str, Any]:
        """Return the newest values of the topics that have one which was not returned yet.

        Args:
            timeout: s to wait for one at most; None: until there is one, or it is closed.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._fresh or self._closed, timeout)
            news, self._fresh = self._fresh, {}
        return news

    def close(self) -> None:
        """End the subscription."""
        self._bus.remove(self)
        with self._changed:
            self._closed = True
            self._changed.notify_all()


def subscribe(bus: TopicBus, *topics: str) -> Subscription:
    """Subscribe to topics of a flight: the latest value of each, which no flight waits for.

    Args:
        bus: an observer of the flight.
        topics: "pose", "command", "goal", "state", "status" or "tick"; all but "tick" if none is
            named.

    Returns:
        The subscription, which is closed at the end of a `with` block.

    Raises:
        UsageError: there is no such topic.

    Example:
        >>> bus = missionkit.TopicBus()
        >>> states = missionkit.subscribe(bus, "state")
        >>> summary = missionkit.rehearse(mission, observers=[bus])
        >>> states.latest("state").state
        'land'
    """
    for topic in topics:
        if topic not in TOPICS:
            raise UsageError(f"unknown topic {topic!r}; {nearest(topic, TOPICS)}")
    subscription = Subscription(bus, frozenset(topics) or frozenset(TOPICS) - {"tick"})
    bus.add(subscription)
    return subscription
