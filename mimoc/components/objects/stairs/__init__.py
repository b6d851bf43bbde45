"""Stairs."""

from mimoc.components.objects.stairs.spec import StairsSpec
from mimoc.schema.kinds import ObjectKind

KIND = ObjectKind("stairs", "Stairs.", StairsSpec, "mimoc.components.objects.stairs.build")
