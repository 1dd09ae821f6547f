"""The study of killed flights: its moments, its page, and one flight that is killed."""

from __future__ import annotations

from studies import resume
from studies.kills import Kill, Survived, copied, survived
from studies.resume import Cost, Whole, kills, page

WHOLE = [Whole(1900, True)] * 200


def of(seed: int, **changes: object) -> Survived:
    says = "resumed after 2.1 s: in the air, in gps; the chart continues"
    run = Survived(
        *(Kill(seed, 400, 1.0), "gps", 19.5, says, "success", "flown as planned"),
        landed=True,
        finished=True,
        error=0.04,
    )
    return run._replace(**changes)


def test_moments_are_spread_over_the_flight_and_come_from_the_seed():
    moments = kills(WHOLE, 0, 1.0)
    assert moments == kills(WHOLE, 0, 1.0) != kills(WHOLE, 1, 1.0)
    ticks = [moment.tick for moment in moments]
    assert 1 <= min(ticks) < 100
    assert 1780 < max(ticks) < 1880
    assert [moment.seed for moment in moments] == list(range(200))


def test_the_page_lists_every_flight_that_did_not_succeed():
    runs = [of(0), of(1, outcome="crash", reason="hit an obstacle or the ground", landed=False)]
    text = page(runs, WHOLE[:2], Cost((0.001, 0.003, 0.002), 62_000, 1900), "the command")
    assert "1 of 2 ended on the ground, unhurt" in text
    assert "the same seeds without a kill: 2 of 2" in text
    assert "- seed 1, killed at 20.00 s in gps: hit an obstacle or the ground" in text
    assert "took 2.0 ms (median), 3.0 ms at most" in text
    assert "| gps       | in the air, in gps; the chart continues | 2 " in text
    assert "$" not in text


def test_checkpoints_are_timed():
    spent = resume.cost("corners")
    assert len(spent.took) > spent.ticks * 0.05
    assert 10_000 < spent.size < 500_000


def test_a_killed_flight_continues(tmp_path):
    run = survived(copied(tmp_path, "corners"), Kill(1, 200, 1.0))
    assert (run.outcome, run.landed, run.finished) == ("success", True, True)
    assert 8.9 <= run.saved_at <= 11.5
    assert "in the air, in gps" in run.resumed
