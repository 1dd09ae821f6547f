"""The states of a document, as the plain interpreter of SCXML reads them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

ROOT = "<scxml>"


class Transition(NamedTuple):
    source: str
    target: tuple[str, ...]
    event: tuple[str, ...]
    cond: dict[str, Any] | None
    internal: bool
    content: list[dict[str, Any]]


class Node:
    """A state of the document, or the document itself."""

    def __init__(self, name: str, parent: Node | None, data: dict[str, Any], order: int) -> None:
        self.name, self.parent, self.data, self.order = name, parent, data, order
        self.children: list[Node] = []  # histories too
        self.transitions = [
            Transition(
                name,
                tuple(one.get("to", ())),
                tuple(one.get("event", ())),
                one.get("when"),
                one.get("internal", False),
                one.get("do", []),
            )
            for one in data.get("transitions", [])
        ]

    @property
    def history(self) -> str | None:
        return self.data.get("history")

    @property
    def final(self) -> bool:
        return bool(self.data.get("final"))

    @property
    def parallel(self) -> bool:
        return bool(self.data.get("parallel"))

    @property
    def compound(self) -> bool:
        return self.name == ROOT or bool(self.children and not self.parallel)

    @property
    def atomic(self) -> bool:
        return not self.children and self.history is None

    def child_states(self) -> list[Node]:
        return [child for child in self.children if child.history is None]

    def begin(self) -> tuple[list[str], list[dict[str, Any]]]:
        """The targets and the content of <initial>, or of the default of a history."""
        start = self.data.get("default") or self.data["initial"]
        return list(start["to"]), start.get("do", [])

    def proper_ancestors(self, until: Node | None = None) -> Iterator[Node]:
        around = self.parent
        while around is not None and around is not until:
            yield around
            around = around.parent

    def is_descendant(self, of: Node) -> bool:
        return any(around is of for around in self.proper_ancestors())
