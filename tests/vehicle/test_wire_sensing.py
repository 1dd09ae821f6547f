"""Satellites and wind, in flight, over the wire; judged by where the vehicle really was."""

import numpy as np
import pytest
from vehicle.flying import BRISK, sitl
from vehicle.on_a_mission import fly_mission, stay, strike

from missionkit.engine.flight_end import FlightEnd

LOST = "{use: gnss_lost, longer_than: 2}"


def away(truth):
    """Return how far (m) it is from where it took off."""
    return float(np.hypot(*truth["position"][:2]))


def test_without_satellites_the_mission_lands_before_the_autopilot_has_to(tmp_path):
    with sitl(speed=BRISK) as autopilot:
        mission = fly_mission(autopilot, stay(failsafe=LOST), tmp_path, {"up": strike("gnss_lost")})
        truth = autopilot.truth
    assert mission.flown.end is FlightEnd.LANDED
    assert mission.reasons[-1] == "failsafe mishap"
    assert 1.0 < mission.began["land"][0] - mission.began["up"][0] < 3.0
    assert "failsafe_takeover" not in mission.events
    assert truth["on_ground"]
    assert not truth["crashed"]
    assert away(truth) < 1.5


@pytest.mark.parametrize(("dialect", "after"), [("px4", 3.0), ("ardupilot", 10.0)])
def test_the_autopilot_lands_without_satellites_and_is_not_taken_for_a_pilot(
    dialect, after, tmp_path
):
    patience = {"EKF2_NOAID_TOUT": 3e6} if dialect == "px4" else {}
    with sitl(dialect, BRISK) as autopilot:
        lost = strike("gnss_lost", **patience)
        mission = fly_mission(autopilot, stay(), tmp_path, {"up": lost})
        since = mission.began["up"][1]
        (mode,) = autopilot.notes("mode", since + 1.0)
        late = autopilot.notes("setpoint", mode["at"] + 3.0)
        truth = autopilot.truth
    assert mode["which"] == "LAND"
    assert mode["at"] - since == pytest.approx(after, abs=0.5)
    assert "failsafe_takeover" in mission.events
    assert "pilot_takeover" not in mission.events
    assert late == []
    assert mission.flown.end is FlightEnd.GROUNDED
    assert not truth["crashed"]


def test_a_fix_that_jumps_is_not_flown_after(tmp_path):
    with sitl(speed=BRISK) as autopilot:
        mission = fly_mission(
            autopilot, stay(failsafe=LOST), tmp_path, {"up": strike("gnss_jump=20")}
        )
        truth = autopilot.truth
    assert mission.reasons[-1] == "failsafe mishap"
    assert mission.flown.end is FlightEnd.LANDED
    assert away(truth) < 3.0
    assert not truth["crashed"]


def test_fixes_that_wander_off_do_not_take_it_along_faster_than_they_do(tmp_path):
    with sitl("ardupilot") as autopilot:
        mission = fly_mission(autopilot, stay(after=5), tmp_path, {"up": strike("gnss_drift=0.5")})
        truth = autopilot.truth
        speeds = autopilot.speeds(mission.began["up"][1])[1]
    assert mission.flown.end is FlightEnd.LANDED
    assert away(truth) < 1.5  # five seconds of it amount to 2.5
    assert max(speeds) < 1.0
    assert not truth["crashed"]


@pytest.mark.parametrize(
    ("fault", "most"),
    [("baro_stuck", 1.5), ("gnss_toggling=2", 1.5), ("range_lost", 1.5), ("imu_biased=2", 6.0)],
)
def test_a_sensor_that_fails_is_flown_without(fault, most, tmp_path):
    with sitl(speed=BRISK) as autopilot:
        text = stay(after=6, more="{to: land, when: estimate_bad}, ")
        mission = fly_mission(autopilot, text, tmp_path, {"up": strike(fault)})
        assert "up" in mission.began, (mission.reasons, mission.problems)
        since = mission.began["up"][1]
        rows = np.array(autopilot.ask(track=True, since=since)["rows"], dtype=float)
        truth = autopilot.truth
    assert mission.flown.end is FlightEnd.LANDED
    assert away(truth) < most
    assert -rows[:, 3].min() < 3.0
    assert not truth["crashed"]


def test_a_gust_is_held_against(tmp_path):
    with sitl(speed=BRISK) as autopilot:
        mission = fly_mission(autopilot, stay(after=4), tmp_path, {"up": strike("wind_gust=6+2")})
        since = mission.began["up"][1]
        rows = np.array(autopilot.ask(track=True, since=since)["rows"], dtype=float)
        truth = autopilot.truth
    assert mission.flown.end is FlightEnd.LANDED
    pushed = np.hypot(rows[:, 1] - rows[0, 1], rows[:, 2] - rows[0, 2]).max()
    assert 0.2 < pushed < 2.0
    assert not truth["crashed"]
