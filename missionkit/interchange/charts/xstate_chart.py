"""Charts of XState, as the JSON of a machine's configuration, rewritten as SCXML.

https://stately.ai/docs/machines. Names of guards, actions and invoked services stand for code that
is not in the file: a transition that needs a guard is refused, and so is each action and service.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from missionkit.chart.model.model_base import EVENT_PATTERN, NAME_PATTERN
from missionkit.interchange.bounded_input import ForeignFileError, number
from missionkit.interchange.charts.scxml_chart import DONE, SCXML
from missionkit.interchange.ledger import Ledger

RAISES = ("xstate.raise", "raise")
ROOT = "machine"
LEFT_OUT = {
    "invoke": "a service is code of the program: give the state a behaviour",
    "activities": "an activity is code of the program",
    "output": "a mission has no output",
    "data": "a mission has no data of final states",
}
TRANSITION = frozenset({"target", "actions", "internal", "reenter", "description", "meta"})


def scxml_of(data: Any, ledger: Ledger) -> Element:
    """Return the SCXML chart of a machine.

    Args:
        data: the configuration, as JSON has it.
        ledger: gets an entry for each state, transition, action, service and value of the context.

    Raises:
        ForeignFileError: it is no machine.
    """
    if not isinstance(data, dict) or not isinstance(data.get("states"), dict):
        raise ForeignFileError("a machine of XState is a mapping with 'states'")
    machine = _Machine(data, ledger)
    root = Element(f"{SCXML}scxml", {"version": "1.0", "initial": ROOT})
    model = SubElement(root, f"{SCXML}datamodel")
    context = data.get("context", {})
    for name, value in context.items() if isinstance(context, dict) else ():
        entry = ledger.open("context", str(name)[:60])
        if (isinstance(value, bool) or number(value) == value) and re.match(
            NAME_PATTERN, str(name)
        ):
            text = str(value).lower() if isinstance(value, bool) else repr(value)
            SubElement(model, f"{SCXML}data", {"id": str(name), "expr": text})
        else:
            ledger.refuse(entry, "a variable of a mission is a number or a truth value")
    machine.state(data, (), root)
    return root


class _Machine:
    """Rewrites state by state; a state is called by the path of keys to it."""

    def __init__(self, data: Mapping[str, Any], ledger: Ledger) -> None:
        self.ledger = ledger
        self.ids = dict(_ids(data, ()))

    def state(self, data: Mapping[str, Any], path: tuple[str, ...], parent: Element) -> None:
        """Add a state and what is inside it."""
        entry = self.ledger.open("state", ".".join(path) or ROOT)
        kind, inside = str(data.get("type")), data.get("states", {})
        inside = inside if isinstance(inside, dict) else {}
        if kind == "history" or data.get("history"):
            self._history(data, path, parent, entry)
            return
        tag = kind if kind in {"parallel", "final"} else "state"
        element = SubElement(parent, f"{SCXML}{tag}", {"id": _name(path)})
        initial = data.get("initial")
        if inside and tag == "state" and isinstance(initial, str) and initial in inside:
            element.set("initial", _name((*path, initial)))
        for key, why in LEFT_OUT.items():
            for it in _several(data.get(key)):
                self.ledger.refuse(self.ledger.open(key, _said(it)), why)
        for key, block in (("entry", "onentry"), ("exit", "onexit")):
            self._actions(data.get(key), SubElement(element, f"{SCXML}{block}"))
        self._transitions(data, path, element)
        for name, state in inside.items():
            if isinstance(state, dict):
                self.state(state, (*path, str(name)), element)
            else:
                self.ledger.refuse(self.ledger.open("state", str(name)[:60]), "not a mapping")

    def _history(
        self, data: Mapping[str, Any], path: tuple[str, ...], parent: Element, entry: int
    ) -> None:
        depth = "deep" if data.get("history") == "deep" else "shallow"
        target = self._target(data.get("target"), path)
        if target is None:
            self.ledger.refuse(entry, "a history without a target: it says where if never entered")
            return
        attributes = {"id": _name(path), "type": depth}
        element = SubElement(parent, f"{SCXML}history", attributes)
        SubElement(element, f"{SCXML}transition", {"target": target})

    def _transitions(
        self, data: Mapping[str, Any], path: tuple[str, ...], element: Element
    ) -> None:
        on = data.get("on")
        for event, given in on.items() if isinstance(on, dict) else ():
            for each in _several(given, empty=True):
                self._transition(str(event), each, path, element)
        for each in _several(data.get("always")):
            self._transition("", each, path, element)
        for each in _several(data.get("onDone")):
            self._transition(f"{DONE}{_name(path)}", each, path, element)
        after = data.get("after")
        for delay, given in after.items() if isinstance(after, dict) else ():
            self._after(str(delay), given, path, element)

    def _after(self, delay: str, given: Any, path: tuple[str, ...], element: Element) -> None:
        """Add transitions after a delay (ms): an event, sent on entry and dropped on exit."""
        milliseconds = number(delay)
        event = f"after.{delay}.{_name(path)}"
        for each in _several(given):
            if milliseconds is None or milliseconds < 0.0:
                entry = self.ledger.open("transition", f"after {delay}"[:60])
                self.ledger.refuse(entry, "its delay is code of the program")
                continue
            self._transition(event, each, path, element)
        if milliseconds is not None and milliseconds >= 0.0:
            entering, leaving = (
                next(it for it in element if it.tag == f"{SCXML}{tag}")
                for tag in ("onentry", "onexit")
            )
            sent = {"event": event, "id": event, "delay": f"{milliseconds / 1000.0:g}s"}
            SubElement(entering, f"{SCXML}send", sent)
            SubElement(leaving, f"{SCXML}cancel", {"sendid": event})

    def _transition(self, event: str, given: Any, path: tuple[str, ...], element: Element) -> None:
        entry = self.ledger.open("transition", f"{'.'.join(path) or ROOT} {event}"[:60])
        row = given if isinstance(given, dict) else {"target": given}
        target = self._target(row.get("target"), path)
        if wrong := _refusal(event, row, target):
            self.ledger.refuse(entry, wrong)
            for each in _several(row.get("actions")):
                self.ledger.refuse(
                    self.ledger.open("action", _said(each)), "its transition is refused"
                )
            return
        attributes = {} if target is None else {"target": target}
        if event:
            attributes["event"] = event
        if row.get("internal") is True or (target is not None and row.get("reenter") is False):
            attributes["type"] = "internal"
        for key in sorted(set(row) - TRANSITION):
            self.ledger.approximate(entry, f"its {key!r} is left out")
        found = SubElement(element, f"{SCXML}transition", attributes)
        self._actions(row.get("actions"), found)

    def _actions(self, given: Any, parent: Element) -> None:
        for each in _several(given):
            entry = self.ledger.open("action", _said(each))
            kind = str(each.get("type")) if isinstance(each, dict) else ""
            raised = each.get("event", (each.get("params") or {})) if kind in RAISES else None
            event = raised.get("type") if isinstance(raised, dict) else raised
            if isinstance(event, str) and re.match(EVENT_PATTERN, event):
                SubElement(parent, f"{SCXML}raise", {"event": event})
            else:
                self.ledger.refuse(entry, "an action is code of the program")

    def _target(self, given: Any, path: tuple[str, ...]) -> str | None:
        """Return the name of the state that a target means: #id, .child, sibling, sibling.child."""
        targets = [given] if isinstance(given, str) else given
        if not isinstance(targets, list) or len(targets) != 1 or not isinstance(targets[0], str):
            return None
        text = targets[0]
        if text.startswith("#"):
            named, *rest = text[1:].split(".")
            start = self.ids.get(named)
            wanted = None if start is None else (*start, *rest)
        elif text.startswith("."):
            wanted = (*path, *text[1:].split("."))
        else:
            wanted = (*path[:-1], *text.split("."))
        return _name(wanted) if wanted is not None and wanted in self.ids.values() else None


