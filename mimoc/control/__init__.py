"""Control of an infant by inverse dynamics, on a model and its data."""

from mimoc.control.inverse_dynamics import InverseDynamics
from mimoc.control.objectives import GazeTask, OrientationTask, PositionTask
from mimoc.control.posture import Gains, Posture
from mimoc.control.reaching import GAIN_SETS, ReachController, ReachGains

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
