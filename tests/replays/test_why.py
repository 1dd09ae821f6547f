"""Why a transition was taken or was not; the smallest change is what a replay says it is."""

import json

import pytest

import missionkit
from missionkit.cli.app import app
from missionkit.errors import UsageError
from missionkit.recorder.journal_reader import tick_of

FIELDS = {"conjuncts", "before", "if_nothing_changes", "smallest_change", "fired", "text"}


def sure(journal):
    """Return when the marker was sure, and the times and values of its guard."""
    ticks = [tick_of(journal, text) for _, text in journal.ticks]
    return [
        (tick.observation.now, verdict)
        for tick in ticks
        for name, verdict in tick.decision.verdicts
        if name.startswith("aruco")
    ]


def test_what_was_taken_names_its_guards_with_values(run, journal):
    (answer,) = missionkit.why(run, "wait->land")
    at, verdict = sure(journal)[-1]
    (part,) = answer.conjuncts
    assert (answer.fired, answer.at) == (True, at)
    assert (part.holds, part.value, part.since) == (True, verdict.value, at)
    assert answer.smallest_change is None
    assert "taken at" in answer.text


def test_what_was_not_taken_says_how_near_it_came_and_what_would_have_done_it(run, journal):
    asked = sure(journal)[-4][0]  # three ticks before it was taken
    by_guard, by_timer = missionkit.why(run, "wait->land", at=asked)
    (part,) = by_guard.conjuncts
    values = [(it.margin, at) for at, it in sure(journal) if at <= asked and it.margin is not None]
    assert by_guard.fired is False
    assert part.closest == max(values, key=lambda it: (it[0], -it[1]))
    change = by_guard.smallest_change
    assert change.verified
    assert change.numbers[0].key in {"enter", "window"}
    assert change.at <= asked
    (number,) = by_timer.smallest_change.numbers
    assert (number.key, number.flown) == ("after", 20.0)
    assert number.changed == pytest.approx(asked - sure(journal)[0][0], abs=0.2)
    assert any("had passed since its state was entered" in it for it in by_timer.before)


def test_a_state_that_was_not_active_is_named(run):
    (answer,) = missionkit.why(run, "idle->wait", at=1e6)
    assert answer.before[0].endswith("idle was not active: land was")
    assert answer.smallest_change is None


@pytest.mark.parametrize(
    ("transition", "why"),
    [
        ("wait", "expected FROM->TO"),
        ("wait->lnad", "unknown state 'lnad'; did you mean 'land'"),
        ("land->idle", "no transition or failsafe leads from 'land' to 'idle'"),
    ],
)
def test_what_cannot_be_asked_is_a_sentence(run, transition, why):
    with pytest.raises(UsageError, match=why):
        missionkit.why(run, transition)


def test_the_command_answers_in_lines_or_json(run, capsys):
    for arguments in (["wait->land@3.5", "--no-changes"], ["wait->land", "@3.5", "--no-changes"]):
        with pytest.raises(SystemExit) as ended:
            app(["why", str(run), *arguments])
        assert ended.value.code == 0
        assert "not taken" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        app(["why", str(run), "wait->land", "--json"])
    (answer,) = json.loads(capsys.readouterr().out)
    assert answer.keys() >= FIELDS
    with pytest.raises(SystemExit) as ended:
        app(["why", str(run), "wait->land@soon"])
    assert "expected a mission time in seconds" in capsys.readouterr().err
