"""A table."""

from mimoc.components.objects.table.spec import TableSpec
from mimoc.schema.kinds import ObjectKind

KIND = ObjectKind(
    "table",
    "A table with four legs.",
    TableSpec,
    "mimoc.components.objects.table.build",
    start="mimoc.components.objects.table.build",
    poses=("standing",),
)
