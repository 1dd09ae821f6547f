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
    return _record(dict.fromkeys(names, NUMBER_SCHEMA))


def _list(items: Schema) -> Schema:
    return {"type": "array", "items": items}


NUMBER_SCHEMA: Schema = {"type": "number"}
INTEGER: Schema = {"type": "integer"}
TEXT_SCHEMA: Schema = {"type": "string"}
FLAG: Schema = {"type": "boolean"}
_EMPTY_LIST: Schema = _list({"type": "object", "properties": {}, "additionalProperties": False})

VECTOR = _numbers("x", "y", "z")
QUATERNION_SCHEMA = _numbers("x", "y", "z", "w")
COLOUR = _numbers("r", "g", "b", "a")
POINT = _numbers("x", "y")
TIME_SCHEMA = {**_record({"sec": INTEGER, "nsec": INTEGER}), "title": "time"}
DURATION = {**TIME_SCHEMA, "title": "duration"}
POSE = _record({"position": VECTOR, "orientation": QUATERNION_SCHEMA})

POSE_IN_FRAME = _record({"timestamp": TIME_SCHEMA, "frame_id": TEXT_SCHEMA, "pose": POSE})
TRANSFORMS = _record(
    {
        "transforms": _list(
            _record(
                {
                    "timestamp": TIME_SCHEMA,
                    "parent_frame_id": TEXT_SCHEMA,
                    "child_frame_id": TEXT_SCHEMA,
                    "translation": VECTOR,
                    "rotation": QUATERNION_SCHEMA,
                }
            )
        )
    }
)
IMAGE = _record(
    {
        "timestamp": TIME_SCHEMA,
        "frame_id": TEXT_SCHEMA,
        "data": {"type": "string", "contentEncoding": "base64"},
        "format": TEXT_SCHEMA,
    }
)
CALIBRATION = _record(
    {
        "timestamp": TIME_SCHEMA,
        "frame_id": TEXT_SCHEMA,
        "width": INTEGER,
        "height": INTEGER,
        "distortion_model": TEXT_SCHEMA,
        "D": _list(NUMBER_SCHEMA),
        "K": _list(NUMBER_SCHEMA),
        "R": _list(NUMBER_SCHEMA),
        "P": _list(NUMBER_SCHEMA),
    }
)
ANNOTATIONS = _record(
    {
        "circles": _EMPTY_LIST,
        "points": _list(
            _record(
                {
                    "timestamp": TIME_SCHEMA,
                    "type": INTEGER,
                    "points": _list(POINT),
                    "outline_color": COLOUR,
                    "outline_colors": _EMPTY_LIST,
                    "fill_color": COLOUR,
                    "thickness": NUMBER_SCHEMA,
                }
            )
        ),
        "texts": _list(
            _record(
                {
                    "timestamp": TIME_SCHEMA,
                    "position": POINT,
                    "text": TEXT_SCHEMA,
                    "font_size": NUMBER_SCHEMA,
                    "text_color": COLOUR,
                    "background_color": COLOUR,
                }
            )
        ),
    }
)
_SOLID = _record({"pose": POSE, "size": VECTOR, "color": COLOUR})
_CYLINDER_SCHEMA = _record(
    {
        "pose": POSE,
        "size": VECTOR,
        "bottom_scale": NUMBER_SCHEMA,
        "top_scale": NUMBER_SCHEMA,
        "color": COLOUR,
    }
)
SCENE = _record(
    {
        "deletions": _EMPTY_LIST,
        "entities": _list(
            _record(
                {
                    "timestamp": TIME_SCHEMA,
                    "frame_id": TEXT_SCHEMA,
                    "id": TEXT_SCHEMA,
                    "lifetime": DURATION,
                    "frame_locked": FLAG,
                    "metadata": _EMPTY_LIST,
                    "arrows": _EMPTY_LIST,
                    "cubes": _list(_SOLID),
                    "spheres": _list(_SOLID),
                    "cylinders": _list(_CYLINDER_SCHEMA),
                    "lines": _EMPTY_LIST,
                    "triangles": _EMPTY_LIST,
                    "texts": _EMPTY_LIST,
                    "models": _EMPTY_LIST,
                }
            )
        ),
    }
)
LOG_SCHEMA = _record(
    {
        "timestamp": TIME_SCHEMA,
        "level": INTEGER,
        "message": TEXT_SCHEMA,
        "name": TEXT_SCHEMA,
        "file": TEXT_SCHEMA,
        "line": INTEGER,
    }
)
COMMAND = _record(
    {
        "timestamp": TIME_SCHEMA,
        "velocity": VECTOR,
        "yaw_rate": NUMBER_SCHEMA,
        "position": VECTOR,
        "yaw": NUMBER_SCHEMA,
        "attitude": QUATERNION_SCHEMA,
        "thrust": NUMBER_SCHEMA,
        "force": VECTOR,
        "torque": VECTOR,
        "action": TEXT_SCHEMA,
        "height": NUMBER_SCHEMA,
        "payload": TEXT_SCHEMA,
        "orders": TEXT_SCHEMA,
        "gimbal_deg": _numbers("pitch", "yaw"),
    },
    optional=(
        *("velocity", "yaw_rate", "position", "yaw", "attitude", "thrust", "force", "torque"),
        *("action", "height", "payload", "orders", "gimbal_deg"),
    ),
)
VERDICT = _record(
    {
        "name": TEXT_SCHEMA,
        "holds": {"type": "string", "enum": ["yes", "no", "unknown"]},
        "value": NUMBER_SCHEMA,
        "threshold": NUMBER_SCHEMA,
        "margin": NUMBER_SCHEMA,
        "why": TEXT_SCHEMA,
    },
    optional=("value", "threshold", "margin", "why"),
)
GUARDS_SCHEMA = _record({"timestamp": TIME_SCHEMA, "guards": _list(VERDICT)})
STATE_SCHEMA = _record(
    {
        "timestamp": TIME_SCHEMA,
        "state": TEXT_SCHEMA,
        "mode": TEXT_SCHEMA,
        "since": NUMBER_SCHEMA,
        "done": FLAG,
        "note": TEXT_SCHEMA,
        "problems": _list(TEXT_SCHEMA),
    }
)
TRANSITION = _record(
    {
        "timestamp": TIME_SCHEMA,
        "source": TEXT_SCHEMA,
        "to": TEXT_SCHEMA,
        "reason": TEXT_SCHEMA,
        "verdicts": _list(VERDICT),
        "outputs": _list(TEXT_SCHEMA),
    }
)
ESTIMATE_SCHEMA = _record(
    {
        "timestamp": TIME_SCHEMA,
        "velocity": VECTOR,
        "speed": NUMBER_SCHEMA,
        "height": NUMBER_SCHEMA,
        "yaw_deg": NUMBER_SCHEMA,
        "position_sd": NUMBER_SCHEMA,
        "targets": _list(
            _record(
                {
                    "name": TEXT_SCHEMA,
                    "position": VECTOR,
                    "position_sd": NUMBER_SCHEMA,
                    "seen_at": NUMBER_SCHEMA,
                },
                optional=("seen_at",),
            )
        ),
        "range": NUMBER_SCHEMA,
    },
    optional=("range",),
)
STATUS_SCHEMA = _record(
    {
        "timestamp": TIME_SCHEMA,
        "charge": NUMBER_SCHEMA,
        "voltage": NUMBER_SCHEMA,
        "armed": FLAG,
        "in_air": FLAG,
        "vehicle_mode": TEXT_SCHEMA,
        "aligned": FLAG,
        "diverged": FLAG,
        "position_sd": NUMBER_SCHEMA,
        "rejected": INTEGER,
        "gnss_at": NUMBER_SCHEMA,
        "vision_at": NUMBER_SCHEMA,
        "mahalanobis": NUMBER_SCHEMA,
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
        "timestamp": TIME_SCHEMA,
        "sense": NUMBER_SCHEMA,
        "process": NUMBER_SCHEMA,
        "control": NUMBER_SCHEMA,
        "total": NUMBER_SCHEMA,
        "overruns": INTEGER,
    }
)

