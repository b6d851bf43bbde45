"""A mobile that hangs over the infant, with a ribbon that can be tied to a limb."""

from mimoc.components.objects.mobile.spec import MobileSpec
from mimoc.schema.kinds import ObjectKind

KIND = ObjectKind(
    "mobile",
    "A mobile whose figures swing about a bell, with a ribbon that can be tied to a hand or a foot.",
    MobileSpec,
    "mimoc.components.objects.mobile.build",
)
