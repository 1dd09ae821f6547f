"""The shell around the tick: observes, ticks, commands, reports, until the flight has ended."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AsyncExitStack, nullcontext
from dataclasses import replace

from missionkit.chart.semantics.step import ABORT
from missionkit.engine.clock import Pace, Unhurried, processor_time, stopwatch
from missionkit.engine.flight_end import FlightEnd, FlightWatch, FlownFlight
from missionkit.engine.flight_state import FlightState
from missionkit.engine.prepared_mission import PreparedMission, begin
from missionkit.engine.resume.reconciliation import ResumedFlight
from missionkit.engine.resume.resumption import Resumption, resume_flight
from missionkit.engine.run_lifecycle import Lifecycle
from missionkit.engine.tick import Ticked, tick
from missionkit.engine.timed_containment import TimedContainment
from missionkit.errors import UsageError
from missionkit.messages import (
    RETURN_HOME,
    Cycle,
    Observation,
    OperatorReport,
    Record,
    is_event,
)
from missionkit.plugin_containment import Interrupted, described, marking_interrupts
from missionkit.ports import Vehicle

Observer = Callable[[Record, Observation], None]
Keeper = Callable[[FlightState, Record], None]


def no_reports() -> tuple[str, ...]:
    """Report nothing: what records the flight raises what fails."""
    return ()


def keep_nothing(_: FlightState, __: Record) -> None:
    """Save nothing: the flight cannot be resumed."""


def each_of(*keepers: Keeper) -> Keeper:
    """Return a keeper that calls several, in their order."""

    def keep(course: FlightState, record: Record) -> None:
        for keeper in keepers:
            keeper(course, record)

    return keep


class Operator:
    """Requests of the operator: landing, the way home, and events."""

    def __init__(self) -> None:
        self.wants_down = False
        self.wants_out = False  # stop at the next tick, and leave the vehicle holding
        self.present: Callable[[], OperatorReport] | None = None  # of the page, if there is one
        self._events: list[str] = []

    def land(self) -> None:
        """Request a landing, now."""
        self.wants_down = True

    def home(self) -> None:
        """Request the way home: the chart's first state of kind return, from wherever it flies."""
        self._events.append(RETURN_HOME)

    def send(self, event: str) -> None:
        """Send an event to the chart, which handles it at the next tick.

        Raises:
            UsageError: it is not the name of an event.
        """
        if not is_event(event):
            raise UsageError(f"event {event!r}: expected words joined by '.', such as 'go'")
        self._events.append(event)

    def take(self) -> tuple[str, ...]:
        """Return the events sent since the last call."""
        sent = tuple(self._events)
        self._events.clear()
        return sent


class _ContainedCalls:
    """Calls what stands beside the command: observers and the keeper, which end no flight."""

    def __init__(self) -> None:
        self._errors: dict[str, BaseException] = {}  # the first of each
        self._fresh: list[str] = []

    def call(self, what: str, function: Callable[..., object], *arguments: object) -> None:
        try:
            function(*arguments)
        except Interrupted:
            raise
        except (Exception, SystemExit, KeyboardInterrupt) as error:  # noqa: BLE001 - fly on
            if what not in self._errors:
                self._errors[what] = error
                self._fresh.append(f"{what} raised {described(error)}; the flight continues")

    def take(self) -> tuple[str, ...]:
        """Return what failed since the last call, a sentence each."""
        fresh = tuple(self._fresh)
        self._fresh.clear()
        return fresh

    def raise_first(self) -> None:
        """Raise the first error, if there was one."""
        for error in self._errors.values():
            raise error


