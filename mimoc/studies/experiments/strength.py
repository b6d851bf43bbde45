"""Strength from birth to two years: of all motors, and lifting the head and a leg (López et al. 2025, figure 2 d-e)."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, get_args

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.base.units import GRAVITY_M_S2, ms_to_s
from mimoc.body.grow import grow_body
from mimoc.body.poses import Pose, resting_state
from mimoc.bundle.io import Bundle
from mimoc.compiler import building
from mimoc.compiler.building import Builder
from mimoc.compiler.measuring import compile_infant
from mimoc.render.plots import Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.experiment import Experiment, Measured, Results, Table, child
from mimoc.studies.notebook import PAGES, Cell, Notebook, table_rows, yes

Model = Literal["torque", "muscle"]

STEP_MS = 5.0  # Duration of both control and physics steps, as in the paper.
STEPS = 500
SETTLING_STEPS = 400
FLAT = Pose(pitch_deg=-90, angles_deg={}, relaxed=False)  # Lying on the back, all joints at zero.


@dataclass(frozen=True, slots=True)
class Behaviour:
    """A movement of one joint."""

    name: str
    actuator: str  # Name of the actuator in MIMo.
    joint: str
    direction: int  # 1 towards positive joint angles, -1 towards negative ones.


BEHAVIOURS = (
    Behaviour("head lift", "act:head_tilt", "robot:head_tilt", 1),
    Behaviour("leg lift", "act:right_hip_flex", "robot:right_hip1", -1),
)


@dataclass(frozen=True, slots=True)
class Effort:
    """The trajectory of a joint; angles are measured from the joint's zero, positive in the behaviour's direction."""

    behaviour: Behaviour
    age_months: float
    strength_age_months: float
    length_cm: float  # Length of the infant from crown to sole.
    angle_deg: FloatArray  # Angles at the start and after each control step, shape (n + 1,).
    end_deg: float  # Limit of the joint range, which is soft.

    @property
    def time_s(self) -> FloatArray:
        """Times of the angles, shape (n + 1,)."""
        return np.arange(len(self.angle_deg), dtype=np.float64) * ms_to_s(STEP_MS)

    @property
    def peak_deg(self) -> float:
        """The largest angle; a fast joint exceeds its soft limit slightly."""
        return float(self.angle_deg.max())

    @property
    def peak_in_range_deg(self) -> float:
        """The largest angle, clipped to the joint range."""
        return min(self.peak_deg, self.end_deg)

    def time_to_s(self, angle_deg: float) -> float | None:
        """Return the time at which an angle was first reached, interpolated between steps; None if it never was."""
        reached = np.flatnonzero(self.angle_deg >= angle_deg)
        if not reached.size:
            return None
        around = slice(max(reached[0] - 1, 0), reached[0] + 1)
        return float(np.interp(angle_deg, self.angle_deg[around], self.time_s[around]))


def efforts(
    development: Development, age_months: float, model: Model = "torque", strength_age_months: float | None = None
) -> Iterator[Effort]:
    """Yield the trajectory of each behaviour of the average child, all from the same resting state."""
    builder = lying(development, age_months, model, strength_age_months)
    with closing(InfantEnv(builder(0, check=False))) as env:
        env.reset()
        env.data.qpos[:] = resting_state(builder.tree, FLAT)
        nothing = np.zeros(len(env.manifest.actuation.actuators), np.float32)
        for _ in range(SETTLING_STEPS):
            env.step(nothing)
        rest = env.get_state()
        for behaviour in BEHAVIOURS:
            env.set_state(rest)
            yield _effort(env, behaviour, age_months if strength_age_months is None else strength_age_months)


def lying(
    development: Development, age_months: float, model: Model = "torque", strength_age_months: float | None = None
) -> Builder:
    """Return the builder of the infant; for its arguments see `efforts`."""
    actuation = {"model": model, "strength_age_months": strength_age_months}
    control = {"step_ms": STEP_MS, "timestep_ms": STEP_MS}
    return building.builder(child("lying", age_months, development=development, actuation=actuation, control=control))


def _effort(env: InfantEnv, behaviour: Behaviour, strength_age_months: float) -> Effort:
    joint = env.model.joint(behaviour.joint)
    muscle = f"{behaviour.actuator}_{'positive' if behaviour.direction > 0 else 'negative'}"
    wanted = {behaviour.actuator: behaviour.direction, muscle: 1}
    actuators = env.manifest.actuation.actuators
    action = np.array([wanted.get(actuator.name, 0) for actuator in actuators], np.float32)
    angles_rad = [float(env.data.qpos[joint.qposadr[0]])]
    for _ in range(STEPS):
        env.step(action)
        angles_rad.append(float(env.data.qpos[joint.qposadr[0]]))
    return Effort(
        behaviour=behaviour,
        age_months=env.manifest.child.age_months,
        strength_age_months=strength_age_months,
        length_cm=env.manifest.child.length_cm,
        angle_deg=behaviour.direction * np.degrees(angles_rad),
        end_deg=float(np.degrees((behaviour.direction * joint.range).max())),
    )


GROUPS = {  # The motor and the direction that stand for each group of muscles.
    "neck, back": ("act:head_tilt", -1),
    "neck, front": ("act:head_tilt", 1),
    "trunk": ("act:hip_bend", 1),
    "arm": ("act:right_shoulder_abduction", 1),
    "hand": ("act:right_wrist_flexion", 1),
    "hip": ("act:right_hip_flex", -1),
    "knee": ("act:right_knee", 1),
    "ankle": ("act:right_foot_flexion", -1),
}


@dataclass(frozen=True, slots=True)
class Strength:
    """What one motor can do in one direction."""

    development: Development
    age_months: float
    actuator: str
    direction: int  # 1 towards positive joint angles, -1 towards negative ones.
    torque_nm: float  # Largest torque.
    moment_nm: float  # Gravity moment of all that hangs on the joint, stretched out level.

    @property
    def ratio(self) -> float:
        """Torque by gravity moment: below 1, the infant cannot lift it."""
        return self.torque_nm / self.moment_nm


def strengths(development: Development, age_months: float) -> Iterator[Strength]:
    """Yield the strength of all motors of the average child, but for those of the eyes, in both directions."""
    spec = InfantSpec(mimoc=1, name="standing", age_months=age_months, development=development)
    model = compile_infant(spec)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for actuator in range(model.nu):
        name = model.actuator(actuator).name
        joint = int(model.actuator_trnid[actuator, 0])
        if "eye" in name:
            continue
        for direction, limit in zip((-1, 1), model.actuator_forcerange[actuator], strict=True):
            torque_nm = abs(model.actuator_gear[actuator, 0] * limit)
            yield Strength(development, age_months, name, direction, float(torque_nm), _moment_nm(model, data, joint))


def _moment_nm(model: mujoco.MjModel, data: mujoco.MjData, joint: int) -> float:
    """Return the weight of what hangs on a hinge, times the distance of its centre of mass from the hinge."""
    body = int(model.jnt_bodyid[joint])
    arm_m = np.linalg.norm(data.subtree_com[body] - data.xanchor[joint])
    return float(GRAVITY_M_S2 * model.body_subtreemass[body] * arm_m)


TARGET_DEG = 60.0
FULL_SIZE_MONTHS = 18  # The age at which a part's relative size is 1.
LAW_MONTHS = 3  # Age from which on the time is compared; a newborn does not reach 60 degrees.


def is_faster_with_age(efforts: Iterable[Effort], within_s: float = 0.0) -> bool:
    """Return whether the time to 60 degrees falls with age from 3 months on, but for rises below *within_s*."""
    times_s = [effort.time_to_s(TARGET_DEG) for effort in efforts if effort.age_months >= LAW_MONTHS]
    return all(a is not None and b is not None and a + within_s > b for a, b in pairwise(times_s))


def gets_as_far_with_age(efforts: Iterable[Effort]) -> bool:
    """Return whether the peak angle, clipped to the joint range, never decreases with age."""
    return all(a.peak_in_range_deg <= b.peak_in_range_deg for a, b in pairwise(efforts))


def _laws(torque: Sequence[Effort]) -> str:
    laws = []
    for behaviour in BEHAVIOURS:
        name, every = behaviour.name.capitalize(), _of(torque, behaviour)
        faster = "decreases" if is_faster_with_age(_shown(every)) else "does NOT always decrease"
        steadily = "never" if is_faster_with_age(every, ms_to_s(STEP_MS)) else "sometimes"
        as_far = "never decreases" if gets_as_far_with_age(every) else "DOES decrease"
        laws += [
            f"- {name}, time to {TARGET_DEG:g} degrees: from {LAW_MONTHS} months on, it {faster} from each age in the"
            " table to the next;",
            f"- {name}, the same over all ages in `strength.csv`: it {steadily} increases by a control step or more;",
            f"- {name}, peak angle within the joint range: it {as_far} with age, from birth on.",
        ]
    return "\n".join(laws)


def _of(efforts: Iterable[Effort], behaviour: Behaviour) -> list[Effort]:
    return [effort for effort in efforts if effort.behaviour == behaviour]


def _shown(efforts: Iterable[Effort]) -> list[Effort]:
    return [effort for effort in efforts if effort.age_months in PAPER_MONTHS]


def _muscle_rows(muscle: Sequence[Effort]) -> str:
    times = {(effort.age_months, effort.strength_age_months, effort.behaviour): _time(effort) for effort in muscle}
    rows = {
        age: [times[age, strength, behaviour] for strength in (age, FULL_SIZE_MONTHS) for behaviour in BEHAVIOURS]
        for age in sorted({age for age, _, _ in times})
    }
    return table_rows((f"{age:g}", *row) for age, row in rows.items())


def _time(effort: Effort) -> str:
    time_s = effort.time_to_s(TARGET_DEG)
    return "never" if time_s is None else f"{time_s:.2f}"


PAPER_MONTHS: Sequence[float] = (0, 3, 6, 9, 12, 18, 24)
MONTHS: Sequence[float] = range(25)
SIZES: Mapping[str, Sequence[float]] = {"head lift": (0.75, 0.85, 1.0), "leg lift": (0.62, 0.75, 0.85, 1.0)}
"""Relative sizes of which the paper's figures are known."""

