"""What moves an infant's joints: the actuation models, a folder each."""

from mimoc.actuation.muscle import MUSCLE
from mimoc.actuation.position import POSITION
from mimoc.actuation.torque import TORQUE
from mimoc.kinds import ActuationKind, Kinds, by_name

ACTUATIONS: Kinds[ActuationKind] = Kinds("actuation model", by_name((TORQUE, MUSCLE, POSITION)))
