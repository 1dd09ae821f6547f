"""The vehicles of a fleet, as the command line names them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from missionkit.api.missions import LoadedMission, assemble, refuse
from missionkit.chart.load import load
from missionkit.chart.model.guard_expressions import Use, parts_of
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.traversal import guards_of
from missionkit.cli.overrides import overrides
from missionkit.errors import UsageError, nearest
from missionkit.guards.separation import SeparationBelow

NAME = re.compile(r"[A-Za-z_][\w-]*")
FOR_ONE = re.compile(r"(?P<vehicle>[A-Za-z_][\w-]*):(?P<rest>.*)", re.DOTALL)


class FleetOptions(NamedTuple):
    """The options of the command."""

    members: tuple[str, ...]  # [NAME=]FILE
    settings: tuple[str, ...] = ()  # [VEHICLE:]NAME=VALUE
    faults: tuple[str, ...] = ()  # VEHICLE:FAULT
    plugins: tuple[Path, ...] = ()
    seed: int = 0
    speed: float | None = None
    separation: float = 2.0
    out: Path = Path("runs")
    sitl: str | None = None
    vehicles: tuple[str, ...] = ()  # addresses
    systems: tuple[int, ...] = ()
    runs: int | None = None
    workers: int | None = None
    anyway: bool = False
    as_json: bool = False


class Member(NamedTuple):
    """One vehicle of a fleet."""

    name: str
    mission: LoadedMission
    settings: tuple[str, ...]
    faults: tuple[str, ...]


def members_of(wanted: FleetOptions) -> tuple[Member, ...]:
    """Load the missions of a fleet, and refuse what cannot be right.

    Raises:
        FileError: a mission or a plug-in file cannot be used.
        UsageError: the vehicles have no names of their own, or an option names none of them.
    """
    if len(wanted.members) < 2:
        raise UsageError("a fleet is of two missions or more; `missionkit run` flies one")
    named = [_named(text) for text in wanted.members]
    catalogue = assemble(wanted.plugins)
    faults = _for_vehicles(wanted.faults, "--fault", "VEHICLE:FAULT")
    settings = _for_vehicles(wanted.settings, "--set", "")
    found = []
    for name, path in named:
        plain = load(path, catalogue)
        called = name or plain.name
        given = _settings(settings, called, plain)
        model = load(path, catalogue, overrides(given)) if given else plain
        refuse(model, catalogue)
        mission = LoadedMission(model, catalogue, path, overrides(given), wanted.plugins)
        found.append(
            Member(called, mission, given, tuple(text for who, text in faults if who == called))
        )
    _check_names(found, faults, settings)
    return tuple(found)


def _named(text: str) -> tuple[str, Path]:
    name, equals, path = text.partition("=")
    if not equals:
        return "", Path(text)
    if not NAME.fullmatch(name) or not path:
        raise UsageError(f"{text}: expected MISSION.yaml or NAME=MISSION.yaml")
    return name, Path(path)


def _for_vehicles(
    texts: Sequence[str], option: str, required: str
) -> tuple[tuple[str | None, str], ...]:
    """Return for each text the vehicle it is for, None for all, and what it says."""
    found: list[tuple[str | None, str]] = []
    for text in texts:
        match = FOR_ONE.fullmatch(text)
        if match is None and required:
            raise UsageError(f"{option} {text}: say for which vehicle: {required}")
        found.append((None, text) if match is None else (match["vehicle"], match["rest"]))
    return tuple(found)


def _settings(
    settings: Sequence[tuple[str | None, str]], name: str, mission: Mission
) -> tuple[str, ...]:
    """Return the settings for a vehicle; those for all leave out who lacks the parameter."""
    return tuple(
        text for who, text in settings if who == name or (who is None and _for_this(text, mission))
    )


def _for_this(text: str, mission: Mission) -> bool:
    """Say whether a setting for all is for this mission; one without `=` is refused by each."""
    parameter, equals, _ = text.partition("=")
    return not equals or parameter in mission.params


def _check_names(
    members: Sequence[Member],
    faults: Sequence[tuple[str | None, str]],
    settings: Sequence[tuple[str | None, str]],
) -> None:
    names = [it.name for it in members]
    for name, count in Counter(names).items():
        if count > 1:
            raise UsageError(
                f"{count} vehicles are called {name!r}: name them, as in one=FILE two=FILE"
            )
        if not NAME.fullmatch(name):
            raise UsageError(f"vehicle {name!r}: name it with letters, digits, '-' and '_'")
    for option, given in (("--fault", faults), ("--set", settings)):
        for who, text in given:
            if who is not None and who not in names:
                raise UsageError(f"{option} {who}:{text}: no such vehicle; {nearest(who, names)}")
    _check_settings(members, [text for who, text in settings if who is None])
    for member in members:
        _check_guards(member, names)


def _check_settings(members: Sequence[Member], settings: Sequence[str]) -> None:
    """Refuse a setting for all that none of the missions has."""
    known = {name: None for it in members for name in it.mission.parameters}
    for text in settings:
        parameter, equals, _ = text.partition("=")
        if equals and parameter not in known:
            hint = nearest(parameter, known)
            raise UsageError(f"--set {text}: no mission has such a parameter; {hint}")


def _check_guards(member: Member, names: Sequence[str]) -> None:
    others = [name for name in names if name != member.name]
    for guard in _separations(member.mission.model):
        if guard.vehicle is not None and guard.vehicle not in others:
            raise UsageError(
                f"{member.mission.path}: separation_below of vehicle {guard.vehicle!r}, which is "
                f"not another vehicle of the fleet; {nearest(guard.vehicle, others)}"
            )


def _separations(mission: Mission) -> Iterator[SeparationBelow]:
    for expression in guards_of(mission):
        for part in parts_of(expression):
            if isinstance(part, Use) and isinstance(part.plugin, SeparationBelow):
                yield part.plugin