HEADING = "behaviour,age_months,strength_age_months,length_cm,start_deg,peak_deg,peak_in_range_deg,time_to_60_deg_s"


@dataclass(frozen=True, slots=True)
class Case:
    """An infant that lifts its head and a leg."""

    development: Development
    age_months: float
    model: Model = "torque"
    strength_age_months: float | None = None


def cases(notebook: Notebook) -> list[Case]:
    """Return infants of all ages, then those whose parts have sizes of the paper, then those with muscles."""
    law = notebook.law
    by_age = [Case(law, age) for age in (PAPER_MONTHS if notebook.quick else MONTHS)]
    by_size = [Case(law, age) for age in _ages_of_sizes(law).values()]
    muscles = [Case(law, age, "muscle", strength) for strength in (None, FULL_SIZE_MONTHS) for age in PAPER_MONTHS]
    return [*by_age, *by_size, *muscles]


def _ages_of_sizes(law: Development) -> dict[tuple[Behaviour, float], float]:
    """Return the ages at which parts have the relative sizes of the paper, if infants have the paper's body."""
    sizes = [(item, size) for item in BEHAVIOURS for size in SIZES[item.name] if law == "published"]
    return {key: age for key in sizes if (age := age_of(*key)) is not None}


def _torque(results: Results) -> list[Effort]:
    months = PAPER_MONTHS if results.notebook.quick else MONTHS
    return [effort for age in months for effort in results.by_case[Case(results.notebook.law, age)][0]]


