"""The study of the known map, one flight of each variant end to end."""

from __future__ import annotations

import re

import pytest

from studies import known_map


def test_the_page_shows_the_results_of_the_flights(tmp_path, capsys):
    known_map.main(["--seeds", "1", "--workers", "1", "--out", str(tmp_path)])
    page = (tmp_path / "known_map.md").read_text()
    assert capsys.readouterr().out.strip() in page
    assert "3 of 3 flights reached" in page
    assert not re.search(r"\$[a-z]", page)
    for name in ("known_map_paths.png", "known_map_clearance.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")


def test_the_paths_of_the_paper():
    _, wide, routes = known_map.planned()
    assert wide == pytest.approx(1.15)
    lengths = [routes[name].length for name in ("classical", "modified", "modified, smoothed")]
    assert lengths == sorted(lengths, reverse=True)
    # Manhattan distance with the way round both walls: 4 legs
    assert routes["classical"].cost == pytest.approx(21.6, abs=0.3)
