"""State chart engines side by side on one chart: a quiet tick, a fired transition, loading."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from importlib.metadata import version

from benchmarks.measure import Table
from benchmarks.peers import missionkit_chart as own
from benchmarks.peers.fixture import Fixture, verified
from benchmarks.peers.ring import Engine, ring
from benchmarks.peers.turns import ROUNDS, SAMPLE, kept, medians
from missionkit.chart.load import parse
from missionkit.chart.model.state_contracts import unmet
from missionkit.chart.semantics.chart_compiler import compile_mission

PEERS = ("if_else", "pytransitions", "pyxstate", "pysismic", "pytrees", "pystatemachine")
MISSIONKIT = own.ENGINES[0].name
GUARDS = 3
CHART = ring(7, GUARDS)
LARGEST = "1000 states"
GROWTH = {
    "10 states": ring(10, GUARDS),
    "100 states": ring(100, GUARDS),
    LARGEST: ring(1000, GUARDS),
    "1 guard": ring(10, 1),
    "10 guards": ring(10, 10),
    "100 guards": ring(10, 100),
}


def tables() -> list[Table]:
    """Check every engine, then time them in turns."""
    engines = list(_engines())
    asked = {engine.name: verified(engine, CHART, GUARDS) for engine in engines}
    return [_ticks(engines, asked), _growth(engines), _loading()]


def _engines() -> Iterator[Engine]:
    yield from own.ENGINES
    for name in PEERS:
        try:
            yield from import_module(f"benchmarks.peers.{name}").ENGINES
        except ModuleNotFoundError as error:
            print(f"left out: {name} ({error}); make bench installs it")


def _ticks(engines: Sequence[Engine], asked: Mapping[str, tuple[str, str]]) -> Table:
    at = {engine.name: Fixture(engine, CHART) for engine in engines}
    quiet = medians({name: it.quiet() for name, it in at.items()})
    pairs = medians({name: it.to_and_fro() for name, it in at.items()})
    fired = {name: both / 2 for name, both in pairs.items()}
    loaded = medians({name: it.load for name, it in at.items()}, collecting=True)
    rows = [
        (
            *(name, *_against(quiet, name, 1e6), asked[name][0]),
            *(*_against(fired, name, 1e6), asked[name][1]),
            *_against(loaded, name, 1e3),
        )
        for name in at
    ]
    header = (
        *("engine", "quiet tick, us", "x", "guards asked", "fired transition, us", "x"),
        *("guards asked", "load, ms", "x"),
    )
    return Table("State charts: engines", header, rows, _how(engines))


def _against(times: Mapping[str, float], name: str, scale: float) -> tuple[str, str]:
    return f"{scale * times[name]:.2f}", f"{times[name] / times[MISSIONKIT]:.2f}"


def _how(engines: Sequence[Engine]) -> str:
    how = "\n".join(f"- {engine.name}{_version(engine)}: {engine.how}." for engine in engines)
    return (
        f"One chart of 7 states with {GUARDS} guards each, numbers compared with limits. x: times "
        f"missionkit's. Medians of {ROUNDS} samples of {1e3 * SAMPLE:.0f} ms, in turns, processor "
        "time; garbage is collected while loading only. Before timing each engine was seen to ask "
        "its guards and to change state. missionkit's guards answer with value, threshold and "
        "margin for the record, the others' with yes or no. After a transition missionkit asks "
        f"the guards of the new state too, until the chart rests.\n\n{how}"
    )


def _version(engine: Engine) -> str:
    return f" {version(engine.package)}" if engine.package else ""


def _growth(engines: Sequence[Engine]) -> Table:
    columns: list[dict[str, float]] = []
    loaded: dict[str, float] = {}
    for title, chart in GROWTH.items():
        at = {engine.name: Fixture(engine, chart) for engine in engines}
        columns.append(medians({name: it.quiet() for name, it in at.items()}))
        if title == LARGEST:
            loads = {name: it.load for name, it in at.items()}
            loaded = medians(loads, rounds=3)
    rows = [
        (
            engine.name,
            *(f"{1e6 * column[engine.name]:.2f}" for column in columns),
            f"{1e3 * loaded[engine.name]:.0f}",
        )
        for engine in engines
    ]
    note = (
        f"A quiet tick, us: with {GUARDS} guards in each of 10, 100, 1000 states, the active one "
        "in the middle; with 1, 10, 100 guards in each of 10 states. And loading the largest, ms, "
        "without garbage collection."
    )
    header = ("engine", *GROWTH, f"load {LARGEST}")
    return Table("State charts: growth", header, rows, note)


def _loading() -> Table:
    note = (
        f"missionkit, a YAML text of so many states with {GUARDS} guards each. Memory: what the "
        "mission as parsed and the chart as compiled keep, by tracemalloc."
    )
    header = (
        "states",
        "parse, ms",
        "check, ms",
        "compile, ms",
        "all, ms",
        "mission, kB",
        "chart, kB",
    )
    return Table("State charts: loading", header, [_loading_row(7), _loading_row(1000)], note)


def _loading_row(states: int) -> tuple[str, ...]:
    text = own.text(ring(states, GUARDS))
    mission = parse(text, own.FILE, own.CATALOGUE)
    works = {
        "parse": lambda: parse(text, own.FILE, own.CATALOGUE),
        "check": lambda: unmet(mission, own.CATALOGUE),
        "compile": lambda: compile_mission(mission, own.CATALOGUE),
    }
    took = medians(works, collecting=True).values()
    times = [f"{1e3 * time:.2f}" for time in (*took, sum(took))]
    memory = [f"{kept(works[name]) / 1e3:.0f}" for name in ("parse", "compile")]
    return str(states), *times, *memory
