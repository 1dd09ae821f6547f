"""Faults of processes and files: `missionkit run` as a program, over `missionkit sitl`.

The judge is the simulated autopilot's ground truth and journal, never the program's own report.
"""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from missionkit.chart.plugin_catalogue import builtin
from studies.fault_flights import Seen
from studies.fuzz import checked
from studies.fuzz_documents import FAMILIES, document
from studies.over_the_wire import DIALECTS, Autopilot, free_port, sitl

SPEED = 1.0  # times real time: what is measured includes a slow machine
FAST = 3.0  # m/s northwards: it is under way
STANDING = 0.5  # m/s
IN_TIME = 4.0  # s until it stands: 1.5 s, and braking from 4 m/s
LIMIT = 90.0  # s of the vehicle that anything may take in flight
START = 600.0  # s of the vehicle until it flies: a slow machine compiles first
PATIENCE = 300.0  # s of the wall until a program has said no, or has ended
STOOD = "stood within 4 s, unhurt"
LANDED = "landed, unhurt"
TAKEN = "landed at home by the autopilot's failsafe, not commanded"
REFUSED = "refused on the ground, in a sentence"
BOTH = "the second refused in a sentence, the first landed unhurt"
STRAIGHT = """\
missionkit: 1
mission: straight
camera: {use: none}
targets: {far: {position: [FAR, 0.0, -3.0]}}
failsafes:
  - {name: lost, when: {use: estimate_bad}, for: 1.0, to: land}
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 3.0}, transitions: [{to: away, when: done}]}
  away:
    kind: custom
    behavior: {use: go_to, target: far, speed: 4.0}
    transitions: [{to: land, when: GUARD}, {to: land, after: LONGEST}]
  land: {kind: land}
"""
HANGS = '''\
import time
from typing import ClassVar

from missionkit.messages import Estimate, Verdict
from missionkit.plugin import Guard


class Hangs(Guard):
    """Blocks for four seconds of the vehicle beyond `north`, and swallows interruptions."""

    kind: ClassVar[str] = "hangs"
    north: float
    seconds: float

    def check(self, seen: Estimate) -> Verdict:
        end = time.perf_counter() + self.seconds
        while seen.position[0] > self.north and time.perf_counter() < end:
            try:
                while time.perf_counter() < end:
                    pass
            except Exception:
                continue
        return Verdict(holds=False)
'''
IMPORTS = (
    "import there_is_no_such_module\n",
    "class Half(\n",
    "raise RuntimeError('not today')\n",
    "import sys; sys.exit(3)\n",
    "1 / 0\n",
    "def again(): again()\nagain()\n",
    "from missionkit.plugin import Guard\nclass Nameless(Guard):\n    pass\n",
    "from missionkit.nowhere import Guard\n",
    "assert False\n",
    "raise KeyboardInterrupt\n",
)


class Under(NamedTuple):
    """A flight under way: the program, and the truth."""

    autopilot: Autopilot
    process: subprocess.Popen[str]
    dialect: str
    url: str
    folder: Path

    @property
    def truth(self) -> dict[str, Any]:
        """The true state now."""
        state: dict[str, Any] = self.autopilot.ask(truth=True)
        return state

    @property
    def now(self) -> float:
        """Simulated time (s)."""
        return float(self.autopilot.ask(time=True)["time"])

    def until(self, holds: Callable[[], bool], limit: float = LIMIT) -> bool:
        """Wait at most `limit` (s, simulated) until `holds()`; return whether it did."""
        end = self.now + limit
        while not holds():
            if self.now > end:
                return False
            threading.Event().wait(0.05 / SPEED)
        return True

    def flies(self) -> None:
        """Wait until it is fast.

        Raises:
            RuntimeError: it never was.
        """
        ended = self.process.poll
        self.until(lambda: self.truth["velocity"][0] > FAST or ended() is not None, START)
        if self.truth["velocity"][0] <= FAST:
            raise RuntimeError(f"it never flew: {ended()}, {self.truth}")

    def away(self, chance: np.random.Generator) -> float:
        """Wait until it is fast, and up to 3 s more; return the simulated time (s)."""
        self.flies()
        later = self.now + chance.uniform(0.0, 3.0)
        self.until(lambda: self.now >= later)
        return self.now

    def down(self) -> bool:
        """Wait until it is on the ground, disarmed; return whether that happened."""
        return self.until(lambda: self.truth["on_ground"] and not self.truth["armed"])

    def stood(self, since: float) -> tuple[float, float]:
        """Wait; return how long (s) after `since` it was slow for good, and how far (m) it flew."""
        self.until(lambda: self.now > since + 10.0)
        rows = np.array(self.autopilot.ask(track=True, since=since)["rows"], dtype=float)
        fast = np.flatnonzero(np.hypot(rows[:, 4], rows[:, 5]) > STANDING)
        last = int(fast[-1]) if len(fast) else 0
        way = float(np.hypot(*(rows[last, 1:3] - rows[0, 1:3])))
        return float(rows[last, 0]) - since, way


