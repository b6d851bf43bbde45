"""Vision, with a camera in each eye."""

from mimoc.base.kinds import AgeTable, SenseKind
from mimoc.delays import AGES_MONTHS
from mimoc.senses.vision.spec import VisionEntry, VisionSpec

KIND = SenseKind(
    name="vision",
    spec=VisionSpec,
    entry=VisionEntry,
    build="mimoc.senses.vision.build",
    run="mimoc.senses.vision.run",
    device="mimoc.runtime.device.vision.reader",
    organs=("left_eye", "right_eye"),
    physiological_delay=AgeTable(AGES_MONTHS, (245, 205, 115, 105, 105, 105)),
)
