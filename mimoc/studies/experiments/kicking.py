"""Kicking from birth to six months: rate, size, duration, acceleration and coupling, beside published figures."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from mimoc.quantities import Quantity
from mimoc.quantities.child import AGE
from mimoc.render.plots.file import encode
from mimoc.render.plots.plot import Band, Dots, Line, Plot, Sheet
from mimoc.studies.experiments.legs.driving import Mover
from mimoc.studies.experiments.legs.infants import MONTHS_PER_WEEK, Setup, open_infant
from mimoc.studies.experiments.legs.intervals import Interval, interval, sign_test
from mimoc.studies.experiments.legs.kicks import LegMotion, kicks_of, leg_motions, summarise
from mimoc.studies.experiments.legs.trials import Result, Trial, forget_trials, run_trials
from mimoc.studies.experiments.notebook import Notebook, table_rows

MONTHS: Sequence[float] = (0, 1, 3, 6)
WEEKS: Sequence[float] = (6, 12, 18)
QUICK_MONTHS: Sequence[float] = (0, 3)
QUICK_WEEKS: Sequence[float] = ()
SHORT = {
    "rate_per_min": "Kicks",
    "size_trunk": "Size",
    "hip_deg": "Hip",
    "knee_deg": "Knee",
    "ankle_deg": "Ankle",
    "stretch_s": "Stretching",
    "bend_s": "Bending",
    "peak_m_s2": "Peak in a kick",
    "unit_s": "Movement",
    "unit_m_s2": "Peak in a movement",
    "hip_knee_r": "Hip and knee",
    "knee_ankle_r": "Knee and ankle",
    "left_right_r": "Left and right",
}
"""Labels of measures in small plots."""
SEEDS, QUICK_SEEDS = range(20), range(2)
SECONDS, QUICK_SECONDS = 40.0, 20.0
SETTLING_S = 2.0
SHOWN_SEED = 0
SHOWN_S = 20.0
"""Time in which loops of hip and knee are drawn."""
RARELY = 3
"""Every third control step is drawn."""


@dataclass(frozen=True, slots=True)
class Case:
    """Infants of an age that kick for a while."""

    age_months: float
    seconds: float


@dataclass(frozen=True, slots=True)
class Published:
    """What real infants do, by a measure of `summarise`."""

    measure: Quantity
    low: float | None
    """None for no end, as for `high`."""
    high: float | None
    until_months: float
    """The oldest age that it is about."""
    source: str
    """With R for read in the paper or its abstract, M for from memory, F for measured on recordings."""

    @property
    def range(self) -> str:
        """What the table shows."""
        if self.low is None or self.high is None:
            return "-"
        return f"{self.low:g} to {self.high:g}" + (f" until {self.until_months:g} mo" if self.until_months < 6 else "")

    def verdict(self, age_months: float, value: Interval) -> str:
        """Return whether a mean is inside, or nothing if nothing is known."""
        if (self.low is None and self.high is None) or age_months > self.until_months:
            return ""
        return " in" if value.overlaps(self.low, self.high) else " **out**"


RATE = Quantity("rate_per_min", "Kicks of a leg", "1/min")
HIP_KNEE = Quantity("hip_knee_r", "Hip and knee together", "r")
KNEE_ANKLE = Quantity("knee_ankle_r", "Knee and ankle together", "r")
KICK_PEAK = Quantity("peak_m_s2", "Peak acceleration of the ankle in a kick", "m/s²")
LEFT_RIGHT = Quantity("left_right_r", "Left and right leg together", "r")
PUBLISHED: Sequence[Published] = (
    Published(RATE, 5, 15, 6, "Thelen; Rovee-Collier (M)"),
    Published(
        Quantity("size_trunk", "Size of a kick", "trunk"), 0.31, 0.55, 6, "12 infants up to 7 months, ± 2 SD (F)"
    ),
    Published(Quantity("hip_deg", "Range of the hip in a kick", "deg"), 30, 60, 6, "Thelen; Fry-Hilderbrand 2022 (M)"),
    Published(Quantity("knee_deg", "Range of the knee in a kick", "deg"), 40, 70, 6, "as of the hip (M)"),
    Published(Quantity("ankle_deg", "Range of the ankle in a kick", "deg"), 20, 40, 6, "as of the hip (M)"),
    Published(
        Quantity("stretch_s", "Stretching", "s"), 0.3, 0.4, 6, "Thelen et al. 1981 (M); 12 infants .37 ± .05 (F)"
    ),
    Published(Quantity("bend_s", "Bending", "s"), 0.3, 0.4, 6, "Thelen et al. 1981 (M); 12 infants .32 ± .07 (F)"),
    Published(KICK_PEAK, 3.1, 11.1, 6, "12 infants up to 7 months, ± 2 SD, seen from above (F)"),
    Published(Quantity("unit_s", "Leg movement", "s"), 0.23, 0.33, 6, "Trujillo-Priego & Smith 2017, 1-12 months (R)"),
    Published(Quantity("unit_m_s2", "Its peak acceleration", "m/s²"), 3.1, 8.83, 6, "Trujillo-Priego & Smith 2017 (R)"),
    Published(HIP_KNEE, 0.8, 0.9, 1, "Thelen 1985; Fetters 2004, newborns (M)"),
    Published(KNEE_ANKLE, 0.5, 0.8, 1, "Thelen 1985; Fetters 2004, newborns (M)"),
    Published(LEFT_RIGHT, -0.35, 0.77, 6, "12 infants up to 7 months, ± 2 SD (F)"),
)

Seeds = Sequence[Mapping[str, float]]
"""Measures of each seed."""


def run(notebook: Notebook) -> Path:
    """Let infants of several ages kick, and return the path of the report.

    An interrupted run goes on with the trials that it had not finished, if its folder is the same.
    """
    quick = notebook.quick
    months, weeks = (QUICK_MONTHS, QUICK_WEEKS) if quick else (MONTHS, WEEKS)
    seeds, seconds = (QUICK_SEEDS, QUICK_SECONDS) if quick else (SEEDS, SECONDS)
    ages = sorted((*months, *(week * MONTHS_PER_WEEK for week in weeks)))
    trials = [Trial(kicking, Case(age, seconds), seed) for age in ages for seed in seeds]
    results = run_trials(notebook, trials)
    by_age: dict[float, Seeds] = {}
    loops: dict[float, Result] = {}
    for number, age in enumerate(ages):
        part = results[number * len(seeds) : (number + 1) * len(seeds)]
        by_age[age], loops[age] = [result.values for result in part], part[0]
    notebook.write_table("kicks.csv", "age_months,seed,measure,value", _rows(by_age, seeds))
    sheet = Sheet(tuple(_age_plots(by_age)), columns=4, panel_px=(480, 380))
    notebook.write_picture("kicks.png", encode(sheet))
    notebook.write_plots("loops.png", list(_loops({age: loops[age] for age in months})))
    page = notebook.write_page(
        None,
        "scipy",
        months=", ".join(f"{age:g}" for age in months),
        weeks=f" and of {', '.join(f'{week:g}' for week in weeks)} weeks" if weeks else "",
        seeds=len(seeds),
        seconds=seconds,
        shown=SHOWN_S,
        headings=" | ".join(f"{age:g} mo" for age in months),
        rules=" | ".join("---" for _ in months),
        table=_table({age: by_age[age] for age in months}),
        directions=_directions(by_age),
    )
    forget_trials(notebook)
    return page


def kicking(case: Case, seed: int) -> Result:
    """Let an infant lie on its back and move by itself for a while, and measure its kicks."""
    with closing(open_infant(Setup(case.age_months))) as env:
        mover = Mover(env, seed)
        mover.move(SETTLING_S)
        legs = leg_motions(env.model, mover.move(case.seconds), mover.rate_hz)
    return Result(values=summarise(legs), traces=_shown(legs["left"]) if seed == SHOWN_SEED else {})


def _shown(leg: LegMotion) -> dict[str, tuple[float, ...]]:
    """Return the angles of hip and knee in the part of the motion that has the most kicks."""
    length = round(SHOWN_S * leg.rate_hz)
    peaks = [kick.peak for kick in kicks_of(leg)]
    starts = [max(0, min(peak - round(leg.rate_hz), len(leg.length_trunk) - length)) for peak in peaks] or [0]
    start = max(starts, key=lambda first: sum(first <= peak < first + length for peak in peaks))
    part = slice(start, start + length, RARELY)
    return {joint: tuple(leg.angles_deg[joint][part].round(2).tolist()) for joint in ("hip", "knee")}


def _rows(by_age: Mapping[float, Seeds], seeds: Sequence[int]) -> Iterator[tuple[float, int, str, float]]:
    for age, values in by_age.items():
        for seed, measures in zip(seeds, values, strict=True):
            for name, value in measures.items():
                yield age, seed, name, value


def _of(values: Seeds, name: str) -> list[float]:
    """Return a measure of all seeds that have it."""
    return [measures[name] for measures in values if name in measures]


def _table(by_age: Mapping[float, Seeds]) -> str:
    return table_rows(
        (
            item.measure.heading,
            *(_cell(item, age, _of(by_age[age], item.measure.name)) for age in by_age),
            item.range,
            item.source,
        )
        for item in PUBLISHED
    )


def _cell(item: Published, age_months: float, values: Sequence[float]) -> str:
    if not values:
        return "none"
    mean = interval(values)
    digits = 1 if mean.mean >= 5 else 2
    return mean.text(digits) + item.verdict(age_months, mean)


def _directions(by_age: Mapping[float, Seeds]) -> str:
    """Return as sentences which measures fall with age, as published, over seeds."""
    ages = list(by_age)
    young, old = ages[0], ages[-1]
    six, eighteen = (min(ages, key=lambda age, week=week: abs(age - week * MONTHS_PER_WEEK)) for week in (6, 18))
    asked = (
        ("kicks are slightly fewer (Geerdink et al. 1996, R)", RATE, six, eighteen),
        ("hip and knee part (Chen 2020, S; Piek 1996, R)", HIP_KNEE, young, old),
        ("knee and ankle part (Chen 2020, S)", KNEE_ANKLE, young, old),
    )
    return (
        "\n".join(
            f"- {text}, from {first:.2g} to {second:.2g} months: {_change(by_age, quantity, first, second)};"
            for text, quantity, first, second in asked
        ).removesuffix(";")
        + "."
    )


def _change(by_age: Mapping[float, Seeds], quantity: Quantity, first: float, second: float) -> str:
    pairs = zip(by_age[first], by_age[second], strict=True)
    name = quantity.name
    falls = [before[name] - after[name] for before, after in pairs if name in before and name in after]
    if not falls:
        return "not measured"
    change = interval([-fall for fall in falls])
    return f"{change.text()} {quantity.unit}, p = {sign_test(falls):.2g} that it falls by chance"


def _age_plots(by_age: Mapping[float, Seeds]) -> Iterator[Plot]:
    for item in PUBLISHED:
        ages = [age for age in by_age if _of(by_age[age], item.measure.name)]
        means = [interval(_of(by_age[age], item.measure.name)) for age in ages]
        dots = [(age, value) for age in ages for value in _of(by_age[age], item.measure.name)]
        bands = [Band(ages, [mean.low for mean in means], [mean.high for mean in means], "95 % interval", "band")]
        if item.low is not None and item.high is not None:
            end = min(item.until_months, max(by_age))
            bands.append(Band([0, end], [item.low] * 2, [item.high] * 2, "published", "usual"))
        lines = (Line(ages, [mean.mean for mean in means], "mean", "median"),)
        points = (Dots([age for age, _ in dots], [value for _, value in dots], "infants", "whisker"),)
        short = replace(item.measure, label=SHORT[item.measure.name])
        yield Plot(AGE, short, lines, tuple(bands), points)


def _loops(shown: Mapping[float, Result]) -> Iterator[Plot]:
    hip, knee = Quantity("hip_deg", "Hip, bending", "deg"), Quantity("knee_deg", "Knee, bending", "deg")
    for age, result in shown.items():
        line = Line(result.traces["hip"], result.traces["knee"], "", "median")
        yield Plot(hip, knee, (line,), title=f"{age:g} month{'s' * (age != 1)}", x_range=(0, 140), y_range=(0, 155))
