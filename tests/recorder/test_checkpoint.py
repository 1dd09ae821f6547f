"""Whenever the process dies, one of two checkpoints can be read; a damaged one is recognised."""

from __future__ import annotations

import errno
import hashlib
import os

import numpy as np
import pytest

from missionkit.errors import UsageError
from missionkit.recorder import checkpoint
from missionkit.recorder.checkpoint import (
    BEFORE_NEWEST,
    CHECKPOINT_PREFIX,
    HEADER,
    NEWEST,
    Checkpoints,
    load,
)

ROWS = np.arange(30.0).reshape(10, 3)


def journal(count):
    """The first rows of a track that grows."""
    return {"truth": lambda first: ROWS[first:count]}


def saved(folder, *counts):
    files = Checkpoints(folder)
    for count in counts:
        files.save({"rows": count}, journal(count))
    return files


def test_the_newest_is_read_with_its_rows(tmp_path):
    saved(tmp_path, 2, 2, 7)
    found = load(tmp_path)
    assert (found.value, found.name, found.wrong) == ({"rows": 7}, NEWEST, ())
    np.testing.assert_array_equal(found.journals["truth"], ROWS[:7])
    assert {path.name for path in tmp_path.iterdir()} == {
        *(NEWEST, BEFORE_NEWEST, "checkpoint-truth.rows")
    }


