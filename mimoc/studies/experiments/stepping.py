"""Stepping from birth to three months: what becomes of steps as the body grows, with weights, in water, by practice."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from statistics import fmean

import mujoco
import numpy as np
from scipy.signal import find_peaks

from mimoc.base.quantities import AGE, Quantity
from mimoc.base.units import GRAVITY_M_S2
from mimoc.motion.body_points import locate
from mimoc.policies.named import policy_of
from mimoc.render.plots import Dots, Line, Plot
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import FloatArray, Observation
from mimoc.studies.comparison import band_of, change_text, relative_changes
from mimoc.studies.experiment import Experiment, Results, TrialResult, measures_table
from mimoc.studies.experiments.legs import MONTHS_PER_WEEK, SIDES, Mover, Setup, bundle_of, leg_kg, legs_of, open_infant
from mimoc.studies.notebook import PAGES, Notebook, table_rows

SHARE, SPREAD = 0.13, 0.5
"""Median activation of the muscles that bend a leg, fitted, so that newborns step about as often as published, and the
standard deviation of its logarithm, a guess."""
BURST_S = 0.6
"""How long the muscles of a step are active; flexion of a kick takes .3 to .4 s, and it has to be put down again."""
TRIES_PER_MIN = 24.0
"""Steps that are tried a minute, with both legs in turn; a guess, with published rates of 5 to 20 a minute in view."""
UNEVEN = 0.2  # Standard deviation of the logarithm of the time between two tries; a guess.
BENDING = {"hip_flex_negative": 1.0, "knee_negative": 0.7, "foot_flexion_positive": 0.5}
"""Muscles of a step, after the side, by the activation of the hip's: all of them bend, as in kicks (Thelen & Fisher
1983); sizes are a guess."""
STRETCHING = {"hip_flex_positive": 1.0, "knee_positive": 1.0}
"""Muscles that stretch a leg while it is not lifted, as newborns bear weight on their legs (positive support)."""
STANCE = 0.15  # Their activation; a guess.
LIFT_SHARE = 0.1  # Least rise of the foot that counts as a step, by the length of the leg.


@dataclass(frozen=True, slots=True)
class StepCase:
    """An infant that is held upright for a while, its soles on the floor."""

    age_months: float
    seconds: float
    weight_kg: float = 0.0  # At each ankle.
    water: bool = False  # Whether it stands in water up to the chest.
    strength: float = 1.0  # Factor on the strength of its legs.
    reflex: bool = False  # Whether the policy `reflexes` steps instead of the simple drive.


GAIN_WEEKS = 4


def step_cases_of(age_months: float, seconds: float) -> dict[str, StepCase]:
    """Return how an infant of an age steps: plain, with what a leg gains in four weeks at each ankle, and in water."""
    gain_kg = leg_kg(age_months + GAIN_WEEKS * MONTHS_PER_WEEK) - leg_kg(age_months)
    plain = StepCase(age_months, seconds)
    return {"plain": plain, "weights": replace(plain, weight_kg=round(gain_kg, 3)), "water": replace(plain, water=True)}


class AlternateSteps:
    """Bends legs in turn: activation is a share times sin² over a burst; the other leg is stretched a little."""

    def __init__(self, env: Infant):
        names = [env.model.actuator(int(index)).name for index in env.actuation.actuators]
        self._bends, self._stretches = (
            {side: [names.index(f"act:{side}_{name}") for name in muscles] for side in SIDES}
            for muscles in (BENDING, STRETCHING)
        )
        self._step_s = env.manifest.step_ms / 1000.0
        self._size = len(names)
        self._since_s = BURST_S
        self._next_s = 0.0
        self._turn = 0
        self._strength = 0.0

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the activations, shape (n,)."""
        self._since_s += self._step_s
        self._next_s -= self._step_s
        if self._next_s <= 0.0:
            self._turn, self._since_s = 1 - self._turn, 0.0
            self._next_s = 60.0 / TRIES_PER_MIN * generator.lognormal(0.0, UNEVEN)
            self._strength = SHARE * generator.lognormal(0.0, SPREAD)
        action = np.zeros(self._size, np.float32)
        lifted = SIDES[self._turn] if self._since_s < BURST_S else ""
        for side in SIDES:
            if side == lifted:
                level = self._strength * np.sin(np.pi * self._since_s / BURST_S) ** 2
                action[self._bends[side]] = np.minimum(level * np.array(list(BENDING.values())), 1.0)
            else:
                action[self._stretches[side]] = STANCE * np.array(list(STRETCHING.values()))
        return action


def stepping(case: StepCase, seed: int) -> TrialResult:
    """Hold an infant upright, let it step for a while, and measure its steps."""
    weight_kg = case.weight_kg
    setup = Setup(case.age_months, True, weight_kg, weight_kg, strength=case.strength, feels=case.reflex)
    with closing(open_infant(setup)) as env:
        forces = Water(env.model) if case.water else None
        mover = Mover(env, seed, partial(policy_of, policy="reflexes") if case.reflex else AlternateSteps, forces)
        qpos = mover.move(case.seconds)
        return TrialResult(values=summarise_steps(env.model, qpos, mover.rate_hz))


