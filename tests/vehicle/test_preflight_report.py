import json
import math

import pytest
from vehicle.flying import CORNERS
from vehicle.test_batteries import packs, said
from vehicle.test_ground_sensors import DOWN, RAD, RATE
from vehicle.test_obstacle_ring import ring

from missionkit.errors import VehicleError
from missionkit.geodesy import Origin
from missionkit.vehicle.autopilot_dialect import ARDUPILOT, PX4
from missionkit.vehicle.command.fence_upload import polygon, rally, set_fence
from missionkit.vehicle.failsafe_parameters import FailsafeLevel
from missionkit.vehicle.preflight.preflight_report import Findings, judged

SAFE = {
    "COM_OF_LOSS_T": 1.0, "COM_OBL_RC_ACT": 5.0, "NAV_DLL_ACT": 2.0,
    "COM_DL_LOSS_T": 10.0, "COM_LOW_BAT_ACT": 3.0, "BAT1_SOURCE": 0.0,
    "BAT_CRIT_THR": 0.07, "BAT_EMERGEN_THR": 0.05,
}  # fmt: skip
GOOD = Findings(
    armed=False,
    in_air=False,
    mode="hold",
    armable=True,
    sensors={"gyroscope": True, "GNSS": True},
    home={"latitude": 473977418, "longitude": 85455938, "altitude": 488000},
    local=dict.fromkeys(("x", "y", "z", "vx", "vy", "vz"), 0.01),
    fix={"fix_type": 3, "satellites_visible": 12, "h_acc": 1200},
    packs=packs(said(0, 95)),
    parameters=SAFE,
    date_gap=0.2,
    clock_rate=1.001,
)


def test_a_vehicle_without_faults_is_ready():
    report = judged("PX4", PX4, GOOD)
    assert report.level is FailsafeLevel.GOOD
    assert report.text().startswith("PX4: ready to fly")
    assert {check["level"] for check in json.loads(report.json())["checks"]} == {"good"}


