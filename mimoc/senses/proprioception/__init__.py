"""Joint angles, velocities, torques and limits, and the state of the actuators."""

from mimoc.base.kinds import AgeTable, NoiseOption, SenseKind
from mimoc.delays import AGES_MONTHS
from mimoc.senses.proprioception.spec import ProprioceptionEntry, ProprioceptionSpec

KIND = SenseKind(
    name="proprioception",
    spec=ProprioceptionSpec,
    entry=ProprioceptionEntry,
    build="mimoc.senses.proprioception.build",
    run="mimoc.senses.proprioception.run",
    physiological_delay=AgeTable(AGES_MONTHS, (40, 35, 25, 20, 20, 20), (40, 40, 35, 35, 30, 30)),
    noise=NoiseOption(
        unit="deg",
        about="Standard deviation of each sensed joint angle; sensed velocities have the noise that follows from it.",
        most=45.0,
        run="mimoc.senses.proprioception.noise",
    ),
)
