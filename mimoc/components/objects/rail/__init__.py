"""A rail to hold on to."""

from mimoc.components.objects.rail.spec import RailSpec
from mimoc.schema.kinds import ObjectKind

KIND = ObjectKind(
    "rail",
    "A bar across two posts, to hold on to.",
    RailSpec,
    "mimoc.components.objects.rail.build",
    start="mimoc.components.objects.rail.build",
    poses=("standing",),
)
