import pytest
from samples import HOP

from missionkit.api.vehicle_flight import share_of
from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.errors import UsageError
from missionkit.vehicle.command.estimate_sharing import Share

PADS = parse(
    HOP + "targets: {pad: {position: [1, 0, 0]}, tree: {position: [9, 0, -2]}}\n", "hop", builtin()
)


@pytest.mark.parametrize(
    ("texts", "share"),
    [
        ((), Share()),
        (("pose",), Share(pose=True)),
        (("target=pad", "pose"), Share(pose=True, target="pad")),
        (("target=pad", "target=pad"), Share(target="pad")),
    ],
)
def test_only_the_requested_data_is_shared(texts, share):
    assert share_of(texts, PADS) == share


@pytest.mark.parametrize(
    ("texts", "reason"),
    [
        (("poses",), "must be pose, or target=NAME"),
        (("pose=1",), "must be pose, or target=NAME"),
        (("target=pda",), "no such target; .*pad"),
        (("target=pad", "target=tree"), "of one target"),
    ],
)
def test_anything_else_is_refused_with_what_would_be_right(texts, reason):
    with pytest.raises(UsageError, match=reason):
        share_of(texts, PADS)


def test_sharing_needs_a_vehicle(call):
    result = call("run", "hop.yaml", "--share", "pose")
    assert (result.exit_code, "--share needs --vehicle" in result.stderr) == (2, True)
