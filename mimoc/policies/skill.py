"""A policy that has a skill: a movement through a few postures, or a trained policy, as shipped or in a file.

A movement goes through a few postures, once or as a rhythm, and leans against falling over.
Each joint that it moves is asked for a share of its strength in proportion to how far it is from the posture of the
moment, by what the infant senses of it, which comes late. So a movement is some hundred numbers, which a search can
find in minutes (`mimoc skill`), and a person can read.
"""

from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from mimoc.base.errors import PolicyError
from mimoc.base.units import GRAVITY_M_S2, ms_to_s
from mimoc.bundle.files import write_file
from mimoc.bundle.regular_files import UnusableFileError, read_json_file
from mimoc.policies.control.actuators import pulls_of
from mimoc.policies.policy import Policy
from mimoc.policies.policy_file import load_network, read_policy
from mimoc.runtime.actuation import commanded
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import FloatArray, Observation
from mimoc.schema.base import Model
from mimoc.schema.entries import Amount, Label, Number

Share = Annotated[float, Field(ge=-1, le=1)]
SWAYS = ("forward", "sideways", "forward_speed", "sideways_speed")
"""What is felt of falling over: gravity's share along x and y of the head, and the head's speeds about y and x."""


class Postures(Model):
    """A movement of an infant through a few postures."""

    mimoc_postures: Literal[1] = 1
    """Version of this form."""
    task: Label
    """The task that it was made for."""
    age_months: Amount
    """Age of the infant that it was made for."""
    joints: Annotated[tuple[Label, ...], Field(min_length=1, max_length=500)]
    """The hinges that it moves."""
    postures: Annotated[tuple[tuple[Share, ...], ...], Field(min_length=1, max_length=50)]
    """Angle of each joint in each posture: -1 and 1 are the ends of its range."""
    posture_s: Annotated[float, Field(ge=0.05, le=60)] = 1.0
    """How long each posture is asked for."""
    moving_s: Annotated[float, Field(ge=0.01, le=60)] = 0.4
    """How long the target takes to get to it."""
    repeats: bool = False
    """Whether the first posture follows the last; otherwise, the last is kept."""
    mirrored: bool = False
    """Whether they follow once more with left and right exchanged, before they repeat."""
    sway: tuple[tuple[Number, ...], ...] = ()
    """How the angles of the joints, as shares, follow each of `SWAYS`, against falling over; none does if empty."""
    stiffness_per_rad: Amount = 1.0
    """Share of strength for each radian that a joint is off the target; with 0, a posture is the commands themselves:
    shares of strength, from -1 to 1."""
    damping_s: Amount = 0.1
    """What the speed of a joint is multiplied by, to be counted as an angle."""
    recipe: dict[Label, Label | Number] = Field(default_factory=dict)
    """How it was found, for readers: the command, seed, tries, success."""

    @model_validator(mode="after")
    def _check_shapes(self) -> Self:
        """Check that every joint is there once, and that postures and sway have a number for each."""
        count = len(self.joints)
        if len(set(self.joints)) < count:
            raise ValueError("joints: one is there twice")
        for number, posture in enumerate(self.postures):
            if len(posture) != count:
                raise ValueError(f"postures.{number}: {len(posture)} numbers, for {count} joints")
        if self.sway and [len(row) for row in self.sway] != [count] * len(SWAYS):
            raise ValueError(f"sway: give {len(SWAYS)} rows ({', '.join(SWAYS)}) of {count} numbers, or none")
        return self

    def targets(self) -> FloatArray:
        """Return all postures as they follow one another, shape (p, n), in shares of ranges."""
        postures = np.array(self.postures, float)
        return np.concatenate([postures, mirrored(self.joints, postures)]) if self.mirrored else postures


def mirrored(joints: tuple[str, ...], postures: FloatArray) -> FloatArray:
    """Return postures with left and right exchanged, shape (p, n); leaning and turning change their side."""
    place = {joint: column for column, joint in enumerate(joints)}
    other = [place.get(_other_side(joint), column) for column, joint in enumerate(joints)]
    is_across = np.array([_other_side(joint) == joint and any(part in joint for part in ACROSS) for joint in joints])
    return np.where(is_across, -1.0, 1.0) * postures[:, other]


ACROSS = ("lean", "rot", "swivel", "side")  # In the names of joints in the middle that go to one side.


def _other_side(joint: str) -> str:
    if "left_" in joint:
        return joint.replace("left_", "right_")
    return joint.replace("right_", "left_")


