"""Kicking from birth to six months: rate, size, duration, acceleration and coupling, beside published figures."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from mimoc.base.quantities import QUANTITIES, Quantity
from mimoc.base.quantities.child import AGE
from mimoc.bundle.io import Bundle
from mimoc.movement.filming import RATE_HZ, Filmed
from mimoc.movement.joints import joint_angles
from mimoc.movement.measures import kicks_of, leg_lengths
from mimoc.movement.real_infants import real_infants
from mimoc.movement.report import measure_all
from mimoc.movement.trunk_frame import trunk_paths
from mimoc.render.plots.file import encode
from mimoc.render.plots.plot import Band, Dots, Line, Plot, Sheet
from mimoc.studies.experiments.legs.driving import Mover
from mimoc.studies.experiments.legs.infants import MONTHS_PER_WEEK, Setup, bundle_of, open_infant
from mimoc.studies.experiments.legs.intervals import Interval, band_of, interval, sign_test
from mimoc.studies.experiments.legs.trials import Result, forget_trials, run_cases, write_measures
from mimoc.studies.experiments.notebook import Notebook, table_rows

MONTHS: Sequence[float] = (0, 1, 3, 6)
WEEKS: Sequence[float] = (6, 12, 18)
QUICK_MONTHS: Sequence[float] = (0, 3)
QUICK_WEEKS: Sequence[float] = ()
SEEDS, QUICK_SEEDS = range(20), range(2)
SECONDS, QUICK_SECONDS = 40.0, 20.0
SHOWN_SEED = 0
SHOWN_S = 20.0  # Time in which loops of hip and knee are drawn.


@dataclass(frozen=True, slots=True)
class Case:
    """Infants of an age that kick for a while."""

    age_months: float
    seconds: float


@dataclass(frozen=True, slots=True)
class Published:
    """What real infants do, by a measure of `mimoc movement`."""

    measure: str
    short: str  # Its label in a small plot.
    low: float | None = None  # None if only recordings of real infants tell.
    high: float | None = None
    source: str = "-"
    """With R for read in the paper or its abstract; what is not is an assumption, by which nothing is judged."""
    until_months: float = 6  # The oldest age that it is about.

    @property
    def quantity(self) -> Quantity:
        """What is measured."""
        return QUANTITIES[self.measure]

    @property
    def range(self) -> tuple[float, float] | None:
        """What was read in a publication, or else the real infants' mean ± 2 SD."""
        if self.low is not None and self.high is not None and not self.source.endswith(ASSUMED):
            return self.low, self.high
        return recorded(self.measure)

    @property
    def shown(self) -> tuple[float, float] | None:
        """What the plot shows of real infants: the same, or what is assumed of them."""
        return self.range if self.low is None or self.high is None else (self.low, self.high)

    @property
    def text(self) -> str:
        """What the table shows as published."""
        if self.low is None or self.high is None:
            return "-"
        return f"{self.low:g} to {self.high:g}" + (f" until {self.until_months:g} mo" if self.until_months < 6 else "")

    def verdict(self, age_months: float, value: Interval) -> str:
        """Return whether a mean is inside or out."""
        if self.range is None or age_months > self.until_months:
            return ""
        return " in" if value.overlaps(*self.range) else " **out**"


def recorded(measure: str) -> tuple[float, float] | None:
    """Return the mean ± 2 SD of the 12 real infants in a measure; None if a camera from above cannot know it."""
    sample = real_infants()
    if measure not in sample.means:
        return None
    mean, deviation = sample.means[measure], sample.deviations[measure]
    return mean - 2 * deviation, mean + 2 * deviation


RATE, HIP_KNEE, KNEE_ANKLE, LEGS = "kicks_per_min", "kick_hip_knee_r", "kick_knee_ankle_r", "legs_together_r"
ASSUMED = "(an assumption)"
RANGES = f"after Thelen; Fry-Hilderbrand 2022 {ASSUMED}"
NEWBORNS = f"after Thelen 1985; Fetters 2004, newborns {ASSUMED}"
TRUJILLO = "Trujillo-Priego & Smith 2017, 1-12 months (R)"
PUBLISHED: Sequence[Published] = (
    Published(RATE, "Kicks", 5, 15, f"after Thelen; Rovee-Collier {ASSUMED}"),
    Published("kick_amplitude_trunk", "Size"),
    Published("hip_excursion_deg", "Hip", 30, 60, RANGES),
    Published("knee_excursion_deg", "Knee", 40, 70, RANGES),
    Published("ankle_excursion_deg", "Ankle", 20, 40, RANGES),
    Published("kick_extension_s", "Extending", 0.3, 0.4, f"after Thelen et al. 1981 {ASSUMED}"),
    Published("kick_flexion_s", "Flexing", 0.3, 0.4, f"after Thelen et al. 1981 {ASSUMED}"),
    Published("kick_acceleration_trunk_s2", "Peak in a kick"),
    Published("leg_movement_s", "Movement", 0.23, 0.33, TRUJILLO),
    Published("leg_movement_m_s2", "Peak in a movement", 3.1, 8.83, TRUJILLO),
    Published(HIP_KNEE, "Hip and knee", 0.8, 0.9, NEWBORNS, 1),
    Published(KNEE_ANKLE, "Knee and ankle", 0.5, 0.8, NEWBORNS, 1),
    Published(LEGS, "Left and right"),
)

Seeds = Sequence[Mapping[str, float]]  # Measures of each seed.


