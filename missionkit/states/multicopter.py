"""Multicopter: takes off, flies velocities, lands."""

from types import MappingProxyType

from missionkit.states.custom import CUSTOM_KIND
from missionkit.states.gps import GPS_KIND
from missionkit.states.hover import HOVER_STATE
from missionkit.states.idle import IDLE_KIND
from missionkit.states.land import LAND_KIND
from missionkit.states.logic import LOGIC
from missionkit.states.returning import RETURN_KIND
from missionkit.states.search import SEARCH
from missionkit.states.task import TASK
from missionkit.states.vehicle_kind import VehicleKind
from missionkit.states.visual import VISUAL

MULTICOPTER = VehicleKind(
    name="sim",
    summary="A multicopter, simulated; `--vehicle` replaces it by a real one.",
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
            for kind in (
                IDLE_KIND,
                GPS_KIND,
                VISUAL,
                SEARCH,
                TASK,
                RETURN_KIND,
                LAND_KIND,
                HOVER_STATE,
                CUSTOM_KIND,
                LOGIC,
            )
        }
    ),
    estimate_limit=3.0,
    ending_limit=5.0,
    over_mavlink=True,
    over_ground=True,
)
