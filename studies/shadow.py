"""One robot held in view, image in the loop, as P4's Fig. 5: `python -m studies.shadow`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.geometry import Mat, Transform
from missionkit.messages import CameraModel, Observation, Record
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import Stage, stage, world_of
from missionkit.sim.ground_robots import EAST, HEADING, NORTH
from missionkit.sim.world import World
from studies.canvas import LIMIT, page
from studies.markdown import table
from studies.parallel import in_parallel
from studies.statistics import wilson

MISSIONS = Path("missions")
UPRIGHT = 120.0  # px, half the image: P4's limit
SETTLED = 4.0  # s in the state, after which the robot must be held
LEADS = ("switched", "always", "never")
SPIN = 2.456  # s
PAGE = """# Study: one robot held in view (P4, Fig. 5)

P4 shows one flight: a robot turns at 15 and 45 s and spins at 30 s, and the vehicle holds it
within ±120 px of the middle of a 320 x 240 image. Here `missions/shadow.yaml` flies, with drawn
camera, blob detector, tracker, navigator and controller in the loop. The robot drives by its
firmware: a spin of 180 deg at 10, 30 and 50 s after the start, and a random turn every 5 s, at 15
and 45 s too. The camera is fixed to the body and looks down from 2.5 m.

    {command}

- {held}
- Farthest from the middle, along the image's short side: {farthest}.

![distance from the middle of the image](shadow.png)

Every row: the whole mission; px are of the true place of the robot's middle, from {settled:g} s
after the vehicle begins to follow until it flies home after a minute. Held: within ±120 px upright
and ±160 px along at every tick, by the track it began with. After a spin: the largest distance in
the 4 s from its beginning, median over flights.

{table}

Camera: `drawn` images with the detector in the loop, or `boxes`: what a detector finds, by the
simulator, with misses, false boxes and 1.5 px of noise.

- `switched` leads by the robot's heading while it drives and by its place alone while its spin is
  likelier than not. `always` leads by the heading even in a spin, when it turns half round; `never`
  does not lead, so that the vehicle hangs back by its lag.
