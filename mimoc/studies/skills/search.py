"""How an infant comes to have a skill: a search for a movement over a few postures, or trainings on a device.

The search is the cross-entropy method. Vectors are drawn around a mean; the best ones so far move it, and narrow what
is drawn next. A round has one start. At first, what is kept may have been lucky in its start, which leads on to what is
rare; later, it is tried again in the start of each round, and stays only if it is good in most. In the end, the kept
ones and the mean are told apart in more starts, by successive halving:

    rounds of 40 tries, 1,440 of 1,600    first half: 40 draws    second half: 32 draws, and the 8 that were kept
    checks, the other 160                 9 candidates in 4 starts each, 5 in 8 more, 3 in 13 more, 2 in 20 more

A movement is made of a vector of numbers, by the recipe of its skill, so that any search can find it:

    vector (v,)  ->  postures (p, n), in shares of the ranges of n joints, and how they follow what is felt, (4, n)

What no draw does may still be possible: a search that finds nothing says so much about itself as about the body.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mimoc.base.errors import SpecError
from mimoc.compiler import building
from mimoc.policies.rollout import rollout
from mimoc.policies.skill import PosturePolicy, Postures, mirrored
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.opening import open_infant
from mimoc.runtime.sense import FloatArray
from mimoc.schema.base import Model
from mimoc.schema.infant import InfantSpec
from mimoc.studies.jobs import Progress, run_jobs

if TYPE_CHECKING:
    from mimoc.training import Training
    from mimoc.training.trainer import TrainingJob

TRUNK = ("hip_bend1", "hip_lean1", "hip_rot1")
LIMBS = ("shoulder_horizontal", "shoulder_ad_ab", "elbow", "hip1", "hip2", "knee")
ROLLING = (*TRUNK, "head_swivel", "head_tilt", *LIMBS, "shoulder_rotation", "hip3")
UPRIGHT = (*TRUNK, "head_tilt", *LIMBS, "foot1", "foot2")
HOLDING = ("hand1", "hand2", "hand3", "fingers")
"""Joints that move, without `robot:` and without their side; all others are left quiet, so that a search has fewer
numbers. `fingers` are all of their joints."""
FINGERS = ("th", "ff", "mf", "rf", "lf")
SWAY_STEP = 0.5  # Gain from what is felt to a share of the range, for each unit of the vector.


@dataclass(frozen=True)
class Recipe:
    """A kind of movement."""

    joints: tuple[str, ...]  # The joints that move, without their side.
    postures: int
    posture_s: float
    moving_s: float
    is_symmetric: bool = False  # Whether both sides do the same, but for what is felt of falling to a side.
    repeats: bool = False
    is_mirrored: bool = False  # Whether both sides take turns.
    sways: bool = False  # Whether the infant leans against falling over.
    spread: float = 0.6  # Spread of the first draws around the start, or around no command, in shares of half a range.
    stiffness_per_rad: float = 0.0
    """Share of strength for each radian off a posture; 0 for movements of commands, drawn around none."""


_HELD = Recipe(UPRIGHT, 1, 1.0, 0.2, True, sways=True, spread=0.15, stiffness_per_rad=1.0)
RECIPES: Mapping[str, Recipe] = {
    "roll": Recipe(ROLLING, 3, 1.0, 0.4, spread=0.7),
    "sit_up": Recipe(ROLLING, 3, 1.0, 0.4, spread=1.0),
    "sit": _HELD,
    "crawl": Recipe(ROLLING, 2, 0.4, 0.3, repeats=True, is_mirrored=True, spread=0.6),
    "pull_to_stand": Recipe(UPRIGHT, 2, 1.5, 1.0, True, sways=True),
    "stand": _HELD,
    "cruise": Recipe(UPRIGHT, 2, 0.4, 0.3, repeats=True, spread=0.2, sways=True, stiffness_per_rad=1.0),
    "walk": Recipe(UPRIGHT, 2, 0.3, 0.2, repeats=True, is_mirrored=True, sways=True, spread=0.2, stiffness_per_rad=1.0),
    "grasp": Recipe(HOLDING, 2, 1.0, 0.4, spread=0.5),
}


class Form:
    """From vectors to movements of an infant."""

    def __init__(self, recipe: Recipe, task: str, age_months: float, joints: tuple[str, ...], start: FloatArray):
        """Say what a movement is made of; hinges that can be commanded start at shares of their range, shape (n,)."""
        kept = [place for place, joint in enumerate(joints) if _name(joint) in recipe.joints]
        self.recipe, self.task, self.age_months = recipe, task, age_months
        self.joints = tuple(joints[place] for place in kept)
        self._start = np.clip(start[kept], -1.0, 1.0) if recipe.stiffness_per_rad else np.zeros(len(kept))
        one_side = np.eye(len(self.joints))[[place for place, joint in enumerate(self.joints) if "left_" not in joint]]
        other_side = mirrored(self.joints, one_side)
        alike = np.sign(one_side + other_side)
        opposite = np.sign(one_side - other_side)
        # Postures in which both sides do the same, and in which they do the opposite, shape (b, n) each.
        self._alike = alike[alike.any(axis=1)]
        self._opposite = opposite[opposite.any(axis=1)]
        self._of_posture = self._alike if recipe.is_symmetric else np.eye(len(kept))
        self._of_sway = (self._alike, self._opposite) * 2 if recipe.sways else ()

    @property
    def sizes(self) -> list[int]:
        """Number of numbers of each posture, then of each row of the sway."""
        return [len(self._of_posture)] * self.recipe.postures + [len(basis) for basis in self._of_sway]

    def scale(self) -> FloatArray:
        """Return by how much the numbers of first draws spread, shape (v,)."""
        return np.full(sum(self.sizes), self.recipe.spread)

    def movement(self, vector: FloatArray) -> Postures:
        """Return the movement that a vector means, shape (v,)."""
        parts = np.split(vector, np.cumsum(self.sizes)[:-1])
        count = self.recipe.postures
        postures = [np.clip(self._start + part @ self._of_posture, -1.0, 1.0) for part in parts[:count]]
        sway = [SWAY_STEP * part @ basis for part, basis in zip(parts[count:], self._of_sway, strict=True)]
        return Postures(
            task=self.task,
            age_months=self.age_months,
            joints=self.joints,
            postures=tuple(tuple(np.round(posture, 4).tolist()) for posture in postures),
            posture_s=self.recipe.posture_s,
            moving_s=self.recipe.moving_s,
            repeats=self.recipe.repeats,
            mirrored=self.recipe.is_mirrored,
            stiffness_per_rad=self.recipe.stiffness_per_rad,
            sway=tuple(tuple(np.round(row, 4).tolist()) for row in sway),
        )


def _name(joint: str) -> str:
    name = joint.removeprefix("robot:").removeprefix("left_").removeprefix("right_")
    return "fingers" if name.partition("_")[0] in FINGERS else name


DRAWS, KEPT = 40, 8  # Movements that are tried in a round, and how many of them are kept for the next one.
MIN_SPREAD, SMOOTHING = 0.15, 0.7
"""The least spread, as a share of the first one, and how far the kept ones move mean and spread."""
EXPLORED = 0.5  # Share of the rounds in which what is kept is not tried again.
PASSED, CHECKS = 0.9, 8
"""The rounds end when a kept movement has had the skill in this share of at least so many starts."""
CHECKED = 0.1  # Share of the tries with which the mean and the kept movements are told apart in the end.
FIRST_TEST = 20_000  # Seed of the first start in which the result of a search is measured.
FIRST_TRY, FIRST_CHECK = 1_000_000, 500_000
"""Seed of the first start of a search, times its own seed and one, and how much further those of its checks begin."""


@dataclass(frozen=True)
class SearchOutcome:
    """The result of a search."""

    movement: Postures
    success: float  # Share of starts that the search has not seen in which the infant has the skill.
    tried: int  # Number of episodes that were tried.
    curve: tuple[float, ...]  # Mean score of the kept movements, in each round.


@dataclass(frozen=True)
class Candidate:
    """A movement that may be the best, and what came of it."""

    vector: FloatArray  # The numbers that it is made from, shape (v,).
    scores: tuple[float, ...] = ()  # Its score in each start that it was tried in.
    successes: tuple[bool, ...] = ()  # Whether the infant had the skill, in each of them.

    @property
    def score(self) -> float:
        """Its mean score; 0 before it was tried."""
        return sum(self.scores) / max(len(self.scores), 1)

    @property
    def success(self) -> float:
        """Share of its starts in which the infant had the skill; 0 before it was tried."""
        return sum(self.successes) / max(len(self.successes), 1)


class Searcher:
    """Tries movements with one infant."""

    def __init__(self, env: InfantEnv):
        self.env = env
        env.reset(seed=0)
        joints = tuple(dict.fromkeys(a.joint for a in env.manifest.actuation.actuators if a.commanded))
        low, high = np.array([env.model.joint(joint).range for joint in joints]).T
        angles = env.data.qpos[[env.model.joint(joint).qposadr[0] for joint in joints]]
        start = (angles - (low + high) / 2) / np.maximum((high - low) / 2, 1e-9)
        task = env.manifest.task.kind
        self.form = Form(RECIPES[task], task, env.age_months, joints, start)

    def play(self, movement: Postures, seed: int) -> tuple[float, bool]:
        """Return the score of an episode, and whether the infant had the skill in it.

        That is its reward, weighted by the share of the episode that has passed: what counts is where it leads.
        """
        total, success = 0.0, False
        for step in rollout(self.env, lambda env: PosturePolicy(env, movement), episodes=1, seed=seed):
            total = total + step.reward * step.number / (self.env.max_steps or 1)
            success = step.success
        return total, success

    def success(self, movement: Postures, first: int, count: int) -> float:
        """Return in what share of some starts, from a seed on, the infant has the skill."""
        return sum(self.play(movement, seed)[1] for seed in range(first, first + count)) / count

    def tried(self, candidate: Candidate, seed: int) -> Candidate:
        """Return a candidate with what comes of it in one more start."""
        score, success = self.play(self.form.movement(candidate.vector), seed)
        return replace(candidate, scores=(*candidate.scores, score), successes=(*candidate.successes, success))


def search(
    env: InfantEnv, seed: int, tries: int = 1000, starts: int = 20, progress: Callable[[int], None] = lambda tried: None
) -> SearchOutcome:
    """Return the best movement that a search finds for a task, measured in *starts* that it has not seen.

    There are at most as many tries as asked for, in rounds and in checks of the best; one round at least.
    """
    searcher, random = Searcher(env), np.random.default_rng(seed)
    scale, first = searcher.form.scale(), FIRST_TRY * (seed + 1)
    mean = np.zeros(len(scale))
    spread = scale.copy()
    kept = list[Candidate]()
    curve = list[float]()
    rounds = max(1, int(tries * (1 - CHECKED)) // DRAWS)
    while len(curve) < rounds and not any(
        len(candidate.successes) >= CHECKS and candidate.success >= PASSED for candidate in kept
    ):
        lucky, again = (kept, []) if len(curve) < EXPLORED * rounds else ([], kept)
        draws = mean + spread * random.standard_normal((DRAWS - len(again), len(mean)))
        candidates = [*again, *(Candidate(draw) for draw in draws)]
        played = [searcher.tried(candidate, first + len(curve)) for candidate in candidates]
        kept = sorted([*lucky, *played], key=lambda candidate: -candidate.score)[:KEPT]
        vectors = np.array([candidate.vector for candidate in kept])
        mean = mean + SMOOTHING * (vectors.mean(axis=0) - mean)
        spread = np.maximum(spread + SMOOTHING * (vectors.std(axis=0) - spread), MIN_SPREAD * scale)
        curve.append(round(sum(candidate.score for candidate in kept) / KEPT, 3))
        progress(len(curve) * DRAWS)
    tried = len(curve) * DRAWS
    checks = min(int(tries * CHECKED), tries - len(curve) * DRAWS)
    best, checked = best_of(searcher, [Candidate(mean), *kept], first + FIRST_CHECK, checks)
    movement = searcher.form.movement(best.vector)
    success = searcher.success(movement, FIRST_TEST, starts)
    return SearchOutcome(movement, success, tried + checked, tuple(curve))


def best_of(searcher: Searcher, candidates: Sequence[Candidate], first: int, tries: int) -> tuple[Candidate, int]:
    """Return the best of some candidates, and the number of tries that this took, by successive halving.

    All are tried anew in a few starts, the better half of them in more, and so on, until one is left: the one with the
    skill in most of these starts, or with the best score if that is as many. Each halving has the same share of all
    tries; without enough of them it is the first one.
    """
    left = [Candidate(candidate.vector) for candidate in candidates]
    seed = first
    tried = 0
    halvings = (len(left) - 1).bit_length()
    for _ in range(halvings):
        starts = range(seed, seed + tries // halvings // len(left))
        tried, seed = tried + len(starts) * len(left), starts.stop
        left = [reduce(searcher.tried, starts, candidate) for candidate in left]
        left.sort(key=lambda candidate: (-candidate.success, -candidate.score))
        left = left[: (len(left) + 1) // 2]
    return left[0], tried


class SkillSearch(Model):
    """One search at one age."""

    age_months: float
    """The infant's age."""
    seed: int
    """Seed of the search."""
    success: float
    """Share of starts in which it has the skill."""
    starts: int
    """Number of these starts."""
    tried: int = 0
    """Number of movements tried, or of control steps of a training."""
    curve: tuple[float, ...] = ()
    """Mean score of the best tries in each round, or the share of episodes with success in each row of a training."""
    movement: Postures | None = None
    """The movement that a search found; None if a policy was trained, or the infant cannot even begin."""
    policy: str = ""
    """Path of the policy that was trained on a device, from the folder of the results."""
    success_on_device: float | None = None
    """Share of the infants that had success there with the same policy, one episode each."""
    problem: str = ""
    """Why it cannot begin."""


