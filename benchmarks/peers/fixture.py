"""One engine with one chart, and the proof that it does what is timed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any
from unittest.mock import patch

from benchmarks.peers.ring import Engine, Machine, Predicate, Ring, Sky, asks, predicate
from missionkit.guards.battery import BatteryBelow
from missionkit.guards.comparison import ComparedGuard
from missionkit.guards.link_loss import LinkLost
from missionkit.guards.plugin_failure import PluginFailed
from missionkit.guards.state_progress import Elapsed
from missionkit.messages import Estimate

OWN = (BatteryBelow, Elapsed, LinkLost, PluginFailed)  # guards that missionkit asks here


class Fixture:
    """One engine with one chart; `asked` collects the names of the guards that it asks."""

    def __init__(self, engine: Engine, chart: Ring, asked: list[str] | None = None) -> None:
        self.engine, self.text = engine, engine.text(chart)
        self.sky = Sky(engine.views.calm)
        self.guards = {name: predicate(ask, self.sky) for name, ask in asks(chart).items()}
        if asked is not None:
            self.guards = {name: _counted(it, name, asked) for name, it in self.guards.items()}
        self.machine = self.load()

    def load(self) -> Machine:
        """Start the chart from its text."""
        machine: Machine = self.engine.load(self.text, self.sky, self.guards)
        return machine

    def quiet(self) -> Callable[[], object]:
        """Return a tick in which nothing fires."""
        self.sky.seen = self.engine.views.calm
        self.machine.tick()  # missionkit's first tick enters the initial state
        return self.machine.tick

    def to_and_fro(self) -> Callable[[], object]:
        """Return two ticks, in each of which a transition fires."""
        sky, tick, (_, low, silent) = self.sky, self.machine.tick, self.engine.views

        def both() -> None:
            sky.seen = low
            tick()
            sky.seen = silent
            tick()

        return both


def verified(engine: Engine, chart: Ring, guards: int) -> tuple[str, str]:
    """Check that guards are asked and transitions taken.

    Returns:
        how many guards are asked in a quiet tick and in one that fires.

    Raises:
        RuntimeError: the engine is not in the state in which it should be, or asked too few.
    """
    asked: list[str] = []
    here, partner = chart.initial, chart.states[chart.initial][-1].to
    with _counting(asked):
        at = Fixture(engine, chart, asked)
        at.quiet()
        quiet = _asked(at, engine.views.calm, here, asked)
        fired = _asked(at, engine.views.low, partner, asked)
        _asked(at, engine.views.silent, here, asked)
    if not engine.counted:
        return "in place", "in place"
    if quiet < guards or fired < guards:
        raise RuntimeError(f"{engine.name} asked {quiet} and {fired} guards, not {guards}")
    return str(quiet), str(fired)


def _asked(at: Fixture, seen: Estimate, state: str, asked: list[str]) -> int:
    """Tick, demand a state, and return how many guards were asked."""
    asked.clear()
    at.sky.seen = seen
    at.machine.tick()
    if at.machine.state() != state:
        raise RuntimeError(f"{at.engine.name} is in {at.machine.state()}, not in {state}")
    return len(asked)


def _counted(guard: Predicate, name: str, asked: list[str]) -> Predicate:
    def ask() -> bool:
        asked.append(name)
        return guard()

    return ask


@contextmanager
def _counting(asked: list[str]) -> Iterator[None]:
    """Have the package's own guards note that they are asked."""

    def noting(answer: Callable[..., Any]) -> Callable[..., Any]:
        def noted(guard: Any, seen: Any) -> Any:
            asked.append(guard.kind)
            return answer(guard, seen)

        return noted

    with ExitStack() as stack:
        for kind in OWN:
            name = "measured" if issubclass(kind, ComparedGuard) else "raised"
            stack.enter_context(patch.object(kind, name, noting(getattr(kind, name))))
        yield
