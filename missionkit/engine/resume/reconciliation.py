"""Reconciles a saved memory with the vehicle that is found on resume.

Since the last checkpoint the vehicle had no commands. Where chart and vehicle disagree
the vehicle is right, and the answer is the one that ends on the ground: nothing that has landed
is armed again, and a pilot who has taken over is left alone. The cases are in `CASES`, the
first that applies counts.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import NamedTuple

from missionkit.behaviors.take_off import TakeOff
from missionkit.chart.semantics.chart_memory import ChartMemory
from missionkit.chart.semantics.configuration import SAFETY, configuration
from missionkit.chart.semantics.step import ABORT
from missionkit.engine.flight_state import FlightMemory, FlightState
from missionkit.engine.prepared_mission import PreparedMission
from missionkit.engine.resume.restore_chart import fitted
from missionkit.errors import VehicleError
from missionkit.messages import VehicleStatus

MISSION_MODES = frozenset(("hold", "offboard", "take_off", "land", "precision_land"))
"""Modes that are not a pilot's."""

FAILSAFE_MODES = frozenset(("return", "smart_return", "brake"))  # modes that failsafes choose too


class ResumeAction(Enum):
    """Action taken on resume."""

    GO_ON = "the chart continues"
    LAND = "landing"
    LEAVE = "nothing is commanded"


class VehicleFacts(NamedTuple):
    """Facts about vehicle and chart on which the decision to resume depends."""

    status: VehicleStatus | None  # heard since
    state: str  # that commands
    flying: bool  # the chart believes to fly
    landing: bool  # the chart lands
    climbing: bool  # the chart takes off, and the estimate is sound
    flown: bool  # was armed or in the air before
    placed: bool  # the configuration is one of the chart's
    lost: bool  # the estimate has diverged


class ResumeCase(NamedTuple):
    """One way in which chart and vehicle agree or not."""

    says: str
    then: ResumeAction
    applies: Callable[[VehicleFacts, VehicleStatus], bool]


CASES: tuple[ResumeCase, ...] = (
    ResumeCase(
        "the autopilot's own failsafe is in control, mode {mode}",
        ResumeAction.LEAVE,
        lambda _, s: s.in_air and s.failsafe and s.mode not in MISSION_MODES,
    ),
    ResumeCase(
        "a pilot or the autopilot's own failsafe is in control, mode {mode}",
        ResumeAction.LEAVE,
        lambda _, s: s.in_air and s.mode in FAILSAFE_MODES,
    ),
    ResumeCase(
        "a pilot is in control, mode {mode}",
        ResumeAction.LEAVE,
        lambda _, s: s.in_air and s.mode not in MISSION_MODES,
    ),
    ResumeCase("in the air, landing", ResumeAction.GO_ON, lambda it, s: s.in_air and it.landing),
    ResumeCase(
        "the autopilot is landing",
        ResumeAction.LAND,
        lambda _, s: s.in_air and s.mode in {"land", "precision_land"},
    ),
    ResumeCase(
        "in the air, in a state that the chart no longer has",
        ResumeAction.LAND,
        lambda it, s: s.in_air and not it.placed,
    ),
    ResumeCase(
        "in the air, in {state}, and the estimate has diverged",
        ResumeAction.LAND,
        lambda it, s: s.in_air and it.flying and it.lost,
    ),
    ResumeCase("in the air, in {state}", ResumeAction.GO_ON, lambda it, s: s.in_air and it.flying),
    ResumeCase(
        "in the air, taking off", ResumeAction.GO_ON, lambda it, s: s.in_air and it.climbing
    ),
    ResumeCase(
        "in the air, although the chart was on the ground in {state}",
        ResumeAction.LAND,
        lambda _, s: s.in_air,
    ),
    ResumeCase(
        "on the ground, disarmed: the flight is over",
        ResumeAction.LAND,
        lambda it, s: not s.armed and (it.flying or it.flown),
    ),
    ResumeCase("on the ground, before take-off", ResumeAction.GO_ON, lambda _, s: not s.armed),
    ResumeCase("on the ground, landing", ResumeAction.GO_ON, lambda it, _: it.landing),
    ResumeCase(
        "on the ground, although the chart was flying in {state}",
        ResumeAction.LAND,
        lambda it, _: it.flying,
    ),
    ResumeCase("on the ground, armed, in {state}", ResumeAction.GO_ON, lambda _, __: True),
)


