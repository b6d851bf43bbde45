"""Balance."""

from mimoc.base.kinds import AgeTable, SenseKind
from mimoc.delays import AGES_MONTHS
from mimoc.senses.vestibular.spec import VestibularEntry, VestibularSpec

KIND = SenseKind(
    name="vestibular",
    spec=VestibularSpec,
    entry=VestibularEntry,
    build="mimoc.senses.vestibular.build",
    run="mimoc.senses.vestibular.run",
    physiological_delay=AgeTable(AGES_MONTHS, (10, 10, 10, 10, 10, 10)),
)
