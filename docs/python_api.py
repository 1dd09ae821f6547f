"""Writes `docs/reference/python-api.md` from what `missionkit` exports.

After a change of a public name: `make reference`.
"""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from pathlib import Path
from typing import Any

import missionkit

ROOT = Path(__file__).parent
PAGE = ROOT / "reference" / "python-api.md"
SECTIONS = ("Args", "Attributes", "Returns", "Raises", "Example")
PARTS = {
    "Functions": (
        "load",
        "validate",
        "rehearse",
        "fly",
        "replay",
        "what_if",
        "why",
        "campaign",
        "subscribe",
    ),
    "What they take and return": (
        *("LoadedMission", "Operator", "Summary", "Analysis", "Replay", "ReplayDifference"),
        *("WhatIf", "Why", "TopicBus", "Subscription"),
        "Problem",
    ),
    "Errors": ("MissionkitError", "FileError", "UsageError", "VehicleError", "NotFitError"),
    "Plug-ins": (
        "Plugin",
        "Guard",
        "WindowGuard",
        "CompositeGuard",
        "Behavior",
        "Detector",
        "BoxDetector",
    ),
    "What plug-ins see": (
        *("Estimate", "Health", "Target", "Goal", "Battery", "VehicleStatus", "Occupancy"),
        *("Look", "Prior", "Sighting", "Detection", "GroundFrame", "GroundDetection"),
        *("Frame", "BoxDetection", "CameraModel"),
        *("Inputs", "NamedInput"),
    ),
    "What plug-ins answer": (
        *("Verdict", "Region", "Quantity", "Interval", "Step", "Guidance", "HalfSpace", "Action"),
        "Wrench",
    ),
    "What observers see": ("Record", "Fired", "Command", "Mode", "Observation"),
}
INTRO = """\
# Python API

Everything that `import missionkit` provides. Names are imported on first use, so the import itself
is cheap. World positions are NED (north, east, down) in metres from the take-off
point, body axes FRD (forward, right, down), the camera's as in OpenCV; quaternions (w, x, y, z),
body to world; SI units, radians, seconds of the mission. Unknown values are `None`, never NaN.

In the examples `mission` is `missionkit.load("mission.yaml")`, `summary` the summary of its
rehearsal, and `record`, `observation` and `seen` are of one tick of that flight.
"""


def page() -> str:
    """Return the page."""
    parts = [INTRO]
    for title, names in PARTS.items():
        parts.append(f"## {title}\n")
        parts += [_entry(name, getattr(missionkit, name)) for name in names]
    return "\n".join(parts)


def _entry(name: str, value: Any) -> str:
    said = _sections(inspect.getdoc(value) or "")
    lines = [f"### {name}\n", said["summary"] + "\n"]
    if inspect.isfunction(value):
        lines.insert(1, f"```python\n{name}{_signature(value)}\n```\n")
        lines += [*_listed("Args", said), *_listed("Raises", said)]
        if "Returns" in said:
            lines.append(f"**Returns** {' '.join(said['Returns'].split())}\n")
    else:
        lines += [*_listed("Attributes", said), *_listed("Args", said), *_fields(value)]
        lines += _methods(value)
    example = said.get("Example", textwrap.dedent(EXAMPLES.get(name, ""))).strip()
    if example:
        lines.append(f"```pycon\n{example}\n```\n")
    return "\n".join(lines)


def _signature(function: Any) -> str:
    """Return a signature, a parameter a line if it is long."""
    signature = inspect.signature(function)
    short = str(signature).replace("'", "")
    if len(short) < 60:
        return short
    lines, keyword = [], False
    for parameter in signature.parameters.values():
        if parameter.kind is parameter.KEYWORD_ONLY and not keyword:
            keyword = True
            lines.append("    *,")
        lines.append(f"    {parameter},".replace("'", ""))
    body = "\n".join(lines).replace("mappingproxy({})", "{}")
    return f"(\n{body}\n) -> {signature.return_annotation}".replace("'", "")


def _sections(doc: str) -> dict[str, str]:
    """Return the sections of a docstring by name; what stands before them is `summary`."""
    found = re.split(rf"^({'|'.join(SECTIONS)}):$", doc, flags=re.MULTILINE)
    pairs = zip(found[1::2], found[2::2], strict=True)
    return {"summary": found[0].strip(), **{k: textwrap.dedent(v).strip() for k, v in pairs}}