LOST = {**GOOD.fix, "fix_type": 1}
PIXELS = {"flow_x": 12, "flow_rate_x": 0.0, "flow_rate_y": 0.0}
PRECISE = ("PLND_ENABLED",)
FAULTS = [
    (
        {"to_be_set": PRECISE, "parameters": {**SAFE, "PLND_ENABLED": 0.0}},
        *("PLND_ENABLED", FailsafeLevel.BAD, "would land by satellites"),
    ),
    ({"to_be_set": PRECISE}, "PLND_ENABLED", FailsafeLevel.WARNING, "could not be read"),
    ({"contested": True}, "system", FailsafeLevel.BAD, "two vehicles use the same system id"),
    ({"armed": None}, "state", FailsafeLevel.BAD, "no heartbeat"),
    ({"in_air": True}, "state", FailsafeLevel.WARNING, "already in the air"),
    ({"sensors": {"GNSS": False}}, "health", FailsafeLevel.BAD, "unhealthy: GNSS"),
    ({"armable": False}, "health", FailsafeLevel.BAD, "arming checks fail"),
    ({"armable": None}, "health", FailsafeLevel.WARNING, "does not say"),
    ({"home": None}, "home", FailsafeLevel.BAD, "wait for a fix"),
    ({"local": None}, "estimator", FailsafeLevel.BAD, "no local position"),
    ({"local": {**GOOD.local, "x": None}}, "estimator", FailsafeLevel.BAD, "not a number"),
    ({"local": {**GOOD.local, "vx": 1.2}}, "estimator", FailsafeLevel.BAD, "1.2 m/s on the ground"),
    ({"fix": None}, "gnss", FailsafeLevel.BAD, "no GNSS messages"),
    ({"fix": {**GOOD.fix, "fix_type": 1}}, "gnss", FailsafeLevel.BAD, "no 3D fix"),
    ({"fix": {**GOOD.fix, "satellites_visible": 6}}, "gnss", FailsafeLevel.WARNING, "6 satellites"),
    ({"packs": packs(said(0, 20))}, "battery", FailsafeLevel.BAD, "20%"),
    ({"packs": packs(said(0, -1))}, "battery", FailsafeLevel.WARNING, "unknown"),
    (
        {"packs": packs(said(0, 8), said(1, 95, 4))},
        "battery",
        FailsafeLevel.BAD,
        "8% (battery 0 for everything, 8%; not counted: battery 1 for payload, 95%)",
    ),
    (
        {"fix": {**GOOD.fix, "vel": 65535}},
        "gnss",
        FailsafeLevel.WARNING,
        "does not report its velocity",
    ),
    ({"fix": LOST, "second_fix": GOOD.fix}, "gnss", FailsafeLevel.GOOD, "of the second receiver"),
    ({"fix": LOST}, "gnss", FailsafeLevel.BAD, "missions do not take off without one"),
    ({"fix": LOST, "flow": RAD}, "gnss", FailsafeLevel.WARNING, "navigates by optical flow"),
    ({"home": None, "flow": RAD}, "home", FailsafeLevel.WARNING, "cannot return"),
    ({"sensors": {"GNSS": False}, "flow": RAD}, "health", FailsafeLevel.WARNING, "optical flow"),
    ({"rings": [ring({})]}, "obstacles", FailsafeLevel.GOOD, "72 of 72 directions, 12 m far"),
    ({"rings": [ring({}, frame=0)]}, "obstacles", FailsafeLevel.GOOD, "aligned with north"),
    ({"rings": [ring({}, frame=21)]}, "obstacles", FailsafeLevel.WARNING, "MAV_FRAME 21"),
    ({"flow": RAD, "ranges": [DOWN]}, "ground", FailsafeLevel.GOOD, "quality 204 of 255, a range"),
    ({"flow": RAD}, "ground", FailsafeLevel.WARNING, "no range finder down"),
    ({"ranges": [{**DOWN, "orientation": 0}]}, "ground", FailsafeLevel.GOOD, "face [0]"),
    ({"flow": {**RATE, **PIXELS}}, "ground", FailsafeLevel.WARNING, "flow_rate_x"),
    ({"date_gap": 3600.0}, "date", FailsafeLevel.WARNING, "+3600.0 s"),
    ({"clock_rate": 1.2}, "clock", FailsafeLevel.WARNING, "1.200"),
    (
        {"parameters": {**SAFE, "COM_OBL_RC_ACT": 7.0}},
        "COM_OBL_RC_ACT",
        FailsafeLevel.BAD,
        "rotors",
    ),
    (
        {"parameters": {**SAFE, "COM_OF_LOSS_T": 30.0}},
        "COM_OF_LOSS_T",
        FailsafeLevel.WARNING,
        "flies on",
    ),
    ({"parameters": {}}, "NAV_DLL_ACT", FailsafeLevel.WARNING, "could not be read"),
]


@pytest.mark.parametrize(("fault", "what", "level", "says"), FAULTS)
def test_each_fault_is_found_and_reported(fault, what, level, says):
    report = judged("PX4", PX4, GOOD._replace(**fault))
    (check,) = [check for check in report.checks if check.what == what]
    assert check.level is level
    assert says in check.says
    assert report.fit is (level is not FailsafeLevel.BAD)


def test_ardupilots_defaults_are_warned_about():
    found = GOOD._replace(parameters={"GUID_TIMEOUT": 3.0, "FS_EKF_ACTION": 0.0})
    levels = {check.what: check.level for check in judged("A", ARDUPILOT, found).checks}
    assert levels["GUID_TIMEOUT"] is FailsafeLevel.WARNING
    assert levels["FS_EKF_ACTION"] is FailsafeLevel.BAD


LOW, CRITICAL = ("BATT_LOW_VOLT", "BATT_LOW_MAH"), ("BATT_CRT_VOLT", "BATT_CRT_MAH")
ACTING = {
    "BATT_FS_LOW_ACT": 2.0, "BATT_FS_CRT_ACT": 1.0, "BATT_MONITOR": 4.0,
    "BATT_LOW_VOLT": 10.5, "BATT_LOW_MAH": 0.0, "BATT_CRT_VOLT": 0.0, "BATT_CRT_MAH": 200.0,
}  # fmt: skip