def summarise_steps(model: mujoco.MjModel, qpos: FloatArray, rate_hz: float) -> dict[str, float]:
    """Return steps a minute of both legs, and mean rise of the foot and range of the hip of all tries, steps or not.

    A step is a maximum of the height of an ankle with a prominence of at least a tenth of the length of the leg.
    Configurations have the shape (t, nq).
    """
    steps, lifts_cm, hips_deg = 0, [], []
    for side in SIDES:
        hip_m, ankle_m = np.moveaxis(locate(model, qpos, [f"{side}_hip", f"{side}_ankle"]), 1, 0)
        leg_m = float(np.linalg.norm(ankle_m - hip_m, axis=-1).max())
        angle_deg = -np.degrees(qpos[:, model.joint(f"robot:{side}_hip1").qposadr[0]])
        steps += len(find_peaks(ankle_m[:, 2], prominence=LIFT_SHARE * leg_m)[0])
        lifts_cm.append(100.0 * _height(ankle_m[:, 2]))
        hips_deg.append(_height(angle_deg))
    minutes = len(qpos) / rate_hz / 60.0
    return {"rate_per_min": steps / minutes, "lift_cm": fmean(lifts_cm), "hip_deg": fmean(hips_deg)}


def _height(values: FloatArray) -> float:
    """Return how far the 95th percentile is above the lowest tenth: how high a leg comes when it is lifted."""
    low, high = np.percentile(values, [10.0, 95.0])
    return float(high - low)


WATER_KG_M3 = 1000.0
LIMB_KG_M3 = 1030.0  # Density of an infant's legs: a fifth fat of 900, the rest of 1065 kg/m³ (derived).
DRAG = 1.0  # Drag coefficient of a cylinder across the stream, at Reynolds numbers of 10³ to 10⁵ (an assumption).
ADDED = 1.0
"""Mass of water that moves along with a cylinder across the stream, by that of the water it displaces (potential flow).
"""


class Water:
    """Forces of water on both legs.

    On a part of mass m and velocity v of its centre of mass act, with r the density of water by that of the leg,

        buoyancy  m g r  upwards, so that its weight in water is m g (1 - r), and
        drag      -½ d c A |v| v,  with the density d of water, and c = DRAG,

    and a = ADDED m r of water moves along with it: a is added to its mass, but has no weight. A is the broadside of the
    box that has its mass and inertia. Water up to the chest covers the legs wholly, whatever they do.
    """

    def __init__(self, model: mujoco.MjModel):
        """Fill in water, which changes the masses in *model*."""
        self._model, self._legs = model, legs_of(model)
        mass_kg = model.body_mass[self._legs].copy()
        displaced_kg = mass_kg * WATER_KG_M3 / LIMB_KG_M3
        self._drag = 0.5 * WATER_KG_M3 * DRAG * broadsides_m2(model, self._legs)
        self._lift_n = (1.0 + ADDED) * displaced_kg * GRAVITY_M_S2
        model.body_mass[self._legs] += ADDED * displaced_kg
        mujoco.mj_setConst(model, mujoco.MjData(model))

    def __call__(self, data: mujoco.MjData) -> None:
        """Set the forces that act until the next call."""
        velocity = np.zeros(6)
        for body, drag, lift_n in zip(self._legs, self._drag, self._lift_n, strict=True):
            mujoco.mj_objectVelocity(self._model, data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0)
            speed_m_s = velocity[3:]
            data.xfrc_applied[body, :3] = -drag * np.linalg.norm(speed_m_s) * speed_m_s
            data.xfrc_applied[body, 2] += lift_n


def broadsides_m2(model: mujoco.MjModel, bodies: list[int]) -> FloatArray:
    """Return the largest side of the box that has the mass and the inertia of a body, shape (n,)."""
    inertia = model.body_inertia[bodies]
    squares = 6.0 * (inertia.sum(axis=1, keepdims=True) - 2.0 * inertia) / model.body_mass[bodies, None]
    edges_m = np.sort(np.sqrt(np.maximum(squares, 0.0)), axis=1)
    return edges_m[:, 1] * edges_m[:, 2]


MONTHS: Sequence[float] = (0, 1, 2, 3)
QUICK_MONTHS: Sequence[float] = (0, 2)
PRACTICE = 1.25  # Factor on the strength of practised legs; a guess: no figure is published.
LOADS_KG: Sequence[float] = (0.0, 0.1, 0.2, 0.4, 0.8)
QUICK_LOADS_KG: Sequence[float] = (0.0, 0.4)
LOADED_MONTHS = 1.0
SECONDS, QUICK_SECONDS = 30.0, 15.0
RATE = Quantity("rate_per_min", "Steps", "1/min")
LIFT = Quantity("lift_cm", "Lift of the foot", "cm")
HIP = Quantity("hip_deg", "Range of the hip", "deg")
MEASURES = (RATE, LIFT, HIP)
PUBLISHED_RATE = (5.0, 20.0)  # Steps of newborns a minute (an assumption).
GONE_MONTHS = 2.0
LOAD = Quantity("weight_kg", "Weight at each ankle", "kg")


