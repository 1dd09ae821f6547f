"""The marker dictionaries OpenCV knows, by name, without importing OpenCV."""

from __future__ import annotations

from typing import Annotated, Final

from pydantic import AfterValidator, Field

from missionkit.errors import nearest

SIZES: Final[dict[str, int]] = {
    **{
        f"DICT_{bits}X{bits}_{count}": count
        for bits in (4, 5, 6, 7)
        for count in (50, 100, 250, 1000)
    },
    "DICT_ARUCO_ORIGINAL": 1024,
    "DICT_ARUCO_MIP_36h12": 250,
    "DICT_APRILTAG_16h5": 30,
    "DICT_APRILTAG_25h9": 35,
    "DICT_APRILTAG_36h10": 2320,
    "DICT_APRILTAG_36h11": 587,
}
"""Name of each dictionary and how many markers it holds; ids count from 0."""


def known(name: str) -> str:
    """Return `name` if it is a dictionary.

    Raises:
        ValueError: it is none; the message names the nearest and lists all.
    """
    if name not in SIZES:
        raise ValueError(f"there is no marker dictionary '{name}': {nearest(name, SIZES)}")
    return name


DictionaryName = Annotated[
    str, AfterValidator(known), Field(json_schema_extra={"enum": sorted(SIZES)})
]
"""The name of a marker dictionary, such as DICT_6X6_250."""
