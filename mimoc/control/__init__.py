"""Control: what an infant does on purpose."""

from mimoc.control.gains import Gains
from mimoc.control.inverse_dynamics import InverseDynamics
from mimoc.control.objectives import Align, LookAt, Reach
from mimoc.control.posture import Posture
from mimoc.control.reaching import GAIN_SETS, ReachErrors, ReachGains, Reaching, reach_errors

__all__ = [
    "GAIN_SETS",
    "Align",
    "Gains",
    "InverseDynamics",
    "LookAt",
    "Posture",
    "Reach",
    "ReachErrors",
    "ReachGains",
    "Reaching",
    "reach_errors",
]
