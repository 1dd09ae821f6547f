from __future__ import annotations

import base64
import json
import re
from collections import Counter

import numpy as np
import pytest
from documents import ROOT
from mcap.reader import make_reader

from missionkit.geodesy import Origin
from missionkit.geometry import IDENTITY, Transform, rotate, vec
from missionkit.messages import (
    AttitudeSetpoint,
    Command,
    Detection,
    Fired,
    Frame,
    Occupancy,
    PositionSetpoint,
    Setpoint,
    Sighting,
    Verdict,
    Wrench,
)
from missionkit.perception.opencv_helpers import decode_grey
from missionkit.recorder import message_encoding
from missionkit.recorder.flight_recorder import FlightRecorder, RateLimit
from missionkit.recorder.geographic_messages import Georeference
from missionkit.recorder.message_encoding import UPRIGHT
from missionkit.recorder.record_digest import hash_of
from missionkit.recorder.record_reader import read
from missionkit.recorder.scenery import DrawnTarget, Fence
from missionkit.recorder.topic_schemas import COMMAND, TOPICS

HERE = Origin(80.0, 179.9999, -430.0)
DATE = 1767323045.0  # 2026-01-02 03:04:05 UTC
COSTS = np.array([[1.0, 2.0, np.inf], [4.0, 1.0, np.inf]])


def fly(folder, ticks, **options):
    folder.mkdir(exist_ok=True)
    with FlightRecorder(folder, **options) as recorder:
        for record, truth in ticks:
            recorder.write(record, None, truth)
    return recorder.close()


def conforms(value, schema, where="$"):
    """Check the part of JSON Schema that the record uses; returns the first fault."""
    kinds = {
        "object": dict,
        "array": list,
        "string": str,
        "boolean": bool,
        "integer": int,
        "number": (int, float),
    }
    assert isinstance(value, kinds[schema["type"]]), where
    if schema["type"] in {"number", "integer"}:
        assert not isinstance(value, bool), where
    assert value in schema.get("enum", [value]), where
    if isinstance(value, dict):
        assert set(value) <= set(schema["properties"]), where
        assert set(schema.get("required", ())) <= set(value), where
        for key, part in value.items():
            conforms(part, schema["properties"][key], f"{where}.{key}")
    if isinstance(value, list):
        for index, part in enumerate(value):
            conforms(part, schema["items"], f"{where}[{index}]")


def a_frame_at(t):
    corners = np.array([[10.0, 10.0], [30.0, 10.0], [30.0, 30.0], [10.0, 30.0]])
    pose = Transform(np.array([1.0, 0.0, 0.0, 0.0]), vec(0.0, 0.0, 3.0))
    sighting = Sighting(
        t, "trunk", 23, pose, 0.1, 0.1, 0.2, False, Detection("D", 23, corners, 400.0)
    )
    image = np.tile(np.arange(64, dtype=np.uint8) * 4, (48, 1))
    return Frame(t, image), sighting


