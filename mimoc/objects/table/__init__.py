"""A table."""

from mimoc.base.kinds import ObjectKind
from mimoc.objects.table.spec import TableSpec

KIND = ObjectKind(
    "table",
    "A table with four legs.",
    TableSpec,
    "mimoc.objects.table.build",
    start="mimoc.objects.table.build",
    poses=("standing",),
)
