"""What an infant is to achieve: the tasks, a folder each."""

from mimoc.kinds import Kinds, TaskKind, by_name
from mimoc.tasks.catch import CATCH
from mimoc.tasks.free import FREE
from mimoc.tasks.reach import REACH
from mimoc.tasks.rollover import ROLLOVER
from mimoc.tasks.selfbody import SELFBODY
from mimoc.tasks.standup import STANDUP

TASKS: Kinds[TaskKind] = Kinds("task", by_name((REACH, STANDUP, SELFBODY, CATCH, ROLLOVER, FREE)))
