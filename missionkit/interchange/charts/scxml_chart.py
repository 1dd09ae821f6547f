"""From an SCXML document to a mission document, element by element; no chart is special."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element

from missionkit.interchange.charts.script_expressions import (
    TRUTH,
    BeyondError,
    Value,
    assignment,
    guard,
    literal,
)

SCXML = "{http://www.w3.org/2005/07/scxml}"
STATES = ("state", "parallel", "final", "history")
PLAIN: Mapping[str, frozenset[str]] = {
    "scxml": frozenset({"initial", "version", "datamodel", "name"}),
    "state": frozenset({"id", "initial"}),
    "parallel": frozenset({"id"}),
    "final": frozenset({"id"}),
    "history": frozenset({"id", "type"}),
    "initial": frozenset(),
    "transition": frozenset({"event", "target", "type"}),
    "onentry": frozenset(),
    "onexit": frozenset(),
    "raise": frozenset({"event"}),
    "log": frozenset({"label", "expr"}),
}
MORE: Mapping[str, frozenset[str]] = {
    **PLAIN,
    "transition": PLAIN["transition"] | {"cond"},
    "datamodel": frozenset(),
    "data": frozenset({"id", "expr"}),
    "assign": frozenset({"location", "expr"}),
    "send": frozenset({"event", "delay", "delayexpr", "target", "id"}),
    "cancel": frozenset({"sendid"}),
}
DONE = "done.state."
FAILING = "failing"  # a variable that has no other value: assigning one is an action that fails


class Converted(NamedTuple):
    """A mission document, and what of the chart it could not say."""

    document: dict[str, Any]
    ids: dict[str, str]  # id in the chart -> name of the state
    beyond: tuple[str, ...]


def beyond_plain(chart: Element) -> tuple[str, ...]:
    """Return what a chart uses besides states, transitions, history, parallel and their actions."""
    return _strange(chart, PLAIN) + tuple(
        f"<log> of the expression {each.get('expr')}"
        for each in chart.iter(f"{SCXML}log")
        if not _is_text(each.get("expr", "''"))
    )


def convert(chart: Element) -> Converted:
    """Return the mission that does what a chart does."""
    strange = _strange(chart, MORE)
    converter = _Converter(chart)
    document = {} if strange else converter.document()
    return Converted(document, converter.ids, (*strange, *converter.beyond))


def sends_at_once(chart: Element) -> bool:
    """Say whether a chart sends something to itself, from outside, without delay."""
    sends = chart.iter(f"{SCXML}send")
    return any(not {"delay", "delayexpr", "target"} & set(each.attrib) for each in sends)


def _strange(chart: Element, known: Mapping[str, frozenset[str]]) -> tuple[str, ...]:
    found: dict[str, None] = {}
    for element in chart.iter():
        tag = element.tag.removeprefix(SCXML)
        if tag not in known:
            found[f"<{tag}>"] = None
            continue
        for attribute in sorted(set(element.attrib) - known[tag]):
            if not attribute.startswith("{"):  # other namespaces, such as schemaLocation
                found[f"<{tag} {attribute}>"] = None
    return tuple(found)


def _is_text(expression: str) -> bool:
    try:
        literal(expression)
    except BeyondError:
        return False
    return True


class _Converter:
    def __init__(self, chart: Element) -> None:
        self.chart = chart
        self.beyond: list[str] = []
        self.names = {each: self._name(each, at) for at, each in enumerate(_states(chart))}
        self.ids = {each.get("id", ""): name for each, name in self.names.items()}
        if len(set(self.names.values())) < len(self.names):
            self.beyond.append("ids that differ only in characters that names have not")
        self.delays = {each.get("delayexpr", "") for each in chart.iter(f"{SCXML}send")}
        self.sent = {each.get("id"): each.get("event", "") for each in chart.iter(f"{SCXML}send")}
        self.variables = self._variables()

    def document(self) -> dict[str, Any]:
        document: dict[str, Any] = {
            "missionkit": 1,
            "mission": "converted",
            "dwell": 0,
            "initial": self._initial(self.chart),
            "states": self._inside(self.chart),
        }
        if self.variables:
            document["variables"] = self.variables
        if FAILING in self.variables:
            document["variables"] = {**self.variables, FAILING: {"initial": 0, "max": 0}}
        return document

    def _name(self, element: Element, at: int) -> str:
        """Return a name for a state; characters that names have not are written as numbers."""
        text = element.get("id", f"state-{at}")
        return re.sub(r"^[^A-Za-z]|[^A-Za-z0-9_-]", lambda found: f"x{ord(found[0]):x}_", text)

    def _variables(self) -> dict[str, Value]:
        """Return the data with first values; what has none begins as nought of its later type."""
        variables: dict[str, Value] = {}
        for data in self.chart.iter(f"{SCXML}data"):
            name = data.get("id", "")
            if (data.text or "").strip():
                self.beyond.append(f"<data {name}> with content")
            first = data.get("expr") or next(self._assigned(name), "0")
            value = self._or_beyond(
                f"<data {name}>", 0, lambda first=first, name=name: self._literal(first, name)
            )
            variables[name] = value if data.get("expr") else type(value)()
        if any("cond" in each.attrib for each in self.chart.iter(f"{SCXML}transition")):
            variables[TRUTH] = True
        if any(map(_fails, self.chart.iter())):
            variables[FAILING] = 0
        return variables

    def _literal(self, text: str, name: str) -> Value:
        value = literal(text)
        return _seconds(value) if name in self.delays else value

    def _assigned(self, name: str) -> Iterator[str]:
        for each in self.chart.iter(f"{SCXML}assign"):
            if each.get("location") == name and _is_text(each.get("expr", "")):
                yield each.get("expr", "")

    def _or_beyond(self, what: str, instead: Any, value: Any) -> Any:
        try:
            return value()
        except BeyondError as error:
            self.beyond.append(f"{what}: {error}".strip())
            return instead

    def _inside(self, element: Element) -> dict[str, Any]:
        return {self.names[each]: self._state(each) for each in _children(element, *STATES)}

    def _state(self, element: Element) -> dict[str, Any]:
        tag = element.tag.removeprefix(SCXML)
        if tag == "history":
            (default,) = _children(element, "transition")
            shape = {"history": element.get("type", "shallow"), "default": self._start(default)}
            return {"kind": "logic", **shape}
        state: dict[str, Any] = {
            "kind": "logic",
            "entry": self._actions(_children(element, "onentry")),
            "exit": self._actions(_children(element, "onexit")),
        }
        if tag == "final":
            return {**state, "final": True}
        state["transitions"] = list(map(self._transition, _children(element, "transition")))
        if inside := self._inside(element):
            state["states"] = inside
            parallel = tag == "parallel"
            state |= {"parallel": True} if parallel else {"initial": self._initial(element)}
        return state

    def _initial(self, element: Element) -> dict[str, Any]:
        if "initial" in element.attrib:
            return {"to": self._targets(element.attrib["initial"])}
        for initial in _children(element, "initial"):
            (start,) = _children(initial, "transition")
            return self._start(start)
        return {"to": [self.names[next(_children(element, *STATES))]]}

    def _start(self, transition: Element) -> dict[str, Any]:
        return {"to": self._targets(transition.get("target", "")), "do": self._do(transition)}

    def _targets(self, ids: str) -> list[str]:
        return [self.ids.get(each, each) for each in ids.split()]

    def _transition(self, element: Element) -> dict[str, Any]:
        transition: dict[str, Any] = {"internal": element.get("type") == "internal"}
        if "target" in element.attrib:
            transition["to"] = self._targets(element.attrib["target"])
        if "event" in element.attrib:
            transition["event"] = list(map(self._event, element.attrib["event"].split()))
        if (cond := element.get("cond")) is not None:
            always = {"variable": TRUTH, "equals": True}
            transition["when"] = self._or_beyond(
                "cond", always, lambda: guard(cond, self.ids, self.variables)
            )
        if "event" not in transition and "when" not in transition:
            transition["after"] = 0
        actions = self._do(element)
        if "to" not in transition and not actions:
            actions = [{"log": "stays"}]
        return {**transition, "do": actions}

    def _event(self, event: str) -> str:
        if not event.startswith(DONE):
            return event
        state = event.removeprefix(DONE)
        return DONE + self.ids.get(state, state)

    def _actions(self, blocks: Iterable[Element]) -> list[dict[str, Any]]:
        blocks = list(blocks)
        if any(map(_fails, (each for block in blocks[:-1] for each in block))):
            self.beyond.append(f"<{blocks[0].tag.removeprefix(SCXML)}> twice, the first fails")
        return [action for block in blocks for action in self._do(block)]

    def _do(self, block: Element) -> list[dict[str, Any]]:
        return [self._action(each) for each in block]

    def _action(self, element: Element) -> dict[str, Any]:
        match element.tag.removeprefix(SCXML):
            case "raise":
                return {"raise": self._event(element.get("event", ""))}
            case "assign":
                return {"assign": self._assign(element)}
            case "send":
                return self._send(element)
            case "cancel":
                return {"cancel": self._event(self.sent.get(element.get("sendid"), ""))}
            case _:
                return {"log": " ".join(filter(None, map(element.get, ("label", "expr")))) or "-"}

    def _assign(self, element: Element) -> dict[str, Any]:
        name, text = element.get("location", "").strip(), element.get("expr", "")
        value = self._or_beyond(f"<assign {name}>", 0, lambda: self._assignment(text, name))
        if name not in self.variables:
            self.beyond.append(f"<assign> to the undeclared {name}")
        return {name: value}

    def _assignment(self, text: str, name: str) -> Any:
        value = assignment(text, name, self.variables)
        return value if isinstance(value, dict) or name not in self.delays else _seconds(value)

    def _send(self, element: Element) -> dict[str, Any]:
        event = self._event(element.get("event", ""))
        match element.get("target"):
            case "#_internal" if "delay" not in element.attrib:
                return {"raise": event}
            case None:
                return {"raise": {"event": event, "after": self._delay(element)}}
            case _ if _fails(element):
                return {"assign": {FAILING: {"add": 1}}}
            case target:
                self.beyond.append(f"<send> to {target}")
                return {"log": "-"}

    def _delay(self, element: Element) -> float | str:
        text = element.get("delayexpr", f"'{element.get('delay', '0s')}'")
        if text in self.variables:
            return text
        delay: float = self._or_beyond(f"<send> after {text}", 0.0, lambda: _seconds(literal(text)))
        return delay


def _seconds(text: object) -> float:
    """Return the seconds that a duration such as `1.5s` stands for.

    Raises:
        BeyondError: it is no duration.
    """
    found = re.fullmatch(r"(\d*\.?\d+)(ms|s)", str(text))
    if found is None:
        raise BeyondError(str(text))
    return float(found[1]) * (0.001 if found[2] == "ms" else 1.0)


def _fails(element: Element) -> bool:
    """Say whether an action is sure to fail: nothing can be sent to what is no address."""
    to = element.get("target", "#") if element.tag == f"{SCXML}send" else "#"
    return not to.startswith("#")


def _children(element: Element, *tags: str) -> Iterator[Element]:
    return (each for each in element if each.tag.removeprefix(SCXML) in tags)


def _states(element: Element) -> Iterator[Element]:
    """Yield the states of a chart in document order."""
    for each in _children(element, *STATES):
        yield each
        yield from _states(each)
