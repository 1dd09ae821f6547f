"""A chart of another program as the text of a mission."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any
from xml.etree.ElementTree import Element

from missionkit.interchange.bounded_input import ForeignFileError
from missionkit.interchange.charts.chart_cleaning import cleaned
from missionkit.interchange.charts.scxml_chart import convert
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.mission_text import mission_name

BLOCKS = ("states", "transitions")  # written on lines of their own
ADDED = "a state of kind land, where a low battery leads: the states of the chart command nothing"


def chart_text(root: Element, name: str, ledger: Ledger) -> str:
    """Return the mission that does what a chart does.

    Args:
        root: of an SCXML document.
        name: of the mission.
        ledger: gets an entry for each element.

    Raises:
        ForeignFileError: nothing of it can be a chart.
    """
    chart = convert(cleaned(root, ledger))
    if chart.beyond:
        raise ForeignFileError(chart.beyond[0])
    document = {**chart.document, "mission": mission_name(name)}
    land = _free("land", document["states"])
    document["states"] = {**document["states"], land: {"kind": "land"}}
    battery = {"name": "battery", "when": {"use": "battery_below", "floor": 0.25}, "to": land}
    document["failsafes"] = [battery]
    ledger.added.append(ADDED)
    return "\n".join([*_lines(document, ""), ""])


def _free(name: str, states: Mapping[str, Any]) -> str:
    """Return a name that no state has, however deep."""
    taken: set[str] = set()
    waiting = [states]
    while waiting:
        for key, state in waiting.pop().items():
            taken.add(key)
            waiting.append(state.get("states", {}))
    while name in taken:
        name += "-down"
    return name


def _lines(mapping: Mapping[str, Any], indent: str) -> Iterator[str]:
    """Yield a mapping in YAML: states and transitions a line each, the rest as JSON."""
    for key, value in mapping.items():
        if value in ([], {}) or (key == "internal" and not value):
            continue
        if key == "states":
            yield f"{indent}{key}:"
            for name, state in value.items():
                yield f"{indent}  {name}:"
                yield from _lines(state, f"{indent}    ")
        elif key in BLOCKS:
            yield f"{indent}{key}:"
            yield from (f"{indent}  - {json.dumps(_bare(each))}" for each in value)
        else:
            yield f"{indent}{key}: {json.dumps(value)}"


def _bare(transition: Mapping[str, Any]) -> dict[str, Any]:
    return {
        key: value
        for key, value in transition.items()
        if value != [] and not (key == "internal" and value is False)
    }
