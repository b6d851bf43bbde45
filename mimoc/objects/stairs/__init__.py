"""Stairs."""

from mimoc.base.kinds import ObjectKind
from mimoc.objects.stairs.spec import StairsSpec

KIND = ObjectKind("stairs", "Stairs.", StairsSpec, "mimoc.objects.stairs.build")
