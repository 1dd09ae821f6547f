"""Touching the ground: a failsafe, but where the behaviour leads there on purpose."""

from __future__ import annotations

import pytest

from missionkit.engine.ground_contact import with_ground_contact
from missionkit.messages import GROUND_TOUCHED, Observation, VehicleStatus

FLYING = VehicleStatus(1.0, armed=True, in_air=True, ready=True, mode="offboard")


@pytest.mark.parametrize(("lands", "events"), [(False, (GROUND_TOUCHED,)), (True, ())])
def test_a_touch_is_reported_unless_the_behaviour_leads_to_the_ground(lands, events):
    seen = Observation(1.1, status=FLYING._replace(in_air=False))
    assert with_ground_contact(seen, FLYING, lands=lands).events == events
