"""Whatever a plug-in does, the call returns."""

from __future__ import annotations

import asyncio
import os
import signal
import sys

import pytest

from missionkit.plugin_containment import (
    Containment,
    PluginError,
    marking_interrupts,
    reporting_faults,
)


def test_the_result_is_boxed_so_that_none_can_be_a_result():
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


def raising(error):
    def call():
        raise error

    return call


def ctrl_c():
    os.kill(os.getpid(), signal.SIGINT)
    for _ in range(1000):  # the interpreter looks for signals at each turn
        pass


ENDING = [KeyboardInterrupt, SystemExit, GeneratorExit, asyncio.CancelledError]


@pytest.mark.parametrize("error", ENDING)
def test_a_plugin_that_raises_what_ends_a_program_is_contained(error):
    contain = Containment()
    assert contain.call("x", raising(error)) is None
    assert contain.take() == (f"x raised {error.__name__}",)
    with pytest.raises(PluginError, match=f"^{error.__name__}$"), reporting_faults():
        raising(error)()


def test_ctrl_c_is_not_contained():
    before = signal.getsignal(signal.SIGINT)
    contain = Containment()
    with pytest.raises(KeyboardInterrupt), marking_interrupts():
        contain.call("x", ctrl_c)
    with pytest.raises(KeyboardInterrupt), reporting_faults():
        ctrl_c()
    assert signal.getsignal(signal.SIGINT) is before


class Watched(Containment):
    """Refuses the answer of a plug-in called `late`; keeps what was noted."""

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
