"""A chart that does not come to rest in flight: the vehicle holds at once, then goes home."""

from __future__ import annotations

from rehearsed import flown, short_stage

LIVELOCK = """\
targets: {a: {position: [40, 0, -5]}}
variables: {n: 0}
failsafes:
  - {name: battery, when: {use: battery_below, floor: 0.25}, to: land}
  - {name: link, when: {use: link_lost, longer_than: 3}, to: land}
  - {name: lost, when: estimate_bad, for: 1.0, to: land}
initial: up
states:
  up:
    kind: idle
    behavior: {use: take_off, height: 4}
    transitions: [{to: go, when: done}]
  go:
    kind: gps
    behavior: {use: go_to, target: a}
    transitions: [{to: p, after: 1.0}]
  p:
    kind: custom
    dwell: 0
    behavior: {use: go_to, target: a}
    transitions:
      - {to: q, when: {variable: n, equals: 0}, do: [{assign: {n: 1}}]}
      - {to: land, after: 60}
  q:
    kind: custom
    dwell: 0
    transitions:
      - {to: p, when: {variable: n, equals: 1}, do: [{assign: {n: 0}}]}
      - {to: land, after: 60}
  land: {kind: land}
"""


def test_the_vehicle_holds_at_once_then_lands_and_nothing_of_it_is_recorded():
    ready = short_stage(LIVELOCK)
    flight = flown(ready)
    restless = [r for r in flight.records if r.step_note == "holding: a plug-in misbehaves"]
    assert {r.state for r in restless} == {"go"}
    assert all(r.fired == () for r in restless)
    assert flight.went()[-1] == ("land", "failsafe plug-in failed")
    assert 2.9 < flight.entered("land") - restless[0].now < 3.2
    (problem,) = (text for text in flight.problems() if "come to rest" in text)
    assert problem.endswith("p -> q -> p -> q -> p -> q")