LOCATION_FIX = _record(
    {
        "timestamp": TIME_SCHEMA,
        "frame_id": TEXT_SCHEMA,
        "latitude": NUMBER_SCHEMA,
        "longitude": NUMBER_SCHEMA,
        "altitude": NUMBER_SCHEMA,
        "position_covariance": _list(NUMBER_SCHEMA),
        "position_covariance_type": INTEGER,
    }
)
ORIGIN_SCHEMA = _record(
    {
        "timestamp": TIME_SCHEMA,
        "latitude": NUMBER_SCHEMA,
        "longitude": NUMBER_SCHEMA,
        "altitude": NUMBER_SCHEMA,
        "utc": TEXT_SCHEMA,
    }
)
GRID = _record(
    {
        "timestamp": TIME_SCHEMA,
        "frame_id": TEXT_SCHEMA,
        "pose": POSE,
        "column_count": INTEGER,
        "cell_size": POINT,
        "row_stride": INTEGER,
        "cell_stride": INTEGER,
        "fields": _list(_record({"name": TEXT_SCHEMA, "offset": INTEGER, "type": INTEGER})),
        "data": {"type": "string", "contentEncoding": "base64"},
    }
)

WALL_CLOCK = frozenset({"/timing", "/origin"})
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
    Topic("/map", "foxglove.Grid", GRID),
    Topic("/fix", "foxglove.LocationFix", LOCATION_FIX),
    Topic("/places", "foxglove.GeoJSON", _record({"geojson": TEXT_SCHEMA})),
    Topic("/origin", "missionkit.Origin", ORIGIN_SCHEMA),
    Topic("/log", "foxglove.Log", LOG_SCHEMA),
    Topic("/command", "missionkit.Command", COMMAND),
    Topic("/guards", "missionkit.Guards", GUARDS_SCHEMA),
    Topic("/state", "missionkit.State", STATE_SCHEMA),
    Topic("/transitions", "missionkit.Transition", TRANSITION),
    Topic("/estimate", "missionkit.Estimate", ESTIMATE_SCHEMA),
    Topic("/status", "missionkit.Status", STATUS_SCHEMA),
    Topic("/timing", "missionkit.Timing", TIMING),
)
