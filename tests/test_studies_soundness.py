"""The study of soundness, of a few charts."""

from __future__ import annotations

from studies.soundness import FLIGHTS, judged, page


def test_nothing_impossible_happens_and_every_run_that_is_found_does():
    # 22, 42: were wrong once; 20012: a timer was skipped; 20021: a variable is never unknown;
    # 500160: of independent regions only one flies
    found = [judged(seed) for seed in (9, 11, 22, 24, 42, 20012, 20021, 500160)]
    assert [each.apart for each in found] == [False] * 7 + [True]
    assert [each.contradictions for each in found] == [()] * len(found)
    assert sum(each.shown for each in found) > 10
    assert sum(each.without_run for each in found) <= 4  # of what is not excluded
    text = page(found, "command")
    assert "- Charts: 8, of which 8 were explored completely, and 1 have" in text
    assert f"flies each of them {FLIGHTS}\ntimes" in text
