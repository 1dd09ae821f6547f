"""Files and options that mean harm or make no sense: a sentence and the right exit code."""

import pytest

from missionkit.sim.fault_injection import FAULT_KINDS

ESC, RTL = "\\e[2J", "\\u202E"
MAPPED = "map: {file: %s}\n"
TARGET = "targets: {pole: {position: [%s, 0, -2]}}\n"
INCLUDING = """\
missionkit: 1
mission: m
initial: idle
states: {idle: {kind: idle, transitions: [{to: down, when: done}]}, down: {include: %s}}
"""


def refused(call, *arguments):
    result = call(*arguments)
    assert result.exit_code == 2
    assert "Traceback" not in result.output
    assert result.stderr.strip()
    assert not any(c in result.output for c in "\x1b\u202e\x00")
    return result.stderr


@pytest.mark.parametrize(
    ("more", "says"),
    [
        (MAPPED % '"map\\0.yaml"', "control character U+0000 in a text: it hides what is written"),
        (MAPPED % f'"{"x" * 5000}.yaml"', "not the name of a file that can be read"),
        ('world: "a\\0b"\n', "control character U+0000"),
        (TARGET % "1e308", "1e308 is out of range: expected 0, or a size from 1e-12 to 1e+09"),
        (TARGET % "1e-300", "1e-300 is out of range"),
        (f'summary: "gone {ESC}"\n', "control character U+001B in a text"),
        (f'summary: "gone {RTL}"\n', "control character U+202E in a text"),
        ("summary: gone \u202e home\n", "control character U+202E in a text"),
    ],
)
@pytest.mark.parametrize("command", ["validate", "run", "explain"])
def test_a_mission_that_means_harm_is_refused_in_a_sentence(call, hop, command, more, says):
    hop.write_text(hop.read_text() + more)
    assert says in refused(call, command, "hop.yaml")


@pytest.mark.parametrize("name", [f'"{ESC}"', f'"{RTL}up"'])
def test_names_of_states_hide_nothing(call, hop, name):
    hop.write_text(hop.read_text().replace("land:", f"{name}:").replace("to: land", f"to: {name}"))
    assert "control character" in refused(call, "validate", "hop.yaml")


@pytest.mark.parametrize("more", ["", "x: 1\n"])
def test_the_name_of_a_file_moves_no_cursor(call, hop, more):
    named = hop.with_name("a\x1b[31mred\nnew.yaml")
    named.write_text(hop.read_text() + more)
    result = call("validate", str(named))
    assert "a\ufffd[31mred\ufffdnew.yaml" in result.output
    assert "\x1b" not in result.output


def test_a_parameter_on_the_command_line_is_looked_at_too(call, hop):
    hop.write_text("params: {height: 2.0}\n" + hop.read_text())
    assert "is out of range" in refused(call, "run", "hop.yaml", "--set", "height=1e308")


@pytest.mark.parametrize(
    "wind", ["{mean: [1e300, 0, 0]}", "{mean: [101, 0, 0]}", "{gust: 31}", "{gust_tau: 1e-300}"]
)
def test_a_wind_that_cannot_be_is_refused(call, hop, wind):
    (hop.parent / "field.yaml").write_text(f"world: field\nwind: {wind}\n")
    hop.write_text(hop.read_text() + "world: field.yaml\n")
    assert "field.yaml:2:" in refused(call, "run", "hop.yaml")


@pytest.mark.parametrize("value", ["1e308", "-1e308", "1e7", "nan", "inf"])
@pytest.mark.parametrize("name", [name for name, kind in FAULT_KINDS.items() if kind.unit])
def test_a_fault_that_cannot_be_is_refused(call, hop, name, value):
    assert f"fault {name} " in refused(call, "run", "hop.yaml", "--fault", f"{name}={value}@3")


@pytest.mark.parametrize("when", ["@" + "9" * 400, "+" + "9" * 400, "@idle:" + "9" * 400])
def test_a_fault_that_never_comes_is_refused(call, hop, when):
    assert "times go up to 1e+06 s" in refused(
        call, "run", "hop.yaml", "--fault", f"gnss_lost{when}"
    )


