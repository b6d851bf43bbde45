"""A mobile that hangs over the infant, with a ribbon that can be tied to a limb."""

from mimoc.base.kinds import ObjectKind
from mimoc.objects.mobile.spec import MobileSpec

KIND = ObjectKind(
    "mobile",
    "A mobile whose figures swing about a bell, with a ribbon that can be tied to a hand or a foot.",
    MobileSpec,
    "mimoc.objects.mobile.build",
)
