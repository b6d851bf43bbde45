"""Train an infant, interval by interval, so that it can be interrupted at any time."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.vec_env import VecNormalize

from mimoc.bundle.folder import Bundle
from mimoc.compiler import pipeline
from mimoc.errors import TrainingError
from mimoc.render.plots.learning import curves_png, draw_curves
from mimoc.runtime.env import InfantEnv
from mimoc.schema.infant import InfantSpec
from mimoc.training.agents import begin_interval, make_agent
from mimoc.training.checkpoint import Progress, pack, read_progress, unpack
from mimoc.training.curve import Curve
from mimoc.training.hyper import Number
from mimoc.training.policies import pack_policy
from mimoc.training.recorder import Recorder
from mimoc.training.run_folder import POLICY, STATE, RunFolder, claim
from mimoc.training.settings import Settings
from mimoc.training.worlds import check_learnable, open_world
from mimoc.units import ms_to_s

Source = Bundle | InfantSpec | str | Path
Tell = Callable[[int, int], None]

STEPS = 500_000
"""As many as the paper trains for."""
ENVS = 8
CHECKPOINT_EVERY = 20_480
DRAW_EVERY_S = 20.0
"""How often the picture of the curve is drawn again, which takes longer than a checkpoint."""


@dataclass(frozen=True, slots=True)
class Training:
    """What came of a training."""

    curve: Curve
    policy: Path
    """The file of the policy, for `load_policy`."""
    began_at: int
    """Control steps that had been trained for before: more than 0 if it was gone on with."""


def train(
    source: Source,
    out: str | Path,
    *,
    algo: str = "ppo",
    steps: int = STEPS,
    seed: int = 0,
    envs: int = ENVS,
    checkpoint_every: int = CHECKPOINT_EVERY,
    hyper: Mapping[str, Number] | None = None,
    processes: bool | None = None,
    force: bool = False,
    progress: Tell | None = None,
) -> Training:
    """Train an infant, or go on with a training that was interrupted; one that is done is only read.

    What is learned follows from bundle and settings, bit for bit on one kind of machine with the same software,
    also if the training is killed and gone on with: each interval between two checkpoints begins with all episodes
    anew and with chance of its own. A training that is given more steps once it is done goes on where it ended.
    It uses the random numbers and one thread of torch, and takes numpy's global random numbers.

    Args:
        source: A bundle, the folder of one, or a spec; a path that ends in .yaml or .yml is that of a spec.
        out: The folder of the training: new, empty, or with this training in it.
        algo: `ppo` or `sac`.
        steps: Control steps of all infants together, in whole rounds of learning.
        seed: Of all chance.
        envs: How many infants act at a time.
        checkpoint_every: Control steps from one checkpoint to the next; at most so many are lost by a kill.
        hyper: Hyper-parameters to choose otherwise than `mimoc.training.hyper` does.
        processes: Whether each infant acts in a process of its own; None is where that pays. The same is learned.
            A script that says True needs `if __name__ == "__main__":`.
        force: Begin anew what is in the folder.
        progress: Is told how many steps are done, and of how many.

    Raises:
        SpecError: If a spec cannot be built.
        BundleError: If a folder is not a whole bundle.
        UnknownNameError: If there is no such algorithm or hyper-parameter.
        TrainingError: If a setting is out of its range, or another training or something else is in the folder.
        OutputError: If a file cannot be written.
        MissingExtraError: If matplotlib is not installed.
    """
    settings = Settings.choose(algo, steps, seed, envs, checkpoint_every, hyper or {})
    bundle = pipeline.compiled(source)
    check_learnable(bundle)
    draw_curves({})  # That matplotlib is missing had better be said now than after hours.
    tell = progress or (lambda done, total: None)
    with claim(out, settings, bundle, force=force) as folder:
        before = _before(folder)
        known = before
        if before.steps < steps:
            with _one_thread(), _open(bundle, settings, processes) as (agent, world):
                known = _go_on(folder, agent, world, settings, bundle, tell)
        folder.show(known.curve.to_csv())
        folder.draw(_picture(known))
    return Training(known.curve, folder.path / POLICY, before.steps)


def _before(folder: RunFolder) -> Progress:
    """Return how far the training in a folder has come."""
    state = folder.state()
    with _of(folder):
        return Progress() if state is None else read_progress(state)


def _go_on(
    folder: RunFolder, agent: BaseAlgorithm, world: VecNormalize, settings: Settings, bundle: Bundle, tell: Tell
) -> Progress:
    """Train from where a folder stands to the end, a checkpoint after each interval."""
    state, known, drawn_s = folder.state(), Progress(), 0.0
    if state is not None:
        with _of(folder):
            known = unpack(state, agent, world)
    infant = InfantEnv(bundle)
    try:
        while known.steps < settings.steps:
            known = _interval(agent, settings, known, ms_to_s(bundle.manifest.step_ms), tell)
            policy = pack_policy(agent, world, settings, infant)
            folder.keep(known.steps, policy, pack(policy, agent, known))
            folder.show(known.curve.to_csv())
            if known.wall_s > drawn_s + DRAW_EVERY_S:
                folder.draw(_picture(known))
                drawn_s = known.wall_s
    finally:
        infant.close()
    return known


def _interval(agent: BaseAlgorithm, settings: Settings, before: Progress, step_s: float, tell: Tell) -> Progress:
    """Train from one checkpoint to the next."""
    recorder = Recorder(before, step_s, lambda done: tell(min(done, settings.steps), settings.steps))
    begin_interval(agent, settings.seed)
    agent.learn(settings.end_of_interval(before.steps) - before.steps, recorder, reset_num_timesteps=False)
    return recorder.progress()


def _picture(known: Progress) -> bytes:
    return curves_png({"": [known.curve.columns()]})


@contextmanager
def _open(bundle: Bundle, settings: Settings, processes: bool | None) -> Iterator[tuple[BaseAlgorithm, VecNormalize]]:
    """Open the infants of a training and the agent that learns from them."""
    world = open_world(bundle, settings, processes)
    try:
        yield make_agent(world, settings), world
    finally:
        with suppress(EOFError, OSError):  # After Ctrl-C, which ends their processes too.
            world.close()


@contextmanager
def _one_thread() -> Iterator[None]:
    """Let torch compute on one thread: with networks as small as these the faster way, and on any machine the same."""
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)


@contextmanager
def _of(folder: RunFolder) -> Iterator[None]:
    """Say of what folder an error tells."""
    try:
        yield
    except TrainingError as error:
        raise TrainingError(f"{folder.path / STATE}: {error}") from None
