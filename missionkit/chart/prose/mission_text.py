"""A mission in plain sentences: the whole, then state by state, default failsafes included."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from missionkit.chart.checks.broken_requirements import standings
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.mission_sections import Success
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.model.state_definitions import Failsafe
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.prose.control_text import control_text
from missionkit.chart.prose.incoming_references import changes, entrances, readers
from missionkit.chart.prose.phrases import actions, counted, guard, held, listed, value
from missionkit.chart.prose.place_text import place_texts
from missionkit.chart.prose.requirement_text import requirement_text
from missionkit.chart.prose.state_text import (
    ExplainedChart,
    Sentences,
    item,
    sentence,
    state_sentences,
    topic,
)

ANY = "the behaviour is done"
LANDED = (
    "and it lands undamaged where it meant to, stays inside its fence, knows its position, and is "
    "not ordered down by the pilot, a default failsafe or the time limit"
)
BUILT_IN_TEXT = (
    "Two are built in and come last: if the vehicle touches the ground outside take-off and "
    "landing, it lands; if a plug-in keeps failing for 3 s, it goes home, or lands after 6 s."
)


def explained(mission: Mission, catalogue: Catalogue) -> Iterator[Sentences]:
    """Yield the paragraphs that say what a mission does, in the order of the file.

    Args:
        mission: as its file says it; what the contracts of its kinds add is marked as added.
        catalogue: the kinds of state.
    """
    catalogue = catalogue.flying(mission.vehicle.use)
    full = fulfilled(mission, catalogue)
    chart = ExplainedChart(mission, full, catalogue, entrances(full))
    yield from _whole(chart)
    places = list(place_texts(mission)) if catalogue.vehicle.over_ground else []
    if places:
        yield topic("Places")
        yield from map(item, places)
    yield from _variables(mission)
    yield from _guards(mission)
    yield from _failsafes(chart)
    yield from _states(chart)
    if mission.requirements:
        known = standings(mission, catalogue)
        yield topic("Requirements, watched in flight")
        for each in mission.requirements:
            yield item(f"{requirement_text(each)} {known[each.name]}.")
    controlled = list(control_text(mission, catalogue))
    if controlled:
        yield topic("Control, near a goal, with the lag that the mission declares")
        yield from map(item, controlled)
    if mission.success:
        yield topic("Success")
        wanted = "; ".join(_success(one) for one in mission.success)
        yield sentence(f"The mission has succeeded when {wanted}, {LANDED}.")


def _whole(chart: ExplainedChart) -> Iterator[Sentences]:
    mission = chart.written
    summary = f": {mission.summary}" if mission.summary else ""
    yield topic(f"{mission.name}{summary}")
    count, added = len(chart.full.by_name()), len(chart.added)
    extra = f" ({added} added by the contracts of their kinds)" if added else ""
    do = f", where the chart first {actions(mission.initial.do)}" if mission.initial.do else ""
    begins = f"{counted(count, 'state')}{extra}. It begins in {listed(mission.initial.to)}{do}."
    yield sentence(f"The chart has {begins}")
    dwell = (
        ""
        if mission.dwell == 0
        else (
            f"Each state lasts at least {mission.dwell:g} s (the dwell), unless it says "
            "otherwise; failsafes, events and emergencies do not wait for that. "
        )
    )
    yield sentence(f"{dwell}After {mission.settings.time_limit:g} s in all it lands.")


def _variables(mission: Mission) -> Iterator[Sentences]:
    changed, read = changes(mission), readers(mission)
    if mission.variables:
        yield topic("Variables")
    for name, variable in mission.variables.items():
        first = f"{name}, {variable.described}, begins as {value(variable.initial)}."
        ways = (
            f" It changes: {'; '.join(changed[name])}." if name in changed else " It never changes."
        )
        used = f" It decides {listed(read[name])}." if name in read else " Nothing compares it."
        yield item(first + ways + used)


def _guards(mission: Mission) -> Iterator[Sentences]:
    if mission.guards:
        yield topic("Guards, named once and used by name")
    for name, expression in mission.guards.items():
        yield item(f"{name} holds when {guard(expression, ANY)}.")


def _failsafes(chart: ExplainedChart) -> Iterator[Sentences]:
    yield topic("Failsafes")
    if not chart.written.failsafes:
        yield sentence(
            "None: only what the states themselves say, and the default failsafes below."
        )
        yield sentence(BUILT_IN_TEXT)
        return
    where = listed(name for name, placed in chart.full.by_name().items() if chart.flies(placed))
    yield sentence(
        "They come before everything else; the first that holds wins. They act in the air in "
        f"every state that flies: {where}."
    )
    yield from (item(_failsafe(each)) for each in chart.written.failsafes)
    yield sentence(BUILT_IN_TEXT)


def _failsafe(failsafe: Failsafe) -> str:
    unknown = {
        "take": "It is also taken when the guard is unknown.",
        "ignore": "It is not taken when the guard is unknown.",
    }[failsafe.unknown]
    do = f", and {actions(failsafe.do)}" if failsafe.do else ""
    when = held(failsafe.when, failsafe.for_, ANY)
    return f"{failsafe.name}: {when}, it goes to {failsafe.to}{do}. {unknown}"


def _states(chart: ExplainedChart) -> Iterator[Sentences]:
    depths: Mapping[str | None, int] = _depths(chart.full)
    for placed in chart.full.walk():
        yield from state_sentences(chart, placed, depths[placed.name])


def _depths(mission: Mission) -> Mapping[str | None, int]:
    depths: dict[str | None, int] = {None: -1}
    for name, _, parent in mission.walk():
        depths[name] = depths[parent] + 1
    return depths


def _success(success: Success) -> str:
    parts = []
    if success.visit is not None and success.target is None:
        parts.append(f"{success.visit} was entered")
    elif success.visit is not None:
        parts.append(
            f"{success.visit} was entered within "
            f"{success.position:g} m and {success.yaw_deg:g} degrees of the pose "
            f"{value(success.standoff)} from the marker of {success.target}"
        )
    if success.done is not None:
        parts.append(f"the behaviour of {success.done} finished")
    if success.clearance is not None:
        parts.append(f"it kept {success.clearance:g} m from every obstacle")
    if success.failsafes is not None:
        parts.append(f"at most {success.failsafes} failsafes were taken")
    return " and ".join(parts)
