"""What the page on delays says."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from statistics import fmean

from mimoc.experiments.learner import Learner
from mimoc.experiments.notebook import markdown_table
from mimoc.units import ms_to_s

Groups = Mapping[float, Sequence[Learner]]
"""Infants by the delay of their senses in ms."""

ABOUT = """\
The average child of {age} months is held upright and learns with PPO to touch a ball with its right hand (the
task `reach`), without delay, {delays} later than things are; commands take {motor:g} ms. Each learns for {steps:,}
control steps of 10 ms, anew with each of {seeds} seeds. Then each reaches for the same {episodes} balls.

![Time to reach by training, hand paths, and smoothness by delay](delays.png)

Left: the time of a reach while learning (an episode without one counts with its full length), mean and range of the
seeds. Middle: where the hand goes from the side, the shoulder at the origin, for the first {shown} balls. Right: how
smooth these movements are by spectral arc length (Balasubramanian et al. 2015), the median of each infant; the table
has log dimensionless jerk (Hogan & Sternad 2009) too.

`learning.csv` has the learning curves, `reaches.csv` every reach afterwards, `paths.csv` those that are drawn."""

COMPARED = """\
## Next to the paper

In the paper infants learn slower the later their senses are, and then move less smoothly; figures are not given.
Measured here, over the last fifth of the training and over the reaches afterwards; mean of the seeds, with the least
and the largest:

{table}

{verdict}"""

STROKE = """\
Trained infants touch the ball after {reach_ms:.0f} ms on average: the arm is strong, the reward asks for haste, and
what is felt at the start tells where the ball is. That is sooner than what is felt with the longest delay arrives, so
most reaches are one stroke that nothing corrects, and measures of smoothness have little to tell apart."""


def sections(groups: Groups, **numbers: float) -> tuple[str, str]:
    """Return what was done, and what came of it.

    Args:
        groups: The infants, by delay in ms, the shortest first.
        numbers: Of the experiment, as the text names them.
    """
    later = [f"{delay_ms:g} ms" for delay_ms in groups if delay_ms]
    about = ABOUT.format(delays="and with senses that are " + " and ".join(later), **numbers)
    return about, COMPARED.format(table=_table(groups), verdict=_verdict(groups))


def _table(groups: Groups) -> str:
    headings = (
        "sensory delay",
        "time to reach, learning [s]",
        "balls touched",
        "time to reach, after [s]",
        "spectral arc length",
        "log dimensionless jerk",
        "way / straight",
    )
    rows = [
        (
            f"{delay_ms:g} ms",
            _spread([each.last_time_s() for each in group]),
            _spread([each.success_rate() for each in group]),
            _spread([each.reach_time_s() for each in group]),
            _spread([each.arc_length() for each in group]),
            _spread([each.jerk() for each in group]),
            _spread([each.detour() for each in group]),
        )
        for delay_ms, group in groups.items()
    ]
    return markdown_table(headings, rows)


def _spread(values: Sequence[float]) -> str:
    return f"{fmean(values):.3f} ({min(values):.3f} to {max(values):.3f})"


def _verdict(groups: Groups) -> str:
    """Return whether the order is the paper's, in words."""
    measures = {
        "learning is slower": [fmean(each.last_time_s() for each in group) for group in groups.values()],
        "trained infants take longer": [fmean(each.reach_time_s() for each in group) for group in groups.values()],
        "movements are less smooth by spectral arc length": [
            -fmean(e.arc_length() for e in group) for group in groups.values()
        ],
        "movements are less smooth by log dimensionless jerk": [
            -fmean(each.jerk() for each in group) for group in groups.values()
        ],
    }
    found = "\n".join(
        f"- {what}: {'yes' if _rises(values) else 'not throughout'};" for what, values in measures.items()
    )
    reach_s = fmean(each.reach_time_s() for group in groups.values() for each in group)
    stroke = STROKE.format(reach_ms=1000 * reach_s) if reach_s < ms_to_s(max(groups)) else ""
    return f"With every longer delay\n\n{found.removesuffix(';')}.\n\n{stroke}"


def _rises(values: Sequence[float]) -> bool:
    return all(before < after for before, after in pairwise(values))