def test_every_message_follows_the_schema_embedded_beside_it(tmp_path, flight, orchard, camera):
    known, reference = (
        Occupancy(COSTS, 0.5, (-1.0, 2.0), 0.3),
        Georeference.fixed(HERE, lambda: DATE),
    )
    placed = {"known": known, "reference": reference}
    with FlightRecorder(tmp_path, camera=camera, scenery=orchard, **placed) as recorder:
        for record, truth in flight(45.0):
            frame, sighting = a_frame_at(record.now)
            seen = record.estimate._replace(sightings=(sighting,))
            recorder.write(record._replace(estimate=seen), frame, truth)
    seen_topics = set()
    with (tmp_path / "flight.mcap").open("rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            conforms(json.loads(message.data), json.loads(schema.data), channel.topic)
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            seen_topics.add(channel.topic)
    assert seen_topics == {topic.name for topic in TOPICS}


def test_the_record_says_where_on_the_earth_and_when(tmp_path, flight, orchard):
    late = iter([None] * 40)  # home is known after 2 s
    reference = Georeference(lambda: next(late, HERE), lambda: DATE)
    fence = Fence.box((-10.0, 10.0), (-5.0, 5.0))
    scenery = orchard._replace(targets=(DrawnTarget("tree", (30.0, -4.0)),), fences=(fence,))
    fly(tmp_path, flight(10.0), scenery=scenery, reference=reference)
    path = tmp_path / "flight.mcap"
    (said,) = read(path, "/origin")
    assert (said.data["latitude"], said.data["utc"]) == (80.0, "2026-01-02T03:04:03.000Z")
    fixes = list(read(path, "/fix"))
    assert len(fixes) == 16
    poses = {entry.at: entry.data["pose"]["position"] for entry in read(path, "/pose")}
    for entry in fixes:
        place = [entry.data[name] for name in ("latitude", "longitude", "altitude")]
        there = [poses[entry.at][axis] for axis in "xyz"]
        np.testing.assert_allclose(HERE.local(*place), there, atol=1e-4)
    (shown,) = read(path, "/places")
    tree, fenced = json.loads(shown.data["geojson"])["features"]
    longitude, latitude = tree["geometry"]["coordinates"]
    np.testing.assert_allclose(HERE.local(latitude, longitude, -430.0)[:2], (30.0, -4.0), atol=1e-3)
    assert len(fenced["geometry"]["coordinates"][0]) == 5


def test_the_map_is_a_grid_of_its_own_costs(tmp_path, flight):
    fly(tmp_path, flight(2.0), known=Occupancy(COSTS, 0.5, (-1.0, 2.0)))
    (entry,) = read(tmp_path / "flight.mcap", "/map")
    shades = np.frombuffer(base64.b64decode(entry.data["data"]), np.uint8)
    assert shades.tolist() == [0, 50, 100, 75, 0, 100]
    assert entry.data["column_count"] == 3
    corner = entry.data["pose"]["position"]
    assert (corner["x"], corner["y"]) == (2.0, -1.0)  # east, north


def test_the_layout_shows_topics_that_exist():
    text = (ROOT / "docs/how-to/foxglove-layout.json").read_text()
    layout = json.loads(text)
    topics = {topic.name for topic in TOPICS}
    named = set(re.findall(r'"(/[a-z]+(?:/[a-z]+)?)[".]', text))
    assert named <= topics
    assert {"/pose", "/fix", "/state", "/map"} <= named
    panels = re.findall(r'"([A-Za-z0-9]+![a-z]+)"', json.dumps(layout["layout"]))
    assert set(panels) == set(layout["configById"])


def test_rates_are_those_of_p1(tmp_path, flight, camera):
    fly(tmp_path, flight(20.0), camera=camera)
    counts = Counter(entry.topic for entry in read(tmp_path / "flight.mcap"))
    assert counts["/pose"] == counts["/command"] == counts["/truth/pose"] == 400
    assert counts["/estimate"] == 200
    assert counts["/status"] == 20
    assert 200 <= counts["/guards"] <= 205
    assert 200 <= counts["/state"] <= 202
    assert counts["/goal"] == 159  # from the tick that leaves idle on


def test_a_transition_is_recorded_with_its_reason_guards_and_outputs(tmp_path, flight):
    fly(tmp_path, flight(45.0))
    path = tmp_path / "flight.mcap"
    taken = [entry.data for entry in read(path, "/transitions")]
    assert [(it["source"], it["to"]) for it in taken] == [
        ("idle", "gps"),
        ("gps", "visual"),
        ("visual", "search"),
        ("search", "visual"),
        ("visual", "task"),
        ("task", "return"),
    ]
    assert taken[-1]["outputs"] == ["mode gps", "log injection finished"]
    battery = taken[0]["verdicts"][0]
    assert (battery["name"], battery["holds"], battery["threshold"]) == ("battery", "no", 0.2)
    lines = [entry.data["message"] for entry in read(path, "/log")]
    assert "gps -> visual: when all of marker-sure, trunk-in-range, near-goal" in lines
    assert lines.count("search: height above 2 m is not kept") == 1


def test_the_state_says_since_when(tmp_path, flight):
    fly(tmp_path, flight(10.0))
    standing = list(read(tmp_path / "flight.mcap", "/state"))
    assert {entry.data["since"] for entry in standing if entry.data["state"] == "idle"} == {0.0}
    since = {entry.data["since"] for entry in standing if entry.data["state"] == "gps"}
    assert list(since) == [pytest.approx(4.05)]


@pytest.mark.parametrize("rate", [1.0, 20.0, 25.0, 30.0, 50.0])
def test_a_slot_as_long_as_a_tick_takes_every_tick(rate):
    pace = RateLimit(rate)
    assert all(pace.due(n * (1.0 / rate)) for n in range(1000))
    assert not pace.due(999 * (1.0 / rate))


def test_a_state_that_is_entered_again_says_so(tmp_path, flight):
    ticks = list(flight(8.0))
    record, truth = ticks[120]  # 6 s
    ticks[120] = record._replace(fired=(Fired("gps", "gps", "on again", (), ()),)), truth
    fly(tmp_path, ticks)
    standing = read(tmp_path / "flight.mcap", "/state")
    since = sorted({entry.data["since"] for entry in standing if entry.data["state"] == "gps"})
    assert since == [pytest.approx(4.05), pytest.approx(6.0)]


def test_changes_of_one_tick_are_recorded_at_any_rate(tmp_path, flight):
    odd = 33  # a tick between two of the 10 Hz
    with FlightRecorder(tmp_path) as recorder:
        for k, (record, _) in enumerate(flight(4.0)):
            cycle = record.cycle._replace(overruns=int(k >= odd))
            verdicts = (("link", Verdict(holds=k == odd)),)
            problems = ("late",) if k == odd else ()
            changed = record._replace(cycle=cycle, verdicts=verdicts, problems=problems)
            recorder.write(changed)
    path, at = tmp_path / "flight.mcap", pytest.approx(0.05 * odd)
    held = [it.at for it in read(path, "/guards") if it.data["guards"][0]["holds"] == "yes"]
    assert held == [at]
    assert [it.at for it in read(path, "/state") if it.data["problems"] == ["late"]] == [at]
    assert next(it.at for it in read(path, "/timing") if it.data["overruns"]) == at


def test_poses_are_written_as_they_were(tmp_path, flight):
    record, truth = next(flight(0.1))
    fly(tmp_path, [(record, truth)])
    (entry,) = read(tmp_path / "flight.mcap", "/pose")
    position, orientation = entry.data["pose"]["position"], entry.data["pose"]["orientation"]
    assert [position[axis] for axis in "xyz"] == record.estimate.position.tolist()
    assert [orientation[part] for part in "wxyz"] == record.estimate.attitude.tolist()


def test_an_unknown_guard_leaves_its_numbers_out(tmp_path, flight):
    fly(tmp_path, flight(6.0))
    *_, last = read(tmp_path / "flight.mcap", "/guards")
    said = {it["name"]: it for it in last.data["guards"]}
    assert said["marker-sure"] == {
        "name": "marker-sure",
        "holds": "unknown",
        "why": "no frame for 0.4 s",
    }


def test_the_same_flight_has_the_same_hash_whatever_the_wall_clock_says(tmp_path, flight):
    one = fly(tmp_path / "one", flight(10.0, wall=0.004))
    two = fly(tmp_path / "two", flight(10.0, wall=0.011))
    other = fly(tmp_path / "other", flight(10.0, seed=2))
    assert one == two
    assert one != other
    assert hash_of(tmp_path / "one" / "flight.mcap") == one


def test_images_come_at_their_rate_with_the_markers_found_in_them(tmp_path, flight):
    with FlightRecorder(tmp_path, image_rate=4.0) as recorder:
        for record, truth in flight(3.0):
            frame, sighting = a_frame_at(record.now)
            seen = record.estimate._replace(sightings=(sighting,))
            recorder.write(record._replace(estimate=seen), frame, truth)
    path = tmp_path / "flight.mcap"
    images = list(read(path, "/camera/image"))
    assert len(images) == 12
    sent = a_frame_at(0.0)[0].image
    back = decode_grey(base64.b64decode(images[0].data["data"]))
    assert np.abs(back.astype(int) - sent).mean() < 3.0
    markers = [entry.data for entry in read(path, "/camera/markers")]
    assert markers[3]["points"][0]["points"][2] == {"x": 30.0, "y": 30.0}
    assert markers[3]["texts"][0]["text"] == "trunk (23)"


def test_no_images_at_rate_zero(tmp_path, flight):
    with FlightRecorder(tmp_path, image_rate=0.0) as recorder:
        for record, _ in flight(1.0):
            recorder.write(record, a_frame_at(record.now)[0])
    assert not list(read(tmp_path / "flight.mcap", "/camera/image", "/truth/pose"))


def test_the_root_frame_points_up():
    np.testing.assert_allclose(rotate(UPRIGHT.rotation, vec(2.0, 3.0, -5.0)), (3.0, 2.0, 5.0))


def test_the_scene_stands_on_the_ground(tmp_path, flight, orchard):
    fly(tmp_path, flight(2.5), scenery=orchard)
    (scene,) = read(tmp_path / "flight.mcap", "/scene")
    (world,) = scene.data["entities"]
    trunk = world["cylinders"][0]
    assert trunk["pose"]["position"] == {"x": 25.0, "y": 1.5, "z": -4.5}
    assert trunk["size"] == {"x": 1.6, "y": 1.6, "z": 9.0}
    assert len(world["cubes"]) == 3


def test_a_record_is_never_written_over(tmp_path, flight):
    fly(tmp_path, flight(0.5))
    with pytest.raises(FileExistsError):
        FlightRecorder(tmp_path)


@pytest.mark.parametrize(
    ("setpoint", "fields"),
    [
        (Setpoint(vec(1.0, 2.0, 3.0), 0.5), {"velocity", "yaw_rate"}),
        (PositionSetpoint(vec(1.0, 2.0, 3.0), 0.5), {"position", "yaw"}),
        (AttitudeSetpoint(IDENTITY, 0.5), {"attitude", "thrust"}),
        (Wrench(vec(0.1, 0.0, 0.0), vec(0.0, 0.0, 0.001)), {"force", "torque"}),
    ],
)
def test_every_kind_of_setpoint_is_recorded_by_name(setpoint, fields):
    encoded = json.loads(message_encoding.command('{"sec":1,"nsec":0}', Command(setpoint)))
    assert set(encoded) == {"timestamp", *fields}
    conforms(encoded, COMMAND)
