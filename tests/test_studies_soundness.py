"""The study of soundness, of a few charts."""

from __future__ import annotations

from studies.soundness import FLIGHTS, judged, page


def test_nothing_impossible_happens_and_what_can_happen_does():
    found = [judged(seed) for seed in (9, 11, 22, 24, 35, 42)]  # 22, 42: were wrong once
    assert [each.contradictions for each in found] == [()] * len(found)
    assert sum(each.missed[0] for each in found) == 0
    assert sum(each.happened[0] for each in found) > 10
    text = page(found, "command")
    assert "- Charts: 6, of which 6" in text
    assert f"flies each of them {FLIGHTS}\ntimes" in text
