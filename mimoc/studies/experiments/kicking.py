"""Kicking from birth to six months: rate, size, duration, acceleration and coupling, beside published figures."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace

from mimoc.base.quantities import AGE, QUANTITIES, Quantity
from mimoc.movement.filming import RATE_HZ, Filmed
from mimoc.movement.measured import joint_angles
from mimoc.movement.measures import kicks_of, leg_lengths, trunk_paths
from mimoc.movement.report import measure_all
from mimoc.movement.sample import real_infants
from mimoc.render.plots import Band, Dots, Line, Plot, Sheet
from mimoc.studies.comparison import ASSUMPTION, Reference, band_of, interval, sign_test
from mimoc.studies.experiment import Experiment, Results, TrialResult, measures_table
from mimoc.studies.experiments.legs import MONTHS_PER_WEEK, Mover, Setup, bundle_of, open_infant
from mimoc.studies.notebook import PAGES, months_text, table_rows

MONTHS: Sequence[float] = (0, 1, 3, 6)
WEEKS: Sequence[float] = (6, 12, 18)
SHOWN_SEED = 0
SHOWN_S = 20.0  # Time in which loops of hip and knee are drawn.
RATE, HIP_KNEE, KNEE_ANKLE, LEGS = "kicks_per_min", "kick_hip_knee_r", "kick_knee_ankle_r", "legs_together_r"


def _assumed(low: float, high: float, source: str, until_months: float = 6.0) -> Reference:
    return Reference(
        youngest_months=0, oldest_months=until_months, low=low, high=high, certainty=ASSUMPTION, source=source
    )


def _read(low: float, high: float) -> Reference:
    source = "Trujillo-Priego & Smith 2017, 1-12 months (R)"
    return Reference(youngest_months=0, oldest_months=6, low=low, high=high, certainty="read", source=source)


RANGES = "after Thelen; Fry-Hilderbrand 2022"
NEWBORNS = "after Thelen 1985; Fetters 2004, newborns"
PUBLISHED: Mapping[str, tuple[str, Reference | None]] = {
    RATE: ("Kicks", _assumed(5, 15, "after Thelen; Rovee-Collier")),
    "kick_amplitude_trunk": ("Size", None),
    "hip_excursion_deg": ("Hip", _assumed(30, 60, RANGES)),
    "knee_excursion_deg": ("Knee", _assumed(40, 70, RANGES)),
    "ankle_excursion_deg": ("Ankle", _assumed(20, 40, RANGES)),
    "kick_extension_s": ("Extending", _assumed(0.3, 0.4, "after Thelen et al. 1981")),
    "kick_flexion_s": ("Flexing", _assumed(0.3, 0.4, "after Thelen et al. 1981")),
    "kick_acceleration_trunk_s2": ("Peak in a kick", None),
    "leg_movement_s": ("Movement", _read(0.23, 0.33)),
    "leg_movement_m_s2": ("Peak in a movement", _read(3.1, 8.83)),
    HIP_KNEE: ("Hip and knee", _assumed(0.8, 0.9, NEWBORNS, 1)),
    KNEE_ANKLE: ("Knee and ankle", _assumed(0.5, 0.8, NEWBORNS, 1)),
    LEGS: ("Left and right", None),
}
"""Label in a small plot and published figures, by measure of `mimoc movement`."""


@dataclass(frozen=True, slots=True)
class Case:
    """Infants of an age that kick for a while."""

    age_months: float
    seconds: float


def kicking(case: Case, seed: int) -> TrialResult:
    """Let an infant lie on its back and move by itself for a while, and measure its kicks."""
    with closing(open_infant(Setup(case.age_months))) as env:
        film = Mover(env, seed).film(case.seconds)
    measured = measure_all([film]).infants[0]
    values = {name: measured[name] for name in PUBLISHED if name in measured}
    return TrialResult(values=values, traces=_loop(film) if seed == SHOWN_SEED else {})


def _loop(film: Filmed) -> dict[str, tuple[float, ...]]:
    """Return the angles of hip and knee in the part of a film that has most kicks."""
    leg = leg_lengths(trunk_paths(film.seen))[0]
    length = round(SHOWN_S * RATE_HZ)
    peaks = [kick.peak for kick in kicks_of(leg, RATE_HZ)]
    starts = [max(0, min(peak - round(RATE_HZ), len(leg) - length)) for peak in peaks] or [0]
    start = max(starts, key=lambda first: sum(first <= peak < first + length for peak in peaks))
    angles_deg = joint_angles(film.space or film.seen)
    part = slice(start, start + length)
    return {joint: tuple(angles_deg[f"left_{joint}"][part].round(2).tolist()) for joint in ("hip", "knee")}


def recorded(measure: str) -> tuple[float, float] | None:
    """Return the mean ± 2 SD of the 12 real infants in a measure; None if a camera from above cannot know it."""
    sample = real_infants()
    if measure not in sample.means:
        return None
    mean, deviation = sample.means[measure], sample.deviations[measure]
    return mean - 2 * deviation, mean + 2 * deviation


def usual(measure: str, *, assumed: bool = False) -> tuple[float, float] | None:
    """Return the range that was read in a publication, or perhaps *assumed*, or else that of recorded infants."""
    published = PUBLISHED[measure][1]
    if published and (assumed or published.certainty != ASSUMPTION):
        return (published.low or 0.0, published.high or 0.0)
    return recorded(measure)


def _months_of(results: Results) -> dict[float, Case]:
    """Return the cases of whole months, by age."""
    return {case.age_months: case for case in results.by_case if case.age_months in MONTHS}


def _loops(results: Results) -> Iterator[Plot]:
    hip, knee = Quantity("hip_deg", "Hip", "°"), Quantity("knee_deg", "Knee", "°")
    for age, case in _months_of(results).items():
        traces = results.by_case[case][0].traces
        line = Line(traces["hip"], traces["knee"], "", "median")
        yield Plot(hip, knee, (line,), title=months_text(age), x_range=(40, 180), y_range=(25, 180))


def _by_age(results: Results) -> Sheet:
    plots = list[Plot]()
    for measure, (label, published) in PUBLISHED.items():
        values = {case.age_months: some for case in results.by_case if (some := results.values(case, measure))}
        means = [interval(some) for some in values.values()]
        bands = [band_of(list(values), means, "95 % interval", "band")]
        if shown := usual(measure, assumed=True):
            end = min(published.oldest_months if published else 6.0, max(case.age_months for case in results.by_case))
            bands.append(Band([0, end], [shown[0]] * 2, [shown[1]] * 2, "real infants", "usual"))
        lines = (Line(list(values), [mean.mean for mean in means], "mean", "median"),)
        dots = [(age, value) for age, some in values.items() for value in some]
        points = (Dots([age for age, _ in dots], [value for _, value in dots], "infants", "whisker"),)
        plots.append(Plot(AGE, replace(QUANTITIES[measure], label=label), lines, tuple(bands), points))
    return Sheet(tuple(plots), columns=4, panel_px=(480, 380))


def _numbers(results: Results) -> dict[str, object]:
    cases, months = list(results.by_case), _months_of(results)
    weeks = () if results.notebook.quick else WEEKS
    return {
        "months": ", ".join(f"{age:g}" for age in months),
        "weeks": f" and of {', '.join(f'{week:g}' for week in weeks)} weeks" if weeks else "",
        "seconds": cases[0].seconds,
        "shown": SHOWN_S,
        "headings": " | ".join(f"{age:g} mo" for age in months),
        "rules": " | ".join("---" for _ in months),
        "table": table_rows(_row(results, measure) for measure in PUBLISHED),
        "directions": _directions(results),
    }


def _row(results: Results, measure: str) -> tuple[str, ...]:
    published, text, source = PUBLISHED[measure][1], "-", "-"
    if published:
        until = f" until {published.oldest_months:g} mo" if published.oldest_months < 6 else ""
        text = f"{published.low:g} to {published.high:g}{until}"
        source = f"{published.source} (an assumption)" if published.certainty == ASSUMPTION else published.source
    between = recorded(measure)
    cells = (_cell(results, measure, case) for case in _months_of(results).values())
    known = "{:.2g} to {:.2g}".format(*between) if between else "-"
    return QUANTITIES[measure].heading, *cells, text, source, known


def _cell(results: Results, measure: str, case: Case) -> str:
    if not results.values(case, measure):
        return "none"
    mean = results.mean(case, measure)
    published = PUBLISHED[measure][1]
    verdict = ""
    if (ends := usual(measure)) and (published is None or published.holds_at(case.age_months)):
        verdict = " in" if ends[0] <= mean.mean <= ends[1] else " **out**"
    return mean.text(1 if mean.mean >= 5 else 2) + verdict


def _directions(results: Results) -> str:
    cases = list(results.by_case)
    six, eighteen = (
        min(cases, key=lambda case, week=week: abs(case.age_months - week * MONTHS_PER_WEEK)) for week in (6, 18)
    )
    asked = (
        ("kicks are slightly fewer (Geerdink et al. 1996, R)", RATE, "falls", six, eighteen),
        ("hip and knee part (Chen 2020, S; Piek 1996, R)", HIP_KNEE, "falls", cases[0], cases[-1]),
        ("knee and ankle part (Chen 2020, S)", KNEE_ANKLE, "falls", cases[0], cases[-1]),
        ("legs alternate less (Thelen et al. 1983, R)", LEGS, "rises", cases[0], cases[-1]),
    )
    lines = [
        f"- {text}, from {first.age_months:.2g} to {second.age_months:.2g} months: "
        f"{_change(results, measure, way, first, second)}"
        for text, measure, way, first, second in asked
    ]
    return ";\n".join(lines) + "."


def _change(results: Results, name: str, way: str, first: Case, second: Case) -> str:
    pairs = zip(*([result.values for result in results.by_case[case]] for case in (first, second)), strict=True)
    changes = [after[name] - before[name] for before, after in pairs if name in before and name in after]
    if not changes:
        return "not measured"
    chance = sign_test([change if way == "rises" else -change for change in changes])
    return f"{interval(changes).text()} {QUANTITIES[name].unit or 'r'}, p = {chance:.2g} that it {way} by chance"


EXPERIMENT = Experiment(
    name="kicking",
    trial=kicking,
    cases=[Case(age, 40.0) for age in sorted((*MONTHS, *(week * MONTHS_PER_WEEK for week in WEEKS)))],
    seeds=range(20),
    quick={"seeds": range(2), "cases": [Case(age, 20.0) for age in (0, 3)]},
    files={
        "kicks.csv": measures_table(age_months="age_months"),
        "kicks.png": _by_age,
        "loops.png": _loops,
    },
    page=PAGES / "kicking.md",
    numbers=_numbers,
    libraries=("scipy",),
    infants=lambda law: (bundle_of(Setup(age_months)) for age_months in MONTHS),
)
