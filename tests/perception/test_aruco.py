from __future__ import annotations

import cv2
import pytest
from pydantic import ValidationError

from missionkit.perception.aruco import Aruco
from missionkit.perception.marker_dictionaries import SIZES
from missionkit.perception.opencv_helpers import dictionary


def test_the_table_of_dictionaries_is_opencvs():
    theirs = {n.lower() for n in dir(cv2.aruco) if n.startswith("DICT_")}
    assert {n.lower() for n in SIZES} == theirs
    assert {name: len(dictionary(name).bytesList) for name in SIZES} == SIZES


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ({"dictionary": "DICT_6X6_25O"}, "did you mean 'DICT_6X6_250'"),
        ({"dictionary": "DICT_4X4_50", "id": 50}, "ids 0 to 49, not 50"),
        ({"min_area": 500, "max_area": 400}, "not below"),
        ({"size": 0}, "greater than 0"),
    ],
)
def test_a_marker_that_cannot_be_is_refused(section, said):
    whole = {"target": "trunk", "id": 23, "size": 0.4} | section
    with pytest.raises(ValidationError, match=said):
        Aruco.model_validate(whole)


def test_the_schema_lists_the_dictionaries():
    assert Aruco.model_json_schema()["properties"]["dictionary"]["enum"] == sorted(SIZES)