@pytest.mark.parametrize("command", ["validate", "explain", "graph", "run", "campaign"])
def test_a_world_in_place_of_a_mission_is_one_sentence(call, hop, command):
    (hop.parent / "field.yaml").write_text("world: field\nwind: {gust: 1}\n")
    said = refused(call, command, "field.yaml")
    assert "this file is a world, not a mission; give the mission that names it" in said
    assert said.count("field.yaml:1:") == 1


def test_a_map_in_place_of_a_mission_is_one_sentence(call, hop):
    (hop.parent / "map.yaml").write_text("image: map.png\nresolution: 0.1\n")
    assert "this file is a map, not a mission" in refused(call, "run", "map.yaml")


def test_a_mission_in_place_of_a_world_is_one_sentence(call, hop):
    text = hop.read_text()
    hop.write_text(f"{text}world: hop.yaml\n")
    assert "world 'hop.yaml': this file is a mission, not a world" in refused(
        call, "run", "hop.yaml"
    )
    (hop.parent / "plain.yaml").write_text(text)
    assert "this file is a mission, not a world" in refused(call, "sitl", "--world", "plain.yaml")


@pytest.mark.parametrize("use", ["[sim]", "{a: b}", "3"])
def test_a_world_with_an_odd_vehicle_is_refused(call, hop, use):
    (hop.parent / "odd.yaml").write_text(f"world: odd\nvehicle: {{use: {use}}}\n")
    hop.write_text(hop.read_text() + "world: odd.yaml\n")
    assert "odd.yaml:2:1: unknown key 'vehicle'" in refused(call, "run", "hop.yaml")


def test_a_world_of_another_kind_of_vehicle_is_one_sentence(call, hop):
    (hop.parent / "space.yaml").write_text("world: space\nvehicle: {use: free_flyer}\n")
    said = refused(call, "sitl", "--world", "space.yaml")
    assert "world 'space.yaml' is for vehicle 'free_flyer', not for 'sim'" in said


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("../secret.yaml", "world '../secret.yaml': outside the folder of the mission"),
        ("link.yaml", "world 'link.yaml': outside the folder of the mission"),
        ("loop.yaml", "world 'loop.yaml': not the name of a file that can be read"),
        ("notes.txt", "world 'notes.txt': expected a name that ends in .yaml"),
        ("notes.yaml", "world 'notes.yaml': this file is not a world"),
        ("list.yaml", "world 'list.yaml': this file is not a world"),
    ],
)
@pytest.mark.parametrize("command", ["validate", "run"])
def test_a_world_stays_beside_the_mission_and_another_file_is_not_quoted(
    call, hop, tmp_path, monkeypatch, command, name, says
):
    folder = tmp_path / "missions"
    folder.mkdir()
    (tmp_path / "secret.yaml").write_text("world: hunter2\n")
    (folder / "link.yaml").symlink_to(tmp_path / "secret.yaml")
    (folder / "loop.yaml").symlink_to(folder / "loop.yaml")
    (folder / "notes.txt").write_text("password: hunter2\n")
    (folder / "notes.yaml").write_text("password: hunter2\n")
    (folder / "list.yaml").write_text("- hunter2\n")
    (folder / "m.yaml").write_text(f"{hop.read_text()}world: {name}\n")
    said = refused(call, command, "missions/m.yaml")
    assert says in said
    assert "hunter2" not in said


@pytest.mark.parametrize("name", ["loop.yaml", "round.yaml"])
def test_an_include_that_leads_round_in_a_circle_is_refused(call, tmp_path, name):
    (tmp_path / "loop.yaml").symlink_to(tmp_path / "loop.yaml")
    (tmp_path / "round.yaml").symlink_to(tmp_path / "again.yaml")
    (tmp_path / "again.yaml").symlink_to(tmp_path / "round.yaml")
    (tmp_path / "m.yaml").write_text(INCLUDING % name)
    said = refused(call, "validate", "m.yaml")
    assert f"include '{name}': not the name of a file that can be read" in said
