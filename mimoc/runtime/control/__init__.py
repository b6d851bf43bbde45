"""Control: what an infant does on purpose."""

from mimoc.runtime.control.gains import Gains
from mimoc.runtime.control.inverse_dynamics import InverseDynamics
from mimoc.runtime.control.objectives import Align, LookAt, Reach
from mimoc.runtime.control.posture import Posture
from mimoc.runtime.control.reaching import GAIN_SETS, ReachErrors, ReachGains, Reaching, reach_errors

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
