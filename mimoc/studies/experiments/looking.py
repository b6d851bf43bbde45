"""Preferential looking: which gratings infants prefer to grey, by frequency and contrast, through their own eyes."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import NormalDist

import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.bundle.io import Bundle
from mimoc.components.senses.vision.build_acuity import acuity_at
from mimoc.components.senses.vision.thresholds import sensitivity_at
from mimoc.render.plots.plot import Dots, Line, Plot
from mimoc.runtime.sense import FloatArray
from mimoc.studies.experiments.grating_card import CardTrial, Eyes, looking_infant
from mimoc.studies.experiments.notebook import Notebook, markdown_table

AGES_MONTHS: Sequence[float] = (1, 3, 6, 12)
QUICK_MONTHS: Sequence[float] = (1, 6)
FAR_FROM_MONTHS = 6
NEAR_M, FAR_M = 0.38, 0.84
"""Distance of the card before that age, and from it on; both are used with the Teller Acuity Cards."""
HALF_WIDTH_M = 0.21  # What is seen to each side of the middle of the card.
SIZE_PX = 512
NOISE = 0.003  # Standard deviation of the noise of the decision, on each side, as a contrast.
RIGHT = 0.75  # Share of right choices at the threshold, as is usual with two sides.
MATURING = tuple((key, "age") for key in ("contrast", "colour", "field", "focus", "flicker"))
PLAIN, MATURE_KEYS, USUAL = "acuity alone", "all that matures", "64 x 64 pixels"
ACUITY_SHARES: Sequence[float] = (0.5, 0.65, 0.8, 0.88, 0.94, 0.98, 1.02, 1.06, 1.15)
USUAL_CPD: Sequence[float] = (0.2, 0.3, 0.4, 0.44, 0.48, 0.52)
"""Frequencies for eyes of 64 x 64 pixels over 60 degrees, which hold up to .48 cycles per degree."""
CONTRAST_CPD: Sequence[float] = (0.25, 0.5, 1.0, 2.0, 4.0)
THRESHOLD_SHARES: Sequence[float] = np.geomspace(0.7, 1.6, 14).tolist()
"""Contrasts of gratings, relative to the entered threshold."""
MOST_CONTRAST, PROBE = 0.85, 0.5
"""Of a card at most, and of the one by which it is found out how much contrast pictures of it have."""
CUT_OFFS_CPD = {1.0: 2.4, 3.0: 4.0}
"""Of Banks & Salapatek 1978, Invest Ophthalmol Vis Sci 17: 361, by preferential looking."""


@dataclass(frozen=True, slots=True)
class Threshold:
    """Where an infant chooses the grating in three of four trials."""

    age_months: float
    entered: float  # What its eyes are built with.
    measured: float  # NaN if no grating was preferred.

    @property
    def ratio(self) -> float:
        """The measured over the entered one."""
        return self.measured / self.entered


def run(notebook: Notebook) -> Path:
    """Hold cards before infants of several ages, and return the path of the report."""
    ages = QUICK_MONTHS if notebook.quick else AGES_MONTHS
    count = notebook.counter(4 * len(ages))
    plain = [count(acuity(age, eyes_of(age))) for age in ages]
    mature = [count(acuity(age, eyes_of(age, MATURING))) for age in ages]
    usual = [count(acuity(age, Eyes(age, NEAR_M, 64, 60.0), USUAL_CPD)) for age in ages]
    contrasts = {age: count(list(contrast_thresholds(age))) for age in ages}
    rows = (
        (item.age_months, name, item.entered, item.measured)
        for name, items in ((PLAIN, plain), (MATURE_KEYS, mature), (USUAL, usual))
        for item in items
    )
    notebook.write_table("acuity.csv", "age_months,eyes,entered_cpd,measured_cpd", rows)
    notebook.write_table(
        "contrast.csv",
        "age_months,frequency_cpd,entered,measured",
        ((age, at, item.entered, item.measured) for age, items in contrasts.items() for at, item in items),
    )
    notebook.write_plots("looking.png", [_acuity_plot(ages, plain, mature), _contrast_plot(contrasts)])
    measured = [item for items in contrasts.values() for _, item in items]
    headings = ("months", "cycles/degree", "entered threshold [%]", "measured [%]", "measured / entered")
    rows = (
        [f"{age:g}", f"{at:.2f}", f"{100 * item.entered:.1f}", f"{100 * item.measured:.1f}", f"{item.ratio:.2f}"]
        for age, items in contrasts.items()
        for at, item in items
    )
    return notebook.write_page(
        None,
        size=SIZE_PX,
        near=100 * NEAR_M,
        far=100 * FAR_M,
        far_from=FAR_FROM_MONTHS,
        noise=100 * NOISE,
        acuities=_acuity_table(plain, mature, usual),
        contrasts=markdown_table(headings, rows),
        plain_error=max(abs(item.ratio - 1) for item in plain) * 100,
        contrast_error=max(abs(item.ratio - 1) for item in measured) * 100,
        contrast_count=len(measured),
    )


def infants(law: object) -> Iterator[Bundle]:
    """Yield the infants that look; they have no other law of development than the usual one."""
    yield from (looking_infant(eyes_of(age)) for age in AGES_MONTHS)


def eyes_of(age_months: float, keys: tuple[tuple[str, str], ...] = ()) -> Eyes:
    """Return eyes with as fine a picture of the card as its gratings need."""
    distance_m = FAR_M if age_months >= FAR_FROM_MONTHS else NEAR_M
    return Eyes(age_months, distance_m, SIZE_PX, 2 * math.degrees(math.atan(HALF_WIDTH_M / distance_m)), keys)


def right_choices(contrasts: FloatArray) -> float:
    """Return Φ(d / (s √2)), the share of right choices with the difference d of contrasts and noise s on each side."""
    plain, grating = contrasts
    return NormalDist(0, NOISE * math.sqrt(2)).cdf(float(grating - plain))


def acuity(age_months: float, eyes: Eyes, frequencies_cpd: Sequence[float] = ()) -> Threshold:
    """Return the finest grating that is preferred."""
    entered_cpd = acuity_at(age_months, "tac2")
    tried_cpd, shares = list[float](), list[float]()
    for frequency_cpd in frequencies_cpd or [share * entered_cpd for share in ACUITY_SHARES]:
        with CardTrial(eyes, frequency_cpd) as trial:
            tried_cpd.append(trial.frequency_cpd)
            shares.append(right_choices(trial.look().observed))
    return Threshold(age_months, entered_cpd, crossing(tried_cpd[::-1], shares[::-1]))


def contrast_thresholds(age_months: float) -> Iterator[tuple[float, Threshold]]:
    """Yield the frequencies at which an infant's contrast threshold can be measured, with it."""
    eyes = eyes_of(age_months, MATURING)
    entry = looking_infant(eyes).manifest.senses.vision
    assert entry is not None, "it sees"
    peak, peak_cpd = entry.sensitivity or math.nan, entry.sensitivity_peak_cpd or math.nan
    for wanted_cpd in CONTRAST_CPD:
        with CardTrial(eyes, wanted_cpd) as trial:
            frequency_cpd = trial.frequency_cpd
            entered = 1 / float(sensitivity_at(np.array(frequency_cpd), peak, peak_cpd))
            if entered * THRESHOLD_SHARES[-1] > MOST_CONTRAST:
                continue
            drawn_share = float(trial.look(PROBE).drawn[1]) / PROBE  # Textures are smoothed where they are drawn small.
            printed = [min(entered * share / drawn_share, 1.0) for share in THRESHOLD_SHARES]
            seen = [trial.look(contrast) for contrast in printed]
            shares = [right_choices(item.observed) for item in seen]
        drawn = [float(item.drawn[1]) for item in seen]
        yield frequency_cpd, Threshold(age_months, entered, crossing(drawn, shares))


