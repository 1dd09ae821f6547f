"""The topics of a flight record and the JSON Schema of each.

Names that begin with `foxglove.` follow Foxglove's published message schemas, so that its panels
show them without conversion; the others are missionkit's own. A key that is not required is left
out when it is not known: viewers understand a missing key, not `null`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

Schema = dict[str, Any]


class Topic(NamedTuple):
    """One channel of the record."""

    name: str
    schema_name: str
    schema: Schema


def _record(properties: Schema, optional: tuple[str, ...] = ()) -> Schema:
    """Return the schema of an object with these keys and no others."""
    return {
        "type": "object",
        "properties": properties,
        "required": [key for key in properties if key not in optional],
        "additionalProperties": False,
    }


def _numbers(*names: str) -> Schema:
    return _record(dict.fromkeys(names, NUMBER))


def _list(items: Schema) -> Schema:
    return {"type": "array", "items": items}


NUMBER: Schema = {"type": "number"}
INTEGER: Schema = {"type": "integer"}
TEXT: Schema = {"type": "string"}
FLAG: Schema = {"type": "boolean"}
_NONE: Schema = _list({"type": "object", "properties": {}, "additionalProperties": False})

VECTOR = _numbers("x", "y", "z")
QUATERNION = _numbers("x", "y", "z", "w")
COLOUR = _numbers("r", "g", "b", "a")
POINT = _numbers("x", "y")
TIME = {**_record({"sec": INTEGER, "nsec": INTEGER}), "title": "time"}
DURATION = {**TIME, "title": "duration"}
POSE = _record({"position": VECTOR, "orientation": QUATERNION})

POSE_IN_FRAME = _record({"timestamp": TIME, "frame_id": TEXT, "pose": POSE})
TRANSFORMS = _record(
    {
        "transforms": _list(
            _record(
                {
                    "timestamp": TIME,
                    "parent_frame_id": TEXT,
                    "child_frame_id": TEXT,
                    "translation": VECTOR,
                    "rotation": QUATERNION,
                }
            )
        )
    }
)
IMAGE = _record(
    {
        "timestamp": TIME,
        "frame_id": TEXT,
        "data": {"type": "string", "contentEncoding": "base64"},
        "format": TEXT,
    }
)
CALIBRATION = _record(
    {
        "timestamp": TIME,
        "frame_id": TEXT,
        "width": INTEGER,
        "height": INTEGER,
        "distortion_model": TEXT,
        "D": _list(NUMBER),
        "K": _list(NUMBER),
        "R": _list(NUMBER),
        "P": _list(NUMBER),
    }
)
ANNOTATIONS = _record(
    {
        "circles": _NONE,
        "points": _list(
            _record(
                {
                    "timestamp": TIME,
                    "type": INTEGER,
                    "points": _list(POINT),
                    "outline_color": COLOUR,
                    "outline_colors": _NONE,
                    "fill_color": COLOUR,
                    "thickness": NUMBER,
                }
            )
        ),
        "texts": _list(
            _record(
                {
                    "timestamp": TIME,
                    "position": POINT,
                    "text": TEXT,
                    "font_size": NUMBER,
                    "text_color": COLOUR,
                    "background_color": COLOUR,
                }
            )
        ),
    }
)
_SOLID = _record({"pose": POSE, "size": VECTOR, "color": COLOUR})
_CYLINDER = _record(
    {
        "pose": POSE,
        "size": VECTOR,
        "bottom_scale": NUMBER,
        "top_scale": NUMBER,
        "color": COLOUR,
    }
)
SCENE = _record(
    {
        "deletions": _NONE,
        "entities": _list(
            _record(
                {
                    "timestamp": TIME,
                    "frame_id": TEXT,
                    "id": TEXT,
                    "lifetime": DURATION,
                    "frame_locked": FLAG,
                    "metadata": _NONE,
                    "arrows": _NONE,
                    "cubes": _list(_SOLID),
                    "spheres": _list(_SOLID),
                    "cylinders": _list(_CYLINDER),
                    "lines": _NONE,
                    "triangles": _NONE,
                    "texts": _NONE,
                    "models": _NONE,
                }
            )
        ),
    }
)
LOG = _record(
    {
        "timestamp": TIME,
        "level": INTEGER,
        "message": TEXT,
        "name": TEXT,
        "file": TEXT,
        "line": INTEGER,
    }
)
COMMAND = _record(
    {
        "timestamp": TIME,
        "velocity": VECTOR,
        "yaw_rate": NUMBER,
        "position": VECTOR,
        "yaw": NUMBER,
        "attitude": QUATERNION,
        "thrust": NUMBER,
        "force": VECTOR,
        "torque": VECTOR,
        "action": TEXT,
        "height": NUMBER,
        "payload": TEXT,
    },
    optional=(
        *("velocity", "yaw_rate", "position", "yaw", "attitude", "thrust", "force", "torque"),
        *("action", "height", "payload"),
    ),
)
VERDICT = _record(
    {
        "name": TEXT,
        "holds": {"type": "string", "enum": ["yes", "no", "unknown"]},
        "value": NUMBER,
        "threshold": NUMBER,
        "margin": NUMBER,
        "why": TEXT,
    },
    optional=("value", "threshold", "margin", "why"),
)
GUARDS = _record({"timestamp": TIME, "guards": _list(VERDICT)})
STATE = _record(
    {
        "timestamp": TIME,
        "state": TEXT,
        "mode": TEXT,
        "since": NUMBER,
        "done": FLAG,
        "note": TEXT,
        "problems": _list(TEXT),
    }
)
TRANSITION = _record(
    {
        "timestamp": TIME,
        "source": TEXT,
        "to": TEXT,
        "reason": TEXT,
        "verdicts": _list(VERDICT),
        "outputs": _list(TEXT),
    }
)
ESTIMATE = _record(
    {
        "timestamp": TIME,
        "velocity": VECTOR,
        "speed": NUMBER,
        "height": NUMBER,
        "yaw_deg": NUMBER,
        "position_sd": NUMBER,
        "targets": _list(
            _record(
                {"name": TEXT, "position": VECTOR, "position_sd": NUMBER, "seen_at": NUMBER},
                optional=("seen_at",),
            )
        ),
        "range": NUMBER,
    },
    optional=("range",),
)
STATUS = _record(
    {
        "timestamp": TIME,
        "charge": NUMBER,
        "voltage": NUMBER,
        "armed": FLAG,
        "in_air": FLAG,
        "vehicle_mode": TEXT,
        "aligned": FLAG,
        "diverged": FLAG,
        "position_sd": NUMBER,
        "rejected": INTEGER,
        "gnss_at": NUMBER,
        "vision_at": NUMBER,
        "mahalanobis": NUMBER,
    },
    optional=(
        "charge",
        "voltage",
        "armed",
        "in_air",
        "vehicle_mode",
        "gnss_at",
        "vision_at",
        "mahalanobis",
    ),
)
TIMING = _record(
    {
        "timestamp": TIME,
        "sense": NUMBER,
        "process": NUMBER,
        "control": NUMBER,
        "total": NUMBER,
        "overruns": INTEGER,
    }
)

WALL_CLOCK = frozenset({"/timing"})
"""Topics that differ between two flights of the same seed, and are left out of the hash."""

TOPICS = (
    Topic("/pose", "foxglove.PoseInFrame", POSE_IN_FRAME),
    Topic("/truth/pose", "foxglove.PoseInFrame", POSE_IN_FRAME),
    Topic("/goal", "foxglove.PoseInFrame", POSE_IN_FRAME),
    Topic("/tf", "foxglove.FrameTransforms", TRANSFORMS),
    Topic("/camera/image", "foxglove.CompressedImage", IMAGE),
    Topic("/camera/calibration", "foxglove.CameraCalibration", CALIBRATION),
    Topic("/camera/markers", "foxglove.ImageAnnotations", ANNOTATIONS),
    Topic("/scene", "foxglove.SceneUpdate", SCENE),
    Topic("/log", "foxglove.Log", LOG),
    Topic("/command", "missionkit.Command", COMMAND),
    Topic("/guards", "missionkit.Guards", GUARDS),
    Topic("/state", "missionkit.State", STATE),
    Topic("/transitions", "missionkit.Transition", TRANSITION),
    Topic("/estimate", "missionkit.Estimate", ESTIMATE),
    Topic("/status", "missionkit.Status", STATUS),
    Topic("/timing", "missionkit.Timing", TIMING),
)
