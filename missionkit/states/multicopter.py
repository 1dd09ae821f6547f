"""Multicopter: takes off, flies velocities, lands."""

from types import MappingProxyType

from missionkit.states.custom import CUSTOM
from missionkit.states.gps import GPS
from missionkit.states.hover import HOVER_STATE
from missionkit.states.idle import IDLE
from missionkit.states.land import LAND
from missionkit.states.logic import LOGIC
from missionkit.states.returning import RETURN
from missionkit.states.search import SEARCH
from missionkit.states.task import TASK
from missionkit.states.vehicle_kind import VehicleKind
from missionkit.states.visual import VISUAL

MULTICOPTER = VehicleKind(
    name="sim",
    summary="A multicopter, simulated; `--vehicle` replaces it by a real one.",
    ended="landed",
    setpoint="velocity",
    sections=MappingProxyType(
        {
            "navigation": "visual_inertial_ekf",
            "avoid": "potential_field",
            "control": "velocity_pid",
        }
    ),
    kinds=MappingProxyType(
        {
            kind.name: kind
            for kind in (IDLE, GPS, VISUAL, SEARCH, TASK, RETURN, LAND, HOVER_STATE, CUSTOM, LOGIC)
        }
    ),
    estimate_limit=3.0,
    ending_limit=5.0,
    over_mavlink=True,
    over_ground=True,
)