def cut(text):
    return text[: len(text) // 2]


def emptied(_):
    return ""


def changed(text):
    return text.replace('"rows",7', '"rows",8')


def renewed(text):
    return text.replace(HEADER, f"{CHECKPOINT_PREFIX}999")


@pytest.mark.parametrize("damage", [cut, emptied, changed, renewed])
def test_a_damaged_one_is_named_and_the_one_before_is_used(tmp_path, damage):
    saved(tmp_path, 2, 7)
    text = (tmp_path / NEWEST).read_text()
    assert damage(text) != text
    (tmp_path / NEWEST).write_text(damage(text))
    found = load(tmp_path)
    assert (found.value, found.name) == ({"rows": 2}, BEFORE_NEWEST)
    np.testing.assert_array_equal(found.journals["truth"], ROWS[:2])
    (wrong,) = found.wrong
    assert wrong.startswith(f"{tmp_path / NEWEST}: this checkpoint cannot be used: ")


def test_a_checkpoint_of_another_version_is_refused_in_a_sentence(tmp_path):
    saved(tmp_path, 2)
    path = tmp_path / NEWEST
    path.write_text(renewed(path.read_text()))
    with pytest.raises(UsageError, match="another version of missionkit wrote it"):
        load(tmp_path)


def test_bytes_that_are_not_text_are_refused_in_a_sentence(tmp_path):
    saved(tmp_path, 2)
    (tmp_path / NEWEST).write_bytes(b"\xff\xfe\x00")
    with pytest.raises(UsageError, match="this checkpoint cannot be used"):
        load(tmp_path)


def test_rows_that_are_missing_are_noticed(tmp_path):
    saved(tmp_path, 2, 7)
    os.truncate(tmp_path / "checkpoint-truth.rows", 4 * 3 * 8)
    assert load(tmp_path).value == {"rows": 2}
    (tmp_path / "checkpoint-truth.rows").unlink()
    with pytest.raises(UsageError, match=r"rows: no such file, though checkpoint.json needs it"):
        load(tmp_path)


def test_changed_rows_are_reported_and_the_previous_checkpoint_used(tmp_path):
    saved(tmp_path, 2, 7)
    path = tmp_path / "checkpoint-truth.rows"
    data = bytearray(path.read_bytes())
    data[3 * 3 * 8] ^= 1  # of the fourth row, which the checkpoint before does not stand on
    path.write_bytes(data)
    found = load(tmp_path)
    assert (found.value, found.name) == ({"rows": 2}, BEFORE_NEWEST)
    assert found.wrong == (
        f"{tmp_path / NEWEST}: this checkpoint cannot be used: "
        "checkpoint-truth.rows, which it builds on, was truncated or changed",
    )
    data[0] ^= 1
    path.write_bytes(data)
    with pytest.raises(UsageError, match=r"(?s)checkpoint\.json.*checkpoint-before\.json"):
        load(tmp_path)


def test_of_all_changes_of_a_bit_none_is_taken_for_the_truth(tmp_path):
    """Whatever is read after a change is what was saved, then or before."""
    rng, files = np.random.default_rng(7), tmp_path / "run"
    files.mkdir()
    saved(files, 4, 7)
    whole = {path: path.read_bytes() for path in files.iterdir()}
    for _ in range(600):
        path = list(whole)[rng.integers(len(whole))]
        data = bytearray(whole[path])
        data[rng.integers(len(data))] ^= 1 << rng.integers(8)
        path.write_bytes(data)
        try:
            found = load(files)
        except UsageError:
            pass
        else:
            assert found.value in ({"rows": 4}, {"rows": 7})
            np.testing.assert_array_equal(found.journals["truth"], ROWS[: found.value["rows"]])
        path.write_bytes(whole[path])


def test_rows_that_were_half_written_when_the_disk_was_full_are_written_again(tmp_path):
    files = saved(tmp_path, 2)
    with (tmp_path / "checkpoint-truth.rows").open("ab") as stream:
        stream.write(b"half a row")
    files.save({"rows": 7}, journal(7))
    np.testing.assert_array_equal(load(tmp_path).journals["truth"], ROWS[:7])


def test_a_checkpoint_that_cannot_be_written_leaves_both_before_it(tmp_path, monkeypatch):
    files = saved(tmp_path, 2, 4)

    def full(_):
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(checkpoint.os, "fsync", full)
        with pytest.raises(OSError, match="No space left"):
            files.save({"rows": 7}, journal(7))
    assert load(tmp_path).value == {"rows": 4}
    (tmp_path / NEWEST).unlink()
    assert load(tmp_path).value == {"rows": 2}


def test_without_a_checkpoint_there_is_nothing_to_resume(tmp_path):
    with pytest.raises(UsageError, match="nothing to resume: it holds no checkpoint"):
        load(tmp_path)


class DiedError(Exception):
    """Stands for a process that is killed."""


@pytest.mark.parametrize("call", range(1, 7))
def test_death_at_any_step_of_writing_leaves_one_that_can_be_read(tmp_path, monkeypatch, call):
    """Every system call that writing the third checkpoint makes is the last one once."""
    files, count, died = saved(tmp_path, 2, 4), 0, False
    real = {name: getattr(os, name) for name in ("replace", "fsync")}

    def dying(name):
        def step(*arguments):
            nonlocal count
            count += 1
            if count == (call + 1) // 2 and call % 2:
                raise DiedError
            real[name](*arguments)
            if count == call // 2 and not call % 2:
                raise DiedError

        return step

    for name in real:
        monkeypatch.setattr(checkpoint.os, name, dying(name))
    try:
        files.save({"rows": 7}, journal(7))
    except DiedError:
        died = True
    monkeypatch.undo()
    found = load(tmp_path)
    assert died
    assert found.value in ({"rows": 4}, {"rows": 7})
    np.testing.assert_array_equal(found.journals["truth"], ROWS[: found.value["rows"]])


@pytest.mark.parametrize("broken", [False, True])
def test_resuming_drops_newer_rows_and_appends(tmp_path, broken):
    saved(tmp_path, 2, 7)
    if broken:
        (tmp_path / NEWEST).write_text("")
    before = load(tmp_path)
    with (tmp_path / "checkpoint-truth.rows").open("ab") as stream:
        stream.write(b"half a row")
    files = Checkpoints(tmp_path, before)
    assert load(tmp_path).value == before.value
    files.save({"rows": 9}, journal(9))
    found = load(tmp_path)
    np.testing.assert_array_equal(found.journals["truth"], ROWS[:9])
    (tmp_path / NEWEST).unlink()
    assert load(tmp_path).value == before.value


def test_a_foreign_checkpoint_cannot_name_a_file_outside_its_folder(tmp_path):
    secret = tmp_path / "checkpoint-x.rows"
    secret.write_bytes(b"12345678")
    run = tmp_path / "run"
    run.mkdir()
    digest = hashlib.sha256(b"12345678").hexdigest()
    forged = checkpoint.Saved(1, {"x/../../checkpoint-x": checkpoint.Stretch(1, 1, digest)})
    (run / NEWEST).write_text(checkpoint.sealed(forged))
    with pytest.raises(UsageError, match="cannot be used"):
        load(run)


def test_a_flight_that_has_ended_leaves_none(tmp_path):
    saved(tmp_path, 2, 7).forget()
    assert not list(tmp_path.iterdir())