def run(notebook: Notebook) -> Path:
    """Let infants of several ages kick, and return the path of the report."""
    quick = notebook.quick
    months, weeks = (QUICK_MONTHS, QUICK_WEEKS) if quick else (MONTHS, WEEKS)
    seeds, seconds = (QUICK_SEEDS, QUICK_SECONDS) if quick else (SEEDS, SECONDS)
    ages = sorted((*months, *(week * MONTHS_PER_WEEK for week in weeks)))
    results = run_cases(notebook, [(kicking, Case(age, seconds)) for age in ages], seeds)
    write_measures(notebook, "kicks.csv", results, seeds, age_months="age_months")
    by_age = {case.age_months: [result.values for result in same] for case, same in results.items()}
    loops = {case.age_months: same[0] for case, same in results.items()}
    sheet = Sheet(tuple(_age_plots(by_age)), columns=4, panel_px=(480, 380))
    notebook.write_picture("kicks.png", encode(sheet))
    hip, knee = Quantity("hip_deg", "Hip", "°"), Quantity("knee_deg", "Knee", "°")
    plots = []
    for age in months:
        line = Line(loops[age].traces["hip"], loops[age].traces["knee"], "", "median")
        title = f"{age:g} month{'s' * (age != 1)}"
        plots.append(Plot(hip, knee, (line,), title=title, x_range=(40, 180), y_range=(25, 180)))
    notebook.write_plots("loops.png", plots)
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


def infants(law: None) -> Iterator[Bundle]:
    """Yield the infant at each whole month."""
    yield from (bundle_of(Setup(age_months)) for age_months in MONTHS)


def kicking(case: Case, seed: int) -> Result:
    """Let an infant lie on its back and move by itself for a while, and measure its kicks."""
    with closing(open_infant(Setup(case.age_months))) as env:
        film = Mover(env, seed).film(case.seconds)
    measured = measure_all([film]).infants[0]
    values = {item.measure: measured[item.measure] for item in PUBLISHED if item.measure in measured}
    return Result(values=values, traces=_shown(film) if seed == SHOWN_SEED else {})


def _shown(film: Filmed) -> dict[str, tuple[float, ...]]:
    leg, length = leg_lengths(trunk_paths(film.seen))[0], round(SHOWN_S * RATE_HZ)
    peaks = [kick.peak for kick in kicks_of(leg, RATE_HZ)]
    starts = [max(0, min(peak - round(RATE_HZ), len(leg) - length)) for peak in peaks] or [0]
    start = max(starts, key=lambda first: sum(first <= peak < first + length for peak in peaks))
    angles_deg = joint_angles(film.space or film.seen)
    part = slice(start, start + length)
    return {joint: tuple(angles_deg[f"left_{joint}"][part].round(2).tolist()) for joint in ("hip", "knee")}


def _of(values: Seeds, name: str) -> list[float]:
    return [measures[name] for measures in values if name in measures]


def _table(by_age: Mapping[float, Seeds]) -> str:
    return table_rows(
        (
            item.quantity.heading,
            *(_cell(item, age, _of(by_age[age], item.measure)) for age in by_age),
            item.text,
            item.source,
            "{:.2g} to {:.2g}".format(*between) if (between := recorded(item.measure)) else "-",
        )
        for item in PUBLISHED
    )


def _cell(item: Published, age_months: float, values: Sequence[float]) -> str:
    if not values:
        return "none"
    mean = interval(values)
    return mean.text(1 if mean.mean >= 5 else 2) + item.verdict(age_months, mean)


def _directions(by_age: Mapping[float, Seeds]) -> str:
    ages = list(by_age)
    young, old = ages[0], ages[-1]
    six, eighteen = (min(ages, key=lambda age, week=week: abs(age - week * MONTHS_PER_WEEK)) for week in (6, 18))
    asked = (
        ("kicks are slightly fewer (Geerdink et al. 1996, R)", RATE, "falls", six, eighteen),
        ("hip and knee part (Chen 2020, S; Piek 1996, R)", HIP_KNEE, "falls", young, old),
        ("knee and ankle part (Chen 2020, S)", KNEE_ANKLE, "falls", young, old),
        ("legs alternate less (Thelen et al. 1983, R)", LEGS, "rises", young, old),
    )
    lines = [
        f"- {text}, from {first:.2g} to {second:.2g} months: {_change(by_age, measure, way, first, second)}"
        for text, measure, way, first, second in asked
    ]
    return ";\n".join(lines) + "."


def _change(by_age: Mapping[float, Seeds], name: str, way: str, first: float, second: float) -> str:
    pairs = zip(by_age[first], by_age[second], strict=True)
    changes = [after[name] - before[name] for before, after in pairs if name in before and name in after]
    if not changes:
        return "not measured"
    chance = sign_test([change if way == "rises" else -change for change in changes])
    return f"{interval(changes).text()} {QUANTITIES[name].unit or 'r'}, p = {chance:.2g} that it {way} by chance"


def _age_plots(by_age: Mapping[float, Seeds]) -> Iterator[Plot]:
    for item in PUBLISHED:
        ages = [age for age in by_age if _of(by_age[age], item.measure)]
        means = [interval(_of(by_age[age], item.measure)) for age in ages]
        dots = [(age, value) for age in ages for value in _of(by_age[age], item.measure)]
        bands = [band_of(ages, means, "95 % interval", "band")]
        if item.shown:
            end, (low, high) = min(item.until_months, max(by_age)), item.shown
            bands.append(Band([0, end], [low] * 2, [high] * 2, "real infants", "usual"))
        lines = (Line(ages, [mean.mean for mean in means], "mean", "median"),)
        points = (Dots([age for age, _ in dots], [value for _, value in dots], "infants", "whisker"),)
        yield Plot(AGE, replace(item.quantity, label=item.short), lines, tuple(bands), points)
