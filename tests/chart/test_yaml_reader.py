from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from missionkit.chart.text import yaml_reader
from missionkit.chart.text.located_data import place_at
from missionkit.chart.text.yaml_reader import (
    MAX_BYTES,
    MAX_DEPTH,
    read,
    read_file,
)
from missionkit.errors import FileError, Place

TEXT = """\
# a comment
first: {a: 1, b: [x, 2.5]}
second:
  - c: "quoted"
    d: |
      several
      lines
"""


def test_every_key_and_value_has_its_place():
    data = read(TEXT, "m.yaml").data
    assert data == {
        "first": {"a": 1, "b": ["x", 2.5]},
        "second": [{"c": "quoted", "d": "several\nlines\n"}],
    }
    start = Place("m.yaml", 1, 1)
    assert place_at(data, ("first", "b", 1), start) == Place("m.yaml", 2, 22)
    assert place_at(data, ("second", 0, "c"), start) == Place("m.yaml", 4, 8)
    assert data["second"][0].key_places["d"] == Place("m.yaml", 5, 5)
    assert data["first"]["b"][0].place == Place("m.yaml", 2, 19)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("no", "no"),
        ("on", "on"),
        ("012", 12),
        ("0o17", 15),
        ("0x1F", 31),
        ("-7", -7),
        ("1:30", "1:30"),
        ("1e3", 1000.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("1_000", "1_000"),
        ("2026-01-31", "2026-01-31"),
        ("+", "+"),
        ("TRUE", True),
        ("tRUE", "tRUE"),
        ("~", None),
        ("", None),
        ("'12'", "12"),
        ("!!str 12", "12"),
        ("!!float 12", 12),
        ("<<", "<<"),
        ("٣", "٣"),  # a digit, but not one of YAML's
    ],
)
def test_scalars_follow_the_core_schema(written: str, meant: object):
    found = read(f"key: {written}\n", "m.yaml").data["key"]
    assert found == meant
    assert isinstance(found, bool) == isinstance(meant, bool)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: .inf", "m.yaml:1:4: .inf is not a finite number"),
        ("a: 1e999", "m.yaml:1:4: 1e999 is not a finite number"),
        ("a: " + "9" * 5000, "m.yaml:1:4: a whole number must fit in 64 bits"),
        ("a: 1\nb: 2\na: 3", "m.yaml:3:1: duplicate key 'a': first given in line 1"),
        ("1: a", "m.yaml:1:1: a key must be a word, got 1"),
        ("? [a]\n: 1", "m.yaml:1:3: a key must be a word, got a list"),
        ("a: !mine 1", "m.yaml:1:4: tag '!mine': tags are not used"),
        ("a: !!set {b}", "m.yaml:1:4: tag 'tag:yaml.org,2002:set': tags are not used"),
        ("a: !!int x", "m.yaml:1:4: 'x' is not a valid int"),
    ],
)
def test_small_problems_leave_the_rest_readable(text: str, message: str):
    document = read(f"{text}\nlast: 1\n", "m.yaml")
    assert [str(problem) for problem in document.problems] == [message]
    assert document.data["last"] == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "m.yaml:1:1: the file is empty"),
        ("a: 1\n---\nb: 2", "m.yaml:2:1: a second document: move it to a file of its own"),
        ("a:\n\tb: 1", "m.yaml:2:1: a tab: indent with spaces"),
        ("a: \x07", "m.yaml:1:4: control character U+0007 in the text"),
        ("a: \udcff", "m.yaml:1:4: control character U+DCFF in the text"),
        ("[" * 100, f"m.yaml:1:{MAX_DEPTH + 1}: nested deeper than 64 levels"),
        ("a: &a [*a]", "m.yaml:1:8: alias *a: no anchor &a before it"),
        ("a: b: c", "m.yaml:1:5: a ':' that does not fit here: check the indentation, or quote"),
        ("x" * (MAX_BYTES + 1), "m.yaml:1:1: larger than 4 MiB"),
        ("%YAML 9.9\n---\na: 1", "m.yaml:1:1: not valid YAML"),
    ],
)
def test_what_cannot_be_read_names_its_place(text: str, message: str):
    with pytest.raises(FileError) as error:
        read(text, "m.yaml")
    assert str(error.value).startswith(message)


def test_aliases_share_values_but_have_their_own_place():
    data = read("a: &x [1, 2]\nb: *x\n", "m.yaml").data
    assert data["b"] == [1, 2]
    assert data.value_places["b"] == Place("m.yaml", 2, 4)


def test_aliases_cannot_explode():
    lines = ["a0: &a0 [" + "x, " * 10 + "]"]
    lines += [f"a{n}: &a{n} [" + f"*a{n - 1}, " * 10 + "]" for n in range(1, 9)]
    with pytest.raises(FileError, match="more than 100000 values"):
        read("\n".join(lines), "m.yaml")


def test_aliases_cannot_nest_deeper_than_brackets_may():
    deep = "[" * 40 + "]" * 40
    with pytest.raises(FileError, match=r"m\.yaml:2:34: nested deeper than 64 levels"):
        read(f"a: &a {deep}\nb: {'[' * 30}*a {']' * 30}\n", "m.yaml")


def test_a_byte_order_mark_is_ignored(tmp_path: Path):
    path = tmp_path / "m.yaml"
    path.write_bytes(b"\xef\xbb\xbfa: 1\n")
    assert read_file(path).data == {"a": 1}


def test_bytes_that_are_not_text_are_found(tmp_path: Path):
    path = tmp_path / "m.yaml"
    path.write_bytes("a: 1\nä: \xff".encode("latin-1"))
    with pytest.raises(FileError, match=r"m\.yaml:2:1: not UTF-8"):
        read_file(path)


@pytest.mark.parametrize("name", ["nowhere.yaml", ".", "nul\0.yaml"])
def test_a_file_that_cannot_be_opened(tmp_path: Path, name: str):
    with pytest.raises(FileError, match="cannot be read"):
        read_file(tmp_path / name)


def test_without_libyaml_the_same_is_read(monkeypatch: pytest.MonkeyPatch, example: Path):
    text = example.read_text()
    fast = read(text, "m.yaml").data
    monkeypatch.setattr(yaml_reader, "_Loader", yaml.SafeLoader)
    slow = read(text, "m.yaml").data
    assert slow == fast
    assert slow["states"].key_places == fast["states"].key_places