def program(*words: str | Path, blocks: int | None = None) -> subprocess.Popen[str]:
    """Start `missionkit run`; it may write files of so many `blocks` of 512 bytes."""
    line = [sys.executable, "-m", "missionkit", "run", "--headless", "--json", *map(str, words)]
    if blocks is not None:
        line = ["sh", "-c", f'ulimit -f {blocks}; exec "$@"', "sh", *line]
    return subprocess.Popen(line, stdout=-1, stderr=-1, text=True)  # noqa: S603


def straight(far: float, guard: str, longest: float) -> str:
    """Return a mission that flies `far` (m) north until a guard holds, `longest` (s) at most."""
    text = STRAIGHT.replace("FAR", str(far)).replace("GUARD", guard)
    return text.replace("LONGEST", str(longest))


@contextmanager
def flying(
    seed: int,
    *words: str | Path,
    far: float = 80.0,
    guard: str = "done",
    longest: float = 60.0,
    blocks: int | None = None,
) -> Iterator[Under]:
    """Fly north over the wire, the dialects in turn, while this context is open."""
    port, dialect = free_port(), DIALECTS[seed % len(DIALECTS)]
    with (
        tempfile.TemporaryDirectory() as name,
        sitl(None, dialect, port, SPEED, seed) as autopilot,
    ):
        mission = Path(name) / "straight.yaml"
        mission.write_text(straight(far, guard, longest))
        url = f"udpin://127.0.0.1:{port}"
        more = ["--vehicle", url, "--speed", str(SPEED), "--out", Path(name) / "runs"]
        with program(mission, *more, *words, blocks=blocks) as process:
            try:
                yield Under(autopilot, process, dialect, url, Path(name))
            finally:
                process.kill()


def killed(seed: int) -> Seen:
    """SIGKILL under way."""
    with flying(seed) as under:
        since = under.away(np.random.default_rng([seed, 1]))
        under.process.kill()
        return _standing(seed, under, since)


def _standing(seed: int, under: Under, since: float) -> Seen:
    after, way = under.stood(since)
    details = f"{under.dialect}: stood after {after:.1f} s, {way:.1f} m on"
    if under.truth["crashed"]:
        return Seen(seed, "crashed", details)
    return Seen(seed, STOOD if after <= IN_TIME else "stood later", details)


def terminated(seed: int) -> Seen:
    """SIGTERM under way."""
    with flying(seed) as under:
        under.away(np.random.default_rng([seed, 2]))
        under.process.send_signal(signal.SIGTERM)
        return _landing(seed, under)


def _landing(seed: int, under: Under) -> Seen:
    """Wait until the program has ended and the vehicle is down."""
    code, wrong = _ended(under.process)
    down, truth = under.down(), under.truth
    rows = np.array(under.autopilot.ask(track=True, since=0.0, every=10)["rows"], dtype=float)
    flew = bool((rows[:, 3] < -1.0).any())
    details = f"{under.dialect}: exit {code}, {truth['position'][0]:.1f} m north; {wrong[-150:]!r}"
    if truth["crashed"]:
        return Seen(seed, "crashed", details)
    if not flew and code and "Traceback" not in wrong:
        return Seen(seed, REFUSED, details)
    good = flew and down and code is not None
    return Seen(seed, LANDED if good else "did not fly and come down", details)


