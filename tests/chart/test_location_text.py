from __future__ import annotations

import pytest

from missionkit.chart.text.location_text import location_text

DATA = {
    "states": {"gps": {"transitions": [{"when": {"all": ["a", {"not": {"use": "b"}}]}}]}},
    "failsafes": [{"name": "link"}, {"to": "land"}],
    "control": {"gps": {"kp": [1]}},
}


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ((), ""),
        (("initial",), ""),
        (("states", "gps", "kind"), "state 'gps'"),
        (("states", "gps", "transitions", 0), "state 'gps'"),
        (("states", "gps", "transitions", 0, "to"), "state 'gps', transition 1"),
        (
            ("states", "gps", "transitions", 0, "when", "all", 1, "not", "use"),
            "state 'gps', transition 1, when, all, item 2, not",
        ),
        (("failsafes", 0, "when"), "failsafe 'link'"),
        (("failsafes", 1, "when"), "failsafe 2"),
        (("control", "gps", "kp", 0), "control, gps"),
    ],
)
def test_a_path_is_described(path: tuple[int | str, ...], words: str):
    assert location_text(DATA, path) == words
