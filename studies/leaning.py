"""The precision task on PX4's simulated vehicle, which leans in wind, with small markers."""

from __future__ import annotations

from dataclasses import replace

from missionkit.chart.model.mission import Mission
from missionkit.geometry import vec
from missionkit.perception.aruco import Aruco
from missionkit.sim.airframes import flown_with
from missionkit.sim.world import World

NOISE = {"gyro_noise": 0.01, "accel_noise": 0.2}
"""Of PX4's simulated inertial unit, rad/s/√Hz and m/s²/√Hz."""
SMALL = 0.10  # m, edge of the two markers more
SMALL_IDS = (101, 102)
APART = 0.31  # m, from centre to centre: the large one's half, two white margins, half a small one
SEEN_FROM = 600.0  # px², a small marker counts from about 2.3 m


def knowing_noise(mission: Mission) -> Mission:
    """Return the mission with a filter that knows the noise of PX4's simulated inertial unit."""
    plugin = mission.navigation.plugin.model_copy(update=NOISE)
    return mission.model_copy(update={"navigation": replace(mission.navigation, plugin=plugin)})


def sih(world: World, wind: tuple[float, float, float], gust: float) -> World:
    """Return the world with PX4's simulated vehicle in a wind (m/s, NED) with its gusts (m/s)."""
    air = world.wind.model_copy(update={"mean": wind, "gust": gust})
    return flown_with(world.model_copy(update={"wind": air}), "sih")


def with_small_markers(mission: Mission, world: World) -> tuple[Mission, World]:
    """Hang a small marker above and one below the first marker that the mission looks for.

    However far the vehicle leans at arm's length, one of the three is in the picture.

    Raises:
        ValueError: that marker does not hang in the world.
    """
    use = mission.perception[0]
    first = use.plugin
    large = world.marker(first.id, first.dictionary) if isinstance(first, Aruco) else None
    if large is None:
        raise ValueError(f"{mission.name}: its first marker does not hang in {world.world}")
    uses, markers = list(mission.perception), list(world.markers)
    for number, up in zip(SMALL_IDS, (APART, -APART), strict=True):
        north, east, down = large.pose.apply(vec(0.0, up, 0.0)).tolist()
        parts = {"id": number, "size": SMALL}
        markers.append(large.model_copy(update={**parts, "position": (north, east, down)}))
        parts |= {"offset": (0.0, up, 0.0), "min_area": SEEN_FROM}
        uses.append(replace(use, plugin=first.model_copy(update=parts)))
    return (
        mission.model_copy(update={"perception": tuple(uses)}),
        world.model_copy(update={"markers": tuple(markers)}),
    )
