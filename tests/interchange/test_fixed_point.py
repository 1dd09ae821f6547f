"""A mission written as a plan and read back is the same mission, again and again."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from plans import exported, imported, plans

from missionkit.interchange.mission_text import mission_text
from missionkit.interchange.plan_formats import WRITERS

WHOLE = (".plan", ".kml", ".kmz", ".geojson")  # formats that say everything but a ceiling


@pytest.mark.parametrize("suffix", sorted(WRITERS))
@settings(max_examples=8, deadline=None)
@given(plan=plans())
def test_import_export_import_is_a_fixed_point(suffix, plan):
    _, writer = WRITERS[suffix]
    first, _ = imported(exported(mission_text(plan, "plan"), writer)[0])
    raw, ledger = exported(first, writer)
    second, back = imported(raw)
    assert second == first
    for it in (ledger, back):
        assert sum(it.counts().values()) == len(it.entries)
    assert exported(second, writer)[0] == raw


@pytest.mark.parametrize("suffix", WHOLE)
@settings(max_examples=8, deadline=None)
@given(plan=plans())
def test_what_a_format_can_say_comes_back_as_it_was(suffix, plan):
    if suffix == ".plan" and plan.fence is not None:
        plan = plan._replace(fence=None)
    heights = {it.place.reference for it in plan.rally}
    if suffix == ".plan" and heights != {"above_home"}:
        plan = plan._replace(rally=())
    text = mission_text(plan, "plan")
    raw, _ = exported(text, WRITERS[suffix][1])
    assert imported(raw)[0] == text
