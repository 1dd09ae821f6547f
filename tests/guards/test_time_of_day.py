"""The time of day: windows, midnight, local time, and where the vehicle has it from."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import pytest
from samples import HOP, calm

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.errors import FileError
from missionkit.guards.time_of_day import TimeOfDay
from missionkit.rehearsal.stage import stage, world_of

NOON = datetime(2026, 6, 1, 12, tzinfo=UTC)


def answer(guard, hours):
    return guard.check(calm(utc=(NOON + timedelta(hours=hours - 12.0)).timestamp()))


@pytest.mark.parametrize(
    ("window", "hour", "holds", "margin"),
    [
        (("08:00", "17:30"), 12.0, True, 4.0),
        (("08:00", "17:30"), 8.0, True, 0.0),
        (("08:00", "17:30"), 17.5, False, 0.0),
        (("08:00", "17:30"), 7.0, False, -1.0),
        (("22:00", "06:00"), 23.5, True, 1.5),
        (("22:00", "06:00"), 1.0, True, 3.0),
        (("22:00", "06:00"), 12.0, False, -6.0),
        (("11:59:59", "12:00:01"), 12.0, True, 1.0 / 3600.0),
    ],
)
def test_it_holds_within_its_window(window, hour, holds, margin):
    verdict = answer(TimeOfDay(after=window[0], before=window[1]), hour)
    assert (verdict.holds, verdict.value) == (holds, pytest.approx(hour))
    assert verdict.margin == pytest.approx(margin)


@pytest.mark.parametrize(("offset", "holds"), [(0.0, False), (5.5, True), (-8.0, False)])
def test_local_time_is_ahead_of_utc(offset, holds):
    guard = TimeOfDay(after="17:00", before="18:00", utc_offset=offset)
    assert answer(guard, 12.0).holds is holds


def test_without_a_time_it_is_unknown():
    verdict = TimeOfDay(after="08:00", before="17:30").check(calm())
    assert (verdict.holds, verdict.why) == (None, "the time of day is not known")


@pytest.mark.parametrize("clock", ["8:00", "24:00", "12:60", "noon"])
def test_a_time_that_is_none_is_refused(clock):
    with pytest.raises(ValueError, match="pattern"):
        TimeOfDay(after=clock, before="17:30")


@pytest.mark.parametrize(
    ("date", "utc"), [("", None), ("settings: {date: '2026-06-01T14:00:00+02:00'}\n", NOON)]
)
def test_a_simulated_flight_has_the_date_of_the_mission(date, utc):
    mission = parse(HOP.replace("initial: idle\n", f"{date}initial: idle\n"), "hop.yaml", builtin())
    ready = stage(mission, builtin(), world_of(mission, None), 1)
    seen = ready.vehicle.advance(0.25)
    assert seen.utc == (None if utc is None else pytest.approx(utc.timestamp() + 0.25))


@pytest.mark.parametrize("date", ["2026-06-01T14:00:00", "tomorrow"])
def test_a_date_without_a_zone_is_refused(date):
    text = HOP.replace("initial: idle\n", f"settings: {{date: '{date}'}}\ninitial: idle\n")
    with pytest.raises(FileError, match="expected a date with time and zone"):
        parse(text, "hop.yaml", builtin())
