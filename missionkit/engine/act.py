"""Last part of the tick: from the active state to a command for the vehicle."""

from __future__ import annotations

from collections.abc import Sequence

from missionkit.chart.model.variables import Values
from missionkit.chart.semantics.compiled_chart import NO_VALUES, CompiledState
from missionkit.engine.behavior_parameters import Behaving, behaving
from missionkit.engine.control_law import ControlLaw, Controlled
from missionkit.engine.flight_state import BehaviorState
from missionkit.engine.position_hold import standing
from missionkit.engine.prepared_mission import PreparedMission
from missionkit.engine.step_validation import fault_of
from missionkit.messages import Action, Command, Estimate, Mode, Step
from missionkit.plugin_containment import Containment, is_foreign

HOLD_IDLE = Step(note="holding: no state commands")
HOLD_MISBEHAVIOUR = Step(note="holding: a plug-in misbehaves")
HOLD_DIVERGED = "holding: the estimate has diverged"
HOLD_BLIND = "holding: the obstacle scanner is silent"
LAND_MISBEHAVIOUR = Step(action=Action.LAND, note="landing: a plug-in misbehaves")


def act(
    plan: PreparedMission,
    acting: BehaviorState,
    seen: Estimate,
    orders: Sequence[Action],
    contain: Containment,
    pause: str = "",
    variables: Values = NO_VALUES,
) -> tuple[BehaviorState, Command, Step]:
    """Let the behaviour of the state that commands speak, and turn its answer into a command.

    While any plug-in misbehaves the vehicle holds, unless the autopilot is flying by itself
    (taking off, landing). It holds as well, without a place, while the estimate has diverged: no
    guidance leads to its goal from a position that is wrong.

    Args:
        plan: what flies.
        acting: of the state that commands.
        seen: what is known, with that state in it.
        orders: the chart's own commands to the autopilot; the last sane one counts.
        contain: keeps what went wrong.
        pause: why the behaviour pauses and the vehicle holds its place; "": it does not.
        variables: of the chart, which a behaviour that begins may take parameters from.
    """
    state = plan.chart.states[seen.state]
    if pause:
        mode, step = state.kind.mode, Step(note=pause, memory=acting.behavior)
    else:
        acting, mode, step = _answered(state, acting, variables, seen, contain)
    failing = contain.take()
    if failing and mode is not Mode.NONE:
        step = HOLD_MISBEHAVIOUR._replace(memory=acting.behavior, goal=acting.goal)
    mode = _flown(mode, step, seen)
    if mode is not Mode.NONE and seen.health.diverged:
        step = _without_goal(step)
    law = plan.law
    acting = law.noted(acting, seen)
    if mode is not Mode.NONE and law.blind(acting, step.guidance, seen):
        step = step._replace(guidance=None, done=False, note=HOLD_BLIND)
    if not step.stop:
        acting = standing(law, acting, mode, step.guidance, seen)
    command, control, avoidance = _commanded(law, mode, acting, step, seen, contain)
    if wrong := contain.take():  # the planner
        failing += wrong
        step = HOLD_MISBEHAVIOUR._replace(memory=step.memory, goal=step.goal)
        acting = standing(law, acting, mode, None, seen)
        command, control, _ = _commanded(law.without_planner(), mode, acting, step, seen, contain)
    following = BehaviorState(
        control,
        avoidance,
        behavior=step.memory,
        begun=acting.begun,
        done=step.done,
        goal=step.goal,
        failing=failing,
        events=step.events,
        paused=acting.paused,
        past=acting.past,
        held=acting.held,
        scan=acting.scan,
        lands=step.lands,
        chosen=step.chosen,
        gimbal=step.gimbal or acting.gimbal,
    )
    return following, _ordered(command, orders, seen), step


def _answered(
    state: CompiledState,
    acting: BehaviorState,
    variables: Values,
    seen: Estimate,
    contain: Containment,
) -> tuple[BehaviorState, Mode, Step]:
    """Return the behaviour's state, begun, the mode it is flown in, and its answer."""
    mode = state.kind.mode
    if state.behavior is None:
        return acting, Mode.GPS, HOLD_IDLE
    now = behaving(state, acting.behavior, variables, contain)
    if now is None:
        return acting, mode, _misbehaving(state)
    if not acting.begun:
        acting = _begun(acting, now, seen, contain)
        now = now._replace(memory=acting.behavior)
        acting = acting._replace(behavior=now.remembered(acting.behavior))
    step = _stepped(now, state, seen, contain)
    step = step._replace(memory=now.remembered(step.memory))
    return acting, Mode.GPS if mode is Mode.NONE and step.takes_over else mode, step


def _without_goal(step: Step) -> Step:
    """Return a step that leads nowhere: with an estimate that has diverged no place is known."""
    if step.guidance is None:
        return step._replace(bound=None)
    return step._replace(guidance=None, bound=None, done=False, note=HOLD_DIVERGED)


def _flown(mode: Mode, step: Step, seen: Estimate) -> Mode:
    """Return the mode in which a step is flown: NONE if the autopilot flies by itself."""
    on_ground = seen.status is None or not seen.status.in_air
    if step.action is not None or (on_ground and step.guidance is None):
        return Mode.NONE
    return Mode.GPS if step.stop else mode


def _ordered(command: Command, orders: Sequence[Action], seen: Estimate) -> Command:
    """Put the chart's own request into the command; nothing disarms in the air."""
    in_air = seen.status is None or seen.status.in_air
    sane = [order for order in orders if not (order is Action.DISARM and in_air)]
    if not sane:
        return command
    return Command(action=sane[-1], payload=command.payload, orders=command.orders)


def _begun(
    acting: BehaviorState, now: Behaving, seen: Estimate, contain: Containment
) -> BehaviorState:
    behavior = now.behavior
    boxed = contain.call(behavior.kind, behavior.begin, seen, foreign=is_foreign(behavior))
    memory = None if boxed is None else boxed[0]
    return acting._replace(behavior=memory, begun=True, done=False, goal=None)


def _stepped(now: Behaving, state: CompiledState, seen: Estimate, contain: Containment) -> Step:
    behavior, memory = now.behavior, now.memory
    boxed = contain.call(behavior.kind, behavior.step, seen, memory, foreign=is_foreign(behavior))
    wrong = "" if boxed is None else fault_of(boxed[0])
    if wrong:
        contain.note(f"{behavior.kind} returned {wrong}")
    if boxed is not None and not wrong:
        return boxed[0]
    return _misbehaving(state)


def _misbehaving(state: CompiledState) -> Step:
    return LAND_MISBEHAVIOUR if state.kind.name == "land" else HOLD_MISBEHAVIOUR


def _commanded(
    law: ControlLaw,
    mode: Mode,
    acting: BehaviorState,
    step: Step,
    seen: Estimate,
    contain: Containment,
) -> Controlled:
    if mode is Mode.NONE:
        command = Command(None, step.action, step.height, step.payload, orders=step.orders)
        if step.action is Action.PRECISION_LAND:
            command = command._replace(landing_target=step.landing_target)
        return Controlled(command, law.begin(), acting.avoidance)
    return law.command(acting, mode, step, seen, contain)
