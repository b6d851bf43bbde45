"""Touch, all over the skin."""

from mimoc.base.kinds import AgeTable, NoiseOption, SenseKind
from mimoc.delays import AGES_MONTHS
from mimoc.senses.touch.spec import TouchEntry, TouchSpec

KIND = SenseKind(
    name="touch",
    spec=TouchSpec,
    entry=TouchEntry,
    build="mimoc.senses.touch.build",
    run="mimoc.senses.touch.run",
    many="mimoc.senses.touch.run",
    device="mimoc.runtime.device.touch",
    physiological_delay=AgeTable(AGES_MONTHS, (40, 35, 25, 20, 20, 20), (40, 40, 35, 35, 30, 30)),
    noise=NoiseOption(
        unit="n",
        about="Standard deviation of the force at each skin point that is touched, in newtons.",
        most=100.0,
        run="mimoc.senses.touch.noise",
    ),
)
