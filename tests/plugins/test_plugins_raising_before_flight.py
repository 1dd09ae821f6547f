"""Plug-ins that raise while a mission is read: one sentence, with the place of their use."""

from __future__ import annotations

import pytest

from missionkit.api.missions import assemble
from missionkit.chart.checks.guard_regions import region_of
from missionkit.chart.load import parse
from missionkit.errors import FileError

PLUGINS = '''\
"""Raise where they should not."""

from typing import ClassVar

from pydantic import field_validator

from missionkit.messages import Step, Verdict
from missionkit.plugin import Behavior, Guard, WindowGuard


class Late(BaseException):
    pass


def raised(how):
    known = {"late": Late, "stop": KeyboardInterrupt, "exit": SystemExit, "error": RuntimeError}
    if how in known:
        raise known[how]("no")


class Picky(Guard):
    kind: ClassVar[str] = "picky"
    how: str

    @field_validator("how")
    @classmethod
    def looked_at(cls, how):
        raised(how)
        return how

    def check(self, seen):
        return Verdict(False)


class Vague(Guard):
    kind: ClassVar[str] = "vague"
    how: str

    def region(self):
        raised(self.how)

    def check(self, seen):
        return Verdict(False)


class Forgetful(WindowGuard):
    kind: ClassVar[str] = "forgetful"
    how: str

    def begin(self):
        raised(self.how)

    def advance(self, memory, seen):
        return memory

    def check(self, memory, seen):
        return Verdict(False)


class Aimless(Behavior):
    kind: ClassVar[str] = "aimless"
    how: str

    def targets(self):
        raised(self.how)
        return ()

    def step(self, seen, memory):
        return Step()


class Unfit(Behavior):
    kind: ClassVar[str] = "unfit"
    how: str

    def unfit(self, known, targets):
        raised(self.how)
        return ""

    def step(self, seen, memory):
        return Step()
'''

MISSION = """\
missionkit: 1
mission: m
initial: idle
states:
  idle:
    kind: idle
    behavior: {behavior}
    transitions: [{{to: idle, when: {guard}}}]
"""
TAKE_OFF = "{use: take_off, height: 3}"


@pytest.fixture(scope="module")
def catalogue(tmp_path_factory):
    path = tmp_path_factory.mktemp("plugins") / "raising.py"
    path.write_text(PLUGINS)
    return assemble([path])


@pytest.mark.parametrize(
    ("how", "says"),
    [
        ("late", "Late: no"),
        ("stop", "KeyboardInterrupt: no"),
        ("exit", "SystemExit: no"),
        ("error", "RuntimeError: no"),
    ],
)
@pytest.mark.parametrize(
    ("kind", "place", "why"),
    [
        ("picky", "m.yaml:8:42: ", "guard 'picky' cannot be used: it raised "),
        ("forgetful", "m.yaml:8:42: ", "guard 'forgetful' cannot be used: it raised "),
        ("aimless", "m.yaml:7:21: ", "behaviour 'aimless' cannot be used: it raised "),
        ("unfit", "m.yaml:7:15: ", "state 'idle': unfit: unfit raised "),
    ],
)
def test_a_plugin_that_raises_while_it_is_read_is_a_sentence(
    catalogue, kind, place, why, how, says
):
    use = f"{{use: {kind}, how: {how}}}"
    is_guard = kind in catalogue.group("guards")
    text = MISSION.format(behavior=TAKE_OFF if is_guard else use, guard=use if is_guard else "done")
    with pytest.raises(FileError) as refusal:
        parse(text, "m.yaml", catalogue)
    (problem,) = refusal.value.problems
    assert str(problem.place) + ": " == place
    assert problem.message.endswith(why + says)


@pytest.mark.parametrize("how", ["late", "stop", "exit", "error"])
def test_a_guard_that_cannot_declare_what_it_reads_counts_as_one_that_does_not(catalogue, how):
    assert region_of(catalogue.group("guards")["vague"](how=how)) is None


def test_plugins_that_do_not_raise_are_read(catalogue):
    for kind in ("picky", "vague", "forgetful"):
        guard = f"{{use: {kind}, how: well}}"
        parse(MISSION.format(behavior=TAKE_OFF, guard=guard), "m", catalogue)
    for kind in ("aimless", "unfit"):
        behavior = f"{{use: {kind}, how: well}}"
        parse(MISSION.format(behavior=behavior, guard="done"), "m", catalogue)
