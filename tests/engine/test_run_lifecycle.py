from __future__ import annotations

from missionkit.engine.run_lifecycle import Lifecycle


def lived(*triggers: str) -> list[str]:
    life = Lifecycle()
    states = [life.state]
    for trigger in triggers:
        getattr(life, trigger)()
        states.append(life.state)
    return states


def test_a_run_is_ready_then_flying_then_ended():
    assert lived("start", "finish") == ["ready", "flying", "ended"]
    assert lived("start", "abort", "finish") == ["ready", "flying", "aborting", "ended"]


def test_what_comes_out_of_order_is_ignored():
    assert lived("abort", "finish") == ["ready"] * 3
    assert lived("start", "abort", "abort", "start") == ["ready", "flying", *["aborting"] * 3]
    assert lived("start", "finish", "start", "abort")[2:] == ["ended"] * 3
