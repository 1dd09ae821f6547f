"""Another chart in a flight that was flown: the first decision that differs is the right one."""

import json
import shutil
from itertools import pairwise

import pytest
from replays.conftest import LOOK, WORLD

import missionkit
from missionkit.api import fork
from missionkit.api import what_if as api
from missionkit.api.what_if import Question, what_if_each
from missionkit.cli.app import app
from missionkit.engine.prepared_mission import prepare
from missionkit.errors import UsageError
from missionkit.recorder.journal_reader import read_journal, tick_of
from missionkit.replays import decision_sweep
from missionkit.replays.decision_sweep import AS_FLOWN, DecisionAt, swept
from missionkit.replays.decision_table import Change

SEEN = "{use: aruco_confidence, target: pad, window: 10, enter: 0.7, exit: 0.5}"


@pytest.fixture
def edited(tmp_path):
    """Write the mission with edits, and return its path."""

    def write(*edits):
        text = LOOK
        for old, new in edits:
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "worlds").mkdir()
        (tmp_path / "worlds" / "here.yaml").write_text(WORLD)
        (tmp_path / "edited.yaml").write_text(text)
        return tmp_path / "edited.yaml"

    return write


def waiting(journal):
    """Return the time and the confidence of each tick in which the guard was evaluated."""
    ticks = (tick_of(journal, text) for _, text in journal.ticks)
    return [
        (tick.observation.now, verdict.value)
        for tick in ticks
        for name, verdict in tick.decision.verdicts
        if name.startswith("aruco")
    ]


def test_the_mission_that_was_flown_decides_the_same(run, edited):
    found = missionkit.what_if(run, edited())
    assert found.notes == ()
    assert (found.table.first, found.table.parted) == (None, None)
    assert [row.change for row in found.table.rows] == [Change.SAME] * 2


@pytest.mark.parametrize("enter", [0.35, 0.45, 0.55])
def test_a_lower_threshold_is_crossed_where_the_record_says(run, journal, edited, enter):
    values = waiting(journal)
    crossed = next(at for at, value in values if value is not None and value >= enter)
    lower = SEEN.replace("0.7, exit: 0.5", f"{enter}, exit: 0.2")
    found = missionkit.what_if(run, edited((SEEN, lower)))
    first = found.table.first
    assert first is not None
    assert (first.change, first.now.at) == (Change.EARLIER, crossed)
    assert first.evidence
    assert found.table.parted == crossed


def test_how_long_it_must_hold_counts_from_when_it_held(run, edited):
    found = missionkit.what_if(run, edited((SEEN + "}", SEEN + ", for: 0.4}")))
    first = found.table.first
    assert first.change is Change.LATER
    assert first.now.at - first.flown.at == pytest.approx(0.4, abs=0.051)


def test_a_timer_that_is_shorter_acts_first(run, journal, edited):
    begun = waiting(journal)[0][0]
    found = missionkit.what_if(run, edited(("after: 20", "after: 0.2")))
    first = found.table.first
    assert first.change is Change.EARLIER
    assert first.now.reason == "after 0.2 s"
    assert first.now.at == pytest.approx(begun + 0.2, abs=0.06)


def test_a_transition_that_is_gone_is_missing(run, edited):
    found = missionkit.what_if(run, edited(("      - {to: land, when: " + SEEN + "}\n", "")))
    first = found.table.first
    assert (first.change, first.now) == (Change.MISSING, None)
    assert first.evidence


def test_what_follows_another_command_is_marked(run, journal):
    found = missionkit.what_if(run, settings={"height": 2.3})
    assert found.table.parted is not None
    assert found.table.parted < 3.0
    assert [row.evidence for row in found.table.rows] == [False, False]


def test_another_camera_does_not_see_with_its_own_eyes(run, edited):
    found = missionkit.what_if(run, edited(("size: 0.6}", "size: 0.5}")))
    (note,) = found.notes
    assert "perception differs from what flew" in note


def test_a_folder_of_flights_is_a_regression_test(run, edited, capsys):
    with pytest.raises(SystemExit) as ended:
        app(["what-if", str(run.parent), "--mission", str(edited())])
    assert ended.value.code == 0
    assert "1 flight would have gone the same way" in capsys.readouterr().out
    with pytest.raises(SystemExit) as ended:
        app(["what-if", str(run.parent), "--set", "height=2.3", "--json"])
    (told,) = json.loads(capsys.readouterr().out)
    changes = {row["change"] for row in told["transitions"]}
    assert changes
    assert ended.value.code == 1, "it would have flown differently"
    assert not any(row["evidence"] for row in told["transitions"])


def test_one_bad_journal_does_not_keep_the_others_from_being_compared(run, tmp_path, capsys):
    shutil.copytree(run, tmp_path / "good")
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad" / "journal.mcap").write_bytes(b"x")
    with pytest.raises(SystemExit) as ended:
        app(["what-if", str(tmp_path), "--set", "height=2.2"])
    assert ended.value.code == 2
    printed = capsys.readouterr()
    assert "1 flight would have gone the same way" in printed.out
    assert "bad/journal.mcap: this is not a flight record" in printed.err