@pytest.mark.parametrize(
    ("dialect", "values", "what", "says"),
    [
        (ARDUPILOT, {"BATT_MONITOR": 0.0}, "BATT_MONITOR", "BATT_FS_LOW_ACT and BATT_FS_CRT_ACT"),
        (ARDUPILOT, dict.fromkeys(LOW, 0.0), LOW[0], "BATT_LOW_VOLT and BATT_LOW_MAH are both 0"),
        (ARDUPILOT, dict.fromkeys(CRITICAL, 0.0), CRITICAL[0], "BATT_FS_CRT_ACT has no effect"),
        (
            ARDUPILOT,
            {"BATT_MONITOR": 3.0},
            CRITICAL[0],
            "BATT_CRT_MAH 200 cannot act, because BATT_MONITOR 3 measures no current",
        ),
        (
            ARDUPILOT,
            {"BATT_MONITOR": 3.0, "BATT_LOW_VOLT": 0.0, "BATT_LOW_MAH": 300.0},
            LOW[0],
            "set BATT_LOW_VOLT (V), or BATT_MONITOR 4 if the current is measured",
        ),
        (ARDUPILOT, dict.fromkeys(LOW), LOW[0], "could not be read"),
        (PX4, {"BAT1_SOURCE": -1.0}, "BAT1_SOURCE", "COM_LOW_BAT_ACT has no effect"),
        (PX4, {"BAT_CRIT_THR": 0.0}, "BAT_CRIT_THR", "never counts as critical"),
        (PX4, {"BAT_EMERGEN_THR": 0.0}, "BAT_EMERGEN_THR", "never an emergency"),
    ],
)
def test_a_battery_failsafe_that_cannot_act_is_warned_about(dialect, values, what, says):
    def check(parameters):
        report = judged("A", dialect, GOOD._replace(parameters=parameters))
        (found,) = [it for it in report.checks if it.what == what]
        return found

    acting = {**SAFE, **ACTING}
    assert check(acting).level is FailsafeLevel.GOOD
    found = check({**acting, **values})
    assert found.level is FailsafeLevel.WARNING
    assert says in found.says


class Keeper:
    """A link that keeps what it is given, perhaps not all of it."""

    def __init__(self, loses=0):
        self.items, self.loses = (), loses

    def upload_fence(self, items):
        self.items = tuple(items)[self.loses :]

    def download_fence(self):
        return self.items


HOME = Origin(47.3977418, 8.5455938, 488.0)


def test_a_fence_is_uploaded_and_read_back():
    fence, link = polygon(HOME, CORNERS), Keeper()
    set_fence(link, fence)
    places = [HOME.local(1e-7 * item.x, 1e-7 * item.y, 0.0) for item in link.items]
    assert [round(place[0]) for place in places] == [-20, 120, 120, -20]
    assert [round(place[1]) for place in places] == [-40, -40, 60, 60]
    assert all(item.param1 == 4.0 and item.command == 5001 for item in link.items)


@pytest.mark.parametrize("loses", [1, 4])
def test_a_fence_that_reads_back_differently_is_not_relied_on(loses):
    with pytest.raises(VehicleError, match="do not rely on it"):
        set_fence(Keeper(loses), polygon(HOME, CORNERS))


def test_rally_points_are_above_home():
    (point,) = rally(HOME, [(10.0, -5.0, 15.0)])
    assert (point.command, point.frame, point.z, point.mission_type) == (5100, 3, 15.0, 2)
    assert math.isclose(HOME.local(1e-7 * point.x, 1e-7 * point.y, 0.0)[0], 10.0, abs_tol=0.02)


@pytest.mark.parametrize(
    ("declination", "level"), [(-2.0, FailsafeLevel.GOOD), (3.4, FailsafeLevel.WARNING)]
)
def test_the_filter_is_to_know_where_the_field_points(declination, level):
    report = judged("PX4", PX4, GOOD._replace(declination=declination))
    (check,) = (check for check in report.checks if check.what == "north")
    assert check.level is level
    assert ("declination_deg: 3}" in check.says) == (level is FailsafeLevel.WARNING)
