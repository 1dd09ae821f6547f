"""The study of broken documents: the same documents for the same seed, and what it counts."""

from __future__ import annotations

from pathlib import Path

import pytest

from studies import fuzz
from studies.fuzz_documents import FAMILIES, document

CHEAP = [family for family in FAMILIES if family != "wide"]


@pytest.mark.parametrize("family", FAMILIES)
def test_a_document_is_the_same_for_the_same_seed_and_another_for_another(family):
    first = [document(family, 1, number) for number in range(2)]
    assert first == [document(family, 1, number) for number in range(2)]
    assert first != [document(family, 2, number) for number in range(2)]


@pytest.mark.parametrize("family", CHEAP)
def test_broken_documents_are_refused_or_checked(family, tmp_path):
    outcomes = [fuzz.judge(fuzz.Order(family, 7, number), tmp_path) for number in range(12)]
    assert [it.crash for it in outcomes if it.crash] == []
    assert all(it.loaded or it.problems for it in outcomes)
    assert not list(tmp_path.iterdir())


def test_some_documents_are_read_and_found_wrong(tmp_path):
    outcomes = [fuzz.judge(fuzz.Order("rewired", 7, number), tmp_path) for number in range(6)]
    assert any(it.loaded and it.problems for it in outcomes)


def test_a_traceback_is_counted(monkeypatch, capsys):
    def broken(path: Path, catalogue: object) -> None:
        raise RecursionError("too deep")

    monkeypatch.setattr(fuzz, "checked", broken)
    assert fuzz.main(["--documents", str(len(FAMILIES)), "--workers", "1"]) == 1
    printed = capsys.readouterr().out
    assert (
        f"| all          | {len(FAMILIES)}         | 0    | 0        | {len(FAMILIES)} " in printed
    )
    assert "--only spliced:0:" in printed
    assert "RecursionError: too deep" in printed


def test_a_slow_document_is_reported(monkeypatch, capsys):
    monkeypatch.setattr(fuzz, "LIMIT", -1.0)
    assert fuzz.main(["--documents", "1", "--workers", "1"]) == 1
    assert "--only spliced:0:" in capsys.readouterr().out


def test_one_document_can_be_written(capsysbinary):
    assert fuzz.main(["--only", "deep:3", "--seed", "4"]) == 0
    assert capsysbinary.readouterr().out == document("deep", 4, 3)
