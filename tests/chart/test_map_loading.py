"""The map of a mission: read with it, and its mistakes reported with it."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from missionkit.chart import map_loading
from missionkit.chart.load import elaborate, load, parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.text.parameter_expansion import Expanded
from missionkit.errors import FileError

MISSION = """\
missionkit: 1
mission: mapped
{section}
targets: {{spot: {{position: {spot}}}}}
initial: path
states:
  path:
    kind: custom
    behavior: {{use: follow_path, target: spot{more}}}
    transitions: [{{to: land, when: done}}]
  land: {{kind: land}}
"""
DRAWN = "map: {north: [-2, 8], east: [-2, 8], polygons: [[[3, 0], [4, 0], [4, 4], [3, 4]]]}"
META = "image: map.png\nresolution: 0.5\norigin: [-2, -3, 0]\n"


def written(folder, meta=META, **kept):
    (folder / "maps").mkdir()
    (folder / "maps" / "map.yaml").write_text(meta)
    cv2.imwrite(str(folder / "maps" / "map.png"), np.full((20, 30), 254, np.uint8))
    path = folder / "mission.yaml"
    section = kept.get("section", "map: {file: maps/map.yaml}")
    path.write_text(MISSION.format(section=section, spot="[1, 1, 0]", more=""))
    return path


def message_of(section=DRAWN, spot="[6, 6, 0]", more=""):
    with pytest.raises(FileError) as caught:
        parse(MISSION.format(section=section, spot=spot, more=more), "m.yaml", builtin())
    return str(caught.value)


def test_polygons_are_drawn():
    mission = parse(MISSION.format(section=DRAWN, spot="[6, 6, 0]", more=""), "m", builtin())
    assert mission.known.costs.shape == (100, 100)
    assert mission.known.blocked((3.5, 2.0))
    assert not mission.known.blocked((2.5, 2.0))


def test_a_map_file_is_read_and_counts_as_a_file_of_the_mission(tmp_path):
    mission = load(written(tmp_path), builtin())
    assert mission.known.costs.shape == (20, 30)
    assert mission.known.spot(0, 0) == (-3.0, -2.0)
    assert [path.name for path in mission.included] == ["map.yaml", "map.png"]


def test_elaborating_a_mission_leaves_the_mission_itself_as_it_was(tmp_path):
    path = written(tmp_path)
    mission = load(path, builtin())
    bare = mission.with_files((), None)
    whole = elaborate(bare, Expanded({}, {}, ()), tmp_path)
    assert (bare.known, bare.included) == (None, ())
    assert whole.known.costs.shape == (20, 30)
    assert [it.name for it in whole.included] == ["map.yaml", "map.png"]
    assert whole.states == mission.states


@pytest.mark.parametrize(
    ("meta", "section", "why"),
    [
        (META, "map: {file: maps/none.yaml}", "mission.yaml:3:6: map 'maps/none.yaml': no such"),
        (META, "map: {file: ../map.yaml}", "outside the folder of the mission"),
        (META.replace("map.png", "no.png"), None, "map.yaml:1:1: map 'no.png': no such file"),
        (META.replace("map.png", "map.yaml"), None, "map image map.yaml: these"),
        (META.replace("0.5", "-1"), None, "map.yaml:2:13: "),
        ("- 1\n", None, "expected a mapping"),
    ],
)
def test_an_unreadable_map_is_reported_with_its_place(tmp_path, meta, section, why):
    path = written(tmp_path, meta, **({} if section is None else {"section": section}))
    with pytest.raises(FileError) as caught:
        load(path, builtin())
    assert why in str(caught.value)


def test_a_path_needs_a_map_and_a_goal_on_it():
    where = "m.yaml:9:15: state 'path': follow_path: "
    assert message_of(section="summary: no map") == where + "needs the mission's 'map'"
    assert message_of(spot="[60, 6, 0]") == where + "its target 'spot' is outside the map"
    assert "'spot' is 0.00 m from a wall, less than the 1.05 m to keep" in message_of(
        spot="[3.5, 2, 0]"
    )
    assert "'spot' is 0.50 m from a wall" in message_of(spot="[4.5, 2, 0]")
    assert "'manhattan' overestimates" in message_of(more=", heuristic: manhattan")


def test_a_start_off_the_map_or_in_a_wall_is_a_mistake_as_for_targets():
    where = "m.yaml:9:15: state 'path': follow_path: the take-off point is "
    north = DRAWN.replace("north: [-2, 8]", "north: [1, 8]")
    assert message_of(section=north) == where + "outside the map"
    walled = DRAWN.replace("[[3, 0], [4, 0], [4, 4], [3, 4]]", "[[-1, -1], [1, -1], [1, 1]]")
    assert message_of(section=walled) == where + "inside a wall of the map"


def test_an_image_of_many_bytes_is_not_even_read(tmp_path, monkeypatch):
    monkeypatch.setattr(map_loading, "MOST_BYTES", 50)
    with pytest.raises(FileError, match=r"map image map\.png: it has more than 0 MB"):
        load(written(tmp_path), builtin())
