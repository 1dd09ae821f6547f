"""Imported by the process from which workers are forked: all of them share what it has loaded."""

from __future__ import annotations

import missionkit.campaigns.single_run  # noqa: F401
from missionkit.estimation import warm_up as filters
from missionkit.sim import warm_up as simulator

filters.warm_up()
simulator.warm_up(corners=True)
