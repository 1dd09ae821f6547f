"""A flight that is ticked again decides the same to the last bit; a journal says when it cannot."""

import json
import shutil

import numpy as np
import pytest
from mcap.reader import make_reader

import missionkit
from missionkit.api.recorded_mission import mission_flown, restored
from missionkit.api.run_origin import Origin
from missionkit.cli.app import app
from missionkit.errors import UsageError
from missionkit.recorder import value_codec
from missionkit.recorder.flight_journal import TICK
from missionkit.recorder.journal_reader import memory_of, read_journal, tick_of
from missionkit.replays.decision_difference import first_difference, same
from missionkit.replays.replayed_flight import replayed, start_at


def with_tick(journal, number, **changes):
    """Return the journal with another decision at one tick."""
    texts = list(journal.ticks)
    tick = tick_of(journal, texts[number][1])
    changed = tick._replace(decision=tick.decision._replace(**changes))
    texts[number] = (texts[number][0], value_codec.written(changed).encode())
    return journal._replace(ticks=tuple(texts))


def differing(plan, journal):
    """Return the number of the first tick that differs, and its field."""
    every = ((it.number, first_difference(it.flown, it.replayed)) for it in replayed(plan, journal))
    return next(((number, field) for number, field in every if field), None)


def test_it_decides_the_same_without_its_images_and_files(run, journal):
    (part,) = missionkit.replay(run)
    assert part.difference is None
    assert part.notes == ()
    assert (
        part.ticks
        == len(journal.ticks)
        == json.loads((run / "summary.json").read_text())["timing"]["ticks"]
    )


def test_from_any_memory_too(run, plan, journal):
    assert len(journal.memories) >= 2
    for at, _ in journal.memories:
        (part,) = missionkit.replay(run, since=at + 1.0)
        assert (part.difference, part.since) == (None, pytest.approx(at))


def test_the_memory_it_passes_is_the_one_that_was_kept(plan, journal):
    kept = {memory.number: memory.memory for memory in (
        memory_of(journal, text) for _, text in journal.memories)}  # fmt: skip
    compared = 0
    for tick in replayed(plan, journal):
        if tick.number + 1 in kept:
            assert value_codec.written(tick.memory) == value_codec.written(kept[tick.number + 1])
            compared += 1
    assert compared == len(kept)


def test_the_first_field_that_differs_is_named_with_its_tick(plan, journal):
    number = 60
    flown = tick_of(journal, journal.ticks[number][1]).decision
    assert differing(plan, journal) is None
    assert differing(plan, with_tick(journal, number, active=("wait", "up"))) == (
        number, f"active: wait, up flown, {', '.join(flown.active)} replayed",
    )  # fmt: skip
    assert differing(plan, with_tick(journal, number, done=not flown.done))[1].startswith("done: ")


def test_the_last_bit_counts(plan, journal):
    number, name, verdict = next(
        (tick.number, name, verdict)
        for tick in (tick_of(journal, text) for _, text in journal.ticks)
        for name, verdict in tick.decision.verdicts
        if verdict.value is not None
    )
    flown = tick_of(journal, journal.ticks[number][1]).decision
    moved = verdict._replace(value=float(np.nextafter(verdict.value, 10.0)))
    verdicts = tuple((it, moved if it == name else was) for it, was in flown.verdicts)
    at, field = differing(plan, with_tick(journal, number, verdicts=verdicts))
    assert at == number
    assert field.startswith(f"guard {name}, value: ")


def test_a_journal_that_was_cut_short_is_replayed_as_far_as_it_goes(run, tmp_path):
    data = (run / "journal.mcap").read_bytes()
    for share in (0.3, 0.9):
        cut = tmp_path / "cut.mcap"
        cut.write_bytes(data[: int(share * len(data))])
        (part,) = missionkit.replay(cut)
        assert part.difference is None
        assert 0 < part.ticks < len(read_journal(run / "journal.mcap").ticks)
        assert part.notes == (
            f"{cut}: it ends at {part.until:.2f} s: the flight goes on, or was killed, "
            "or the file was cut short",
        )


def test_a_journal_that_was_changed_in_the_middle_says_how_far_it_can_be_read(run, tmp_path):
    data = bytearray((run / "journal.mcap").read_bytes())
    middle = len(data) // 2
    for at in range(middle, middle + 40):
        data[at] ^= 0x55
    (tmp_path / "journal.mcap").write_bytes(data)
    (part,) = missionkit.replay(tmp_path)
    assert part.difference is None
    assert 0 < part.ticks < len(read_journal(run / "journal.mcap").ticks)
    (note,) = part.notes
    assert note.endswith(f"it can be read up to {part.until:.2f} s: the rest is damaged")
    assert missionkit.what_if(tmp_path, settings={"height": 2.2}).notes == (note,)


