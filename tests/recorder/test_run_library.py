"""The library of runs: searched, tagged, compared; what is damaged is one line."""

import json

import pytest

from missionkit.cli.app import app
from missionkit.errors import UsageError
from missionkit.recorder import flight_track
from missionkit.recorder.run_library import runs_of, tag
from missionkit.recorder.run_summary import StateChange, summarise


def write(folder, **changes):
    """Write the summary of a run that never was."""
    folder.mkdir(parents=True)
    summary = summarise(
        flight_track.begin(),
        mission="errand",
        outcome="success",
        reason="flown as planned",
        seed=1,
    )
    summary = summary.model_copy(update=changes)
    (folder / "summary.json").write_text(summary.model_dump_json())
    return folder


@pytest.fixture
def library(tmp_path):
    out = StateChange(at=4.0, source="idle", to="out", reason="when done")
    write(tmp_path / "a", duration=20.0, transitions=(out,))
    write(tmp_path / "b", outcome="ended_safely", reason="failsafe battery", faults=("wind",),
          transitions=(out.model_copy(update={"at": 5.0}),))  # fmt: skip
    write(tmp_path / "fleet" / "north")
    (tmp_path / "killed").mkdir()
    (tmp_path / "killed" / "journal.mcap").write_bytes(b"")
    (tmp_path / "odd").mkdir()
    (tmp_path / "odd" / "summary.json").write_bytes(b"{\xff")
    (tmp_path / "notes").mkdir()
    return tmp_path


def called(arguments, capsys):
    """Return the exit code and what was printed."""
    with pytest.raises(SystemExit) as ended:
        app(["runs", *map(str, arguments)])
    printed = capsys.readouterr()
    return ended.value.code, printed.out + printed.err


def test_every_run_is_a_line_also_one_that_is_damaged(library, capsys):
    code, printed = called([library], capsys)
    assert code == 0
    lines = printed.splitlines()
    assert lines[0].split() == ["a", "success", "20.0", "s", "errand"]
    assert [line.split()[0] for line in lines[:-1]] == ["a", "b", "fleet/north", "killed", "odd"]
    assert "no summary.json: the flight was killed" in lines[3]
    assert "summary.json cannot be read: not UTF-8 text" in lines[4]
    assert lines[-1] == "5 runs: 2 success, 1 ended safely, 2 unknown"


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"mission": 3}', "null", "[" * 5000])
def test_a_summary_of_any_content_is_a_line(content, library):
    (library / "odd" / "summary.json").write_text(content)
    odd = runs_of(library)[-1]
    assert odd.problem.startswith("summary.json cannot be read: ")
    assert "\n" not in odd.problem


def test_runs_are_found_by_words_outcome_and_tags(library, capsys):
    def names(*options):
        _, printed = called([library, "--json", *options], capsys)
        return [it["folder"].rsplit("/", 1)[-1] for it in json.loads(printed)]

    assert names("--search", "WIND battery") == ["b"]
    assert names("--outcome", "ended safely") == ["b"]
    assert names("--outcome", "unknown") == ["killed", "odd"]
    good = ("--search", "errand", "--outcome", "success", "--add-tag", "good")
    assert names(*good) == ["a", "north"]
    assert names("--tag", "good") == ["a", "north"]
    assert names("--tag", "good", "--remove-tag", "good") == ["a", "north"]
    assert names("--tag", "good") == []
    assert not (library / "a" / "tags.txt").exists()


def test_what_cannot_be_a_tag_is_refused_and_damaged_tags_are_a_line(library):
    for name in ("", "two words", "a/b", "../x", "-x"):
        with pytest.raises(UsageError, match="expected up to 64 letters"):
            tag(library / "a", [name])
    (library / "a" / "tags.txt").write_bytes(b"\xff")
    first = runs_of(library)[0]
    assert (first.tags, first.problem) == ((), "tags.txt cannot be read: not UTF-8 text")
    assert first.summary is not None


def test_two_runs_are_compared(library, capsys):
    code, printed = called([library / "a", "--compare", library / "b"], capsys)
    assert code == 0
    assert "outcome: success | ended safely" in printed
    assert "later    idle -> out: 4.00 s (when done) | 5.00 s (when done)" in printed
    code, printed = called([library / "a", "--compare", library / "odd"], capsys)
    assert code == 2
    assert "odd: summary.json cannot be read" in printed


def test_a_folder_that_is_not_there_is_refused(tmp_path, capsys):
    code, printed = called([tmp_path / "nowhere"], capsys)
    assert (code, "nowhere: no such folder" in printed) == (2, True)
