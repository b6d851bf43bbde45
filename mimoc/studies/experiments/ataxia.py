"""Reaches by a controller whose proprioception is late: what makes them ataxic, one cause at a time."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass

import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.base.units import ms_to_s
from mimoc.compiler import pipeline
from mimoc.policies.control import GAIN_SETS
from mimoc.render.plots.plot import Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.experiments.child import child
from mimoc.studies.experiments.notebook import Notebook, page_text, table_rows
from mimoc.studies.experiments.sensed_reaching import REACH_SHARE, Reach, reach_once

DELAYS_MS: Sequence[float] = (0, 50, 200)  # Delays of the senses, the paper's.
MOTOR_MS = 5.0  # Delay of commands, the paper's.
AGE_MONTHS, STEP_MS = 18.0, 10.0
OTHER_LAW: Mapping[Development, Development] = {"published": "maturing", "maturing": "published"}
SEED = 1  # Seed of the targets, which are in the same directions in all variants.


@dataclass(frozen=True, slots=True)
class Variant:
    """An infant that reaches, and how; everything but the delay."""

    name: str
    gains: str = "high"  # Key of the controller's gains.
    share: float = REACH_SHARE  # Distance of the targets, by the length of the arm.
    strength: float = 1.0  # Factor on the strength of the arms.
    step_ms: float = STEP_MS  # Time between commands.
    age_months: float = AGE_MONTHS
    other_law: bool = False  # Whether it has the other law of development.


VARIANTS: Sequence[Variant] = (
    Variant("high gains"),
    Variant("medium gains", gains="medium"),
    Variant("low gains", gains="low"),
    Variant("high gains, targets at 0.5 of the arm", share=0.5),
    Variant("high gains, targets at 0.95 of the arm", share=0.95),
    Variant("high gains, arms of a fifth of the strength", strength=0.2),
    Variant("high gains, commands every 5 ms", step_ms=5.0),
    Variant("high gains, commands every 50 ms", step_ms=50.0),
    Variant("high gains, 3 months old", age_months=3.0),
    Variant("high gains, 9 months old", age_months=9.0),
    Variant("high gains, the other law", other_law=True),
)
PLOTTED = ("high gains", "low gains")  # Variants whose first reach is plotted.
MEASURES: Mapping[str, Callable[[Reach], float]] = {  # Measures of a reach, by the heading of their column.
    "duration_s": lambda reach: reach.duration_s,
    "movement_units": lambda reach: reach.units,
    "path_ratio": lambda reach: reach.path_ratio,
    "peak_speed_m_s": lambda reach: float(reach.speed_m_s.max()),
}
Reaches = Mapping[tuple[Variant, float], Sequence[Reach]]  # By variant and delay.


def infant(variant: Variant, development: Development, delay_ms: float) -> InfantSpec:
    """Return an infant that sits with its hip held and moves its right arm, without noise."""
    return child(
        "reaching",
        variant.age_months,
        development=OTHER_LAW[development] if variant.other_law else development,
        actuation={"regions": ["right_arm"], "locked": ["trunk", "neck"], "strength": {"arms": variant.strength}},
        control={"step_ms": variant.step_ms, "timestep_ms": 5.0},
        senses={"proprioception": {"include": ["velocity"]}},
        delays={"sensory_ms": float(delay_ms), "motor_ms": MOTOR_MS},
        scene={"kind": "flat", "pose": "sitting", "held": ["hip"]},
    )


def reach_with_variants(
    variants: Sequence[Variant],
    development: Development,
    count: int,
    most_s: float,
    counted: Callable[[object], object],
) -> Reaches:
    """Let the infant of each variant reach with each delay, for the same targets; *counted* is called for each infant.

    A reach is given up after *most_s* of simulated time.
    """
    reaches: dict[tuple[Variant, float], Sequence[Reach]] = {}
    for variant in variants:
        for delay_ms in DELAYS_MS:
            generator = np.random.default_rng(SEED)
            with closing(InfantEnv(pipeline.build(infant(variant, development, delay_ms)))) as env:
                how = {"gains": variant.gains, "share": variant.share}
                same = [reach_once(env, seed, generator, most_s, **how) for seed in range(count)]
            reaches[variant, delay_ms] = same
            counted(same)
    return reaches


def write_ataxia(notebook: Notebook, reaches: Reaches) -> None:
    """Write `ataxia.csv` and `ataxia.png`."""
    notebook.write_table(
        "ataxia.csv",
        ",".join(("variant", "delay_ms", "reach", "arrived", *MEASURES)),
        (
            (variant.name, delay_ms, index, float(reach.arrived), *(measure(reach) for measure in MEASURES.values()))
            for (variant, delay_ms), same in reaches.items()
            for index, reach in enumerate(same)
        ),
    )
    names = [name for name in PLOTTED if any(variant.name == name for variant, _ in reaches)]
    notebook.write_plots("ataxia.png", [_plot(reaches, name) for name in names])


def _plot(reaches: Reaches, name: str) -> Plot:
    lines = []
    for (variant, delay_ms), same in reaches.items():
        if variant.name == name:
            away_cm = 100 * same[0].away_m
            lines.append(Line(same[0].step_s * np.arange(len(away_cm)), away_cm, f"{delay_ms:g} ms"))
    x, y = Quantity("time_s", "Time since onset", "s"), Quantity("away_cm", "Hand from target", "cm")
    return Plot(x, y, tuple(lines), title=f"One reach, {name}")


def ataxia_text(reaches: Reaches, most_s: float) -> str:
    """Return the part of the report on these reaches."""
    base = {delay_ms: same for (variant, delay_ms), same in reaches.items() if variant == VARIANTS[0]}
    shortest, *_, longest = (_medians(same) for same in base.values())
    return page_text(
        "ataxia",
        count=len(base[DELAYS_MS[0]]),
        age=AGE_MONTHS,
        most_s=most_s,
        share=REACH_SHARE,
        longest_ms=DELAYS_MS[-1],
        table=table_rows(_rows(reaches)),
        least_units=shortest["movement_units"],
        units=longest["movement_units"],
        ratio=longest["path_ratio"],
        motor_ms=MOTOR_MS,
        products=_products(DELAYS_MS[-1]),
        middle_ms=DELAYS_MS[1],
        middle_products=_products(DELAYS_MS[1]),
    )


def _products(delay_ms: float) -> str:
    late_s = ms_to_s(delay_ms + MOTOR_MS)
    hands = [(name, gains.hands) for name, gains in GAIN_SETS.items()]
    return ", ".join(f"{gain.strength / gain.viscosity_per_s * late_s:.2g} ({name})" for name, gain in hands[::-1])


def _rows(reaches: Reaches) -> Iterator[tuple[str, ...]]:
    for variant in dict.fromkeys(variant for variant, _ in reaches):
        yield variant.name, *(_cell(reaches[variant, delay_ms]) for delay_ms in DELAYS_MS)


def _cell(same: Sequence[Reach]) -> str:
    medians, arrived = _medians(same), np.mean([reach.arrived for reach in same])
    return (
        f"{arrived:.0%}, {medians['duration_s']:.2f} s, {medians['movement_units']:g} units, "
        f"{medians['path_ratio']:.2g} x"
    )


def _medians(same: Sequence[Reach]) -> dict[str, float]:
    return {name: float(np.median([measure(reach) for reach in same])) for name, measure in MEASURES.items()}
