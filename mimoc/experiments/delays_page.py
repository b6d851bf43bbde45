"""The report on delays."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from statistics import fmean

from mimoc.experiments.learner import Learner, mean_and_range
from mimoc.experiments.notebook import markdown_table, page_texts
from mimoc.units import ms_to_s

Groups = Mapping[float, Sequence[Learner]]
"""Trained infants by sensory delay in ms."""

TEXTS = page_texts("delays")


def sections(groups: Groups, **numbers: float) -> tuple[str, str]:
    """Return the sections of the report: method and results.

    Args:
        groups: The infants by delay in ms, the shortest first.
        numbers: Numbers of the experiment, by their names in the text.
    """
    *others, longest = (f"{delay_ms:g} ms" for delay_ms in groups)
    about = TEXTS["about"].format(delays=f"{', '.join(others)} and {longest}", **numbers)
    return about, TEXTS["compared"].format(table=_table(groups), verdict=_verdict(groups))


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
            mean_and_range([each.last_time_s() for each in group]),
            mean_and_range([each.success_rate() for each in group]),
            mean_and_range([each.reach_time_s() for each in group]),
            mean_and_range([each.arc_length() for each in group]),
            mean_and_range([each.jerk() for each in group]),
            mean_and_range([each.detour() for each in group]),
        )
        for delay_ms, group in groups.items()
    ]
    return markdown_table(headings, rows)


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
    stroke = TEXTS["stroke"].format(reach_ms=1000 * reach_s) if reach_s < ms_to_s(max(groups)) else ""
    return f"With increasing delay,\n\n{found.removesuffix(';')}.\n\n{stroke}"


def _rises(values: Sequence[float]) -> bool:
    return all(before < after for before, after in pairwise(values))
