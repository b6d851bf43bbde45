"""Sound localisation by age: which minimum audible angles follow from the size of the head, and which do not."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.base.geometry.spherical_head import interaural_time_s
from mimoc.base.quantities import AGE, Quantity
from mimoc.base.random_streams import stream
from mimoc.bundle.io import Bundle
from mimoc.compiler.building import build
from mimoc.render.plots import Band, Dots, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.studies.experiment import Experiment, Results, Table, child
from mimoc.studies.notebook import PAGES, table_rows

MONTHS: Sequence[float] = (2, 4, 6, 12, 18)
ANGLES_DEG = (0, 2, 4, 6, 8, 10, 13, 16, 20, 25, 30, 40, 50, 60, 75, 90)
PUBLISHED_DEG: Mapping[float, tuple[float, float]] = {2: (27, 27), 4: (20, 22), 6: (14, 18), 12: (8, 10), 18: (4, 6)}
"""Minimum audible angles, lowest and highest that are reported (Morrongiello 1988, Ashmead 1987, Litovsky 1997: from
memory)."""
PUBLISHED_US = (50.0, 75.0)
"""Smallest interaural time differences that infants of 16, 20 and 28 weeks hear (Ashmead et al. 1991)."""
FITTED_MONTHS = 4.0  # Age whose published angle gives the timing noise of the first observer.
CORRECT, QUANTILE = 0.75, 0.6745  # Share of right answers at the minimum audible angle, and its normal quantile.
TRIALS, QUICK_TRIALS = 100_000, 4000
DISTANCE_M, LEVEL_DB, BURST_S = 1.5, 65.0, 0.05
STEPS = 9  # Control steps in which a burst is heard whole.
FINER = 16  # By which the cross-correlation is interpolated: 2.6 µs.
TIME = Quantity("time_us", "Interaural time difference", "µs")
AZIMUTH = Quantity("azimuth_deg", "Azimuth", "deg")
ANGLE = Quantity("angle_deg", "Minimum audible angle", "deg")


@dataclass(frozen=True, slots=True)
class Ears:
    """What the ears of an age tell of sounds."""

    age_months: float
    radius_m: float
    angles_deg: tuple[float, ...]  # Azimuths of the sounds, to the left.
    times_us: tuple[float, ...]  # By how much later the right ear heard each of them.


@dataclass(frozen=True, slots=True)
class Case:
    """An infant that hears sounds from some azimuths."""

    age_months: float
    angles_deg: tuple[float, ...]


def hear(case: Case, seed: int) -> Ears:
    """Return by how much later the right ear of an infant hears bursts of noise from its left."""
    age_months, angles_deg = case.age_months, case.angles_deg
    burst_pa = 20e-6 * 10 ** (LEVEL_DB / 20) * DISTANCE_M * stream(seed, "localisation.burst").standard_normal(1200)
    with np.errstate(all="raise"):
        env = InfantEnv(_bundle(age_months))
        entry = env.manifest.senses.hearing
        times_us: list[float] = []
        for angle_deg in angles_deg:
            env.reset(seed=seed)
            head, angle = env.data.body(entry.head), np.radians(angle_deg)
            towards = np.array([np.cos(angle), np.sin(angle), 0.0]) * DISTANCE_M + entry.centre_m
            env.play(burst_pa, entry.sample_rate_hz, head.xpos + head.xmat.reshape(3, 3) @ towards)
            rest = np.zeros(env.action_space.shape or (), np.float32)
            ears = np.concatenate([env.step(rest)[0]["hearing"] for _ in range(STEPS)], axis=1)
            times_us.append(1e6 * lag_s(ears.astype(np.float64), entry.sample_rate_hz))
        env.close()
    return Ears(age_months, entry.radius_m, tuple(angles_deg), tuple(np.maximum.accumulate(times_us).tolist()))


def lag_s(ears: FloatArray, rate_hz: float) -> float:
    """Return how much later the right ear hears, shape (2, n), by the peak of an interpolated cross-correlation."""
    size = 2 * ears.shape[1]
    left, right = np.fft.rfft(ears, size)
    correlation = np.fft.irfft(np.conj(left) * right, FINER * size)
    most = round(1e-3 * rate_hz * FINER)
    near = np.concatenate([correlation[-most:], correlation[: most + 1]])
    return float(near.argmax() - most) / (FINER * rate_hz)


def judged_deg(ears: Ears, noise_us: float, trials: int) -> float:
    """Return the azimuth at which an observer tells the side of sounds in three trials of four.

    In a trial it hears the time difference and noise of a normal distribution, and says the side of their sum, which is
    what an ideal observer of one noisy number does.
    """
    drawn = stream(0, "localisation.trials").standard_normal(trials)
    shares = [float(np.mean(time_us + noise_us * drawn > 0)) for time_us in ears.times_us]
    return float(np.interp(CORRECT, np.maximum.accumulate(shares), ears.angles_deg))


def _bundle(age_months: float) -> Bundle:
    return build(child("listener", age_months, senses={"hearing": {"output": "waveform", "thresholds": "age"}}))


def _heard(results: Results) -> list[Ears]:
    return [ears for (ears,) in results.by_case.values()]


def _noises_us(heard: Sequence[Ears]) -> dict[str, float]:
    """Return the timing noise of two observers, by what it is fitted to."""
    fitted = next(ears for ears in heard if ears.age_months == FITTED_MONTHS)
    fitted_us = float(np.interp(float(np.mean(PUBLISHED_DEG[FITTED_MONTHS])), fitted.angles_deg, fitted.times_us))
    by_source_us = {"angles at 4 months": fitted_us, "times at 4 to 6 months": float(np.mean(PUBLISHED_US))}
    return {name: time_us / QUANTILE for name, time_us in by_source_us.items()}


def _angles_deg(results: Results) -> dict[str, list[float]]:
    """Return the minimum audible angle at each age, by what the noise of the observer is fitted to."""
    heard = _heard(results)
    trials = QUICK_TRIALS if results.notebook.quick else TRIALS
    return {name: [judged_deg(ears, noise, trials) for ears in heard] for name, noise in _noises_us(heard).items()}


def _times(heard: Sequence[Ears]) -> Iterator[tuple[float, ...]]:
    for ears in heard:
        for angle_deg, time_us in zip(ears.angles_deg, ears.times_us, strict=True):
            law_us = 1e6 * float(interaural_time_s(np.radians(angle_deg), ears.radius_m))
            yield ears.age_months, angle_deg, time_us, law_us


def _angles_table(results: Results) -> Table:
    both = zip(_heard(results), *_angles_deg(results).values(), strict=True)
    rows = ((ears.age_months, 100 * ears.radius_m, *values) for ears, *values in both)
    return "age_months,radius_cm,fitted_to_angle_deg,fitted_to_times_deg", rows


def _plots(results: Results) -> list[Plot]:
    heard = _heard(results)
    low, high = zip(*(PUBLISHED_DEG[ears.age_months] for ears in heard), strict=True)
    ages = [ears.age_months for ears in heard]
    lines = tuple(Line(ages, values, f"noise from {name}") for name, values in _angles_deg(results).items())
    angles_plot = Plot(AGE, ANGLE, lines, bands=(Band(ages, low, high, "published"),), title="Minimum audible angle")
    return [_times_plot(heard), angles_plot]


def _times_plot(heard: Sequence[Ears]) -> Plot:
    fine_deg = np.arange(91.0)
    lines, dots = [], []
    for ears in (heard[0], heard[-1]):
        label = f"{ears.age_months:g} months"
        law_us = 1e6 * interaural_time_s(np.radians(fine_deg), ears.radius_m)
        lines.append(Line(fine_deg.tolist(), law_us.tolist(), label))
        dots.append(Dots(ears.angles_deg, ears.times_us, label))
    return Plot(AZIMUTH, TIME, tuple(lines), dots=tuple(dots), title="Time between the ears")


def _numbers(results: Results) -> dict[str, object]:
    heard = _heard(results)
    angles_deg = list(_angles_deg(results).values())
    fitted_us, timed_us = _noises_us(heard).values()
    published = [PUBLISHED_DEG[ears.age_months] for ears in heard]
    needed_us = [
        float(np.interp(np.mean(ends), ears.angles_deg, ears.times_us))
        for ears, ends in zip(heard, published, strict=True)
    ]
    cells = zip(heard, *angles_deg, published, needed_us, strict=True)
    return {
        "months": ", ".join(f"{ears.age_months:g}" for ears in heard),
        "level": LEVEL_DB,
        "distance": DISTANCE_M,
        "trials": QUICK_TRIALS if results.notebook.quick else TRIALS,
        "error": max(abs(time_us - law_us) for *_, time_us, law_us in _times(heard)),
        "fitted": fitted_us,
        "timed": timed_us,
        "first": angles_deg[0][0],
        "last": angles_deg[0][-1],
        "first_published": float(np.mean(published[0])),
        "last_published": float(np.mean(published[-1])),
        "table": table_rows(
            (
                f"{ears.age_months:g}",
                f"{100 * ears.radius_m:.2f}",
                f"{by_angle:.1f}{'*' * (ears.age_months == FITTED_MONTHS)}",
                f"{by_time:.1f}",
                f"{ends[0]:g}" if ends[0] == ends[1] else f"{ends[0]:g}-{ends[1]:g}",
                f"{needs:.0f}",
            )
            for ears, by_angle, by_time, ends, needs in cells
        ),
    }


EXPERIMENT = Experiment(
    name="localisation",
    trial=hear,
    cases=[Case(age_months, ANGLES_DEG) for age_months in MONTHS],
    quick={"cases": [Case(age_months, (0, 5, 15, 30, 60, 90)) for age_months in (4, 18)]},
    kept=False,
    files={
        "times.csv": lambda results: ("age_months,azimuth_deg,time_us,woodworth_us", _times(_heard(results))),
        "angles.csv": _angles_table,
        "localisation.png": _plots,
    },
    page=PAGES / "localisation.md",
    numbers=_numbers,
    infants=lambda law: map(_bundle, MONTHS),
)
