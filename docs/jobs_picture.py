"""Draw `docs/images/jobs.png`: five missions that people fly, rehearsed, seen from above."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import missionkit
from missionkit.messages import Observation, Record
from missionkit.recorder import flight_track
from missionkit.recorder.palette import styles
from missionkit.recorder.plot import PLOT_STYLE
from missionkit.recorder.plot_ground import Flown, MapScene
from missionkit.recorder.plot_map import draw_map, view_of
from missionkit.recorder.plot_text import Ruler
from missionkit.recorder.scenery import scenery_of
from missionkit.rehearsal.stage import world_of

ROOT = Path(__file__).parent
IMAGE = ROOT / "images" / "jobs.png"
JOBS = ("three_poles", "survey", "pad_landing", "tower", "find_and_orbit")
SEED = 5


def main() -> None:
    """Write the picture."""
    with mpl.rc_context(PLOT_STYLE):
        figure = Figure(figsize=(16.0, 9.6), dpi=80, facecolor="white", layout="constrained")
        FigureCanvasAgg(figure)
        panels = figure.subplots(2, 3).flat
        for job in JOBS:
            _map(figure, next(panels), job)
        next(panels).set_axis_off()
        figure.savefig(IMAGE)


def _map(figure: Figure, axes: Axes, job: str) -> None:
    mission = missionkit.load(ROOT.parent / "missions" / f"{job}.yaml")
    track = flight_track.begin()

    def keep(record: Record, _: Observation) -> None:
        flight_track.add(track, record, None)

    missionkit.rehearse(mission, seed=SEED, observers=[keep])
    scenery = scenery_of(world_of(mission.model, mission.path.parent), mission.model)
    flown = Flown.of(track)
    figure.canvas.draw()  # lays the panels out: the map's limits depend on their shape
    scene = MapScene(Ruler(figure), flown, scenery, styles(it.state for it in track.visits))
    draw_map(axes, scene, view_of(flown, scenery))
    axes.set_title(f"{job}.yaml", fontfamily="monospace")


if __name__ == "__main__":
    main()
