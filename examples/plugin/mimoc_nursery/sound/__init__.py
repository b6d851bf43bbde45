"""Sound: how loud the toys are at both ears, and where they are."""

from mimoc.schema.kinds import AgeTable, SenseKind
from mimoc_nursery.sound.spec import SoundEntry, SoundSpec

KIND = SenseKind(
    name="sound",
    spec=SoundSpec,
    entry=SoundEntry,
    build="mimoc_nursery.sound.build",
    run="mimoc_nursery.sound.run",
    # Latency of the auditory brainstem response's wave V, which shortens over the first two years; rounded.
    physiological_delay=AgeTable(ages_months=(0.0, 6.0, 24.0), ms=(10.0, 10.0, 5.0)),
)
