"""A screen."""

from mimoc.components.objects.screen.spec import ScreenSpec
from mimoc.schema.kinds import ObjectKind

KIND = ObjectKind("screen", "A screen that shows a picture.", ScreenSpec, "mimoc.components.objects.screen.build")
