"""Whatever a plug-in does, the call returns."""

from __future__ import annotations

import sys

import pytest

from missionkit.plugin_containment import Containment


def test_the_answer_comes_in_a_box_so_that_none_is_an_answer_too():
    contain = Containment()
    assert contain.call("x", lambda a, b: a + b, 2, 3) == (5,)
    assert contain.call("x", lambda: None) == (None,)
    assert contain.take() == ()


@pytest.mark.parametrize("foreign", [True, False])
def test_an_exception_becomes_a_sentence(foreign):
    contain = Containment()
    assert contain.call("x", lambda: int("x"), foreign=foreign) is None
    assert contain.call("y", lambda: sys.exit("enough"), foreign=foreign) is None
    assert contain.take() == (
        "x raised ValueError: invalid literal for int() with base 10: 'x'",
        "y raised SystemExit: enough",
    )
    assert contain.take() == ()


def test_the_person_at_the_keys_is_not_contained():
    def stopped():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Containment().call("x", stopped)


class Watched(Containment):
    """Refuses the answer of a plug-in called `late`; keeps what it was told."""

    def __init__(self) -> None:
        super().__init__()
        self.heard: list[str] = []

    def enter(self, name: str) -> None:
        self.heard.append(f"enter {name}")

    def abandon(self) -> None:
        self.heard.append("abandon")

    def leave(self, name: str) -> bool:
        self.heard.append(f"leave {name}")
        return name != "late"


def test_only_foreign_plugins_are_timed_and_a_late_answer_does_not_count():
    contain = Watched()
    assert contain.call("own", lambda: 1, foreign=False) == (1,)
    assert contain.heard == []
    assert contain.call("quick", lambda: 1) == (1,)
    assert contain.call("late", lambda: 1) is None
    assert contain.call("broken", lambda: 1 / 0) is None
    assert contain.heard == [
        *("enter quick", "leave quick", "enter late", "leave late", "enter broken", "abandon"),
    ]
