"""The report on delays."""

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from statistics import fmean

from mimoc.studies.experiments.learner import Learner, mean_and_range
from mimoc.studies.experiments.notebook import markdown_table, page_texts
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
            mean_and_range([learner.last_time_s() for learner in group]),
            mean_and_range([learner.success_rate() for learner in group]),
            mean_and_range([learner.reach_time_s() for learner in group]),
            mean_and_range([learner.arc_length() for learner in group]),
            mean_and_range([learner.jerk() for learner in group]),
            mean_and_range([learner.detour() for learner in group]),
        )
        for delay_ms, group in groups.items()
    ]
    return markdown_table(headings, rows)


def _verdict(groups: Groups) -> str:
    """Return as text whether the results have the same order as the paper's."""
    measures: Mapping[str, Callable[[Learner], float]] = {
        "learning is slower": Learner.last_time_s,
        "trained infants take longer": Learner.reach_time_s,
        "movements are less smooth by spectral arc length": lambda learner: -learner.arc_length(),
        "movements are less smooth by log dimensionless jerk": lambda learner: -learner.jerk(),
    }
    means = {what: [fmean(map(of, group)) for group in groups.values()] for what, of in measures.items()}
    lines = "\n".join(f"- {what}: {'yes' if _rises(rise) else 'not in every case'};" for what, rise in means.items())
    reach_s = fmean(learner.reach_time_s() for group in groups.values() for learner in group)
    stroke = TEXTS["stroke"].format(reach_ms=1000 * reach_s) if reach_s < ms_to_s(max(groups)) else ""
    return f"With increasing delay,\n\n{lines.removesuffix(';')}.\n\n{stroke}"


def _rises(values: Sequence[float]) -> bool:
    return all(before < after for before, after in pairwise(values))