def test_a_start_after_the_end_of_the_flight_is_refused(run):
    with pytest.raises(UsageError, match=r"there is nothing after 1e\+06 s: it ends at"):
        missionkit.replay(run, since=1e6)


def test_a_folder_of_several_runs_is_replayed(run, tmp_path):
    for name in ("north", "south"):
        shutil.copytree(run, tmp_path / name)
    assert [it.journal.parent.name for it in missionkit.replay(tmp_path)] == ["north", "south"]
    with pytest.raises(UsageError, match="nowhere: no such folder"):
        missionkit.replay(tmp_path / "nowhere")


def test_after_a_missing_tick_nothing_is_compared(plan, journal):
    gap = journal._replace(ticks=(*journal.ticks[:50], *journal.ticks[51:]))
    assert [it.number for it in replayed(plan, gap)] == list(range(50))


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (None, "neither it nor a folder in it holds a journal.mcap"),
        (b"", "this is not a flight record (MCAP)"),
        (b"\x89MCAP0\r\n" + bytes(40), "this is not the journal of a flight: it names no mission"),
    ],
)
def test_what_is_no_journal_is_refused_in_a_sentence(content, why, tmp_path):
    if content is not None:
        (tmp_path / "journal.mcap").write_bytes(content)
    with pytest.raises(UsageError, match=r"neither it|this is not") as refused:
        missionkit.replay(tmp_path)
    assert why in str(refused.value)


def test_a_start_behind_the_end_replays_from_the_last_memory(plan, journal):
    start = start_at(plan, journal, 1e6)
    assert start.memory.now == pytest.approx(journal.memories[-1][0])


def test_the_command_says_so_in_a_line_and_by_its_exit_code(run, capsys):
    with pytest.raises(SystemExit) as ended:
        app(["replay", str(run)])
    assert ended.value.code == 0
    assert "no difference" in capsys.readouterr().out
    with pytest.raises(SystemExit) as ended:
        app(["replay", str(run), "--json"])
    (part,) = json.loads(capsys.readouterr().out)
    assert part["difference"] is None


def origin(mission, texts, plugins=()):
    return Origin(str(mission), (), plugins, 0, (), {}, (), texts, "1")


def test_a_file_beside_the_mission_s_folder_is_restored_inside_the_given_one(tmp_path):
    texts = {"m.yaml": "a", "../parts/b.yaml": "b\r\n"}
    path = restored(tmp_path, origin("/there/missions/m.yaml", texts), tmp_path / "files")
    assert path.read_text() == "a"
    assert (path.parent / "../parts/b.yaml").resolve().read_bytes() == b"b\r\n"


def test_a_binary_file_must_still_be_the_one_that_was_flown(tmp_path):
    (tmp_path / "map.png").write_bytes(b"\xff\xfe")
    flown = "2 bytes, SHA-256 " + "0" * 64
    texts = {"m.yaml": "a", "map.png": flown}
    with pytest.raises(UsageError, match=r"map\.png, which the flight stood on, has changed since"):
        restored(tmp_path, origin(tmp_path / "m.yaml", texts), tmp_path / "files")


def test_plug_in_files_are_never_run_by_themselves(journal, tmp_path):
    foreign = tmp_path / "mine.py"
    foreign.write_text("raise SystemExit('it ran')")
    head = journal.head._replace(
        origin=journal.head.origin._replace(plugins=(str(foreign),), mission=str(tmp_path / "m"))
    )
    with pytest.raises(UsageError, match=r"review them and name them: --plugin .*mine\.py"):
        mission_flown(journal._replace(head=head), tmp_path / "files")


def test_values_are_compared_to_the_bit_and_by_type():
    assert same(np.nan, np.nan)
    assert same((1.0, np.zeros(2)), (1.0, np.zeros(2)))
    for one, other in [
        (0.0, -0.0), (1, 1.0), (True, 1), ((1,), (1, 2)), (np.zeros(2), -np.zeros(2)),
        (np.zeros(2), np.zeros(2, np.float32)), (None, 0),
    ]:  # fmt: skip
        assert not same(one, other)


def test_the_file_is_read_by_any_reader_of_mcap(run, journal):
    with (run / "journal.mcap").open("rb") as stream:
        topics = [channel.topic for _, channel, _ in make_reader(stream).iter_messages()]
    assert topics.count(TICK) == len(journal.ticks)
