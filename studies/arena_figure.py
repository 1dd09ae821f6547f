"""Pictures of an arena of ground robots from above: a film strip, or an animation of a run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from missionkit.geometry import Mat
from missionkit.recorder.palette import (
    FENCE_COLOUR,
    HOME_COLOUR,
    INK,
    MUTED,
    RULE,
    STATE_COLOURS,
    WOOD,
    WOOD_EDGE,
)
from missionkit.sim.arena import Arena
from missionkit.sim.ground_robots import HEADING, HOME, LOST, OBSTACLE, OUT
from missionkit.sim.simulated_vehicle import SimulatedVehicle

SIDE, HEAD, MARGIN = 400, 44, 14  # px, of the arena's picture, of the text above, and around it
FINE = 2  # times as large while it is drawn
COLOURS = 32  # of an animation
LARGER = 1.6  # times their size, so that robots are seen
TRAIL = 15.0  # s of the way behind
LOW = 0.3  # m, a vehicle below is filled
GONE_FOR = 4.0  # s, that a robot is still shown beyond the line
VEHICLE, PALE = STATE_COLOURS[0], "#B8C0C8"


class Film(NamedTuple):
    """A run, moment by moment."""

    arena: Arena
    times: Mat  # (T,), s
    robots: Mat  # (T, R, 3), m, m, rad: north, east, heading
    out: Mat  # (T, R): 0 in play, `HOME` or `LOST`
    obstacles: int  # the last so many of the robots
    vehicle: Mat | None = None  # (T, 3), m, NED
    captions: Sequence[str] = ()  # of each moment, such as the state and the choice

    def moment(self, at: float) -> int:
        """Return the number of the last moment at or before a time (s)."""
        return max(0, int(np.searchsorted(self.times, at + 1e-9)) - 1)


def film_of(vehicle: SimulatedVehicle) -> Film:
    """Return the film of what a simulated vehicle has flown, over the robots of its world."""
    states, rows = vehicle.herd.states, vehicle.track.rows
    times = vehicle.herd.times
    seen = np.searchsorted(rows[:, 0], times)
    return Film(
        vehicle.world.arena or Arena(),
        times,
        states[:, :, : HEADING + 1],
        states[:, :, OUT],
        int((states[0, :, OBSTACLE] > 0.0).sum()),
        rows[seen, 1:4],
    )


def animation(path: Path, film: Film, every: float = 2.0, speed: float = 30.0) -> None:
    """Write a GIF.

    Args:
        path: of the file.
        film: what to show.
        every: s between two frames.
        speed: times real time.
    """
    moments = np.arange(film.times[0], film.times[-1] + 1e-9, every)
    frames = [_small(frame(film, film.moment(at))) for at in moments]
    lasting = [round(1000.0 * every / speed)] * (len(frames) - 1) + [3000]
    frames[0].save(
        path, save_all=True, append_images=frames[1:], duration=lasting, loop=0, optimize=True
    )


def strip(path: Path, film: Film, times: Sequence[float], columns: int = 3) -> None:
    """Write a PNG of moments side by side.

    Args:
        path: of the file.
        film: what to show.
        times: s, of the panels.
        columns: panels in a row.
    """
    panels = [frame(film, film.moment(at)) for at in times]
    wide, high = panels[0].size
    rows = math.ceil(len(panels) / columns)
    page = Image.new("RGB", (wide * min(columns, len(panels)), high * rows), "white")
    for n, panel in enumerate(panels):
        page.paste(panel, (wide * (n % columns), high * (n // columns)))
    page.save(path, optimize=True)


def frame(film: Film, moment: int) -> Image.Image:
    """Draw one moment.

    Args:
        film: what to show.
        moment: its number.
    """
    size = (SIDE + 2 * MARGIN, SIDE + HEAD + MARGIN)
    large = Image.new("RGB", (FINE * size[0], FINE * size[1]), "white")
    _Panel(film, large).draw(moment)
    image = large.resize(size, Image.Resampling.BOX)
    _write(ImageDraw.Draw(image), film, moment)
    return image


def _small(image: Image.Image) -> Image.Image:
    return image.quantize(COLOURS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)


def _write(pen: ImageDraw.ImageDraw, film: Film, moment: int) -> None:
    """Write the time, what became of the robots, and the caption."""
    targets = film.out[moment, : film.out.shape[1] - film.obstacles]
    home, lost = (int((targets == end).sum()) for end in (HOME, LOST))
    font = ImageFont.load_default(13)
    place = float(MARGIN)
    for text, colour in (
        (f"{film.times[moment]:.0f} s", INK),
        (f"{home} home", HOME_COLOUR),
        (f"{lost} lost", FENCE_COLOUR),
        (f"{len(targets) - home - lost} in play", MUTED),
    ):
        pen.text((place, 5), text, colour, font)
        place += pen.textlength(text, font) + 14
    if film.captions:
        pen.text((MARGIN, 23), film.captions[moment], INK, font)


class _Panel:
    """Draws on the large picture."""

    def __init__(self, film: Film, image: Image.Image) -> None:
        self._film = film
        self._pen = ImageDraw.Draw(image)
        self._scale = FINE * SIDE / film.arena.side

    def draw(self, moment: int) -> None:
        """Draw floor, robots and vehicle."""
        self._floor()
        film = self._film
        count = film.robots.shape[1]
        first = film.moment(film.times[moment] - TRAIL)
        for n in range(count):
            colour = WOOD if n >= count - film.obstacles else PALE
            self._trail(film.robots[first : moment + 1, n], colour)
        for n in range(count):
            self._robot(moment, n, obstacle=n >= count - film.obstacles)
        if film.vehicle is not None:
            self._vehicle(film.vehicle[first : moment + 1])

    def _at(self, north: float, east: float) -> tuple[float, float]:
        """Return a place in the picture (px)."""
        (n, e), half = self._film.arena.centre, 0.5 * self._film.arena.side
        return (
            FINE * MARGIN + self._scale * (east - e + half),
            FINE * HEAD + self._scale * (n + half - north),
        )

    def _floor(self) -> None:
        (n, e), side = self._film.arena.centre, self._film.arena.side
        low = (n - 0.5 * side, e - 0.5 * side)
        for k in range(0, int(side) + 1, 2):
            for a, b in (((k, 0.0), (k, side)), ((0.0, k), (side, k))):
                ends = [self._at(low[0] + it[0], low[1] + it[1]) for it in (a, b)]
                self._pen.line(ends, RULE, FINE)
        corners = [self._at(low[0] + i, low[1] + j) for i, j in ((0, 0), (side, side))]
        (left, bottom), (right, top) = corners
        self._pen.rectangle((left, top, right, bottom), outline=MUTED, width=FINE)
        sides = {
            "north": (left, top, right, top),
            "south": (left, bottom, right, bottom),
            "west": (left, top, left, bottom),
            "east": (right, top, right, bottom),
        }
        self._pen.line(sides[self._film.arena.goal], HOME_COLOUR, 5 * FINE)

    def _trail(self, way: Mat, colour: str) -> None:
        if len(way) > 1:
            places = [self._at(north, east) for north, east, _ in way.tolist()]
            self._pen.line(places, colour, FINE)

    def _robot(self, moment: int, robot: int, *, obstacle: bool) -> None:
        film = self._film
        end = float(film.out[moment, robot])
        if end > 0.0:
            gone = film.times[int((film.out[:, robot] > 0.0).argmax())]
            if film.times[moment] - gone > GONE_FOR:
                return
        north, east, heading = film.robots[moment, robot].tolist()
        x, y = self._at(north, east)
        r = LARGER * self._scale * 0.17
        colour = {HOME: HOME_COLOUR, LOST: FENCE_COLOUR}.get(end, WOOD_EDGE if obstacle else MUTED)
        self._pen.ellipse((x - r, y - r, x + r, y + r), colour)
        tip = (x + 1.9 * r * math.sin(heading), y - 1.9 * r * math.cos(heading))
        self._pen.line((x, y, *tip), INK, 2 * FINE)

    def _vehicle(self, way: Mat) -> None:
        places = [self._at(north, east) for north, east, _ in way.tolist()]
        if len(places) > 1:
            self._pen.line(places, VEHICLE, FINE)
        (x, y), low = places[-1], -way[-1, 2] < LOW
        r = LARGER * self._scale * 0.25
        box = (x - r, y - r, x + r, y + r)
        self._pen.ellipse(box, VEHICLE if low else None, VEHICLE, 2 * FINE)
        self._pen.line((x - r, y, x + r, y), "white" if low else VEHICLE, FINE)
        self._pen.line((x, y - r, x, y + r), "white" if low else VEHICLE, FINE)
