"""Messages between the layers: observation -> estimate -> verdicts -> command -> record.

Frames: world NED (m) with its origin at the take-off point, body FRD, camera as in OpenCV.
Quaternions (w, x, y, z), body to world. SI units, radians, seconds on the mission's clock.
A thing that is not known is `None`, never NaN.
"""

from missionkit.messages.command import (
    Action,
    AnySetpoint,
    AttitudeSetpoint,
    AutopilotSetpoint,
    Command,
    Guidance,
    HalfSpace,
    Mode,
    PositionSetpoint,
    Setpoint,
    Step,
    Wrench,
)
from missionkit.messages.estimate import Estimate, Goal, Health, Target
from missionkit.messages.events import (
    ABORT,
    CONTROL_RESUMED,
    GROUND_TOUCHED,
    MARKER_DUPLICATED,
    MARKER_UPSIDE_DOWN,
    is_event,
)
from missionkit.messages.image_features import FeatureMatches, FeatureSearch
from missionkit.messages.observation import (
    NO_CYCLE,
    AnchorRange,
    Baro,
    Battery,
    Cycle,
    ExternalPose,
    Features,
    Frame,
    Gnss,
    Image,
    Imu,
    Magnetometer,
    Observation,
    OpticalFlow,
    Points,
    Range,
    Scan,
    VehicleStatus,
)
from missionkit.messages.occupancy import Occupancy, Spot
from missionkit.messages.record import Fired, Record
from missionkit.messages.tracked_names import TRACKED, names_a_track, track_name
from missionkit.messages.traffic import OtherVehicle, TrafficReport
from missionkit.messages.verdict import Verdict
from missionkit.messages.vision import (
    BoxDetection,
    CameraModel,
    Detection,
    GroundDetection,
    GroundFrame,
    Look,
    Sighting,
)

__all__ = [
    "ABORT",
    "CONTROL_RESUMED",
    "GROUND_TOUCHED",
    "MARKER_DUPLICATED",
    "MARKER_UPSIDE_DOWN",
    "NO_CYCLE",
    "TRACKED",
    "Action",
    "AnchorRange",
    "AnySetpoint",
    "AttitudeSetpoint",
    "AutopilotSetpoint",
    "Baro",
    "Battery",
    "BoxDetection",
    "CameraModel",
    "Command",
    "Cycle",
    "Detection",
    "Estimate",
    "ExternalPose",
    "FeatureMatches",
    "FeatureSearch",
    "Features",
    "Fired",
    "Frame",
    "Gnss",
    "Goal",
    "GroundDetection",
    "GroundFrame",
    "Guidance",
    "HalfSpace",
    "Health",
    "Image",
    "Imu",
    "Look",
    "Magnetometer",
    "Mode",
    "Observation",
    "Occupancy",
    "OpticalFlow",
    "OtherVehicle",
    "Points",
    "PositionSetpoint",
    "Range",
    "Record",
    "Scan",
    "Setpoint",
    "Sighting",
    "Spot",
    "Step",
    "Target",
    "TrafficReport",
    "VehicleStatus",
    "Verdict",
    "Wrench",
    "is_event",
    "names_a_track",
    "track_name",
]
