from __future__ import annotations

import csv

import pytest
from campaigns import row

from missionkit.campaigns.run_journal import (
    JOURNAL_FILE,
    Journal,
    read,
    write,
)
from missionkit.errors import UsageError


def kept(folder, *rows):
    with Journal(folder) as journal:
        for it in rows:
            journal.add(it)


def test_rows_come_back_in_order_and_once(tmp_path):
    rows = [row(2), row(0, "crash"), row(1)]
    kept(tmp_path, *rows, row(1, "hung"))
    assert read(tmp_path) == [rows[1], rows[2], rows[0]]


@pytest.mark.parametrize("cut", [1, 40, 200])
def test_a_line_cut_short_by_a_kill_is_dropped_and_written_over(tmp_path, cut):
    kept(tmp_path, row(0), row(1))
    path = tmp_path / JOURNAL_FILE
    whole = path.read_bytes()
    path.write_bytes(whole[:-cut])
    assert read(tmp_path) == [row(0)]
    kept(tmp_path, row(1))
    assert path.read_bytes() == whole


def test_a_journal_is_written_by_one_process_at_a_time(tmp_path):
    with Journal(tmp_path), pytest.raises(UsageError, match="already flying this campaign"):
        Journal(tmp_path)


def test_a_line_from_another_vehicle_is_refused(tmp_path):
    (tmp_path / JOURNAL_FILE).write_text('{"number": 1}\n')
    with pytest.raises(UsageError, match=r"rows.jsonl:1: not a campaign row"):
        read(tmp_path)


def test_the_table_has_a_row_for_each_run_and_a_column_for_everything(tmp_path):
    lost = row(1, "hung", parameters={}, settings={"height": "3"}, metrics={}, times={})
    write(tmp_path, [row(0, parameters={"height": 2.0, "at": [1, 2]}), lost])
    with (tmp_path / "runs.csv").open() as stream:
        first, second = csv.DictReader(stream)
    assert first["param:at"] == "[1, 2]"
    assert (first["time:idle"], first["count:idle -> land"]) == ("4.0", "1")
    assert (first["path"], first["outcome"]) == ("idle > land", "success")
    assert (second["param:height"], second["metric:duration"]) == ("3", "")
    assert second["outcome"] == "hung"


@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1", " =1", "\r=1"])
def test_a_text_is_not_a_spreadsheet_formula(tmp_path, text):
    write(tmp_path, [row(0, parameters={"label": text, "down": -2.0}, problems=(text,))])
    with (tmp_path / "runs.csv").open(newline="") as stream:
        (first,) = csv.DictReader(stream)
    cell = f"'{text}".replace("\r", "\ufffd")
    assert (first["param:label"], first["problems"]) == (cell, cell)
    assert first["param:down"] == "-2.0"