def crossing(values: Sequence[float], shares: Sequence[float]) -> float:
    """Return from which value on the share of right choices is at the threshold, by logarithms of values; or NaN."""
    missed = [index for index, share in enumerate(shares) if share < RIGHT]
    if not missed or missed[-1] + 1 == len(shares):
        return math.nan if missed else float(values[0])
    before, after = missed[-1], missed[-1] + 1
    part = (RIGHT - shares[before]) / (shares[after] - shares[before])
    return float(values[before] * (values[after] / values[before]) ** part)


def _acuity_table(plain: Sequence[Threshold], mature: Sequence[Threshold], usual: Sequence[Threshold]) -> str:
    headings = (
        *("months", "entered [cycles/degree]", PLAIN, MATURE_KEYS, USUAL),
        *("Mayer et al. 1995", "Banks & Salapatek 1978"),
    )
    rows = (
        [
            f"{item.age_months:g}",
            *(f"{value:.2f}" for value in (item.entered, item.measured, full.measured, coarse.measured)),
            f"{acuity_at(item.age_months, 'mayer1995'):.2f}",
            f"{CUT_OFFS_CPD[item.age_months]:g}" if item.age_months in CUT_OFFS_CPD else "",
        ]
        for item, full, coarse in zip(plain, mature, usual, strict=True)
    )
    return markdown_table(headings, rows)


def _acuity_plot(ages: Sequence[float], plain: Sequence[Threshold], mature: Sequence[Threshold]) -> Plot:
    x = Quantity("age_months", "Age", "months")
    y = Quantity("acuity_cpd", "Finest grating preferred", "cycles/degree")
    profiles = {"tac2": "entered", "mayer1995": "Mayer et al. 1995"}
    lines = tuple(Line(ages, [acuity_at(age, name) for age in ages], label) for name, label in profiles.items())
    measured = {PLAIN: plain, MATURE_KEYS: mature}
    dots = tuple(Dots(ages, [item.measured for item in items], label) for label, items in measured.items())
    return Plot(x, y, lines, dots=dots, title="Acuity")


def _contrast_plot(contrasts: dict[float, list[tuple[float, Threshold]]]) -> Plot:
    lines, dots = [], []
    for age, items in contrasts.items():
        label, at = f"{age:g} month{'s' * (age != 1)}", [frequency for frequency, _ in items]
        lines.append(Line(np.log2(at), np.log10([1 / item.entered for _, item in items]), label))
        dots.append(Dots(np.log2(at), np.log10([1 / item.measured for _, item in items]), label))
    x = Quantity("frequency", "Spatial frequency", "log2 of cycles/degree")
    y = Quantity("sensitivity", "Contrast sensitivity", "log10")
    return Plot(x, y, tuple(lines), dots=tuple(dots), title="Contrast sensitivity")
