"""The tick: one pure function from memory and observation to memory, command and record.

    Observation -> Estimate -> Verdicts -> Configuration -> Command

No I/O, no clock, no randomness: the same memory and observations give the same flight. The shell
may pass a stopwatch to time the three parts (P1, section 9.1).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from missionkit.camera_pointing import angles_to
from missionkit.chart.semantics.arming_check import against_arming
from missionkit.chart.semantics.configuration import configuration
from missionkit.chart.semantics.quick_step import decide
from missionkit.engine import pause
from missionkit.engine.act import act
from missionkit.engine.behavior_handover import handed_over
from missionkit.engine.flight_state import BehaviorState, FlightMemory, SensorState
from missionkit.engine.ground_contact import with_ground_contact
from missionkit.engine.prepared_mission import PreparedMission
from missionkit.engine.sense import sense
from missionkit.messages import Action, Command, Estimate, Observation, Record
from missionkit.perception.vision_warning import begun
from missionkit.plugin_containment import Containment

CAUSES = "check accel_noise, gyro_noise, the marker's size and the lens in the mission"
TAKE_OFF_ACTIONS = frozenset((Action.ARM, Action.TAKE_OFF))
Stopwatch = Callable[[], float]


class Ticked(NamedTuple):
    """Result of one tick."""

    memory: FlightMemory
    command: Command
    record: Record
    took: tuple[float, float, float]  # s, sense, process, control; zeros without a stopwatch
    seen: Estimate  # what the chart was asked with
    stopped: float = 0.0  # s by which a pause put off the clocks of the chart before that
    grounded: str = ""  # why the vehicle is not armed although the mission wants it


def _no_stopwatch() -> float:
    return 0.0


def tick(
    plan: PreparedMission,
    memory: FlightMemory,
    observation: Observation,
    contain: Containment,
    stopwatch: Stopwatch = _no_stopwatch,
) -> Ticked:
    """Advance the mission by one observation.

    Args:
        plan: what flies.
        memory: as the previous tick left it; unchanged.
        observation: what arrived since.
        contain: runs plug-in code and collects its failures.
        stopwatch: s, for the timing in the record.
    """
    t0 = stopwatch()
    observation = with_ground_contact(observation, memory.senses.status, lands=memory.acting.lands)
    in_control = observation.in_control
    paused = pause.asked(memory.paused, observation.events)
    stopped = 0.0
    if pause.reason(plan.chart, memory.chart, by_operator=paused, in_control=in_control):
        stopped = observation.now - memory.now
        memory = memory._replace(chart=pause.stopped(memory.chart, stopped))
    senses, seen = sense(plan, memory, observation, contain)
    asked_with = seen
    t1 = stopwatch()
    chart, decision = decide(plan.chart, memory.chart, seen, contain)
    t2 = stopwatch()
    paused = paused and not pause.ended(plan.chart, chart, decision, seen.now)
    acting = memory.acting
    if decision.entered:
        before, after = memory.chart.pilot, chart.pilot
        acting = handed_over(plan.chart, acting, before, after, decision.moves)
        seen = seen.standing(chart.state, chart.entered_at, done=acting.done, goal=acting.goal)
    if not in_control:
        acting = pause.let_go(plan.law, acting, seen)
    why = pause.reason(plan.chart, chart, by_operator=paused, in_control=in_control)
    acting, command, step = act(plan, acting, seen, decision.orders, contain, why, chart.variables)
    grounded = ""
    if command.action in TAKE_OFF_ACTIONS and _on_ground(seen):
        if paused:
            command, step = (
                Command(payload=command.payload, orders=command.orders),
                step._replace(note=pause.BY_OPERATOR),
            )
        elif not plan.arm_anyway:
            grounded = against_arming(plan.chart, chart, seen, contain)
    if grounded:
        command = Command(payload=command.payload)
        step = step._replace(note=f"not taking off: {grounded}")
    command = _with_gimbal(command, plan, acting, seen)
    t3 = stopwatch()
    record = Record(
        now=seen.now,
        state=chart.state,
        active=chart.active,
        mode=configuration(plan.chart, chart.active).mode,
        verdicts=tuple(decision.answers.items()),
        fired=decision.fired,
        command=command,
        step_note=step.note,
        problems=observation.problems
        + decision.problems
        + _news(acting.failing, memory.acting.failing)
        + _misfit(senses, memory.senses)
        + _warnings(senses, memory.senses),
        estimate=seen,
        done=step.done,
        paused=paused,
        actions=() if observation.operator is None else observation.operator.actions,
    )
    following = FlightMemory(observation.now, senses, chart, acting, paused)
    took = (t1 - t0, t2 - t1, t3 - t2)
    return Ticked(following, command, record, took, asked_with, stopped, grounded)


def _with_gimbal(
    command: Command, plan: PreparedMission, acting: BehaviorState, seen: Estimate
) -> Command:
    """Return the command with what the gimbal is to be turned to, if it has an aim."""
    if acting.gimbal is None:
        return command
    return command._replace(gimbal=angles_to(acting.gimbal, plan.camera, seen))


def _on_ground(seen: Estimate) -> bool:
    return seen.status is None or not seen.status.in_air


def _news(now: tuple[str, ...], before: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(failure for failure in now if failure not in before)


def _misfit(now: SensorState, before: SensorState) -> tuple[str, ...]:
    """Return once in a flight that the sightings do not fit the filter's noise."""
    return (f"{now.misfit}: {CAUSES}",) if now.misfit and not before.misfit else ()


def _warnings(now: SensorState, before: SensorState) -> tuple[str, ...]:
    """Return once in an episode what the camera shows although it should not."""
    return tuple(it.message for it in begun(now.eye.warnings, before.eye.warnings))