def problem_of(error: SpecError) -> str:
    """Return why a task cannot begin, without the place in a spec."""
    return str(error).partition("task.kind: ")[2] or str(error)


Job = tuple[InfantSpec, int]  # The infant that is to learn a skill, and the seed.


def searches(
    jobs: Sequence[Job], progress: Progress, tries: int, starts: int, processes: int
) -> Iterator[tuple[int, SkillSearch]]:
    """Search for movements in processes side by side; progress is in searches."""
    progress(0, len(jobs))
    done = run_jobs(searched, [(*job, tries, starts) for job in jobs], processes)
    for count, attempt in enumerate(done, 1):
        yield attempt
        progress(count, len(jobs))


def searched(spec: InfantSpec, seed: int, tries: int, starts: int) -> SkillSearch:
    """Return what comes of one search."""
    attempt = partial(SkillSearch, age_months=spec.age_months, seed=seed, starts=starts)
    try:
        env = open_infant(spec)
    except SpecError as error:
        return attempt(success=0.0, problem=problem_of(error))
    outcome = search(env, seed, tries, starts)
    env.close()
    recipe = {"learner": "cross-entropy search", "seed": float(seed), "success": outcome.success}
    movement = outcome.movement.model_copy(update={"recipe": {**recipe, "tried": float(outcome.tried)}})
    return attempt(success=outcome.success, tried=outcome.tried, curve=outcome.curve, movement=movement)


