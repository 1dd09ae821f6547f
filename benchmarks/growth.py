"""How a cycle's cost grows, beside P1's O(n W + m log m + k³), section 8.3."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from benchmarks.flights import ready, warm_up
from benchmarks.measure import Table
from benchmarks.peers.fixture import Fixture
from benchmarks.peers.missionkit_chart import ENGINES
from benchmarks.peers.ring import ring
from benchmarks.peers.turns import medians
from missionkit.estimation.error_state_ekf.filter import ErrorStateEkf
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.geometry import IDENTITY, Transform, vec
from missionkit.goal_pose import facing
from missionkit.guards.detection_confidence import ArucoConfidence
from missionkit.messages import Estimate, Frame, Look, Observation, Target
from missionkit.perception.aruco import Aruco
from missionkit.perception.camera_section import Camera
from missionkit.perception.marker_search import Priors
from missionkit.perception.square_pose import project, square
from missionkit.perception.vision_pipeline import VisionPipeline
from missionkit.planning.potential_field import PotentialField
from missionkit.rehearsal.rehearse import rehearse

Work = Callable[[], object]
DICTIONARY, SIZE = "DICT_6X6_250", 0.4
OWN_STATES, TARGET_STATES = 15, 3  # of the filter: its own, and of each target
STILL = Transform(IDENTITY, np.zeros(3))
HEADER = ("work", "grows with", "P1", "sizes", "us", "exponent", "exponent, last two")


def tables() -> list[Table]:
    """Time each part at several sizes and fit t = a xᵇ."""
    warm_up()
    flight = _flown()
    rows = [
        _row("markers found to sightings", "markers n", "n W", _markers()),
        _row("confidence of a marker, one frame", "window W", "n W", _windows(flight[0])),
        _row("avoidance, one scan", "obstacle points m", "m log m", _points(flight[0])),
        _row("filter: inertial, fix, height, heading", "states k", "k³", _states(flight[1])),
        _row("quiet tick of a chart", "states of the chart", "", _charts()),
    ]
    note = (
        "P1, section 8.3, says O(n W + m log m + k³) a cycle. Medians of processor time. Exponent "
        "b of t = a xᵇ by least squares over all sizes, and between the last two. The filter has "
        f"{OWN_STATES} states of its own and {TARGET_STATES} for each target. Guards at work on a "
        "window keep its frames as bits of one number; scans are neither sorted nor searched in a "
        "tree."
    )
    return [Table("Cost of a cycle", HEADER, rows, note)]


def _row(work: str, of: str, paper: str, works: Mapping[int, Work]) -> tuple[str, ...]:
    took = list(medians({str(size): it for size, it in works.items()}).values())
    sizes = list(works)
    exponent = float(np.polyfit(np.log(sizes), np.log(took), 1)[0])
    last = math.log(took[-1] / took[-2]) / math.log(sizes[-1] / sizes[-2])
    times = ", ".join(f"{1e6 * time:.0f}" if time > 1e-5 else f"{1e6 * time:.1f}" for time in took)
    return work, of, paper, ", ".join(map(str, sizes)), times, f"{exponent:.2f}", f"{last:.2f}"


def _flown() -> tuple[Estimate, list[Observation]]:
    """Return an estimate and all observations of one flight."""
    at, seen, observations = ready("none"), [], []
    rehearse(at, [lambda record, it: (seen.append(record.estimate), observations.append(it))])
    return seen[len(seen) // 2], observations


def _charts() -> dict[int, Work]:
    """Tick charts of so many states with 3 guards each, the one in the middle active."""
    return {n: Fixture(ENGINES[0], ring(n, 3)).quiet() for n in (10, 100, 1000)}


def _markers() -> dict[int, Work]:
    return {count: _looking(count) for count in (1, 2, 4, 8, 16, 32)}


def _looking(count: int) -> Work:
    """Look at so many markers in a plane 6 m ahead."""
    camera = Camera().model()
    eye = VisionPipeline(camera, [Aruco(target=f"t{n}", id=n, size=SIZE) for n in range(count)])
    poses = {n: Transform(facing(math.pi), _place(n)) for n in range(count)}
    towards = (STILL @ camera.mount).inverse()
    found = tuple(
        (DICTIONARY, n, project(square(SIZE), towards @ pose, camera)) for n, pose in poses.items()
    )
    targets = {
        f"t{n}": Target(f"t{n}", pose.translation, 0.3, pose.rotation, 0.1, None)
        for n, pose in poses.items()
    }
    priors, observation = (
        Priors(lambda _: STILL, targets, None),
        Observation(1.0, frame=Frame(1.0, None, found)),
    )
    return lambda: eye.look(eye.begin(), observation, priors)


def _place(number: int) -> np.ndarray:
    return vec(6.0, 0.5 * (number % 8) - 1.75, 0.5 * (number // 8) - 0.75)


def _windows(seen: Estimate) -> dict[int, Work]:
    return {window: _watching(window, seen) for window in (30, 100, 1000, 10_000)}


def _watching(window: int, seen: Estimate) -> Work:
    """Advance a full window by a frame, and ask."""
    guard = ArucoConfidence(target="trunk", window=window)
    seen = seen._replace(looks=(Look(seen.now, frozenset({"trunk"})),))
    memory = guard.begin()
    for _ in range(window):
        memory = guard.advance(memory, seen)
    return lambda: guard.check(guard.advance(memory, seen), seen)


def _points(seen: Estimate) -> dict[int, Work]:
    return {count: _avoiding(count, seen) for count in (100, 1000, 10_000, 100_000)}


def _avoiding(count: int, seen: Estimate) -> Work:
    """Avoid so many points around the vehicle, a tenth of them within its reach."""
    rng, field = np.random.default_rng(0), PotentialField()
    away = rng.normal(0.0, 1.0, (count, 3))
    away *= (field.radius * np.cbrt(10.0 * rng.random(count)) / np.linalg.norm(away, axis=1))[
        :, None
    ]
    seen = seen._replace(obstacles=seen.position + away, scanned_at=seen.now)
    goal, wanted = seen.position + vec(20.0, 0.0, 0.0), vec(2.0, 0.0, 0.0)
    return lambda: field.step(field.begin(), seen, goal, wanted)


def _states(observations: list[Observation]) -> dict[int, Work]:
    counts = (0, 3, 9, 21, 45)
    return {OWN_STATES + TARGET_STATES * n: _filtering(n, observations) for n in counts}


def _filtering(targets: int, observations: list[Observation]) -> Work:
    """Advance the filter by one tick in the middle of a flight."""
    surveyed = {f"t{n}": (vec(10.0, float(n), -1.0), 0.5) for n in range(targets)}
    navigator = ErrorStateEkf(VisualInertialEkf(), surveyed, STILL)
    memory = navigator.begin()
    middle = len(observations) // 2
    for observation in observations[:middle]:
        memory = navigator.propagate(memory, observation)
    return lambda: navigator.propagate(memory, observations[middle])
