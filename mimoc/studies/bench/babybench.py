"""BabyBench's two behaviours on mimoc's infants, scored as its starter kit scores its training logs.

BabyBench 2025 (López et al.) asks for behaviours that no reward asks for: self-touch and hand regard. What its
environments log of an episode, and how `babybench/eval.py` scores logs, is stated here anew; logs have its keys.
"""

from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.rounding import render_json
from mimoc.bundle.files import write_file
from mimoc.compiler import building
from mimoc.policies.policy import Policy, start_again
from mimoc.recording.folder import versions
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.schema.base import Model
from mimoc.schema.quantities import Real, Whole
from mimoc.studies.bench import LIBRARIES, checked_file
from mimoc.studies.bench.scores import bound_policy, digests_of
from mimoc.studies.bench.table import babybench_spec, bench_table
from mimoc.studies.jobs import Progress

SELF_TOUCH = "self_touch"
EPISODES, STEPS, RANDOM_STEPS = 10, 1000, 10
"""Episodes of an evaluation, control steps of each, and random steps that come before an episode."""
MAX_LOGS = 10_000  # The score is that of at most this many last episodes.
GEOMS = 34  # Geoms of BabyBench's infant that either hand can touch.
HALF_FIELD_DEG = 15.0  # Angle at the eye within which a hand counts as looked at.
SIDES = "right", "left"
PAIRS = tuple((eye, hand) for hand in SIDES for eye in SIDES)

Log = Mapping[str, Any]  # What is logged of an episode, by BabyBench's keys.


class BabyBenchResults(Model):
    """What a policy scored in a behaviour."""

    behaviour: str
    """`self_touch` or `hand_regard`."""
    policy: str
    policy_files: Mapping[str, str]
    """Digests of the files that decide what the policy does."""
    score: Real
    """The score by BabyBench's formula."""
    in_sight: Real | None = None
    """The score of hand regard by where the eyes' cameras look; None for self-touch."""
    logs: tuple[Mapping[str, Whole | tuple[str, ...]], ...]
    """The log of each episode; the first is of the reset before the first episode, and does not count."""
    seeds: tuple[Whole, Whole]
    """Seeds of the episodes, the second excluded."""
    software: Mapping[str, str]
    """Versions, and the type of the machine."""


def self_touch_score(logs: Sequence[Log]) -> float:
    """Return BabyBench's score of self-touch: the share of the body that hands have touched, by geoms.

    (|R| + |L|) / (2 x 34), where R and L are all that the right and the left hand touched in the last 10,000 episodes.
    The oldest log does not count if there are fewer: it is of the reset before the first episode.

    Args:
        logs: What was logged, the oldest first: geoms, by any names, in `right_hand_touches` and `left_hand_touches`.

    Example:
        >>> from mimoc.studies.bench.babybench import self_touch_score
        >>> self_touch_score([{}, {"right_hand_touches": [3, 7], "left_hand_touches": []}]) == 2 / 68
        True
    """
    recent = _recent(logs)
    touched = [{geom for log in recent for geom in log[f"{side}_hand_touches"]} for side in SIDES]
    return sum(map(len, touched)) / (2 * GEOMS)


def hand_regard_score(logs: Sequence[Log]) -> float:
    """Return BabyBench's score of hand regard: the mean share of steps in which an eye looks at a hand.

    Σ n(e, h) / (4 Σ steps) over both eyes e, both hands h and the last 10,000 episodes, without the oldest log as in
    `self_touch_score`. An episode is looked at once more when it ends, so that 1 can be exceeded by a thousandth.

    Args:
        logs: What was logged, the oldest first: `right_eye_left_hand` and so on, and `steps`.

    Raises:
        ValueError: If there is no episode with steps.
    """
    recent = _recent(logs)
    if not (steps := sum(log["steps"] for log in recent)):
        raise ValueError("no episode has any steps")
    return sum(log[_pair(eye, hand)] for log in recent for eye, hand in PAIRS) / (4 * steps)


class TouchLog:
    """Logs which geoms of the infant its hands touch in an episode, without their fingers, as BabyBench's has them."""

    def __init__(self, env: InfantEnv):
        model = env.model
        self._env = env
        self._hands = {side: set(np.flatnonzero(model.geom_bodyid == model.body(f"{side}_hand").id)) for side in SIDES}
        root = model.body(env.manifest.root_body).rootid
        self._own = set(np.flatnonzero(model.body_rootid[model.geom_bodyid] == root))
        self._touched = {side: dict[str, None]() for side in SIDES}

    def look(self) -> None:
        """Take notice of this moment. If both hands touch each other, it counts for the right one only."""
        for pair in self._env.data.contact.geom.reshape(-1, 2):
            side = next((side for side in SIDES if not self._hands[side].isdisjoint(pair)), None)
            if side:
                other = pair[1] if pair[0] in self._hands[side] else pair[0]
                if other in self._own:
                    self._touched[side][self._env.model.geom(other).name] = None

    def log(self) -> dict[str, Any]:
        """Return what BabyBench logs."""
        return {f"{side}_hand_touches": tuple(touched) for side, touched in self._touched.items()}


