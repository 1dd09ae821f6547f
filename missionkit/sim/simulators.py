"""The simulated vehicles, by the kind of vehicle that a mission names.

Imported late: it compiles kernels.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from missionkit.sim.fault_injection import Fault
from missionkit.sim.flight_grading import Grade, grade, touched_at
from missionkit.sim.free_flyer.docking_grading import grade_docking
from missionkit.sim.free_flyer.free_flyer import FreeFlyer
from missionkit.sim.free_flyer.warm_up import warm_up as warm_up_flyer
from missionkit.sim.herd_grading import grade_herd
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.warm_up import warm_up as warm_up_multicopter
from missionkit.sim.world import World
from missionkit.sim.world_files import AnyWorld

if TYPE_CHECKING:
    from missionkit.perception.camera_section import Camera

ON_DECK = 0.05  # m, higher, what the vehicle stands on is the deck
Simulated = SimulatedVehicle | FreeFlyer


def simulated(world: AnyWorld, camera: Camera, seed: int, faults: Sequence[Fault]) -> Simulated:
    """Return a vehicle in its world, its kernels compiled.

    Args:
        world: says which kind of vehicle flies in it.
        camera: the mission's camera, of a multicopter.
        seed: of all randomness.
        faults: what goes wrong, and when.

    Raises:
        UsageError: a fault that this kind of vehicle cannot have.
    """
    if isinstance(world, World):
        warm_up_multicopter(corners=camera.use == "corners")
        return SimulatedVehicle(world, camera, seed, faults)
    warm_up_flyer()
    return FreeFlyer(world, seed, faults)


def graded(vehicle: Simulated) -> Grade:
    """Return the grade of what a vehicle has flown so far, by ground truth."""
    rows = vehicle.track.rows
    if isinstance(vehicle, SimulatedVehicle):
        herd = grade_herd(vehicle.robots)
        found = grade(rows)._replace(herd=herd)
        if herd is not None:
            return found._replace(touched_at=None)  # it lands before robots
        if vehicle.world.deck is not None:  # on the deck it may stand
            return found._replace(touched_at=touched_at(rows, below=-ON_DECK))
        return found
    return grade(rows)._replace(docking=grade_docking(rows, vehicle.world, vehicle.impulse))
