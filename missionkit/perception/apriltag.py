"""AprilTags as markers of targets: `perception: [{use: apriltag, target: …}]`."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import AfterValidator, Field

from missionkit.errors import nearest
from missionkit.perception.aruco import Aruco
from missionkit.perception.marker_dictionaries import SIZES

FAMILIES = tuple(name for name in SIZES if "APRILTAG" in name)


def _family(name: str) -> str:
    if name not in FAMILIES:
        raise ValueError(f"there is no family of AprilTags '{name}': {nearest(name, FAMILIES)}")
    return name


class AprilTag(Aruco):
    """An AprilTag fixed to a target: a marker as `aruco`, of one of the tag families.

    `size` is the edge of the black square. Everything else is as for `aruco`.
    """

    kind: ClassVar[str] = "apriltag"

    dictionary: Annotated[
        str, AfterValidator(_family), Field(json_schema_extra={"enum": sorted(FAMILIES)})
    ] = "DICT_APRILTAG_36h11"
