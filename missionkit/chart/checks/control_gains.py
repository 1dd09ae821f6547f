"""Gains with which the controller and the vehicle together never come to rest."""

from __future__ import annotations

import math
from collections.abc import Iterator

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.control.closed_loop import ClosedLoop, loops, slowest_pole
from missionkit.errors import Level, Place, Problem
from missionkit.messages import Mode
from missionkit.number_text import beside


def modes_of(mission: Mission, catalogue: Catalogue) -> list[Mode]:
    """Return the control modes of a mission's states, in a fixed order."""
    used = {catalogue.kinds[state.kind].mode for _, state, _ in mission.walk()}
    return [mode for mode in Mode if mode in used and mode is not Mode.NONE]


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield each mode and axis whose closed loop has an eigenvalue of modulus 1 or more."""
    mission = chart.mission
    control, rate = mission.velocity_control, mission.settings.rate
    if control is None:
        return
    place = mission.place("control")
    for mode in modes_of(mission, chart.tree.catalogue):
        for axis, loop in loops(control, mode, rate).items():
            pole = slowest_pole(loop.matrix())
            if abs(pole) >= 1.0:
                yield _unstable(place, f"{mode}, {axis}", loop, rate, pole)
    turns = 1.0 - control.yaw.gain / rate
    if abs(turns) >= 1.0:
        yield Problem(
            place,
            f"control, yaw: with a gain of {control.yaw.gain:g} /s at {rate:g} Hz the heading does "
            f"not come to rest: eigenvalue {turns:.3g}, its modulus must be below 1",
            Level.ERROR,
            "unstable-gains",
            f"a gain below {2.0 * rate:g}",
        )


def _unstable(place: Place, what: str, loop: ClosedLoop, rate: float, pole: complex) -> Problem:
    size, _ = beside(abs(pole), 1.0, 3)
    turns = abs(math.atan2(pole.imag, pole.real)) * rate / (2.0 * math.pi)
    way = f"swings at {turns:.2g} Hz" if turns > 0.0 else "grows"
    return Problem(
        place,
        f"control, {what}: kp {loop.kp:g}, ki {loop.ki:g} and kd {loop.kd:g} with a vehicle that "
        f"answers {loop.response.lag + loop.response.inner:.2g} s late, at {rate:g} Hz, do not "
        f"come to rest: the error {way}, largest eigenvalue {size}, which must be below 1",
        Level.ERROR,
        "unstable-gains",
        "smaller gains, most of all ki, or a truer 'control: {limits: {lag: ...}}'",
    )
