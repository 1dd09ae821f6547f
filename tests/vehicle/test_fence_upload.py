"""A fence counts as uploaded once the autopilot gives it back."""

import pytest

from missionkit.errors import VehicleError
from missionkit.geodesy import Origin
from missionkit.vehicle.command.fence_upload import polygon, rally, set_fence, set_rally

ORIGIN = Origin(47.4, 8.5, 488.0)
FENCE = polygon(ORIGIN, [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)])


class Autopilot:
    """Keeps what it is given, and answers a download by what `answers` makes of it, in turn."""

    def __init__(self, *answers):
        self.answers = list(answers)

    def upload(self, items):
        self.kept = tuple(items)

    def download(self):
        return self.answers.pop(0)(self.kept) if self.answers else self.kept

    upload_fence = upload_rally = upload
    download_fence = download_rally = download


def nothing(_):
    return ()


def moved(items):
    return (items[0]._replace(x=items[0].x + 1), *items[1:])


def higher(items):
    return tuple(it._replace(z=it.z + 0.5) for it in items)


@pytest.mark.parametrize("late", [(), (nothing,), (moved, nothing)])
def test_an_old_answer_is_read_again(late):
    set_fence(Autopilot(*late), FENCE)


@pytest.mark.parametrize("lie", [nothing, moved, higher])
def test_another_fence_is_refused(lie):
    with pytest.raises(VehicleError, match="the geofence was sent with 3 points, but the auto"):
        set_fence(Autopilot(*[lie] * 9), FENCE)


def test_another_rally_point_is_refused():
    with pytest.raises(VehicleError, match="do not rely on it"):
        set_rally(Autopilot(*[higher] * 9), rally(ORIGIN, [(10.0, -5.0, 20.0)]))
