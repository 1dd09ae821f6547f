"""Which sources are files, and where these are looked for."""

import pytest

from missionkit.vehicle.camera.image_source import found, is_device, is_film


@pytest.mark.parametrize(
    "source", [0, "/dev/video9", "rtsp://10.0.0.2/live", "v4l2src ! appsink", "shots/%04d.png"]
)
def test_a_source_that_is_not_a_file_is_unchanged(source, tmp_path):
    assert found(source, tmp_path) == source


def test_a_file_is_looked_for_in_the_folder_alone(tmp_path, monkeypatch):
    beside = tmp_path / "beside"
    beside.mkdir()
    (tmp_path / "film.avi").touch()
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=r"no such file in .*beside; none are known here"):
        found("film.avi", beside)
    (beside / "film.avi").touch()
    assert found("film.avi", beside) == str(beside / "film.avi")
    assert found(str(tmp_path / "film.avi"), beside) == str(tmp_path / "film.avi")


def test_the_nearest_is_named_among_films(tmp_path):
    for name in ("morning.mp4", "evening.MKV", "notes.txt"):
        (tmp_path / name).touch()
    with pytest.raises(ValueError, match=r"did you mean 'morning.mp4'\? Known: evening.MKV, mor"):
        found("mornign.mp4", tmp_path)


def test_a_folder_is_not_a_film(tmp_path):
    with pytest.raises(ValueError, match="this is not a file"):
        found(".", tmp_path)


def test_a_missing_folder_is_reported_as_empty(tmp_path):
    with pytest.raises(ValueError, match=r"no such file in .*; none are known here"):
        found("away/film.mp4", tmp_path)


def test_a_film_plays_without_waiting_but_a_device_waits(tmp_path):
    (tmp_path / "film.avi").touch()
    assert is_film(str(tmp_path / "film.avi"))
    assert not is_film(0)
    assert not is_film("rtsp://10.0.0.2/live")
    assert [is_device(it) for it in (3, "/dev/video0", "film.avi")] == [True, True, False]