def _ended(process: subprocess.Popen[str]) -> tuple[int | None, str]:
    """Return the exit code, None if it does not end, and what was said of problems."""
    try:
        _, wrong = process.communicate(timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return None, ""
    return process.returncode, wrong


def without_remote_control(seed: int) -> Seen:
    """`rc_lost` under way, with the autopilots' default actions but a low return."""
    low = {"px4": {"RTL_RETURN_ALT": 5.0, "RTL_DESCEND_ALT": 5.0}, "ardupilot": {"RTL_ALT": 500}}
    with flying(seed) as under:
        for name, value in low[under.dialect].items():
            under.autopilot.ask(parameter=name, value=value)
        since = under.away(np.random.default_rng([seed, 3]))
        under.autopilot.ask(fault="rc_lost")
        down, truth = under.down(), under.truth
        mine = under.autopilot.ask(journal="setpoint", since=since + 3.0)["notes"]
        home = float(np.hypot(*truth["position"][:2]))
        details = (
            f"{under.dialect}: {truth['failsafe']}, {home:.1f} m from home, {len(mine)} setpoints"
        )
        if down and not truth["crashed"] and home < 5.0 and not mine:
            return Seen(seed, TAKEN, details)
        return Seen(seed, "not as the autopilot wanted", details)


def blocked(seed: int) -> Seen:
    """Block the event loop for four seconds of the vehicle, within a plug-in."""
    with tempfile.TemporaryDirectory() as name:
        plugin = Path(name) / "hangs.py"
        plugin.write_text(HANGS)
        north = np.random.default_rng([seed, 4]).uniform(8.0, 25.0)
        guard = f"{{use: hangs, north: {north:.2f}, seconds: {4.0 / SPEED}}}"
        with flying(seed, "--plugin", plugin, guard=guard) as under:
            under.flies()
            under.until(lambda: under.truth["position"][0] > north)
            return _standing(seed, under, under.now)


def full_disk(seed: int) -> Seen:
    """Let no file grow beyond 2 to 100 kB, as if the disk were full from then on."""
    blocks = round(float(np.exp(np.random.default_rng([seed, 5]).uniform(np.log(4), np.log(200)))))
    with flying(seed, far=20.0, blocks=blocks) as under:
        seen = _landing(seed, under)
        return seen._replace(details=f"{seen.details}, files of at most {blocks / 2:g} kB")


def started_twice(seed: int) -> Seen:
    """Start the program again on the link of one that flies until the second has ended."""
    with flying(seed, far=4.0 * PATIENCE, longest=PATIENCE) as under:
        under.away(np.random.default_rng([seed, 6]))
        again = program(
            under.folder / "straight.yaml",
            *("--vehicle", under.url, "--speed", str(SPEED), "--out", under.folder / "again"),
        )
        with again:
            refused = refusal(again)
        under.process.send_signal(signal.SIGTERM)  # it lands
        first = _landing(seed, under)
        details = f"{refused}; {first.details}"
        good = refused.startswith("exit") and first.outcome == LANDED
        return Seen(seed, BOTH if good else "not both", details)


def refusal(process: subprocess.Popen[str]) -> str:
    """Return "exit N: sentence" of a program that should refuse, or how it failed to."""
    try:
        said, wrong = process.communicate(timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        return "it did not end"
    if process.returncode in {0, 4} or "Traceback" in wrong or not (said + wrong).strip():
        return f"code {process.returncode}: {wrong[-200:]!r}"
    return f"exit {process.returncode}: {(wrong or said).strip().splitlines()[0][:80]}"


def bad_file(seed: int) -> Seen:
    """Fly a mission file that is broken in one of the fuzzer's nine ways; some leave it whole."""
    with tempfile.TemporaryDirectory() as name:
        path, number = Path(name) / "broken.yaml", seed
        families = list(FAMILIES)
        while True:
            path.write_bytes(document(families[number % len(families)], seed, number))
            if not checked(path, builtin())[0]:
                break
            number += 1
        return _refused(seed, Path(name), path)


def bad_import(seed: int) -> Seen:
    """Fly with a plug-in file that cannot be imported."""
    with tempfile.TemporaryDirectory() as name:
        plugin, mission = Path(name) / "plugin.py", Path(name) / "straight.yaml"
        plugin.write_text(IMPORTS[seed % len(IMPORTS)])
        mission.write_text(straight(20.0, "done", 60.0))
        return _refused(seed, Path(name), mission, "--plugin", plugin)


def _refused(seed: int, folder: Path, *words: str | Path) -> Seen:
    with program(*words, "--out", folder / "runs") as process:
        said = refusal(process)
    flew = any((folder / "runs").glob("*/*.mcap"))
    good = said.startswith("exit 2") and not flew
    return Seen(seed, REFUSED if good else "not refused well", said)


Declared = tuple[str, str, tuple[str, ...], Callable[[int], Seen]]
ROWS: tuple[Declared, ...] = (
    (
        "RC lost",
        "over the wire: `rc_lost`, flying north at 4 m/s; the autopilots' default actions",
        (TAKEN,),
        without_remote_control,
    ),
    (
        "loop blocked",
        "over the wire: a plug-in blocks the event loop for 4 s at 4 m/s",
        (STOOD,),
        blocked,
    ),
    ("SIGKILL", "over the wire: at 4 m/s", (STOOD,), killed),
    ("SIGTERM", "over the wire: at 4 m/s", (LANDED,), terminated),
    ("bad file", "`run` of a document of the fuzzer", (REFUSED,), bad_file),
    ("bad import", "`run --plugin` of a file that cannot be imported", (REFUSED,), bad_import),
    (
        "disk full",
        "over the wire: no file may grow beyond 2 to 100 kB",
        (LANDED, REFUSED),
        full_disk,
    ),
    (
        "double start",
        "over the wire: `run` again on the link of one that flies",
        (BOTH,),
        started_twice,
    ),
)
"""Name, the fault, its declared outcomes, the function that injects it."""
