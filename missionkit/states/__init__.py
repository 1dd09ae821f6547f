"""The kinds of state a mission is made of, each with its contract."""

from collections.abc import Mapping
from types import MappingProxyType

from missionkit.states.contract import StateKind
from missionkit.states.custom import CUSTOM
from missionkit.states.gps import GPS
from missionkit.states.hover import HOVER_STATE
from missionkit.states.idle import IDLE
from missionkit.states.land import LAND
from missionkit.states.logic import LOGIC
from missionkit.states.returning import RETURN
from missionkit.states.search import SEARCH
from missionkit.states.task import TASK
from missionkit.states.visual import VISUAL

KINDS: Mapping[str, StateKind] = MappingProxyType(
    {
        kind.name: kind
        for kind in (IDLE, GPS, VISUAL, SEARCH, TASK, RETURN, LAND, HOVER_STATE, CUSTOM, LOGIC)
    }
)
