"""How the controller and the vehicle together come to rest, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator

from missionkit.chart.checks.control_gains import modes_of
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.control.closed_loop import (
    LARGEST_MARGIN,
    ClosedLoop,
    gain_margin,
    loops,
    lyapunov,
    settling_time,
    slowest_pole,
)


def control_text(mission: Mission, catalogue: Catalogue) -> Iterator[str]:
    """Yield for each control mode that the mission uses, and each axis, how it comes to rest."""
    control = mission.velocity_control
    if control is None:
        return
    for mode in modes_of(mission, catalogue):
        for axis, loop in loops(control, mode, mission.settings.rate).items():
            yield f"{mode}, {axis}: {_rest(loop)}."


def _rest(loop: ClosedLoop) -> str:
    A = loop.matrix()
    pole = slowest_pole(A)
    if lyapunov(A) is None:
        return f"it does not come to rest, largest eigenvalue {abs(pole):.3f}"
    margin = gain_margin(loop)
    shown = f"{margin:.3g}" if margin < LARGEST_MARGIN else f"more than {LARGEST_MARGIN:g}"
    falls = f"the slowest pole, {abs(pole):.3f}, falls to 1/e in {_seconds(loop, pole)} s"
    return f"it comes to rest: {falls}; gain margin {shown} ({20.0 * math.log10(margin):.0f} dB)"


def _seconds(loop: ClosedLoop, pole: complex) -> str:
    return f"{settling_time(pole, loop.period):.2g}"