async def fly(
    plan: PreparedMission,
    vehicle: Vehicle,
    observers: Sequence[Observer] = (),
    *,
    operator: Operator | None = None,
    pace: Pace | None = None,
    time_limit: float = 1800.0,
    believe_stopwatch: bool = False,
    keeper: Keeper = keep_nothing,
    reports: Callable[[], tuple[str, ...]] = no_reports,
    resume: Resumption | Callable[[], Resumption] | None = None,
    shared: TimedContainment | None = None,
) -> FlownFlight:
    """Fly the mission.

    The command alone must succeed. What `observers` and `keeper` raise joins the problems, once for
    each, and the flight continues; without `reports`, the first of it is raised when the
    flight is over. Over a vehicle they hand over what may wait to sinks (`recorder.record_sinks`).

    Args:
        plan: the mission, ready to fly.
        vehicle: what carries it out.
        observers: called after every tick with its record and observation.
        operator: may request a landing, which `time_limit` (s) also does.
        pace: lets mission time pass; as fast as possible by default.
        time_limit: mission time (s) after which the flight is aborted.
        believe_stopwatch: show the measured timing to the guards, and limit plug-ins by the wall's
            time. A simulation shows its own timing and limits by processor time instead, so that
            a busy machine does not change how a mission is rehearsed.
        keeper: called after every tick but the last with everything needed to resume from it.
        reports: what failed beside the flight since the last call; joins the problems.
        resume: continues a flight in progress instead of starting one. A function is called once
            the vehicle is connected, for time passes while connecting.
        shared: contains the plug-ins of several flights in one event loop; it is already
            interrupting. None: the flight makes its own.

    Raises:
        VehicleError: the vehicle could not be reached, or must not be commanded.
    """
    operator = operator or Operator()
    pace = pace or Unhurried()
    contain = shared or TimedContainment(stopwatch if believe_stopwatch else processor_time)
    await vehicle.connect()
    end: FlightEnd | None = None
    async with AsyncExitStack() as stack:
        stack.push_async_callback(vehicle.close)
        stack.enter_context(nullcontext() if shared else marking_interrupts())
        (course, events, notes) = await _opening(plan, vehicle, pace, resume)
        stack.enter_context(nullcontext() if shared else contain.interrupting())
        life, watch, beside = _started(course), FlightWatch(time_limit, course), _ContainedCalls()
        memory, cycle, count = course.memory, Cycle(), round(course.memory.now / plan.period)
        while end is None:
            count += 1
            now = count * plan.period
            await pace.until(now)
            observation = await vehicle.observe(now)
            if believe_stopwatch:
                observation = replace(observation, cycle=cycle)
            events += operator.take() + _pressing(life, operator, late=now >= time_limit)
            observation = _with_operator(observation, events, operator.present)
            done = tick(plan, memory, observation, contain, stopwatch)
            memory = done.memory
            await vehicle.send(done.command)
            cycle = _cycle(done, cycle, plan.period)
            record = done.record._replace(
                cycle=cycle, problems=notes + reports() + done.record.problems
            )
            events = ()
            for n, observer in enumerate(observers, 1):
                beside.call(f"observer {n}", observer, record, observation)
            end = watch.over(plan, done)
            if end is None:
                beside.call("checkpoints", keeper, watch.course(memory, life), record)
            notes = beside.take()
    aborted = life.state == "aborting"
    life.finish()
    if reports is no_reports:
        beside.raise_first()
    why = watch.why if end in {FlightEnd.NOT_ARMED, FlightEnd.NEVER_LEFT} else ""
    return FlownFlight(end, aborted, memory.now, count, memory, why)


async def _opening(
    plan: PreparedMission,
    vehicle: Vehicle,
    pace: Pace,
    resume: Resumption | Callable[[], Resumption] | None,
) -> ResumedFlight:
    """Return the state with which the flight begins or resumes."""
    if resume is None:
        return ResumedFlight(FlightState(begin(plan)), (), ())
    since = resume() if callable(resume) else resume
    return await resume_flight(plan, vehicle, pace, since)


def _started(course: FlightState) -> Lifecycle:
    life = Lifecycle()
    life.start()
    if course.aborting:
        life.abort()
    return life


def _pressing(life: Lifecycle, operator: Operator, *, late: bool) -> tuple[str, ...]:
    """Begin the abort when it is time; return the event that says so as long as it lasts.

    Raises:
        Interrupted: the operator wants out; raised in a destructor, the signal's own was ignored.
    """
    if operator.wants_out:
        raise Interrupted
    if life.state == "flying" and (operator.wants_down or late):
        life.abort()
    return (ABORT,) if life.state == "aborting" else ()


def _with_operator(
    observation: Observation,
    events: tuple[str, ...],
    present: Callable[[], OperatorReport] | None,
) -> Observation:
    """Return an observation with what the operator sent, and what is known of them."""
    if present is not None:
        observation = replace(observation, operator=present())
    return replace(observation, events=observation.events + events) if events else observation


def _cycle(done: Ticked, before: Cycle, budget: float) -> Cycle:
    sense, process, control = done.took
    late = sense + process + control > budget
    return Cycle(sense, process, control, before.overruns + late)
