"""Kicking: move a mobile that is tied to a foot (Rovee & Rovee 1969; Rovee-Collier)."""

from mimoc.schema.kinds import TaskKind
from mimoc_nursery.kick.spec import KickEntry, KickSpec

KIND = TaskKind(
    name="kick",
    spec=KickSpec,
    entry=KickEntry,
    build="mimoc_nursery.kick.build",
    run="mimoc_nursery.kick.run",
    scenes=("flat", "crib", "room"),
    poses=("supine",),
)