HYPER = {"gamma": 0.99}
"""What a skill needs, which takes seconds: rewards of a second from now count .6 of those of now, with control steps of
20 ms. Usual for learning to walk on a GPU, as in Isaac Lab."""
HELPED = ("sit", "pull_to_stand", "stand", "cruise", "walk")
SUPPORT = 0.6
"""Skills in which infants that learn are carried by a share of their weight, and its largest value; the share is drawn
for each episode, from 0 on, so that many episodes are as those in which the policy is measured, without help."""


def trainings(
    jobs: Sequence[Job],
    progress: Progress,
    steps: int,
    starts: int,
    device: str,
    envs: int,
    out: Path,
    processes: int,
) -> Iterator[tuple[int, SkillSearch]]:
    """Train policies for infants with seeds on a device side by side; yield the place of each and what came of it."""
    from mimoc.training.trainer import TrainingJob, train_together  # Needs what not everyone has.

    wanted, names = dict[int, "TrainingJob"](), dict[int, str]()
    for place, (spec, seed) in enumerate(jobs):
        try:
            infant = building.compiled(while_learning(spec))
        except SpecError as error:
            attempt = SkillSearch(age_months=spec.age_months, seed=seed, success=0.0, starts=starts)
            yield place, attempt.model_copy(update={"problem": problem_of(error)})
            continue
        names[place] = f"trainings/{spec.age_months:g}_months_{seed}"
        wanted[place] = TrainingJob(infant, out / names[place], seed)
    if not wanted:
        return
    made = train_together(list(wanted.values()), device, steps=steps, envs=envs, hyper=HYPER, progress=progress)
    places = list(wanted)
    measured = [(*jobs[place], names[place], training, starts) for place, training in zip(places, made, strict=True)]
    yield from ((places[index], attempt) for index, attempt in run_jobs(_measured, measured, processes))


def while_learning(spec: InfantSpec) -> InfantSpec:
    """Return an infant that is helped while it learns, unless its task says how."""
    task = spec.task
    if task is None or task.kind not in HELPED or "support" in task.model_fields_set:
        return spec
    return spec.with_(task={**task.model_dump(exclude_unset=True), "support": SUPPORT})


def _measured(spec: InfantSpec, seed: int, name: str, training: "Training", starts: int) -> SkillSearch:
    from mimoc.training import evaluate, load_policy

    env = open_infant(spec)
    episodes = evaluate(env, load_policy(training.policy), episodes=starts, seed=FIRST_TEST)
    env.close()
    return SkillSearch(
        age_months=spec.age_months,
        seed=seed,
        success=sum(episode.success for episode in episodes) / starts,
        starts=starts,
        tried=training.curve.steps,
        curve=tuple(np.nan_to_num(training.curve.column("success_rate")).round(4).tolist()),
        policy=f"{name}/policy.zip",
        success_on_device=training.use.success if training.use else None,
    )
