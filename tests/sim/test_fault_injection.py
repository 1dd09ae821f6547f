from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from missionkit.errors import UsageError
from missionkit.sim.fault_injection import FAULT_KINDS, Fault, parse_fault
from missionkit.sim.world import Marker, Wind, World

Make = Callable[..., Any]
BOARD = (Marker(dictionary="DICT_4X4_50", id=3, size=0.5, position=(2.5, 0.0, 0.0)),)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("gnss_lost", Fault("gnss_lost")),
        ("gnss_lost@20+10", Fault("gnss_lost", None, 20.0, None, 10.0)),
        ("gnss_jump=8.5@gps", Fault("gnss_jump", 8.5, 0.0, "gps")),
        ("marker_hidden@visual:1.5+6", Fault("marker_hidden", None, 1.5, "visual", 6.0)),
        ("marker_hidden=all@3", Fault("marker_hidden", None, 3.0)),
        ("marker_hidden=23+4", Fault("marker_hidden", 23.0, 0.0, None, 4.0)),
        ("battery_sag@5", Fault("battery_sag", 0.3, 5.0)),
        ("gnss_drift=-0.2@near.trunk-2:3", Fault("gnss_drift", -0.2, 3.0, "near.trunk-2")),
    ],
)
def test_grammar(text: str, fault: Fault) -> None:
    assert parse_fault(text) == fault


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("gnss_los@3", "did you mean 'gnss_lost'"),
        ("gnss_lost=3@4", "takes no value"),
        ("gnss_jump=far", r"needs a number \(m\)"),
        ("gnss_jump=nan", "needs a number"),
        ("battery_sag=3", "takes 0 to 1"),
        ("camera_delayed=-1", "takes 0 to 60, got -1"),
        ("gnss_lost@20s", r"NAME\[=VALUE\]"),
        ("gnss_lost@visual+1.0+6", r"NAME\[=VALUE\]"),
        ("gnss_lost+", r"NAME\[=VALUE\]"),
        ("", "unknown fault ''"),
    ],
)
def test_mistakes_are_explained(text: str, complaint: str) -> None:
    with pytest.raises(UsageError, match=complaint):
        parse_fault(text)


def test_window_in_time_and_after_a_state() -> None:
    timed = parse_fault("gnss_lost@2+3")
    assert [timed.since(t, {}) for t in (1.9, 2.0, 4.5, 5.0)] == [None, 0.0, 2.5, None]
    waiting = parse_fault("gnss_lost@visual:1")
    assert waiting.since(99.0, {}) is None
    assert waiting.since(11.5, {"visual": 10.0}) == 0.5
    assert waiting.duration == math.inf


def test_every_kind_says_what_it_does() -> None:
    assert all(kind.effect for kind in FAULT_KINDS.values())


def frames_of(flight: Any, since: float = 0.0) -> list[Any]:
    return [seen.frame for seen in flight.seen if seen.frame and seen.now > since]


def board(perfect: World) -> World:
    return perfect.model_copy(update={"markers": BOARD})


def test_camera_frozen_repeats_the_last_frame(perfect: World, pilot: Make) -> None:
    flight = pilot(board(perfect), "camera_frozen@1+1", use="corners")
    flight.wait(3.0)
    stale = [
        f for f, seen in zip(frames_of(flight), flight.seen, strict=False) if 1.2 < seen.now < 2
    ]
    assert len(stale) > 10
    assert len({id(f) for f in stale}) == 1
    assert flight.seen[-1].frame.at > 2.8


def test_camera_off_gives_nothing(perfect: World, pilot: Make) -> None:
    flight = pilot(board(perfect), "camera_off@1+1", use="corners")
    flight.wait(3.0)
    times = [frame.at for frame in frames_of(flight)]
    assert not [t for t in times if 1.0 <= t < 2.0]
    assert [t for t in times if t >= 2.0]


def test_camera_delayed_arrives_later(perfect: World, pilot: Make) -> None:
    flight = pilot(board(perfect), "camera_delayed=0.4@1", use="corners", latency=0.05)
    flight.wait(3.0)
    late = {round(seen.now - seen.frame.at, 3) for seen in flight.seen[40:] if seen.frame}
    assert late == {0.45}


def test_marker_hidden_is_not_seen_for_that_long(perfect: World, pilot: Make) -> None:
    flight = pilot(board(perfect), "marker_hidden=3@visual:0.5+1", use="corners")
    flight.wait(1.0)
    flight.vehicle.entered("visual", 1.0)
    flight.vehicle.entered("visual", 9.0)
    flight.wait(3.0)
    blind = [f.at for f in frames_of(flight) if not f.corners]
    assert min(blind) == pytest.approx(1.5)
    assert max(blind) == pytest.approx(2.45)


def test_another_hidden_marker_changes_nothing(perfect: World, pilot: Make) -> None:
    flight = pilot(board(perfect), "marker_hidden=4", use="corners")
    flight.wait(1.0)
    assert all(frame.corners for frame in frames_of(flight))


def test_gnss_lost_gives_no_fix_and_no_arming(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect, "gnss_lost@1+2")
    flight.wait(4.0)
    times = [seen.gnss.at for seen in flight.seen if seen.gnss]
    assert not [t for t in times if 1.0 <= t < 3.0]
    assert max(times) > 3.0
    ready = {round(s.at, 2): s.ready for seen in flight.seen if (s := seen.status)}
    assert not ready[2.0]
    assert ready[3.6]


