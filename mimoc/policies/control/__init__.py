"""Control of an infant by inverse dynamics, on a model and its data."""

from mimoc.policies.control.inverse_dynamics import InverseDynamics
from mimoc.policies.control.objectives import Gains, GazeTask, OrientationTask, PositionTask, Posture
from mimoc.policies.control.reaching import GAIN_SETS, ReachController, ReachGains

__all__ = [
    "GAIN_SETS",
    "OrientationTask",
    "Gains",
    "InverseDynamics",
    "GazeTask",
    "Posture",
    "PositionTask",
    "ReachController",
    "ReachGains",
]