class PosturePolicy:
    """Follows a movement through postures, by what the infant senses of its joints and of its balance."""

    def __init__(self, env: Infant, movement: Postures):
        """Bind it to an infant.

        Raises:
            PolicyError: If the infant lacks a joint of the movement, or does not sense angles and speeds of its joints.
        """
        self._env, self._movement = env, movement
        self._step_s = ms_to_s(env.manifest.step_ms)
        self._targets = movement.targets()
        names = _sensed(env, "proprioception")
        missing = [joint for joint in movement.joints if f"{joint} angle [rad]" not in names]
        if missing or f"{movement.joints[0]} velocity [rad/s]" not in names:
            lacking = f"'{missing[0]}'" if missing and names else "the angles and velocities of joints"
            raise PolicyError(
                f"this movement needs to sense {lacking}; add senses.proprioception: {{include: [velocity]}}, or take "
                "another policy"
            )
        self._angles = np.array([names.index(f"{joint} angle [rad]") for joint in movement.joints])
        self._speeds = np.array([names.index(f"{joint} velocity [rad/s]") for joint in movement.joints])
        if movement.sway and not _sensed(env, "vestibular"):
            raise PolicyError("this movement needs the sense of balance; add senses.vestibular: {}")
        low, high = np.array([env.model.joint(env.manifest.prefix + joint).range for joint in movement.joints]).T
        self._middle, self._half = (low + high) / 2, (high - low) / 2
        self._sway = np.array(movement.sway) if movement.sway else None
        self._matrix, self._is_servo = _commands(env, movement.joints)

    def __call__(self, generator: np.random.Generator, observation: Observation) -> npt.NDArray[np.float32]:
        """Return the action, shape (n,); it does not depend on the generator."""
        movement = self._movement
        sensed = observation["proprioception"].astype(np.float64)
        target = self._target(self._env.steps * self._step_s)
        if self._sway is not None:
            target = np.clip(target + self._felt(observation["vestibular"]) @ self._sway, -1.0, 1.0)
        if self._is_servo or not movement.stiffness_per_rad:
            shares = target
        else:
            off_rad = self._middle + self._half * target - sensed[self._angles]
            shares = movement.stiffness_per_rad * (off_rad - movement.damping_s * sensed[self._speeds])
            shares = np.clip(shares, -1.0, 1.0)
        actuation = self._env.actuation
        return np.clip(self._matrix @ shares, actuation.low, actuation.high).astype(np.float32)

    def _target(self, time_s: float) -> FloatArray:
        """Return the posture that is asked for at a time, in shares of ranges, shape (n,)."""
        movement, count = self._movement, len(self._targets)
        number = int(time_s / movement.posture_s)
        is_over = not movement.repeats and number >= count
        now = count - 1 if is_over else number % count
        before = (now - 1) % count if movement.repeats else max(now - 1, 0)
        share = 1.0 if is_over else min((time_s - number * movement.posture_s) / movement.moving_s, 1.0)
        return self._targets[before] + share * (self._targets[now] - self._targets[before])

    def _felt(self, balance: Any) -> FloatArray:
        """Return what is felt of each of `SWAYS`."""
        acceleration, turning = balance[:3] / GRAVITY_M_S2, balance[3:]
        return np.array([acceleration[0], acceleration[1], turning[1], turning[0]], float)


def _sensed(env: Infant, sense: str) -> tuple[str, ...]:
    return env.layout(sense) if sense in env.senses else ()


def _commands(env: Infant, joints: tuple[str, ...]) -> tuple[FloatArray, bool]:
    """Return what turns shares of joints into commands, shape (commands, joints), and whether these are of servos.

    A motor takes the share itself. Of two muscles at a joint, that which pulls the wanted way takes it, as the other's
    command is clipped. A servo takes the target.
    """
    pulls = pulls_of(env.actuation).tolist()
    matrix = np.zeros((len(pulls), len(joints)))
    for row, (actuator, pull) in enumerate(zip(commanded(env.manifest.actuation), pulls, strict=True)):
        if (joint := env.manifest.of_infant(actuator.joint)) in joints:
            matrix[row, joints.index(joint)] = pull or 1.0
    return matrix, env.manifest.actuation.model == "position"


def read_postures(path: Path) -> Postures:
    """Return the movement in a file; raise a PolicyError if there is none."""
    try:
        movement = read_json_file(path, Postures)
    except UnusableFileError as error:
        raise PolicyError(f"{path}: {error}") from None
    if movement is None:
        raise PolicyError(f"{path}: there is no such file; give one that `mimoc skill` wrote")
    return movement


def write_postures(movement: Postures, path: Path) -> None:
    """Write a movement as JSON into an existing folder; raise an OutputError if it cannot be written."""
    write_file(path, f"{movement.model_dump_json(indent=1)}\n".encode())


SHIPPED = Path(__file__).with_name("skills")
"""What comes with mimoc, one file for a skill and an age: a movement (.json) or a trained policy (.zip)."""
KINDS = (".json", ".zip")


def shipped() -> dict[tuple[str, float], Path]:
    """Return the files that come with mimoc, by skill and age in months."""
    files = {}
    for path in sorted(SHIPPED.glob("*_months.*")):
        skill, age = path.stem.removesuffix("_months").rsplit("_", 1)
        files[skill, float(age)] = path
    return files


def bind(env: Infant, text: str) -> Policy:
    """Return the policy of a skill for an environment.

    Args:
        env: The infant.
        text: A skill, such as `roll`, of which what is there for the nearest age is taken; or the path of a file.

    Raises:
        PolicyError: If there is none, or it is none for this infant.
    """
    path = file_of(text, env.age_months)
    if path.suffix == ".json":
        return PosturePolicy(env, read_postures(path))
    maker = load_network(read_policy(path))
    if maker is None:
        raise PolicyError(f"{path}: trained by Stable-Baselines3; give the file itself as the policy, without 'skill:'")
    return maker(env)


def file_of(text: str, age_months: float) -> Path:
    """Return the file that a text names, or the shipped one of a skill for the nearest age, or raise a PolicyError."""
    if text.endswith(KINDS):
        return Path(text)
    ages = {age: path for (skill, age), path in shipped().items() if skill == text}
    if not ages:
        known = ", ".join(sorted({skill for skill, _ in shipped()})) or "none"
        raise PolicyError(
            f"nothing for the skill '{text}' comes with mimoc (there are: {known}); `mimoc skill` learns one"
        )
    return ages[min(ages, key=lambda age: (abs(age - age_months), age))]
