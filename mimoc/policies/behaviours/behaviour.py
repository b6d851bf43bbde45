"""Behaviours: target angles of some joints in each control step, and whether the infant does what they are for."""

import math
import re
from collections import deque
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError, check_name
from mimoc.base.units import ms_to_s
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.policies.control.dynamics import find_frame
from mimoc.policies.control.holding import ESTIMATED_RAD_S, FREQUENCY_RAD_S
from mimoc.policies.control.infant import DrivenInfant
from mimoc.runtime.sense import FloatArray, IntArray, Observation

SEPARATOR = re.compile(r",(?![^(]*\))")  # A comma that is not in parentheses.
NUMBER = r"\s*[-+]?\d*\.?\d+\s*"
BARE_PLACE = re.compile(rf"^({NUMBER},{NUMBER},{NUMBER})(?=,|$)")  # Three numbers at the beginning.


@dataclass(frozen=True, slots=True)
class Option:
    """A number that can be given by its name."""

    default: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Arguments:
    """The arguments of a behaviour."""

    words: tuple[str, ...]  # What has no name, such as a target and a side; a place is one word, `(0.3, 0, 0.2)`.
    numbers: Mapping[str, float]  # All options by their names, with their defaults where none is given.
    flags: frozenset[str] = frozenset()  # Words of its own that are given, such as `still`.


def read_arguments(
    behaviour: str, text: str, options: Mapping[str, Option], most_words: int = 0, flags: Collection[str] = ()
) -> Arguments:
    """Return the arguments in a text, or raise a PolicyError or, for an option, an UnknownNameError.

    *flags* are words of the behaviour's own, which are no target or side.
    """
    words, given = list[str](), list[str]()
    numbers = {name: option.default for name, option in options.items()}
    pieces = SEPARATOR.split(BARE_PLACE.sub(r"(\1)", text))
    for piece in (piece.strip() for piece in pieces if piece.strip()):
        name, sign, value = map(str.strip, piece.partition("="))
        if not sign:
            (given if piece in flags else words).append(piece)
            continue
        check_name(f"setting of '{behaviour}'", name, options)
        numbers[name] = _number(behaviour, name, value, options[name])
    if len(words) > most_words:
        takes = ", ".join((*flags, *(f"{name}={option.default:g}" for name, option in options.items()))) or "no more"
        raise PolicyError(f"'{behaviour}' does not take '{words[most_words]}'; it takes {takes}")
    return Arguments(tuple(words), numbers, frozenset(given))


def place_of(word: str) -> tuple[float, float, float] | None:
    """Return the place that a word is, [m]; None if it is none."""
    if not (word.startswith("(") and word.endswith(")")):
        return None
    try:
        x, y, z = map(float, word[1:-1].split(","))
    except ValueError:
        x = y = z = math.nan
    if not math.isfinite(x + y + z):
        raise PolicyError(f"'{word}' is no place; give x, y and z in metres, such as (0.3, 0, 0.2)")
    return x, y, z


def _number(behaviour: str, name: str, value: str, option: Option) -> float:
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not option.low <= number <= option.high:
        bounds = f"a number from {option.low:g} to {option.high:g}"
        raise PolicyError(f"'{behaviour}': {name}={value} is not possible; give {bounds}")
    return number


TRUTH, LAG = "truth", "lag_weeks"
MAX_LAG_WEEKS = 26.0  # A choice.


@dataclass(frozen=True, slots=True)
class Knowledge:
    """How an infant knows its body: what every behaviour can be told besides its own arguments."""

    reads_truth: bool = False  # Whether it reads the state of the simulation, as no infant can.
    lag_weeks: float = 0.0  # How old its idea of its own weight is.

    def __or__(self, other: "Knowledge") -> "Knowledge":
        """Return the knowledge of an infant with two behaviours."""
        return Knowledge(self.reads_truth or other.reads_truth, max(self.lag_weeks, other.lag_weeks))


def split_knowledge(behaviour: str, text: str) -> tuple[Knowledge, str]:
    """Return what a text says of how the infant knows its body, `truth` or `lag_weeks=4`, and the other arguments."""
    knowledge = Knowledge()
    others = list[str]()
    for piece in text.split(","):
        name, sign, value = map(str.strip, piece.partition("="))
        if name == TRUTH and not sign:
            knowledge |= Knowledge(reads_truth=True)
        elif name == LAG and sign:
            knowledge |= Knowledge(lag_weeks=_number(behaviour, name, value, Option(0.0, 0.0, MAX_LAG_WEEKS)))
        else:
            others.append(piece)
    return knowledge, ",".join(others)


T = TypeVar("T")
SIGHT = "vision"
MIN_S = 0.02  # No single decision is quicker.


@dataclass
class Chance:
    """The generator of the policy whose reactions are drawn, as soon as it has acted."""

    generator: np.random.Generator | None = None

    @property
    def drawn_from(self) -> np.random.Generator:
        """The generator, which a policy gets before anything is drawn."""
        assert self.generator is not None, "a policy sets it in each call, before its behaviours see anything"
        return self.generator