def _muscle(results: Results) -> list[Effort]:
    found = {case: efforts for case, (efforts,) in results.by_case.items() if case.model == "muscle"}
    return [effort for efforts in found.values() for effort in efforts]


def _sized(results: Results) -> dict[tuple[Behaviour, float], Effort]:
    ages = _ages_of_sizes(results.notebook.law)
    law = results.notebook.law
    return {key: _of(results.by_case[Case(law, age)][0], key[0])[0] for key, age in ages.items()}


def _curves(results: Results) -> Table:
    return "behaviour,age_months,time_s,angle_deg", (
        (effort.behaviour.name, effort.age_months, time_s, angle_deg)
        for effort in _shown(_torque(results))
        for time_s, angle_deg in zip(effort.time_s, effort.angle_deg, strict=True)
    )


def _numbers(results: Results) -> dict[str, object]:
    torque = _torque(results)
    shown = _shown(torque)
    ages = (f"{item.name} {size:g}: {effort.age_months:.1f}" for (item, size), effort in _sized(results).items())
    return {
        "settling_s": SETTLING_STEPS * ms_to_s(STEP_MS),
        "steps": STEPS,
        "step_ms": STEP_MS,
        "head_end": torque[0].end_deg,
        "leg_end": torque[1].end_deg,
        "overshoot": max(effort.peak_deg - effort.end_deg for effort in torque),
        "laws": _laws(torque),
        "ages": table_rows(
            (f"{head.age_months:g}", _time(head), f"{head.peak_deg:.1f}", _time(leg), f"{leg.peak_deg:.1f}")
            for head, leg in zip(*(_of(shown, behaviour) for behaviour in BEHAVIOURS), strict=True)
        ),
        "target_deg": TARGET_DEG,
        "full_size": FULL_SIZE_MONTHS,
        "size_ages": ", ".join(ages),
        "muscles": _muscle_rows(_muscle(results)),
    }