def _refusal(event: str, row: Mapping[str, Any], target: str | None) -> str:
    """Return why a transition cannot be in a mission, "" if it can."""
    guard = row.get("guard", row.get("cond"))
    if guard is not None:
        return f"its guard {_said(guard)} is code: write it as 'when'"
    if row.get("target") is not None and target is None:
        return f"it leads to {_said(row.get('target'))}, which is not there"
    if event and not re.match(EVENT_PATTERN, event):
        return f"{event[:40]!r} is not a name of an event"
    return ""


def _ids(data: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield the id of each state, its own or the dotted path, and its path."""
    if isinstance(data.get("id"), str):
        yield data["id"], path
    yield _name(path), path
    inside = data.get("states")
    for name, state in inside.items() if isinstance(inside, dict) else ():
        if isinstance(state, dict):
            yield from _ids(state, (*path, str(name)))


def _name(path: Sequence[str]) -> str:
    return "-".join((ROOT, *path)) if path else ROOT


def _several(given: Any, *, empty: bool = False) -> list[Any]:
    """Return a list of what may be one, several or nothing."""
    if given is None:
        return [None] if empty else []
    return given if isinstance(given, list) else [given]


def _said(value: Any) -> str:
    if isinstance(value, dict):
        value = value.get("type", value.get("src", value.get("name", "...")))
    return repr(value)[:40]
