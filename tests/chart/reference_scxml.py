"""A slow and plain interpreter of SCXML, to compare the chart with: nothing is remembered.

Source: "State Chart XML (SCXML)", W3C Recommendation, 1 September 2015, appendix D, procedure by
procedure under its names. It reads the same document as `missionkit.chart.load.parse`, as plain
dictionaries, and shares no code with the package.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

from reference_tree import ROOT, Node, Transition


class UnsettledError(Exception):
    """More microsteps in one macrostep than are allowed."""


class Interpreter:
    """A session."""

    def __init__(self, document: dict[str, Any], most: int) -> None:
        self.most = most
        self.nodes: dict[str, Node] = {}
        self.root = self.read(ROOT, None, document)
        self.variables: dict[str, Any] = dict(document.get("variables", {}))
        self.configuration: set[str] = set()
        self.history_value: dict[str, list[str]] = {}
        self.internal_queue: deque[str] = deque()
        self.running = True
        self.said: list[str] = []  # logs of the last macrostep, in order
        self.exited: list[str] = []
        self.entered: list[str] = []
        self.interpret()

    def read(self, name: str, parent: Node | None, data: dict[str, Any]) -> Node:
        node = self.nodes[name] = Node(name, parent, data, len(self.nodes))
        node.children = [
            self.read(child, node, inner) for child, inner in data.get("states", {}).items()
        ]
        return node

    def active(self) -> list[str]:
        return [node.name for node in self.in_document_order(self.configuration)]

    # The main loop

    def interpret(self) -> None:
        targets, content = self.root.begin()
        start = Transition(ROOT, tuple(targets), (), None, internal=False, content=content)
        self.steps = 1
        self.execute(content)
        self.enter_states([start])
        self.settle()

    def external_event(self, *events: str) -> None:
        self.steps, self.exited, self.entered, self.said = 0, [], [], []
        self.settle()
        for event in events:
            if not self.running:
                return
            enabled = self.select_transitions(event)
            if enabled:
                self.microstep(enabled)
                self.settle()

    def settle(self) -> None:
        while self.running:
            enabled = self.select_transitions(None)
            if not enabled:
                if not self.internal_queue:
                    return
                enabled = self.select_transitions(self.internal_queue.popleft())
            if enabled:
                self.microstep(enabled)

    def microstep(self, enabled: list[Transition]) -> None:
        if self.steps >= self.most:
            raise UnsettledError
        self.steps += 1
        self.exit_states(enabled)
        for transition in enabled:
            self.execute(transition.content)
        self.enter_states(enabled)

    # Which transitions

    def select_transitions(self, event: str | None) -> list[Transition]:
        enabled: list[Transition] = []
        for state in self.in_document_order(self.configuration):
            if state.atomic:
                found = self.first_enabled([state, *state.proper_ancestors()], event)
                if found is not None and not any(found is other for other in enabled):
                    enabled.append(found)
        return self.remove_conflicting(enabled)

    def first_enabled(self, states: list[Node], event: str | None) -> Transition | None:
        for state in states:
            for transition in state.transitions:
                if name_match(transition.event, event) and self.condition_match(transition.cond):
                    return transition
        return None

    def condition_match(self, cond: dict[str, Any] | None) -> bool:
        match cond:
            case None:
                return True
            case {"in": state}:
                return state in self.configuration
            case {"not": inner}:
                return not self.condition_match(inner)
            case {"variable": name, "at_least": least}:
                return bool(self.variables[name] >= least)
            case _:
                raise ValueError(cond)

    def remove_conflicting(self, enabled: list[Transition]) -> list[Transition]:
        filtered: list[Transition] = []
        for t1 in enabled:
            preempted = False
            to_remove = []
            for t2 in filtered:
                if self.compute_exit_set([t1]) & self.compute_exit_set([t2]):
                    if self.nodes[t1.source].is_descendant(self.nodes[t2.source]):
                        to_remove.append(t2)
                    else:
                        preempted = True
                        break
            if not preempted:
                filtered = [t for t in filtered if not any(t is t3 for t3 in to_remove)]
                filtered.append(t1)
        return filtered

    # Out

    def compute_exit_set(self, transitions: list[Transition]) -> set[str]:
        to_exit: set[str] = set()
        for transition in transitions:
            if transition.target:
                domain = self.get_transition_domain(transition)
                to_exit |= {
                    name for name in self.configuration if self.nodes[name].is_descendant(domain)
                }
        return to_exit

    def exit_states(self, enabled: list[Transition]) -> None:
        to_exit = self.in_document_order(self.compute_exit_set(enabled))[::-1]
        for state in to_exit:
            for child in state.children:
                if child.history is not None:
                    self.history_value[child.name] = self.recorded(child.history, state)
        for state in to_exit:
            self.execute(state.data.get("exit", []))
            self.configuration.remove(state.name)
            self.exited.append(state.name)

    def recorded(self, history: str, around: Node) -> list[str]:
        def deep(node: Node) -> bool:
            return node.atomic and node.is_descendant(around)

        def shallow(node: Node) -> bool:
            return node.parent is around

        fits: Callable[[Node], bool] = deep if history == "deep" else shallow
        return [node.name for node in self.in_document_order(self.configuration) if fits(node)]

    # In

    def enter_states(self, enabled: list[Transition]) -> None:
        to_enter: set[str] = set()
        self.default_entry: set[str] = set()
        self.default_history: dict[str, list[dict[str, Any]]] = {}
        self.compute_entry_set(enabled, to_enter)
        for state in self.in_document_order(to_enter):
            self.configuration.add(state.name)
            self.entered.append(state.name)
            self.execute(state.data.get("entry", []))
            if state.name in self.default_entry:
                self.execute(state.begin()[1])
            self.execute(self.default_history.get(state.name, []))
            if state.final:
                self.reach_final(state)

    def reach_final(self, state: Node) -> None:
        assert state.parent is not None
        if state.parent is self.root:
            self.running = False
            return
        self.internal_queue.append(f"done.state.{state.parent.name}")
        grandparent = state.parent.parent
        if grandparent is not None and grandparent.parallel and self.is_in_final_state(grandparent):
            self.internal_queue.append(f"done.state.{grandparent.name}")

    def is_in_final_state(self, state: Node) -> bool:
        if state.parallel:
            return all(self.is_in_final_state(child) for child in state.child_states())
        return any(child.final and child.name in self.configuration for child in state.children)

    def compute_entry_set(self, transitions: list[Transition], to_enter: set[str]) -> None:
        for transition in transitions:
            for name in transition.target:
                self.add_descendants(self.nodes[name], to_enter)
            ancestor = self.get_transition_domain(transition) if transition.target else None
            for state in self.get_effective_targets(transition.target):
                self.add_ancestors(state, ancestor, to_enter)

    def add_descendants(self, state: Node, to_enter: set[str]) -> None:
        if state.history is not None:
            assert state.parent is not None
            names = self.history_value.get(state.name)
            if names is None:
                names, self.default_history[state.parent.name] = state.begin()
            self.add_inside(names, state.parent, to_enter)
            return
        to_enter.add(state.name)
        if state.compound:
            self.default_entry.add(state.name)
            self.add_inside(state.begin()[0], state, to_enter)
        elif state.parallel:
            self.add_regions(state, to_enter)

    def add_inside(self, names: list[str], around: Node, to_enter: set[str]) -> None:
        for name in names:
            self.add_descendants(self.nodes[name], to_enter)
        for name in names:
            self.add_ancestors(self.nodes[name], around, to_enter)

    def add_ancestors(self, state: Node, ancestor: Node | None, to_enter: set[str]) -> None:
        for around in state.proper_ancestors(ancestor):
            if around is self.root:
                return
            to_enter.add(around.name)
            if around.parallel:
                self.add_regions(around, to_enter)

    def add_regions(self, parallel: Node, to_enter: set[str]) -> None:
        for child in parallel.child_states():
            if not any(self.nodes[name].is_descendant(child) for name in to_enter):
                self.add_descendants(child, to_enter)

    # The tree

    def get_effective_targets(self, names: tuple[str, ...] | list[str]) -> list[Node]:
        targets: list[Node] = []
        for name in names:
            node = self.nodes[name]
            if node.history is None:
                targets.append(node)
            elif name in self.history_value:
                targets += [self.nodes[each] for each in self.history_value[name]]
            else:
                targets += self.get_effective_targets(node.begin()[0])
        return targets

    def get_transition_domain(self, transition: Transition) -> Node:
        targets = self.get_effective_targets(transition.target)
        source = self.nodes[transition.source]
        inside = all(target.is_descendant(source) for target in targets)
        if transition.internal and source.compound and inside:
            return source
        return self.find_lcca([source, *targets])

    def find_lcca(self, states: list[Node]) -> Node:
        for around in states[0].proper_ancestors():
            if around.compound and all(one.is_descendant(around) for one in states[1:]):
                return around
        return self.root

    def in_document_order(self, names: set[str]) -> list[Node]:
        return sorted((self.nodes[name] for name in names), key=lambda node: node.order)

    # Executable content

    def execute(self, content: list[dict[str, Any]]) -> None:
        for action in content:
            match action:
                case {"log": text}:
                    self.said.append(text)
                case {"raise": event}:
                    self.internal_queue.append(event)
                case {"assign": assigned}:
                    ((name, change),) = assigned.items()
                    self.variables[name] += change["add"]


def name_match(descriptors: tuple[str, ...], event: str | None) -> bool:
    if event is None:
        return not descriptors
    words = event.split(".")
    for descriptor in descriptors:
        tokens = descriptor.removesuffix("*").removesuffix(".").split(".")
        if descriptor == "*" or words[: len(tokens)] == tokens:
            return True
    return False