def test_a_copied_journal_counts_once(run, tmp_path, capsys):
    shutil.copytree(run, tmp_path / "one")
    shutil.copy(tmp_path / "one/journal.mcap", tmp_path / "one/journal-2 (copy).mcap")
    shutil.copytree(tmp_path / "one", tmp_path / "two")
    assert len(missionkit.replay(tmp_path / "one")) == 1
    with pytest.raises(SystemExit):
        app(["what-if", str(tmp_path), "--set", "height=2.2"])
    printed = capsys.readouterr()
    assert "1 flight would have gone the same way" in printed.out
    assert "two: the same flight as" in printed.err


def test_a_value_that_comes_from_the_flight_is_named_as_such(run, edited):
    path = edited(("{height: 2.0}", "{height: 2.0, spare: 1}"), ("spare: 1", "spare: 1"),
                  ("after: 20", "after: $spare"), ("height: $height", "height: 2.0"),
                  ("window: 10", "window: $height"), ("{height: 2.0,", "{height: 10,"))  # fmt: skip
    with pytest.raises(UsageError) as refused:
        missionkit.what_if(run, path)
    assert "come from this flight, not from the file: height = 2.2 (the file: 10)" in str(
        refused.value
    )
    assert missionkit.what_if(run, path, settings={"height": 10}).table.rows


def test_flights_that_stand_on_the_same_mission_share_one_that_is_prepared(run, monkeypatch):
    made = []
    monkeypatch.setattr(api, "prepare", lambda *given: made.append(1) or prepare(*given))
    answers = what_if_each([run] * 3, Question(None, {"height": 2.2}))
    assert (len(answers), len(made)) == (3, 1)


def test_two_processes_answer_the_same(run, monkeypatch):
    monkeypatch.setattr(api, "WORTH_A_PROCESS", 2)
    question = Question(None, {"height": 2.3})
    assert what_if_each([run, run], question, processes=2) == what_if_each([run, run], question)


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        ([], "say what is to be different: --mission FILE or --set NAME=VALUE"),
        (
            ["--set", "hight=3"],
            "run/journal.mcap: look.yaml:4:1: --set hight: no such parameter; did you mean",
        ),
    ],
)
def test_mistakes_are_a_sentence(run, arguments, why, capsys):
    with pytest.raises(SystemExit) as ended:
        app(["what-if", str(run), *arguments])
    assert ended.value.code == 2
    assert why in capsys.readouterr().err


def test_a_folder_without_flights_is_refused(tmp_path):
    with pytest.raises(UsageError, match=r"it holds no journal\.mcap"):
        missionkit.what_if(tmp_path, settings={"height": 3.0})


def test_a_fork_repeats_the_rehearsal_and_flies_on_from_the_first_difference(run, edited, capsys):
    path = edited(("after: 20", "after: 0.2"))
    parted = missionkit.what_if(run, path).table.parted
    with pytest.raises(SystemExit) as ended:
        app(["what-if", str(run), "--mission", str(path), "--fork", "--json"])
    assert ended.value.code == 1
    (told,) = json.loads(capsys.readouterr().out)
    assert (told["exact"], told["parted"], told["notes"]) == (True, parted, [])
    assert [row["change"] for row in told["transitions"]] == ["same", "earlier"]
    assert all(row["evidence"] for row in told["transitions"])


def test_a_flight_over_mavlink_is_not_forked(run, monkeypatch):
    real = read_journal(run / "journal.mcap")
    real = real._replace(head=real.head._replace(vehicle="udp://:14540"))
    monkeypatch.setattr(fork, "read_journal", lambda _: real)
    with pytest.raises(UsageError, match="flown at udp://:14540: only a rehearsal"):
        fork.fork(run, settings={"height": 2.3})


def decision(value):
    """Return what a flight decides that lands earlier below 0.3 and not at all above 0.712."""
    if value < 0.3:
        return DecisionAt("a -> b earlier", value)
    return DecisionAt(AS_FLOWN) if value < 0.712 else DecisionAt("a -> b missing", 5.0)


def test_a_sweep_finds_where_the_decision_changes():
    parts = swept(decision, 0.0, 1.0)
    assert [it.says for it in parts] == ["a -> b earlier", AS_FLOWN, "a -> b missing"]
    for (below, above), edge in zip(pairwise(parts), (0.3, 0.712), strict=True):
        assert below.high < edge <= above.low <= below.high + 1.1e-3
    assert (parts[0].first, parts[0].last) == (0.0, parts[0].high)
    counts = swept(lambda value: decision(value / 100), 0, 100, whole=True)
    assert [(it.low, it.high) for it in counts] == [(0, 29), (30, 71), (72, 100)]


def test_a_sweep_asks_the_flight(run, capsys, monkeypatch):
    monkeypatch.setattr(decision_sweep, "SPLITS", 2)
    monkeypatch.setattr(decision_sweep, "KNOWN_TO", 0.5)
    with pytest.raises(SystemExit) as ended:
        app(["what-if", str(run), "--sweep", "height=2.2:2.4"])
    assert ended.value.code == 1
    printed = capsys.readouterr().out
    assert "2.2 to 2.2: as flown" in printed
    assert "2.3 to 2.4: another command" in printed


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("height", "--sweep height: expected NAME=LOW:HIGH"),
        ("hight=1:2", "hight: no such parameter; did you mean 'height'"),
        ("height=3:2", "the range is empty"),
    ],
)
def test_a_sweep_that_cannot_be_asked_is_a_sentence(run, text, why, capsys):
    with pytest.raises(SystemExit) as ended:
        app(["what-if", str(run), "--sweep", text])
    assert ended.value.code == 2
    assert why in capsys.readouterr().err