def infants(law: Development) -> Iterator[Bundle]:
    """Yield the infants that lift head and leg at the paper's ages, with torque motors and with muscles."""
    for model in get_args(Model):
        for age_months in PAPER_MONTHS:
            yield lying(law, age_months, model)(0, check=False)


def _measured(results: Results) -> Measured:
    sized, shown = _sized(results), _shown(_torque(results))
    times: dict[str, float | str | None] = {
        f"{item.name} at relative size {size:g}, time to {TARGET_DEG:g} degrees [s]": (
            sized[item, size].time_to_s(TARGET_DEG) if (item, size) in sized else "none so small"
        )
        for item in BEHAVIOURS
        for size in SIZES[item.name]
    }
    faster = {item: yes(is_faster_with_age(_of(shown, item))) for item in BEHAVIOURS}
    return times | {f"{item.name}: older infants are faster": holds for item, holds in faster.items()}


def age_of(behaviour: Behaviour, size: float) -> float | None:
    """Return the age, in months, at which the body part moved by a behaviour has a relative size; None if it is larger.

    The relative size is the cube root of the part's volume relative to that at 18 months; strength is proportional to
    the volume.
    """
    strengths_nm = [_strength_nm(behaviour, age_months) for age_months in MONTHS]
    sizes = np.cbrt(np.divide(strengths_nm, _strength_nm(behaviour, FULL_SIZE_MONTHS)))
    return round(float(np.interp(size, sizes, MONTHS)), 3) if size >= sizes[0] else None


def _strength_nm(behaviour: Behaviour, age_months: float) -> float:
    spec = InfantSpec(mimoc=1, name="lying", age_months=age_months, development="published")
    return next(motor.gear_nm for motor in grow_body(spec).tree.motors if motor.name == behaviour.actuator)


def _summary(effort: Effort) -> tuple[Cell, ...]:
    infant = (effort.age_months, effort.strength_age_months, effort.length_cm)
    angles_deg = (effort.angle_deg[0], effort.peak_deg, effort.peak_in_range_deg)
    return (effort.behaviour.name, *infant, *angles_deg, effort.time_to_s(TARGET_DEG))


def _plot(results: Iterable[Effort], behaviour: Behaviour) -> Plot:
    lines = (Line(item.time_s, item.angle_deg, f"{item.age_months:g} months") for item in _of(results, behaviour))
    time, angle = Quantity("time_s", "Time", "s"), Quantity("angle_deg", "Angle", "deg")
    return Plot(time, angle, tuple(lines), title=behaviour.name.capitalize(), level=TARGET_DEG)


EXPERIMENT = Experiment(
    name="strength",
    trial=lambda case, seed: list(efforts(case.development, case.age_months, case.model, case.strength_age_months)),
    cases=cases,
    kept=False,
    files={
        "strength.csv": lambda results: (HEADING, map(_summary, _torque(results))),
        "muscles.csv": lambda results: (HEADING, map(_summary, _muscle(results))),
        "curves.csv": _curves,
        "strength.png": lambda results: [_plot(_shown(_torque(results)), item) for item in BEHAVIOURS],
    },
    page=PAGES / "strength.md",
    numbers=_numbers,
    measured=_measured,
    infants=infants,
    development="published",
)