class ResumedFlight(NamedTuple):
    """State with which the flight resumes."""

    course: FlightState
    events: tuple[str, ...]  # for the first tick
    notes: tuple[str, ...]


def reconciled(
    plan: PreparedMission, saved: FlightState, heard: FlightMemory, *, changed: bool = False
) -> ResumedFlight:
    """Fit a saved course to what the vehicle does now.

    Args:
        plan: what flies.
        saved: the course as it was saved.
        heard: its memory, with the sensor data since.
        changed: the mission is not the one that was flown.

    Raises:
        VehicleError: the vehicle is to be left alone; nothing was commanded.
    """
    before = saved.memory
    gap = heard.now - before.now
    chart, placed, notes = fitted(plan.chart, heard.chart, heard.now, gap, changed=changed)
    fresh = heard.senses.status
    if fresh is not None and fresh.at <= before.now:
        fresh = None
    facts = _facts(plan, saved, chart, heard, fresh, placed=placed)
    says, then = _judged(facts)
    if then is ResumeAction.LAND and not plan.chart.land:
        then = ResumeAction.LEAVE
    summary = f"resumed after {gap:.2f} s: {says}; {then.value}"
    if then is ResumeAction.LEAVE:
        raise VehicleError(summary)
    memory = _handed_back(plan, before, heard._replace(chart=chart), fresh, restart=changed)
    events = (ABORT,) if then is ResumeAction.LAND else ()
    return ResumedFlight(
        saved._replace(memory=memory, grounded_since=None), events, (summary, *notes)
    )


def _judged(facts: VehicleFacts) -> tuple[str, ResumeAction]:
    status = facts.status
    if status is None:
        return "the vehicle is silent", ResumeAction.LAND
    case = next(case for case in CASES if case.applies(facts, status))
    return case.says.format(mode=status.mode, state=facts.state), case.then


def _facts(
    plan: PreparedMission,
    saved: FlightState,
    chart: ChartMemory,
    heard: FlightMemory,
    fresh: VehicleStatus | None,
    *,
    placed: bool,
) -> VehicleFacts:
    here = configuration(plan.chart, chart.active)
    behavior = plan.chart.states[chart.state].behavior
    health = plan.navigator.read(heard.senses.navigation).health
    return VehicleFacts(
        fresh,
        chart.state,
        here.flying,
        here.safety == SAFETY["land"],
        isinstance(behavior, TakeOff) and health.aligned and not health.diverged,
        saved.flown or saved.memory.senses.home is not None,
        placed,
        health.diverged,
    )


def _handed_back(
    plan: PreparedMission,
    before: FlightMemory,
    now: FlightMemory,
    fresh: VehicleStatus | None,
    *,
    restart: bool,
) -> FlightMemory:
    """Return the memory to tick with: control starts from how the vehicle moves now."""
    state = plan.navigator.read(now.senses.navigation)
    acting = now.acting._replace(control=plan.law.moving(state.velocity))
    if restart:
        acting = acting._replace(behavior=None, begun=False, done=False, goal=None)
        acting = acting._replace(paused={}, past={})
        acting = acting._replace(avoidance=plan.law.begin_avoidance())
    senses = now.senses
    if restart:
        senses = senses._replace(tracking=None)
    if fresh is not None and fresh.in_air and before.senses.home is None:
        home = plan.navigator.read(before.senses.navigation).position  # where it stood
        senses = senses._replace(home=home)
    return now._replace(senses=senses, acting=acting)