def _listed(section: str, said: dict[str, str]) -> list[str]:
    """Return a section of `name: what` as a table."""
    if section not in said:
        return []
    heading = {"Args": "argument", "Attributes": "attribute", "Raises": "raises"}[section]
    rows = [f"| {heading} | |", "|---|---|"]
    for item in re.split(r"\n(?=\S)", said[section]):
        name, _, what = item.partition(":")
        rows.append(f"| `{name}` | {_cell(what)} |")
    return ["\n".join(rows) + "\n"]


def _fields(cls: type) -> list[str]:
    """Return the fields of a class with type, default and the comment beside them."""
    source = textwrap.dedent(inspect.getsource(cls))
    tree = next(it for it in ast.walk(ast.parse(source)) if isinstance(it, ast.ClassDef))
    lines, rows = source.splitlines(), []
    members = [it for it in tree.body if isinstance(it, ast.AnnAssign | ast.Assign)]
    for node in members:
        name = ast.unparse(node.target if isinstance(node, ast.AnnAssign) else node.targets[0])
        if name.startswith("_") or name == "model_config":
            continue
        kind = ast.unparse(node.annotation) if isinstance(node, ast.AnnAssign) else "str"
        default = "" if node.value is None else f"`{ast.unparse(node.value)}`"
        comment = lines[node.end_lineno - 1][node.end_col_offset :].partition("#")[2]
        rows.append(f"| `{name}` | `{_cell(kind)}` | {_cell(default)} | {_cell(comment)} |")
    if not rows:
        return []
    return ["\n".join(["| field | type | default | |", "|---|---|---|---|", *rows]) + "\n"]


def _methods(cls: type) -> list[str]:
    """Return the public methods that a class itself has."""
    lines = []
    for name, member in vars(cls).items():
        function = member.__func__ if isinstance(member, classmethod) else member
        if name.startswith("_") or not (inspect.isfunction(function) or _is_property(member)):
            continue
        if cls.__doc__ and not (inspect.getdoc(function) or ""):
            continue
        said = " ".join(_sections(inspect.getdoc(function) or "")["summary"].split())
        if _is_property(member):
            lines.append(f"- `{name}`: {said}")
        else:
            shown = str(inspect.signature(function)).replace("'", "")
            shown = re.sub(r"\((self|cls)(, )?", "(", shown, count=1)
            lines.append(f"- `{name}{shown}`: {said}")
    return ["\n".join(lines) + "\n"] if lines else []


def _is_property(member: object) -> bool:
    return isinstance(member, property)


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


