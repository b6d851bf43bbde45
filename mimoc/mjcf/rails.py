"""Rails for a child to hold on to: how high and how thick they are."""

from mimoc.body import BodyTree
from mimoc.body.kinematics import stature
from mimoc.units import cm_to_m

RAIL_IN_CHILDREN = 0.43 / 0.82
"""Height of a rail's middle above the ground, for one length of the child: at 18 months, 0.82 m long, MIMo
holds it at 0.42 to 0.45 m."""
RAIL_RADIUS_M = 0.01
"""A hand closes around it: its girth is 6 cm, a newborn's hand is 6 cm long."""


def rail_height(tree: BodyTree) -> float:
    """Return how high the middle of a rail for this child is, in [m]."""
    return RAIL_IN_CHILDREN * cm_to_m(stature(tree)["length_cm"])