def cases(notebook: Notebook) -> list[StepCase]:
    """Return the cases of all ages, and those with several loads at one age."""
    months, loads_kg = (QUICK_MONTHS, QUICK_LOADS_KG) if notebook.quick else (MONTHS, LOADS_KG)
    seconds = QUICK_SECONDS if notebook.quick else SECONDS
    loaded = [StepCase(LOADED_MONTHS, seconds, weight_kg=load_kg) for load_kg in loads_kg]
    return [case for age in months for case in cases_of(age, seconds).values()] + loaded


def cases_of(age_months: float, seconds: float) -> dict[str, StepCase]:
    """Return the cases of an age: plain, weights, water, legs that are stronger by practice, and the reflex instead."""
    cases = step_cases_of(age_months, seconds)
    plain = cases["plain"]
    return {**cases, "practised": replace(plain, strength=PRACTICE), "reflex": replace(plain, reflex=True)}


def _by_age(results: Results) -> dict[float, dict[str, StepCase]]:
    months = QUICK_MONTHS if results.notebook.quick else MONTHS
    return {age: cases_of(age, next(iter(results.by_case)).seconds) for age in months}


def _plots(results: Results) -> Iterator[Plot]:
    by_age = _by_age(results)
    for measure in (RATE, LIFT):
        lines, bands = [], []
        for name in next(iter(by_age.values())):
            means = [results.mean(cases[name], measure.name) for cases in by_age.values()]
            lines.append(Line(list(by_age), [mean.mean for mean in means], name))
            bands.append(band_of(list(by_age), means, name))
        yield Plot(AGE, measure, tuple(lines), tuple(bands), title=measure.label)
    loads_kg = QUICK_LOADS_KG if results.notebook.quick else LOADS_KG
    seconds = next(iter(results.by_case)).seconds
    means = [results.mean(StepCase(LOADED_MONTHS, seconds, weight_kg=load), RATE.name) for load in loads_kg]
    rates = [mean.mean for mean in means]
    band = band_of(loads_kg, means, "", "band")
    line, dots = Line(loads_kg, rates, "", "median"), Dots(loads_kg, rates, "", "median")
    yield Plot(LOAD, RATE, (line,), (band,), (dots,), title=f"Steps by load at {LOADED_MONTHS:g} month")


def _numbers(results: Results) -> dict[str, object]:
    by_age = _by_age(results)

    def mean(case: StepCase, measure: Quantity) -> str:
        return results.mean(case, measure.name).text(1)

    def change(cases: Mapping[str, StepCase], name: str, measure: Quantity) -> str:
        plain, changed = ([it.values for it in results.by_case[cases[which]]] for which in ("plain", name))
        return change_text(relative_changes(plain, changed, measure.name))

    return {
        "months": ", ".join(f"{age:g}" for age in by_age),
        "seconds": next(iter(results.by_case)).seconds,
        "share": SHARE,
        "tries": TRIES_PER_MIN,
        "practice": PRACTICE,
        "table": table_rows(
            (
                f"{age:g}",
                f"{1000 * leg_kg(age):.0f}",
                *(mean(cases["plain"], measure) for measure in MEASURES),
                *(mean(cases["reflex"], measure) for measure in (RATE, LIFT)),
            )
            for age, cases in by_age.items()
        ),
        "changes": table_rows(
            (f"{age:g}", measure.label, *(change(cases, name, measure) for name in ("weights", "water", "practised")))
            for age, cases in by_age.items()
            for measure in (RATE, LIFT)
        ),
        "answer": _answer(results, by_age),
        "loaded": LOADED_MONTHS,
    }


def _answer(results: Results, by_age: Mapping[float, Mapping[str, StepCase]]) -> str:
    newborn, later = (results.mean(by_age[age]["plain"], RATE.name) for age in (0, GONE_MONTHS))
    low, high = PUBLISHED_RATE
    inside = "inside" if low <= newborn.mean <= high else "**outside**"
    gone = "gone" if later.mean < 0.2 * newborn.mean else "**not gone**"
    published = f"{inside} the {low:g} to {high:g} that are assumed of real ones, and to which the drive was fitted"
    return (
        f"Newborns take {newborn.text(1)} steps a minute, {published}. At {GONE_MONTHS:g} months, with the same drive, "
        f"it is {later.text(1)}: steps are {gone}."
    )


EXPERIMENT = Experiment(
    name="stepping",
    trial=stepping,
    cases=cases,
    seeds=range(20),
    quick={"seeds": range(2)},
    files={
        "steps.csv": measures_table(
            age_months="age_months", weight_kg="weight_kg", water="water", strength="strength", reflex="reflex"
        ),
        "stepping.png": _plots,
    },
    page=PAGES / "stepping.md",
    numbers=_numbers,
    libraries=("scipy",),
    infants=lambda law: (bundle_of(Setup(age_months, held=True)) for age_months in MONTHS),
)
