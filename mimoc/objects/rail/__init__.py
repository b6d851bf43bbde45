"""A rail to hold on to."""

from mimoc.base.kinds import ObjectKind
from mimoc.objects.rail.spec import RailSpec

KIND = ObjectKind(
    "rail",
    "A bar across two posts, to hold on to.",
    RailSpec,
    "mimoc.objects.rail.build",
    start="mimoc.objects.rail.build",
    poses=("standing",),
)
