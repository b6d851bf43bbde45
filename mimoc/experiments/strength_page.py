"""The page about strength: what was measured, next to what the paper says."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from mimoc.experiments.effort import BEHAVIOURS, SETTLING_STEPS, STEP_MS, STEPS, Behaviour, Effort
from mimoc.experiments.notebook import Notebook, markdown_table
from mimoc.units import ms_to_s

TARGET_DEG = 60.0
FULL_SIZE_MONTHS = 18
"""The age at which a part's relative size is 1."""
LAW_MONTHS = 3
"""From which age on the time is compared; a newborn gets to no 60 degrees."""


@dataclass(frozen=True, slots=True)
class Findings:
    """What was measured; youngest first."""

    torque: Sequence[Effort]
    """At all ages, moved by torques."""
    shown: Sequence[Effort]
    """Of these, those at the paper's ages."""
    sized: Sequence[tuple[float, float, Effort]]
    """Relative size, the published infant's time in [s], and the child whose part has that size."""
    muscle: Sequence[Effort]
    """At the paper's ages, moved by muscles: of its own strength, and of that of 18 months."""


ABOUT = """\
The average child lies on its back on a flat floor, every joint at zero, and settles for {settling_s:g} s with
nothing commanded. Then one actuator does all it can, `act:head_tilt` at +1 or `act:right_hip_flex` at -1, and
everything else stays at rest, for {steps} control steps of {step_ms:g} ms. What is measured is the angle of that
joint, from the joint's own zero and positive as the part rises: `robot:head_tilt`, and `robot:right_hip1` with its
sign turned. Before it starts nothing moves by more than 4 degrees a second; what does, creeps on MuJoCo's soft
friction.

![Angle of head and leg over time, by age](strength.png)

`strength.csv` has a row for each behaviour and age, `curves.csv` every step at the paper's ages. At the end of a
joint's range (head {head_end:g}, hip {leg_end:g} degrees) a soft stop catches it; a strong infant dips into that by
up to {overshoot:.1f} degrees, now a little more, now a little less. `peak_deg` is the largest angle,
`peak_in_range_deg` the largest up to the end of the range."""

COMPARED = """\
## Next to the paper

In the paper older infants are faster and stronger. Measured here:

{laws}

{ages}

The paper's reference order is the time to {target_deg:g} degrees by relative length, that of {full_size} months
being 1. It is compared here with the child of the age at which the part that moves, head or thigh, has that
relative size: the cube root of its volume, which its strength follows, over that at {full_size} months. mimoc's
heads and legs do not grow in step with each other, as no child's do, and its body of {full_size} months is MIMo's.

{order}"""

MUSCLES = """\
## With muscles

`muscles.csv` is the same with `actuation: {{model: muscle}}`, and with the strength of {full_size} months at all
ages, as where muscles do not grow. Time to {target_deg:g} degrees, in s:

{table}

The order of ages above comes from springs and dampers in the joints, which are the same at all ages. Muscles leave
no springs and a twentieth of the damping there, as MIMo's do; so a leg takes about as long at every age, and a
small head is up first. That is MIMo's law, kept as it is: for a strength that grows with age in this sense, use
torques."""


def write(notebook: Notebook, findings: Findings) -> Path:
    """Write the page, and return it."""
    overshoot_deg = max(effort.peak_deg - effort.end_deg for effort in findings.torque)
    head_deg, leg_deg = (_of(findings.torque, each)[0].end_deg for each in BEHAVIOURS)
    about = ABOUT.format(
        settling_s=SETTLING_STEPS * ms_to_s(STEP_MS),
        steps=STEPS,
        step_ms=STEP_MS,
        head_end=head_deg,
        leg_end=leg_deg,
        overshoot=overshoot_deg,
    )
    compared = COMPARED.format(
        laws="\n".join(f"- {law}" for law in _laws(findings)),
        ages=_ages_table(findings.shown),
        target_deg=TARGET_DEG,
        full_size=FULL_SIZE_MONTHS,
        order=_order_table(findings.sized),
    )
    muscles = MUSCLES.format(table=_muscle_table(findings.muscle), full_size=FULL_SIZE_MONTHS, target_deg=TARGET_DEG)
    sections = (about, compared, muscles)
    return notebook.write_page("Strength", sections, seeds="Nothing is drawn by chance.", libraries=["matplotlib"])


