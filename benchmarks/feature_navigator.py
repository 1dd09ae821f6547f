"""The navigator by features of the ground: one hover over gravel, tick by tick."""

from __future__ import annotations

from dataclasses import replace

from benchmarks.measure import Table, spread, timed
from missionkit.estimation.builder import build
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.navigator import FeatureNavigator
from missionkit.estimation.ud_vision.parameters import UdVisionEkf
from missionkit.messages import Action, Command, Observation
from missionkit.perception.camera_section import Camera, Mount
from missionkit.perception.feature_matching import matched
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.world import Ground, World

CAMERA = Camera(
    use="rendered", width=320, height=240, focal=200, mount=Mount(position=(0, 0, 0), tilt_deg=90)
)
FLOWN, REST, HOVERING = 25.0, 60, 160  # s, and ticks: when it arms, when it hovers


def tables() -> list[Table]:
    """Time the filter and the matching of every frame of a hover, with 20 features."""
    lens, seen = CAMERA.model(), _observed()
    settings = UdVisionEkf()
    navigator = build(settings, {}, lens.mount, lens)
    if not isinstance(navigator, FeatureNavigator):
        raise TypeError(f"{settings.kind} looks for no features")
    known = navigator.begin()
    filtering: list[float] = []
    matching: list[float] = []
    for tick, each in enumerate(seen):
        known, moved = timed(navigator.propagate, known, each)
        if each.frame is None or each.frame.image is None:
            continue
        search, aimed = timed(navigator.search, known, each.frame.at)
        if search is None:
            continue
        found, looked = timed(matched, each.frame.image, each.frame.at, lens, search)
        known, fused = timed(navigator.see, known, search, found)
        if tick >= HOVERING:
            filtering.append(moved.cpu + aimed.cpu + fused.cpu)
            matching.append(looked.cpu)
    plain = _plain(seen)
    rows = [
        ("filter: propagate, search, see", *_us(filtering, plain)),
        ("features in the image", *_us(matching, plain)),
        ("visual_inertial_ekf: propagate", *_us(plain, plain)),
    ]
    note = (
        f"{len(filtering)} ticks of 50 ms with a frame of 320x240, {settings.features} features "
        "(75 states), double precision. Processor time; x: median over that of "
        "visual_inertial_ekf on the same ticks."
    )
    return [Table("Features of the ground", ("work", "p50, us", "p99, us", "x"), rows, note)]


def _observed() -> list[Observation]:
    """Return what a vehicle observes that rests, takes off to 2 m and hovers; no satellites."""
    world = World(world="hall", ground=Ground(texture="gravel"))
    vehicle, out = SimulatedVehicle(world, CAMERA, 0), []
    for tick in range(1, round(FLOWN / 0.05) + 1):
        out.append(replace(vehicle.advance(tick * 0.05), gnss=None))
        if tick == REST:
            vehicle.apply(Command(action=Action.ARM))
        elif tick == REST + 2:
            vehicle.apply(Command(action=Action.TAKE_OFF, height=2.0))
    return out


def _plain(seen: list[Observation]) -> list[float]:
    navigator = build(VisualInertialEkf(flow=True), {}, CAMERA.model().mount)
    known, times = navigator.begin(), []
    for tick, each in enumerate(seen):
        known, took = timed(navigator.propagate, known, each)
        if tick >= HOVERING:
            times.append(took.cpu)
    return times


def _us(times: list[float], plain: list[float]) -> tuple[str, str, str]:
    ratio = sorted(times)[len(times) // 2] / sorted(plain)[len(plain) // 2]
    return (*spread(times, 1e6, 0), f"{ratio:.1f}")
