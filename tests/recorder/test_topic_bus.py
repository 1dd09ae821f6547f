"""The topics of a flight: latest values at their rates, and nobody waits."""

import threading

import numpy as np
import pytest
from samples import calm

from missionkit.errors import UsageError
from missionkit.messages import Command, Fired, Mode, Observation, Record
from missionkit.recorder.topic_bus import TopicBus, subscribe


def tick(bus, number, state="hover", fired=()):
    now = 0.05 * number
    record = Record(
        now, state, (state,), Mode.GPS, (), fired, Command(), "", (), calm(now=now)
    )  # fmt: skip
    bus(record, Observation(now))
    return record


def counted(topic, ticks):
    """How often a topic is published in so many ticks."""
    bus, count = TopicBus(), 0
    subscription = subscribe(bus, topic)
    for number in range(ticks):
        tick(bus, number)
        count += bool(subscription.news(timeout=0.0))
    return count


@pytest.mark.parametrize(
    ("topic", "times"),
    [("pose", 40), ("command", 40), ("tick", 40), ("goal", 20), ("state", 20), ("status", 2)],
)
def test_each_topic_comes_at_its_rate(topic, times):
    assert counted(topic, 40) == times


def test_a_reader_that_was_away_gets_the_latest_alone():
    bus = TopicBus()
    subscription = subscribe(bus, "pose", "state")
    for number in range(1000):
        last = tick(bus, number)
    assert subscription.news(timeout=0.0)["pose"].at == last.now
    assert subscription.news(timeout=0.0) == {}
    assert np.array_equal(subscription.latest("pose").position, last.estimate.position)


def test_a_change_of_state_is_published_at_its_own_tick():
    bus = TopicBus()
    subscription = subscribe(bus, "state")
    tick(bus, 0)
    tick(bus, 1, "land", (Fired("hover", "land", "when low", (), ()),))
    assert subscription.latest("state").state == "land"


def test_a_subscription_can_be_read_on_another_thread_until_it_is_closed():
    bus, seen = TopicBus(), []
    subscription = subscribe(bus)
    reading = threading.Thread(target=lambda: seen.extend(subscription))
    reading.start()
    tick(bus, 0)
    while not seen:
        pass
    subscription.close()
    reading.join(10.0)
    assert not reading.is_alive()
    assert set(seen[0]) == {"pose", "command", "goal", "state", "status"}
    tick(bus, 1)
    assert subscription.latest("pose").at == 0.0


def test_an_unknown_topic_gets_a_sentence():
    with pytest.raises(UsageError, match=r"unknown topic 'poses'.*'pose'"):
        subscribe(TopicBus(), "poses")