class RegardLog:
    """Logs in how many steps of an episode each eye looks at each hand."""

    def __init__(self, env: InfantEnv, *, in_sight: bool = False):
        """Begin an episode.

        BabyBench looks along the axis -z of the eye's body, which points down: the cameras of MIMo's eyes look along x,
        and *in_sight* looks where they do.
        """
        self._env, self._in_sight = env, in_sight
        self._eyes = {eye.side: eye for eye in env.manifest.anatomy.eyes}
        self._counts = {_pair(eye, hand): 0 for eye, hand in PAIRS}

    def look(self) -> None:
        """Take notice of this moment."""
        data = self._env.data
        for eye, hand in PAIRS:
            entry = self._eyes[eye]
            frame = data.cam(entry.camera).xmat if self._in_sight else data.body(entry.body).xmat
            away_m = data.body(f"{hand}_hand").xpos - data.body(entry.body).xpos
            self._counts[_pair(eye, hand)] += _angle_deg(-frame.reshape(3, 3)[:, 2], away_m) < HALF_FIELD_DEG

    def log(self) -> dict[str, Any]:
        """Return what BabyBench logs."""
        return {name: int(count) for name, count in self._counts.items()}


def run_babybench(
    behaviour: str,
    policy: str,
    out: str | Path,
    episodes: int = EPISODES,
    progress: Progress = lambda done, total: None,
) -> BabyBenchResults:
    """Score a policy in one of BabyBench's behaviours, on an infant with its settings, and write the result.

    An episode begins with 10 random control steps and then has 1,000, as in BabyBench.

    Args:
        behaviour: `self_touch` or `hand_regard`.
        policy: The policy, as `mimoc.run_bench` takes it.
        out: File to write: JSON.
        episodes: Number of episodes.
        progress: Called with the number of episodes done and their total.

    Raises:
        UnknownNameError: If there is no such behaviour or policy.
        PolicyError: If the policy does not fit the infant, or fails.
        OutputError: If the file cannot be written.
    """
    spec = babybench_spec(behaviour)
    out = checked_file(out)
    files = digests_of([policy])
    first = bench_table().seeds.test[0]
    with closing(InfantEnv(building.build(spec))) as env:
        env.reset(seed=first)
        act, loggers = bound_policy(env, policy), _begun(env, behaviour)
        _look(loggers)
        episode_logs = [_logs_of(loggers, 0)]
        for number in range(episodes):
            episode_logs.append(_run_episode(env, act, first + number, behaviour))
            progress(number + 1, episodes)
    logs, *others = zip(*episode_logs, strict=True)
    score = self_touch_score if behaviour == SELF_TOUCH else hand_regard_score
    results = BabyBenchResults(
        behaviour=behaviour,
        policy=policy,
        policy_files=files,
        score=score(logs),
        in_sight=score(others[0]) if others else None,
        logs=logs,
        seeds=(first, first + episodes),
        software=versions(LIBRARIES),
    )
    write_file(out, render_json(results.model_dump(mode="json"), levels=2))
    return results


def _begun(env: InfantEnv, behaviour: str) -> Sequence[TouchLog | RegardLog]:
    return [TouchLog(env)] if behaviour == SELF_TOUCH else [RegardLog(env), RegardLog(env, in_sight=True)]


def _run_episode(env: InfantEnv, act: Policy, seed: int, behaviour: str) -> tuple[Log, ...]:
    """Return the logs of an episode, which ends early only if the simulation becomes unstable."""
    starting = np.random.default_rng([seed, RANDOM_STEPS])
    generator = np.random.default_rng(seed)
    observation, _ = env.reset(seed=seed)
    for _ in range(RANDOM_STEPS):
        command = starting.uniform(env.actuation.low, env.actuation.high).astype(np.float32)
        observation, *_ = env.step(command)
    start_again(act)
    loggers, steps, ended = _begun(env, behaviour), 0, False
    while steps < STEPS and not ended:
        observation, _, ended, _, _ = env.step(act(generator, observation))
        _look(loggers)
        steps += 1
    _look(loggers)  # BabyBench looks once more before it logs.
    return _logs_of(loggers, steps)


def _look(loggers: Sequence[TouchLog | RegardLog]) -> None:
    for logger in loggers:
        logger.look()


def _logs_of(loggers: Sequence[TouchLog | RegardLog], steps: int) -> tuple[Log, ...]:
    return tuple({**logger.log(), "steps": steps} for logger in loggers)


def _recent(logs: Sequence[Log]) -> Sequence[Log]:
    return logs[max(1, len(logs) - MAX_LOGS) :]


def _pair(eye: str, hand: str) -> str:
    return f"{eye}_eye_{hand}_hand"


def _angle_deg(first: FloatArray, second: FloatArray) -> float:
    lengths = np.linalg.norm(first) * np.linalg.norm(second)
    return float(np.degrees(np.arccos(np.clip(first @ second / lengths, -1.0, 1.0)))) if lengths else np.inf
