"""A screen."""

from mimoc.base.kinds import ObjectKind
from mimoc.objects.screen.spec import ScreenSpec

KIND = ObjectKind("screen", "A screen that shows a picture.", ScreenSpec, "mimoc.objects.screen.build")