@dataclass
class Reaction(Generic[T]):
    """Stimuli that are still to be reacted to, the earliest first.

    With a conduction time c, mean decision m and variation v, a stimulus at time t is reacted to at t + c + d, where d
    is drawn from a log-normal distribution of mean m and standard deviation v m; never before an earlier one is.

    Example:
        >>> import numpy as np
        >>> from mimoc.policies.behaviours.behaviour import Reaction
        >>> reaction = Reaction[str](conduction_s=0.1, mean_s=0.3, variation=0.0)
        >>> reaction.see("a ball", 1.0, np.random.default_rng(0))
        >>> reaction.at(1.39), reaction.at(1.4 + 1e-9)
        (None, 'a ball')
    """

    conduction_s: float  # From a stimulus until it could be decided on.
    mean_s: float  # Mean of a decision.
    variation: float  # Its standard deviation, as a share of the mean.
    _due: deque[tuple[float, T]] = field(default_factory=deque)
    _reacted: T | None = None

    def begin(self) -> None:
        """Forget all stimuli."""
        self._due.clear()
        self._reacted = None

    def see(self, stimulus: T, time_s: float, generator: np.random.Generator) -> None:
        """Take a new stimulus; when it is reacted to is drawn now."""
        due_s = time_s + self.conduction_s + self.draw_s(generator)
        self._due.append((max([due_s, *(earlier_s for earlier_s, _ in self._due)]), stimulus))

    def at(self, time_s: float) -> T | None:
        """Return the stimulus that was reacted to last by now; None before the first."""
        while self._due and self._due[0][0] <= time_s:
            self._reacted = self._due.popleft()[1]
        return self._reacted

    def draw_s(self, generator: np.random.Generator) -> float:
        """Return how long a decision takes."""
        spread = math.sqrt(math.log1p(self.variation**2))
        return max(MIN_S, self.mean_s * math.exp(spread * generator.standard_normal() - spread**2 / 2))


def reaction_of(manifest: Manifest, response: str) -> Reaction[int] | None:
    """Return the reaction of an infant by `look` or `reach`, or None if it decides at once (`delays.processing`)."""
    delays = dict(manifest.delays)
    processing = manifest.delays.processing
    if processing is None:
        return None
    mean_ms, variation = (getattr(processing, f"{response}_{what}") for what in ("ms", "variation"))
    return Reaction(ms_to_s(delays[SIGHT].ms), ms_to_s(mean_ms), variation)


@dataclass(frozen=True)
class Subject:
    """The infant that behaviours are bound to, in its scene."""

    infant: DrivenInfant  # Its model, and the n hinges that its actuators drive.
    manifest: Manifest
    chance: Chance = field(default_factory=Chance)  # What the times of its reactions are drawn from.
    reads_truth: bool = False  # Whether it knows the state of the simulation, as it was asked to.
    estimates: bool = False  # Whether it has the senses to estimate the state of its body, and acts from that.

    @property
    def step_s(self) -> float:
        """Duration of a control step."""
        return ms_to_s(self.manifest.step_ms)

    def moved_by(self, groups: tuple[str, ...]) -> IntArray:
        """Return which driven hinges belong to some groups of muscles, shape (m,), as indices among all n."""
        model = self.infant.model
        in_groups = self.manifest.anatomy.groups
        wanted = {model.joint(name).id for group in groups for name in in_groups.get(group, ())}
        return np.flatnonzero(np.isin(self.infant.joints, list(wanted))).astype(np.intp)

    def bodies_below(self, *roots: str) -> frozenset[int]:
        """Return some body parts and all that hang on them."""
        model, prefix = self.infant.model, self.infant.prefix
        ids = [find_frame(root, model, prefix).body for root in roots]
        return frozenset(np.flatnonzero(in_subtrees(model, ids)).tolist())

    def require(self, behaviour: str, *bodies: str) -> None:
        """Raise a PolicyError if the infant lacks some body parts."""
        if missing := [name for name in bodies if not self.infant.has(name)]:
            raise PolicyError(f"'{behaviour}' needs {' and '.join(missing)}, which this infant lacks")


class Behaviour:
    """Proposes angles of some joints; a behaviour of one's own overrides what it needs."""

    joints: IntArray  # The hinges that it moves, as indices among those of its subject, shape (m,).
    start: mujoco.MjData | None = None
    """The posture at the origin, facing along x, that an episode begins in; None to begin where the infant is."""
    is_whole = False  # Whether it is a posture of the whole body, the rest of which others may move.
    loose: IntArray | None = None
    """Those of its joints that bear nothing and only move what hangs on them; None for all, or, of a whole posture,
    none."""
    frequency_rad_s: float | FloatArray = FREQUENCY_RAD_S
    """How stiff its joints are: the natural frequency of all of them, or of each, shape (m,); see `holding`."""
    estimated_rad_s: float = ESTIMATED_RAD_S
    """The same of a posture of the whole body that an infant holds by an estimate of its body."""
    may_touch: frozenset[int] = frozenset()  # Bodies that it may bring to the floor, which counts against no posture.

    def begin(self, data: mujoco.MjData) -> None:
        """Begin an episode in a state."""

    def settle(self, state: mujoco.MjData) -> None:
        """See the state into which the posture settles, before the first control step of an infant that estimates."""

    def sense(self, observation: Observation, time_s: float, generator: np.random.Generator) -> None:
        """Sense what the infant observes before a control step; random numbers come from the policy's generator."""

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angle that each of its joints is to go to, shape (m,), [rad].

        The state *ahead* is that in which the command takes effect, as the infant takes it to be. An infant that reads
        the truth is asked anew for joints to which commands take longer.
        """
        raise NotImplementedError

    def lost(self, data: mujoco.MjData, may_touch: frozenset[int]) -> str:
        """Return why a state is none that it is for, or ""; others may bring the bodies *may_touch* to the floor."""
        return ""

    def watch(self, data: mujoco.MjData, time_s: float) -> None:
        """See the state before each control step, for `metrics`."""

    def metrics(self) -> Mapping[str, float]:
        """Return what the summary of a run tells of this episode, by names with their units."""
        return {}
