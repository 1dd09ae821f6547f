"""The study of detection: what counts, its page, and its picture."""

from __future__ import annotations

import numpy as np
import pytest

from studies import detection, detection_runs
from studies.detection_runs import GROUPS, Answers


def made(found: int, wrong: tuple[float, ...] = ()) -> Answers:
    """Of 100 robots in 50 pictures some are found, with scores 0.9, 0.89, …"""
    right = 0.9 - 0.005 * np.arange(found)
    return Answers(right, np.array(wrong), 100, 50, np.full(50, 0.004), np.full(found, 0.02))


def test_a_threshold_leaves_as_many_false_as_allowed_and_no_more():
    it = made(80, (0.95, 0.7, 0.6, 0.5, 0.3))
    least = it.least_for(0.06)  # three in 50 pictures
    assert it.false(least) == pytest.approx(0.06)
    assert it.false(least - 2e-9) == pytest.approx(0.08)
    assert it.recall(0.851) == pytest.approx(0.10)
    assert it.precision(0.851) == pytest.approx(10 / 11)
    assert made(80).least_for(0.1) == 0.0


def test_the_page_holds_the_results_and_the_picture_is_drawn(tmp_path, monkeypatch):
    monkeypatch.setattr("studies.detection_figure.EXAMPLES", 1)
    some = detection_runs.DOMAIN._replace(worlds=GROUPS["as trained"].worlds[1:2])
    monkeypatch.setattr("studies.detection_figure.GROUPS", dict.fromkeys(GROUPS, some))
    answers = {"haar": made(97), "template": made(60, (0.5,) * 20), "fused": made(98, (0.3,))}
    answers["haar, no gate"] = made(96, (0.9,))._replace(times=np.full(50, 0.04))
    detection.write(dict.fromkeys(GROUPS, answers), tmp_path, "the command", 3)
    text = (tmp_path / "detection.md").read_text()
    assert "$" not in text
    assert "97 of 100 (91.5 to 99.0 %) found, 0.000 false a picture" in text
    assert "10 times as fast, 4.0 ms a picture" in text
    assert (tmp_path / "detection.png").stat().st_size > 20_000


def test_pictures_of_a_group_are_looked_at_by_each_detector_and_both(monkeypatch):
    some = detection_runs.DOMAIN._replace(worlds=GROUPS["as trained"].worlds[1:2], towers=0.0)
    monkeypatch.setitem(detection_runs.GROUPS, "as trained", some)
    answers = detection_runs.group("as trained", 6, 4, ablation=False)
    assert list(answers) == ["haar", "template", "fused"]
    haar, both = answers["haar"], answers["fused"]
    assert haar.robots == both.robots > 4
    assert haar.recall(0.2) > 0.7
    assert both.recall(0.0) >= haar.recall(0.2)
    assert len(haar.times) == 6
    assert np.median(haar.errors) < 0.03