def is_faster_with_age(found: Iterable[Effort], within_s: float = 0.0) -> bool:
    """Say whether the time to 60 degrees falls from each age to the next, from three months on.

    Args:
        found: Youngest first.
        within_s: What is too little to count as a rise.
    """
    times_s = [effort.time_to_s(TARGET_DEG) for effort in found if effort.age_months >= LAW_MONTHS]
    return all(a is not None and b is not None and a + within_s > b for a, b in pairwise(times_s))


def gets_as_far_with_age(found: Iterable[Effort]) -> bool:
    """Say whether the peak angle, as far as the range of the joint goes, never falls with age."""
    return all(a.peak_in_range_deg <= b.peak_in_range_deg for a, b in pairwise(found))


def _laws(findings: Findings) -> list[str]:
    """Return what holds of each behaviour and what does not, as sentences."""
    laws = []
    for behaviour in BEHAVIOURS:
        name = behaviour.name.capitalize()
        every, shown = _of(findings.torque, behaviour), _of(findings.shown, behaviour)
        faster = "falls" if is_faster_with_age(shown) else "does NOT always fall"
        steadily = "never" if is_faster_with_age(every, ms_to_s(STEP_MS)) else "at times"
        as_far = "never falls" if gets_as_far_with_age(every) else "DOES fall"
        laws += [
            f"{name}, time to {TARGET_DEG:g} degrees: from {LAW_MONTHS} months on it {faster} from each age below"
            " to the next;",
            f"{name}, the same over all ages of `strength.csv`: {steadily} rises by a control step;",
            f"{name}, peak angle up to the end of the range: {as_far} with age, from birth on.",
        ]
    return laws


def _of(found: Iterable[Effort], behaviour: Behaviour) -> list[Effort]:
    return [effort for effort in found if effort.behaviour == behaviour]


def _ages_table(shown: Sequence[Effort]) -> str:
    headings = ["months", *(f"{each.name}, {what}" for each in BEHAVIOURS for what in ("s to 60°", "peak [deg]"))]
    pairs = zip(*(_of(shown, behaviour) for behaviour in BEHAVIOURS), strict=True)
    return markdown_table(
        headings,
        (
            [f"{pair[0].age_months:g}", *(text for each in pair for text in (_time(each), _peak(each)))]
            for pair in pairs
        ),
    )


def _order_table(sized: Sequence[tuple[float, float, Effort]]) -> str:
    headings = ("behaviour", "size", "paper, s to 60°", "mimoc, s to 60°", "at months")
    rows = (
        (effort.behaviour.name, f"{size:g}", f"{paper_s:.2f}", _time(effort), f"{effort.age_months:.1f}")
        for size, paper_s, effort in sized
    )
    return markdown_table(headings, rows)


def _muscle_table(muscle: Sequence[Effort]) -> str:
    grown, constant = (
        [effort for effort in muscle if (effort.strength_age_months == effort.age_months) == own]
        for own in (True, False)
    )
    at_full_size = [effort for effort in grown if effort.age_months == FULL_SIZE_MONTHS]
    headings = ["months", *(f"{each.name}{also}" for also in ("", ", strength of 18") for each in BEHAVIOURS)]
    times = {
        (effort.age_months, kind, effort.behaviour): _time(effort)
        for kind, found in (("grown", grown), ("constant", [*constant, *at_full_size]))
        for effort in found
    }
    ages = dict.fromkeys(age for age, _, _ in times)
    return markdown_table(
        headings,
        (
            [f"{age:g}", *(times[age, kind, each] for kind in ("grown", "constant") for each in BEHAVIOURS)]
            for age in sorted(ages)
        ),
    )


def _time(effort: Effort) -> str:
    time_s = effort.time_to_s(TARGET_DEG)
    return "never" if time_s is None else f"{time_s:.2f}"


def _peak(effort: Effort) -> str:
    return f"{effort.peak_deg:.1f}"