- `mmae` is P4's bank without interaction: its heading comes out of a spin wrong.
"""


class Watched(NamedTuple):
    """One flight, tick by tick while it follows the robot."""

    times: Mat  # (n,), s
    pixels: Mat  # (n, 2), px, of the robot from the middle of the image: along, upright
    tracks: int  # names that `tracked` had
    spins: tuple[float, ...]  # s, when one began meanwhile
    finished: bool  # the mission succeeded

    @property
    def held(self) -> bool:
        """Whether the robot was in view throughout, as one track."""
        inside = len(self.times) > 0 and bool((np.abs(self.pixels) <= (160.0, UPRIGHT)).all())
        return inside and self.tracks == 1 and self.finished

    @property
    def after_spins(self) -> float:
        """Largest distance (px) in the 4 s after spins began."""
        near = [self.pixels[(self.times >= t) & (self.times <= t + 4.0)] for t in self.spins]
        return max((float(np.abs(it).max()) for it in near if len(it)), default=np.nan)


class Way(NamedTuple):
    """One way of following."""

    lead: str = "switched"
    estimator: str = "imm"
    camera: str = "rendered"


def flown(seed: int, way: Way) -> Watched:
    """Fly the mission once.

    Args:
        seed: of everything random.
        way: how it follows.
    """
    catalogue = builtin()
    mission = load(
        MISSIONS / "shadow.yaml", catalogue, {"lead": way.lead, "estimator": way.estimator}
    )
    camera = mission.camera.model_copy(update={"use": way.camera})
    settings = mission.settings.model_copy(update={"time_limit": 150.0})
    mission = mission.model_copy(update={"camera": camera, "settings": settings})
    world = world_of(mission, MISSIONS)
    assert isinstance(world, World)  # noqa: S101 - the mission's own
    ready = stage(mission, catalogue, world, seed)
    rows: list[tuple[float, float, float, float]] = []
    names: set[str] = set()
    lost: list[float] = []
    began: list[float] = []

    def watch(record: Record, _: Observation) -> None:
        if record.state == "search" and began:
            lost.append(record.now)
        if record.state != "shadow":
            return
        began.append(record.now)
        tracked = record.estimate.targets.get("tracked")
        if tracked is not None:
            names.add(tracked.name)
        if record.now - began[0] >= SETTLED:
            rows.append((record.now, *_pixels(ready, camera.model())))

    result = rehearse(ready, (watch,))
    times, along, upright, heading = np.array(rows).reshape(-1, 4).T
    begun = np.flatnonzero(np.diff(heading) > 0.5 * np.pi / SPIN / mission.settings.rate)
    begun = begun[begun > 0]  # not one that it begins in
    spins = [t for t in times[begun] if not any(0.0 < t - other < SPIN for other in times[begun])]
    return Watched(
        times,
        np.column_stack((along, upright)),
        len(names),
        tuple(spins),
        result.succeeded and not lost,
    )


def _pixels(ready: Stage, camera: CameraModel) -> tuple[float, float, float]:
    """Return where the robot is in the image, from its middle (px), and its heading (rad)."""
    vehicle = ready.vehicle
    robot, truth = vehicle.robots[0], vehicle.truth
    eye = Transform(truth.attitude, truth.position) @ camera.mount
    x, y, z = eye.inverse().apply(np.array((robot[NORTH], robot[EAST], 0.0))).tolist()
    fx, fy = camera.matrix[0, 0], camera.matrix[1, 1]
    return fx * x / z, fy * y / z, float(robot[HEADING])


def ways() -> list[Way]:
    """Return the rows of the table; the first is the mission as it is."""
    boxed = [Way(lead, camera="corners") for lead in LEADS]
    return [Way(), *boxed, Way(estimator="mmae", camera="corners")]


def row(way: Way, flights: Sequence[Watched]) -> tuple[str, ...]:
    """Return one row of the table."""
    held = sum(it.held for it in flights)
    low, high = (100.0 * share for share in wilson(held, len(flights)))
    seen = [it for it in flights if len(it.times)]
    most = [float(np.abs(it.pixels[:, 1]).max()) for it in seen]
    usual = np.concatenate([np.hypot(*it.pixels.T) for it in seen])
    return (
        "drawn" if way.camera == "rendered" else "boxes",
        f"`{way.lead}`",
        f"`{way.estimator}`",
        f"{held} of {len(flights)} ({low:.1f} to {high:.1f} %)",
        f"{np.sqrt(np.mean(usual**2)):.0f}",
        f"{np.median(most):.0f}, {max(most):.0f}",
        f"{np.nanmedian([it.after_spins for it in seen]):.0f}",
    )


HEADER = (
    *("camera", "lead", "estimator", "held", "rms, px", "upright, most: median, worst, px"),
    "after a spin, px",
)


def draw(path: Path, flights: Sequence[Watched], subtitle: str) -> None:
    """Draw a PNG of all flights with the camera in the loop.

    Args:
        path: of the picture.
        flights: of the first row.
        subtitle: the result in one line.
    """
    with page(path, 1200, 640, "A robot held in view, as in P4's Fig. 5", subtitle) as figure:
        grid = figure.add_gridspec(2, 1, hspace=0.15, left=0.08, right=0.97, top=0.86, bottom=0.1)
        for k, (name, limit) in enumerate((("upright", UPRIGHT), ("along", 160.0))):
            axes: Axes = figure.add_subplot(grid[k, 0])
            for start in (10.0, 30.0, 50.0):
                axes.axvspan(start, start + SPIN, color="0.9", zorder=0)
            for it in flights:
                axes.plot(it.times, it.pixels[:, 1 - k], color="#0072B2", lw=0.5, alpha=0.5)
            for side in (-limit, limit):
                axes.axhline(side, color=LIMIT, lw=1.6)
            axes.set_ylabel(f"{name}, px")
            axes.grid(visible=True)
        axes.set_xlabel("time, s; grey: the robot spins")


def main(arguments: Sequence[str] | None = None) -> None:
    """Fly all ways and write the page and its picture."""
    parser = argparse.ArgumentParser(prog="python -m studies.shadow", description=main.__doc__)
    parser.add_argument("--flights", type=int, default=50, help="seeds of each row")
    parser.add_argument("--first", type=int, default=0, help="seed")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    seeds = range(chosen.first, chosen.first + chosen.flights)
    results = {
        way: list(in_parallel(partial(flown, way=way), seeds, chosen.workers, 2)) for way in ways()
    }
    flights = results[Way()]
    rows = [row(way, found) for way, found in results.items()]
    most = rows[0][5].split(", ")
    held = f"Held in {rows[0][3]} flights, image in the loop."
    chosen.out.mkdir(parents=True, exist_ok=True)
    text = PAGE.format(
        command=f"python -m studies.shadow --flights {chosen.flights} --first {chosen.first}",
        held=held,
        farthest=f"{most[0]} px (median), {most[1]} px (worst) of 120",
        settled=SETTLED,
        table=table(HEADER, rows),
    )
    (chosen.out / "shadow.md").write_text(text, encoding="utf-8")
    draw(chosen.out / "shadow.png", flights, held)
    print(held)  # noqa: T201


if __name__ == "__main__":
    main()
