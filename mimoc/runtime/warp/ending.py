"""Rewards, and how episodes end on a device."""

from collections.abc import Iterable, Sequence

import mujoco_warp as mjw
import warp as wp
from gymnasium.vector import AutoresetMode

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp import overflow
from mimoc.runtime.warp.arrays import put
from mimoc.runtime.warp.starts import Starts

TOO_MUCH = 1e10
"""Position, velocity or acceleration beyond which a simulation is unstable (MuJoCo's mjMAXVAL)."""
NEXT_STEP, SAME_STEP, DISABLED = range(3)
MODES = {AutoresetMode.NEXT_STEP: NEXT_STEP, AutoresetMode.SAME_STEP: SAME_STEP, AutoresetMode.DISABLED: DISABLED}
NEVER = 2**31 - 1


class Ending:
    """What comes of each control step; arrays have the shape (worlds,) if nothing else is said."""

    def __init__(
        self, infants: Sequence[InfantEnv], body: wp.array, terms: int, max_steps: int | None, seeds: wp.array
    ):
        """Make arrays.

        Args:
            infants: The different bodies, which determine how long episodes are.
            body: Which body lives in each world.
            terms: Number of terms of the reward.
            max_steps: Control steps after which any episode is truncated.
            seeds: Of each world, shape (worlds,).
        """
        worlds = body.shape[0]
        limits = [min(NEVER if each is None else each for each in (env.max_steps, max_steps)) for env in infants]
        self._body, self._limits = body, put(limits, wp.int32)
        self.terms = wp.zeros((worlds, terms), dtype=float)
        self.reward = wp.zeros(worlds, dtype=float)
        self.success, self.terminated, self.truncated, self.unstable, self.ended, self.steps, self.episode = (
            wp.zeros(worlds, dtype=int) for _ in range(7)
        )
        self.overflowed = wp.zeros(worlds, dtype=int)
        """Whether contacts or constraints of the infant did not fit, and were lost."""
        self.chosen = wp.full(worlds, -1, dtype=int)
        """The start of the next episode of worlds that begin one now, -1 for others."""
        self.finished = wp.zeros(worlds, dtype=int)
        """Whether an episode has ended in this very step."""
        self.seeds = seeds
        self.report = wp.zeros(overflow.LENGTH, dtype=int)
        """What the CPU must know of the last step; see `overflow.report`."""

    def clear(self) -> None:
        """Forget what the last step earned."""
        for array in (self.terms, self.success, self.terminated, self.report):
            array.zero_()

    def forget(self, worlds: Iterable[int]) -> None:
        """Choose the same starts again, after the first, in worlds that have a new seed."""
        episodes = self.episode.numpy()
        episodes[list(worlds)] = 0
        self.episode.assign(episodes)

    def judge(self, data: mjw.Data, actions: wp.array, mode: AutoresetMode, starts: Starts) -> None:
        """Add up rewards, find what ends, and choose where to begin again."""
        worlds = self._body.shape[0]
        state = [data.qpos, data.qvel, data.qacc, data.overflow]
        wp.launch(_check, worlds, state, [self.unstable, self.overflowed])
        inputs = [MODES[mode], self._body, self._limits, self.seeds, starts.first, starts.count]
        counts = [self.steps, self.episode, self.terms, self.reward, self.success, self.terminated, self.truncated]
        ends = [self.unstable, self.overflowed, self.ended, self.finished, self.chosen]
        wp.launch(_judge, worlds, inputs, [*counts, *ends])
        overflow.report(data, actions, self.unstable, self.overflowed, self.report)

    def begin(self, chosen: wp.array) -> None:
        """Count from the start again in worlds that begin an episode."""
        wp.launch(_begin, chosen.shape, [chosen], [self.steps])


@wp.kernel(enable_backward=False)
def _check(
    qpos: wp.array2d[float],
    qvel: wp.array2d[float],
    qacc: wp.array2d[float],
    flags: wp.array[int],
    unstable: wp.array[int],
    overflowed: wp.array[int],
):
    world = wp.tid()
    broken = _broken(qpos, world) or _broken(qvel, world) or _broken(qacc, world)
    unstable[world] = wp.where(broken, 1, 0)
    overflowed[world] = wp.where(overflow.is_losing(flags[world]) and not broken, 1, 0)


@wp.func
def _broken(values: wp.array2d[float], world: int) -> bool:
    found = bool(False)
    for number in range(values.shape[1]):
        if not (wp.abs(values[world, number]) <= wp.static(TOO_MUCH)):
            found = True
    return found


@wp.func
def _total(terms: wp.array2d[float], world: int, void: bool) -> float:
    """Return the sum of the terms, which are zero if they are void."""
    total = float(0.0)
    for term in range(terms.shape[1]):
        if void:
            terms[world, term] = 0.0
        total += terms[world, term]
    return total


@wp.kernel(enable_backward=False)
def _judge(
    mode: int,
    body: wp.array[int],
    limits: wp.array[int],
    seeds: wp.array[int],
    first: wp.array[int],
    count: wp.array[int],
    steps: wp.array[int],
    episode: wp.array[int],
    terms: wp.array2d[float],
    reward: wp.array[float],
    success: wp.array[int],
    terminated: wp.array[int],
    truncated: wp.array[int],
    unstable: wp.array[int],
    overflowed: wp.array[int],
    ended: wp.array[int],
    finished: wp.array[int],
    chosen: wp.array[int],
):
    world = wp.tid()
    waiting = ended[world] == 1 and mode == wp.static(NEXT_STEP)
    if waiting:
        unstable[world] = 0
        overflowed[world] = 0
    broken = unstable[world] == 1
    steps[world] = steps[world] + 1
    if broken or waiting:
        success[world] = 0
        terminated[world] = wp.where(broken, 1, 0)
    reward[world] = _total(terms, world, broken or waiting)
    truncated[world] = wp.where((steps[world] >= limits[body[world]] or overflowed[world] == 1) and not waiting, 1, 0)
    ends = truncated[world] == 1 or terminated[world] == 1
    finished[world] = wp.where(ends, 1, 0)
    chosen[world] = -1
    if waiting or (ends and mode == wp.static(SAME_STEP)):
        episode[world] = episode[world] + 1
        state = wp.rand_init(seeds[world], episode[world])
        chosen[world] = first[body[world]] + wp.randi(state, 0, count[body[world]])
    ended[world] = wp.where(ends and mode != wp.static(SAME_STEP), 1, 0)


@wp.kernel(enable_backward=False)
def _begin(chosen: wp.array[int], steps: wp.array[int]):
    world = wp.tid()
    if chosen[world] >= 0:
        steps[world] = 0