EXAMPLES = {
    "Operator": """
        >>> operator = missionkit.Operator()
        >>> operator.send("go")  # the chart hears it at the next tick
        >>> operator.land()
    """,
    "Summary": """
        >>> summary.outcome, summary.reason
        ('success', 'flown as planned')
        >>> [stay.state for stay in summary.states]
        ['idle', 'out', 'back', 'land']
    """,
    "Analysis": """
        >>> analysis.variants[0].outcomes  # of the campaign above
        {'success': 1}
    """,
    "Replay": """
        >>> summary = missionkit.rehearse(mission, folder="runs/again")
        >>> [part] = missionkit.replay("runs/again")
        >>> part.difference is None, part.notes
        (True, ())
    """,
    "ReplayDifference": """
        >>> missionkit.ReplayDifference(35.3, 705, "state: gps flown, visual replayed").tick
        705
    """,
    "WhatIf": """
        >>> [row.change.value for row in found.table.rows]
        ['same', 'same', 'same']
    """,
    "Problem": """
        >>> [str(problem) for problem in missionkit.validate("mission.yaml")]
        []
    """,
    "MissionkitError": """
        >>> try:
        ...     missionkit.rehearse(mission, faults=["gremlins"])
        ... except missionkit.MissionkitError as error:
        ...     print(type(error).__name__)
        UsageError
    """,
    "FileError": """
        >>> try:
        ...     missionkit.load("mission.yaml", settings={"hight": 3})
        ... except missionkit.FileError as error:
        ...     print(error.problems[0].message)
        --set hight: no such parameter; did you mean 'height'? Known: cruise, height
    """,
    "UsageError": """
        >>> issubclass(missionkit.UsageError, missionkit.MissionkitError)
        True
    """,
    "VehicleError": """
        >>> missionkit.VehicleError.exit_code.name
        'VEHICLE_LOST'
    """,
    "NotFitError": """
        >>> missionkit.NotFitError.exit_code.name
        'ENDED_SAFELY'
    """,
    "Plugin": """
        >>> missionkit.Guard.__mro__[1] is missionkit.Plugin
        True
    """,
    "Guard": """
        >>> class Fast(missionkit.Guard):
        ...     "Holds above `limit` (m/s)."
        ...
        ...     kind = "fast"
        ...     limit: float = 8.0
        ...
        ...     def check(self, seen):
        ...         return missionkit.Verdict.above(float(abs(seen.velocity).max()), self.limit)
        >>> Fast(limit=90.0).check(seen).holds
        False
    """,
    "WindowGuard": """
        >>> class Ticks(missionkit.WindowGuard):
        ...     "Holds from the third tick on."
        ...
        ...     kind = "ticks"
        ...
        ...     def begin(self):
        ...         return 0
        ...
        ...     def advance(self, memory, seen):
        ...         return memory + 1
        ...
        ...     def check(self, memory, seen):
        ...         return missionkit.Verdict.at_least(float(memory), 3.0)
        >>> Ticks().check(2, seen).margin
        -1.0
    """,
    "CompositeGuard": """
        >>> class Worn(missionkit.CompositeGuard):
        ...     "Holds once `variable` has reached `limit`."
        ...
        ...     kind = "worn"
        ...     variable: str
        ...     limit: float = 3.0
        ...
        ...     def named_inputs(self):
        ...         return (missionkit.NamedInput("variable", self.variable, ("variable",)),)
        ...
        ...     def check(self, memory, seen, inputs):
        ...         return missionkit.Verdict.at_least(inputs.variables[self.variable], self.limit)
        >>> inputs = missionkit.Inputs(answers={}, variables={"tries": 2.0}, active=())
        >>> Worn(variable="tries").check(None, seen, inputs).margin
        -1.0
    """,
    "Inputs": """
        >>> missionkit.Inputs(answers={}, variables={}, active=("gps",)).active
        ('gps',)
    """,
    "NamedInput": """
        >>> missionkit.NamedInput("guard", "marker-sure").what
        'guard'
    """,
    "Behavior": """
        >>> class Stay(missionkit.Behavior):
        ...     "Stay where the state was entered."
        ...
        ...     kind = "stay"
        ...
        ...     def begin(self, seen):
        ...         return seen.position
        ...
        ...     def step(self, seen, memory):
        ...         return missionkit.Step(missionkit.Guidance(memory, 1.0), memory=memory)
        >>> stay = Stay()
        >>> stay.step(seen, stay.begin(seen)).guidance.speed
        1.0
    """,
    "Detector": """
        >>> class Nothing(missionkit.Detector):
        ...     "Sees nothing."
        ...
        ...     kind = "nothing"
        ...
        ...     def detect(self, frame, camera, prior):
        ...         return ()
        >>> Nothing(target="place").target
        'place'
    """,
    "BoxDetector": """
        >>> class Bright(missionkit.BoxDetector):
        ...     "Finds the brightest point."
        ...
        ...     kind = "bright"
        ...
        ...     def boxes(self, frame, camera, prior):
        ...         at = np.array(np.unravel_index(frame.image.argmax(), frame.image.shape))
        ...         return (missionkit.BoxDetection("bright", at[::-1], (3.0, 3.0), 1.0),)
        >>> import numpy as np
        >>> frame = missionkit.Frame(at=2.0, image=np.eye(40, dtype=np.uint8)[:, ::-1])
        >>> Bright().boxes(frame, None, None)[0].centre.tolist()
        [39, 0]
    """,
    "Prior": """
        >>> missionkit.Prior(body=None, target=seen.targets["place"]).target.name
        'place'
    """,
    "Estimate": """
        >>> seen.position.shape, seen.state
        ((3,), 'out')
    """,
    "Health": """
        >>> seen.health.aligned, seen.health.diverged
        (True, False)
    """,
    "Target": """
        >>> seen.targets["place"].position.round().tolist()
        [30.0, 10.0, -5.0]
    """,
    "Goal": """
        >>> seen.goal.position.round().tolist()
        [30.0, 10.0, -5.0]
    """,
    "Battery": """
        >>> 0.0 < seen.battery.charge <= 1.0
        True
    """,
    "VehicleStatus": """
        >>> seen.status.armed, seen.status.in_air
        (True, True)
    """,
    "Occupancy": """
        >>> import numpy as np
        >>> field = missionkit.Occupancy(np.ones((10, 20)), resolution=0.5, origin=(0.0, 0.0))
        >>> field.covers((4.0, 9.0)), field.covers((6.0, 9.0))
        (True, False)
    """,
    "Look": """
        >>> missionkit.Look(at=2.0, seen=frozenset({"tree"})).silent
        False
    """,
    "Sighting": """
        >>> seen.sightings  # this mission looks for nothing
        ()
    """,
    "Detection": """
        >>> import numpy as np
        >>> square = np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]])
        >>> missionkit.Detection("DICT_6X6_250", 23, square, area=81.0).id
        23
    """,
    "GroundFrame": """
        >>> missionkit.GroundFrame(at=2.0, detections=()).ground
        0.0
    """,
    "GroundDetection": """
        >>> import numpy as np
        >>> place, spread = np.array([4.0, 1.0]), 0.01 * np.eye(2)
        >>> found = missionkit.GroundDetection("blob", place, spread, 0.9, 1.0, 2.0, 2.5)
        >>> found.position.tolist(), found.score
        ([4.0, 1.0], 0.9)
    """,
    "BoxDetection": """
        >>> import numpy as np
        >>> missionkit.BoxDetection("blob", np.array([160.0, 120.0]), (30.0, 28.0), 0.9).kind
        ''
    """,
    "Frame": """
        >>> import numpy as np
        >>> missionkit.Frame(at=2.0, image=np.zeros((480, 640), np.uint8)).image.shape
        (480, 640)
    """,
    "CameraModel": """
        >>> camera = mission.model.camera.model()
        >>> camera.width, camera.matrix.shape
        (640, (3, 3))
    """,
    "Verdict": """
        >>> verdict = missionkit.Verdict.below(0.25, 0.5)
        >>> verdict.holds, verdict.margin
        (True, 0.25)
        >>> missionkit.Verdict.unknown("no reading yet").holds is None
        True
    """,
    "Region": """
        >>> height = missionkit.Quantity("height", unit="m")
        >>> missionkit.Region.of(height, missionkit.Interval.below(2.0)).may[0][height].high
        2.0
    """,
    "Quantity": """
        >>> missionkit.Quantity("charge", least=0.0, most=1.0).most
        1.0
    """,
    "Interval": """
        >>> missionkit.Interval.at_least(3.0)
        Interval(low=3.0, high=inf, low_open=False, high_open=False)
    """,
    "Step": """
        >>> missionkit.Step(action=missionkit.Action.LAND, note="coming down").done
        False
    """,
    "Guidance": """
        >>> from missionkit.geometry import vec
        >>> missionkit.Guidance(vec(10.0, 0.0, -5.0), speed=2.0).avoid
        True
    """,
    "HalfSpace": """
        >>> from missionkit.geometry import vec
        >>> missionkit.HalfSpace(vec(0.0, 0.0, -20.0), vec(0.0, 0.0, 1.0)).normal.tolist()
        [0.0, 0.0, 1.0]
    """,
    "Wrench": """
        >>> from missionkit.geometry import vec
        >>> missionkit.Wrench(vec(0.05, 0.0, 0.0), vec(0.0, 0.0, 0.001)).torque.tolist()
        [0.0, 0.0, 0.001]
    """,
    "Action": """
        >>> [action.value for action in missionkit.Action]
        ['arm', 'take_off', 'hold', 'land', 'precision_land', 'return', 'disarm']
    """,
    "Record": """
        >>> record.state, record.mode.value, record.problems
        ('out', 'gps', ())
    """,
    "Fired": """
        >>> fired = missionkit.Fired("out", "back", "when done", (), ())
        >>> f"{fired.source} -> {fired.to}: {fired.reason}"
        'out -> back: when done'
    """,
    "Command": """
        >>> record.command.setpoint.velocity.shape
        (3,)
    """,
    "Mode": """
        >>> record.mode is missionkit.Mode.GPS
        True
    """,
    "Observation": """
        >>> observation.now == record.now
        True
    """,
}


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
