"""The report on delays."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from statistics import fmean

from mimoc.experiments.learner import Learner
from mimoc.experiments.notebook import markdown_table
from mimoc.units import ms_to_s

Groups = Mapping[float, Sequence[Learner]]
"""Trained infants by sensory delay in ms."""

ABOUT = """\
The average child of {age} months is held upright and learns with PPO to touch a ball with its right hand (the task
`reach`), with sensory delays of {delays} and a motor delay of {motor:g} ms. Each infant is trained for {steps:,}
control steps of 10 ms, with each of {seeds} seeds, and then reaches for the same {episodes} balls. The infants are
those of the paper (`development: published`), whose motors follow commands at once.

![Time to reach during training, hand paths, and smoothness by delay](delays.png)

Left: time to reach during training (unsuccessful episodes count with their full length), mean and range over the
seeds. Middle: side view of the hand paths to the first {shown} balls, with the shoulder at the origin. Right:
smoothness of the movements by spectral arc length (Balasubramanian et al. 2015), the median of each infant; the table
also has log dimensionless jerk (Hogan & Sternad 2009).

`learning.csv` has the learning curves, `reaches.csv` all reaches after training, and `paths.csv` the plotted paths."""

COMPARED = """\
## Comparison with the paper

In the paper, infants with longer sensory delays learn more slowly and afterwards move less smoothly; it gives no
numbers. Our measurements over the last fifth of the training and over the reaches after training, as the mean over
seeds with minimum and maximum:

{table}

{verdict}"""

STROKE = """\
Trained infants touch the ball after {reach_ms:.0f} ms on average: the arm is strong, the reward favours speed, and the
first observation determines the position of the ball. This is less than the longest delay, so that most reaches are
ballistic, without feedback, and differ little in smoothness."""


def sections(groups: Groups, **numbers: float) -> tuple[str, str]:
    """Return the sections of the report: method and results.

    Args:
        groups: The infants by delay in ms, the shortest first.
        numbers: Numbers of the experiment, by their names in the text.
    """
    *others, longest = (f"{delay_ms:g} ms" for delay_ms in groups)
    about = ABOUT.format(delays=f"{', '.join(others)} and {longest}", **numbers)
    return about, COMPARED.format(table=_table(groups), verdict=_verdict(groups))


def _table(groups: Groups) -> str:
    headings = (
        "sensory delay",
        "time to reach, end of training [s]",
        "balls touched",
        "time to reach, after training [s]",
        "spectral arc length",
        "log dimensionless jerk",
        "path length / distance",
    )
    rows = [
        (
            f"{delay_ms:g} ms",
            _mean_and_range([each.last_time_s() for each in group]),
            _mean_and_range([each.success_rate() for each in group]),
            _mean_and_range([each.reach_time_s() for each in group]),
            _mean_and_range([each.arc_length() for each in group]),
            _mean_and_range([each.jerk() for each in group]),
            _mean_and_range([each.detour() for each in group]),
        )
        for delay_ms, group in groups.items()
    ]
    return markdown_table(headings, rows)


def _mean_and_range(values: Sequence[float]) -> str:
    return f"{fmean(values):.3f} ({min(values):.3f} to {max(values):.3f})"


def _verdict(groups: Groups) -> str:
    """Return as text whether the results have the same order as the paper's."""
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
        f"- {what}: {'yes' if _rises(values) else 'not in every case'};" for what, values in measures.items()
    )
    reach_s = fmean(each.reach_time_s() for group in groups.values() for each in group)
    stroke = STROKE.format(reach_ms=1000 * reach_s) if reach_s < ms_to_s(max(groups)) else ""
    return f"With increasing delay,\n\n{found.removesuffix(';')}.\n\n{stroke}"


def _rises(values: Sequence[float]) -> bool:
    return all(before < after for before, after in pairwise(values))