def test_gnss_jump_and_drift_go_north(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect, "gnss_jump=5@2", "gnss_drift=0.5@4")
    flight.wait(10.0)
    north = {round(f.at, 1): f.position[0] for seen in flight.seen if (f := seen.gnss)}
    assert north[1.8] == 0.0
    assert north[3.0] == pytest.approx(5.0)
    assert north[8.0] == pytest.approx(5.0 + 2.0)


def test_link_lost_silences_telemetry_but_not_sensors(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect, "link_lost@2+2")
    flight.wait(6.0)
    silent = [seen for seen in flight.seen if 2.0 <= seen.now < 4.0]
    assert not any(seen.status or seen.battery for seen in silent)
    assert all(seen.imu for seen in silent)
    assert flight.seen[-1].status


def test_gnss_toggling_loses_every_other_half(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect, "gnss_toggling=2@2")
    flight.wait(6.0)
    times = {round(seen.gnss.at, 3) for seen in flight.seen if seen.gnss}
    lost = [t for t in np.arange(0.4, 5.8, 0.2).round(3) if t not in times]
    assert lost == [2.0, 2.2, 2.4, 2.6, 2.8, 4.0, 4.2, 4.4, 4.6, 4.8]


def test_a_barometer_that_is_stuck_repeats_itself_while_it_climbs(
    perfect: World, pilot: Make
) -> None:
    flight = pilot(perfect, "baro_stuck@3+4")
    flight.rise(5.0)
    heights = {round(b.at, 1): b.height for seen in flight.seen if (b := seen.baro)}
    assert len({heights[t] for t in (3.0, 3.5, 5.0, 6.9)}) == 1
    assert heights[7.1] - heights[6.9] > 1.0
    assert max(heights) > 7.5


def test_range_lost_says_nothing_in_flight(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect, "range_lost@6+2")
    flight.rise()
    times = [seen.range.at for seen in flight.seen if seen.range]
    assert not [t for t in times if 6.0 <= t < 8.0]
    assert [t for t in times if t < 6.0]
    assert [t for t in times if t >= 8.0]


def test_imu_biased_adds_to_the_forward_axis(perfect: World, pilot: Make) -> None:
    still = pilot(perfect, "imu_biased=1.5@1+1")
    still.wait(3.0)
    forwards = {round(i.at, 2): i.accel[0] for seen in still.seen for i in seen.imu}
    assert forwards[0.9] == forwards[2.5] == pytest.approx(0.0, abs=1e-9)
    assert forwards[1.5] == pytest.approx(1.5)


@pytest.mark.parametrize("use", ["corners", "rendered"])
def test_camera_flipped_turns_pictures_and_corners_by_half_a_turn(
    use: str, perfect: World, pilot: Make
) -> None:
    flights = [pilot(board(perfect), *faults, use=use) for faults in ((), ("camera_flipped",))]
    for flight in flights:
        flight.wait(0.5)
    upright, flipped = (frames_of(flight)[-1] for flight in flights)
    if use == "corners":
        (_, _, before), (_, _, after) = upright.corners[0], flipped.corners[0]
        np.testing.assert_allclose(after, np.array([639.0, 479.0]) - before, atol=1e-9)
    else:
        np.testing.assert_array_equal(flipped.image, upright.image[::-1, ::-1])


def test_battery_sag_stays(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect, "battery_sag=0.4@2+1")
    flight.wait(6.0)
    charges = {b.at: b.charge for seen in flight.seen if (b := seen.battery)}
    assert charges[1.0] == 1.0
    assert charges[3.0] == charges[6.0] == pytest.approx(0.6)


def test_wind_gust_pushes_along_the_mean_wind(perfect: World, pilot: Make) -> None:
    world = perfect.model_copy(update={"wind": Wind(mean=(0.0, 1.0, 0.0))})
    moved = []
    for faults in ((), ("wind_gust=8@10+1",)):
        flight = pilot(world, *faults)
        flight.rise()
        flight.wait(max(0.0, 11.0 - flight.vehicle.now))
        moved.append(flight.vehicle.truth.velocity)
    push = moved[1] - moved[0]
    assert push[1] > 0.1
    assert abs(push[0]) < 0.05 * push[1] + 1e-3
    assert np.isfinite(push).all()


def test_a_velocity_bias_is_flown_after_until_it_ends_and_turns_once_a_minute(
    perfect: World, pilot: Make
) -> None:
    flight = pilot(perfect, "velocity_bias=0.25@10+62")
    flight.rise()
    flight.fly((0.0, 0.0, 0.0), 64.0)
    velocity = {round(row[0], 2): row[4:6] for row in flight.vehicle.track.rows}
    assert abs(velocity[9.9]).max() < 0.02
    assert velocity[25.0] == pytest.approx([0.0, -0.25], abs=0.03)  # it believes it goes east
    assert velocity[40.0] == pytest.approx([0.25, 0.0], abs=0.03)
    assert velocity[70.0] == pytest.approx([-0.25, 0.0], abs=0.03)
    flight.fly((0.0, 0.0, 0.0), 8.0)
    assert flight.vehicle.truth.velocity == pytest.approx([0.0, 0.0, 0.0], abs=0.02)


def test_a_slow_velocity_loop_leans_in_steps(perfect: World, pilot: Make) -> None:
    leans = []
    for faults in ((), ("control_slow=0.4",)):
        flight = pilot(perfect, *faults)
        flight.rise()
        flight.fly((1.0, 0.0, 0.0), 0.25)
        leans.append(abs(flight.vehicle.truth.attitude[2]))
    assert leans[0] > 0.05
    assert leans[1] < 0.5 * leans[0]  # not yet, or only just, its turn
