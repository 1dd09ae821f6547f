"""What of an SCXML chart a mission can say: the rest is refused, element by element."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element

from missionkit.chart.model.model_base import EVENT_PATTERN, NAME_PATTERN
from missionkit.interchange.bounded_input import ForeignFileError, local
from missionkit.interchange.charts.scxml_chart import MORE, SCXML, STATES, convert
from missionkit.interchange.ledger import Ledger

NO_START = "it begins in {!r}, which is not one of its states"
AROUND = "the element around it is refused"
EXPRESSIONS = ("data", "assign", "send", "cancel")  # and transitions with a condition
MOST_EXPRESSIONS = 1_000  # each is tried by itself
ONE_TRANSITION = ("initial", "history")


@dataclass
class _Copy:
    """A copy of the chart, and the entry of the ledger of each of its elements."""

    ledger: Ledger
    entries: dict[Element, int] = field(default_factory=dict)
    parents: dict[Element, Element] = field(default_factory=dict)

    def of(self, element: Element, *, refused: bool) -> Element:
        """Return a copy of an element with what is kept inside it."""
        copy = Element(f"{SCXML}{local(element)}", dict(element.attrib))
        copy.text = element.text
        for each in element:
            if not _is_element(each):
                continue
            entry = self.ledger.open(f"element {len(self.ledger.entries) + 1}", _label(each))
            why = AROUND if refused else _refusal(each)
            inside = self.of(each, refused=bool(why))
            if why:
                self.ledger.refuse(entry, why)
                continue
            for attribute in _unknown(each):
                self.ledger.approximate(entry, f"its {attribute!r} is left out")
                del inside.attrib[attribute]
            self.entries[inside], self.parents[inside] = entry, copy
            copy.append(inside)
        return copy

    def remove(self, element: Element, why: str) -> None:
        """Take an element out of the copy, and refuse it."""
        self.parents[element].remove(element)
        self.refuse(element, why)

    def refuse(self, element: Element, why: str) -> None:
        """Refuse an element and what is inside it."""
        self.ledger.refuse(self.entries[element], why)
        for each in element.iter():
            if each is not element:
                self.ledger.refuse(self.entries[each], AROUND)


def cleaned(root: Element, ledger: Ledger) -> Element:
    """Return a copy of a chart with what a mission can say.

    Args:
        root: of the document.
        ledger: gets an entry for each element below the root.

    Raises:
        ForeignFileError: nothing of it can be a chart.
    """
    copier = _Copy(ledger)
    copy = copier.of(root, refused=False)
    copy.attrib = {key: value for key, value in copy.attrib.items() if key in MORE["scxml"]}
    _require_targets(copy, copier)
    _try_expressions(copy, copier)
    return copy


def _is_element(element: Element) -> bool:
    """Say whether it is one, and not a comment."""
    tag: object = element.tag
    return isinstance(tag, str)


def _label(element: Element) -> str:
    name = element.get("id") or element.get("event") or element.get("location") or ""
    return f"<{local(element)} {name}>"[:60] if name else f"<{local(element)}>"


def _unknown(element: Element) -> list[str]:
    known = MORE[local(element)]
    return [it for it in element.attrib if it not in known and not it.startswith("{")]


def _refusal(element: Element) -> str:
    """Return why an element cannot be in a mission, "" if it can."""
    tag = local(element)
    if tag not in MORE or tag == "scxml":
        return f"a mission has nothing like <{tag}>"
    for event in element.get("event", "").split():
        if not re.match(EVENT_PATTERN, event):
            return f"{event[:40]!r} is not a name of an event"
    if tag == "data" and not re.match(NAME_PATTERN, element.get("id", "")):
        return f"{element.get('id', '')[:40]!r} is not a name of a variable"
    starts = sum(_is_element(it) and local(it) == "transition" for it in element)
    if tag in ONE_TRANSITION and starts != 1:
        return f"<{tag}> needs one transition"
    return ""


def _states(chart: Element) -> Iterator[Element]:
    return (it for it in chart.iter() if local(it) in STATES)


def _require_targets(chart: Element, copier: _Copy) -> None:
    """Refuse transitions that lead to states that are not there.

    Raises:
        ForeignFileError: a state begins in one, or there are no states.
    """
    ids = {it.get("id", "") for it in _states(chart)}
    if not ids:
        raise ForeignFileError("the chart has no states")
    for each in [it for it in chart.iter() if "initial" in it.attrib]:
        for target in each.get("initial", "").split():
            if target not in ids:
                raise ForeignFileError(NO_START.format(target[:40]))
    for each in [it for it in chart.iter() if local(it) == "transition"]:
        gone = [it for it in each.get("target", "").split() if it not in ids]
        if gone and local(copier.parents[each]) in ONE_TRANSITION:
            raise ForeignFileError(NO_START.format(gone[0][:40]))
        if gone:
            copier.remove(each, f"it leads to {gone[0][:40]!r}, which is not there")


def _try_expressions(chart: Element, copier: _Copy) -> None:
    """Take out every expression, and put back one after the other what can be said.

    Raises:
        ForeignFileError: the chart cannot be said even without them, or they are too many.
    """
    waiting = [it for it in chart.iter() if local(it) in EXPRESSIONS or "cond" in it.attrib]
    if len(waiting) > MOST_EXPRESSIONS:
        raise ForeignFileError(f"more than {MOST_EXPRESSIONS} expressions")
    order = {it: list(it) for it in chart.iter()}
    left_out = set(waiting)
    if beyond := _beyond(chart, order, left_out):
        raise ForeignFileError(beyond[0])
    for each in waiting:
        left_out.discard(each)
        if beyond := _beyond(chart, order, left_out):
            left_out.add(each)
            copier.refuse(each, f"it is code: {beyond[0]}"[:120])
    _beyond(chart, order, left_out)


def _beyond(
    chart: Element, order: Mapping[Element, list[Element]], left_out: set[Element]
) -> tuple[str, ...]:
    """Arrange a chart without some elements; return what of it a mission cannot say.

    Args:
        chart: is changed.
        order: all children of each element.
        left_out: elements that are taken out.
    """
    for parent, children in order.items():
        parent[:] = [it for it in children if it not in left_out]
    return convert(chart).beyond
