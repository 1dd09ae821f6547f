"""Events from the keys, and from a plan."""

from __future__ import annotations

import os
import pty

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.cli.key_events import Keys, offered
from missionkit.engine.flight_loop import Operator
from missionkit.messages import Observation

MISSION = """\
missionkit: 1
mission: m
initial: a
states:
  a:
    kind: custom
    entry: [{raise: inner}]
    transitions:
      - {to: land, event: [go, inner, done.state.a]}
      - {to: land, event: [stop.now, go, error.execution, "*"]}
  land: {kind: land}
"""


def test_keys_are_those_events_that_only_a_person_can_send():
    mission = parse(MISSION, "m.yaml", builtin())
    assert offered(mission) == {"1": "go", "2": "stop.now"}


def test_a_key_sends_its_event_and_others_do_nothing():
    main, terminal = pty.openpty()
    operator = Operator()
    with (
        os.fdopen(terminal, "r", encoding="utf-8") as stream,
        Keys(stream, operator, {"1": "go", "2": "stop.now"}) as keys,
    ):
        os.write(main, b"2x1")
        keys(None, Observation(0.05))
        assert operator.take() == ("stop.now", "go")
        keys(None, Observation(0.1))
        assert operator.take() == ()
    os.close(main)


def test_without_a_terminal_nothing_is_read(tmp_path):
    path = tmp_path / "keys.txt"
    path.write_text("111")
    operator = Operator()
    with path.open(encoding="utf-8") as stream, Keys(stream, operator, {"1": "go"}) as keys:
        keys(None, Observation(0.05))
    assert operator.take() == ()


def test_a_key_can_do_other_things_than_send_an_event():
    main, terminal = pty.openpty()
    operator, done = Operator(), []
    with (
        os.fdopen(terminal, "r", encoding="utf-8") as stream,
        Keys(stream, operator, {}, {"r": lambda: done.append("given back")}) as keys,
    ):
        os.write(main, b"xr")
        keys(None, Observation(0.05))
    os.close(main)
    assert done == ["given back"]
    assert operator.take() == ()
