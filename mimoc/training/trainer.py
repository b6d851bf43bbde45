"""Training in intervals between checkpoints, which can be interrupted at any time and resumed."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from copy import deepcopy
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

import torch

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import TrainingError
from mimoc.bundle.io import Bundle
from mimoc.bundle.variants import Variant, Variants, WorldMaker, open_variant
from mimoc.bundle.world import WorldBundle
from mimoc.compiler import pipeline
from mimoc.compiler.world_sources import world_of
from mimoc.recording.folder import check_recordable
from mimoc.render.plots.file import encode, require_matplotlib
from mimoc.render.plots.learning import learning_sheet
from mimoc.runtime.batch.gymnasium_forms import check_mixture
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.infants import infants_of
from mimoc.runtime.world_env import WorldEnv
from mimoc.schema.infant import InfantSpec
from mimoc.schema.world import WorldPlan
from mimoc.training.checkpoint import Progress, read_progress
from mimoc.training.curve import Curve, CurvePoint
from mimoc.training.learner import DeviceUse, Learner
from mimoc.training.learner_choice import LearnerOpener, choose_learner, refuse_in_world, refuse_on_device
from mimoc.training.run_folder import CURVE, PICTURE, POLICY, STATE, RunFolder, open_run_folder
from mimoc.training.settings import CPU, Number, TrainingSettings, check_learnable, episode_limit
from mimoc.training.together import run_together
from mimoc.training.tracking import tracked
from mimoc.training.vector_env import growth_settings

Source = Bundle | InfantSpec | WorldBundle | WorldPlan | Mapping[str, InfantSpec] | str | Path
ProgressCallback = Callable[[int, int], None]
"""Called with the number of steps done and their total."""
RowCallback = Callable[[CurvePoint], None]
"""Called with a new row of the learning curve."""

STEPS = 500_000
"""Training steps in the paper."""
ENVS = 8
PLOT_EVERY_S = 60.0
"""Minimum time between plots of the curve: plotting takes longer than saving a checkpoint."""


@dataclass(frozen=True, slots=True)
class Training:
    """The result of a training run."""

    curve: Curve
    policy: Path
    """File of the trained policy, for `load_policy`."""
    resumed_at: int
    """Control steps at which the run was resumed; 0 if it was not."""
    use: DeviceUse | None = None
    """What it took of a device; None on the CPU."""


@takes("a bundle, a spec, or the path of one", Bundle, InfantSpec, WorldBundle, WorldPlan, Mapping, *PATH)
def train(
    source: Source,
    out: str | Path,
    *,
    algo: str = "ppo",
    steps: int = STEPS,
    seed: int = 0,
    envs: int = ENVS,
    steps_per_episode: int | None = None,
    checkpoint_every: int | None = None,
    hyper: Mapping[str, Number] | None = None,
    threads: int | None = None,
    processes: bool | None = None,
    force: bool = False,
    progress: ProgressCallback | None = None,
    on_row: RowCallback | None = None,
    task: Any = None,
    senses: Mapping[str, Any] | None = None,
    grow: str | None = None,
    schedule: str = "grown",
    grow_steps: int | None = None,
    record: str | Path | None = None,
    origin: Mapping[str, Any] | None = None,
    device: str = CPU,
) -> Training:
    """Train a policy, or resume an interrupted training run; a finished run is only read.

    All infants of a world learn one policy, a row each, and must observe and command the same. When the episode of one
    ends, so do those of the others in its world.
    Bundle and settings determine the result, to the bit on the same type of machine with the same software, even if
    the run is killed and resumed: each interval between two checkpoints starts with all environments reset and with a
    seed of its own. A finished run that is given more steps continues where it ended.
    If it is interrupted (Ctrl-C), `policy.zip` and the curve have what was learnt until then.
    Training sets torch's random state and limits torch to one thread, and sets numpy's global random state.

    Args:
        source: A bundle, a bundle folder, or a spec; a path that ends in .yaml or .yml is that of a spec. Or a world of
            several infants, in any form that `mimoc.make_parallel` takes.
        out: Folder of the training run: new, empty, or that of the same run.
        algo: `ppo` or `sac`.
        steps: Control steps, summed over all environments; the last rollout is completed.
        seed: Random seed.
        envs: Number of parallel environments; of infants in worlds, rounded up to whole worlds.
        steps_per_episode: Control steps after which an episode is truncated; by default those of the task, or, with a
            warning, 500 if it has none.
        checkpoint_every: Control steps between checkpoints: the most that a kill can lose. By default 20,480, or one
            whole episode of each environment (on a device, four) if that takes more.
        hyper: Hyperparameters that differ from the defaults in `mimoc.training.settings`.
        threads: Threads that share the work of all environments, unless *processes* is given; by default, as many as
            this process may use. The result is the same.
        processes: Whether to run each environment in a process of its own, which pays for tasks and senses of a
            script's own that are slow, or one after another; by default all are worked through together. The result
            is the same. A script that passes True needs `if __name__ == "__main__":`.
        force: Discard the training run in the folder and start over.
        progress: Called with the number of steps done and their total.
        on_row: Called with each new row of the learning curve.
        task: An object whose rewards replace those of the task in the bundle, as for `mimoc.make`.
        senses: Objects to sense with, by name, as for `mimoc.make`; each infant has copies of these objects.
            The folder keeps only the names of their classes: pass them again to resume the run.
        grow: Ages in months between which the infant grows over the training, such as `6:12`; None is not at all.
        schedule: In which order it has these ages: `grown`, `adult` (only the oldest), `reversed` or `shuffled`.
        grow_steps: Control steps that growth takes, summed over all environments; None is all of *steps*.
        record: Folder to record every episode of the training in, for `mimoc.read_recording`; a training that is
            resumed continues it. It needs all environments together: leave out *processes*.
        origin: What the run belongs to, as plain data for `run.json`, such as the name of a cohort and of a job.
        device: Where the infants live, as for `mimoc.make_vec`: on `cuda:0`, say, rsl_rl's PPO learns from thousands of
            them. Observations must not be images there, and nothing grows or is recorded.

    Raises:
        SpecError: If the spec cannot be built.
        BundleError: If the folder is not an intact bundle.
        UnknownNameError: If there is no such algorithm or hyperparameter.
        TrainingError: If a setting is out of range, the infant observes nothing, or the folder holds another training
            run or anything else.
        OutputError: If a file cannot be written.
        MissingExtraError: If matplotlib is not installed, or what a recording needs.
        RecordingError: If the folder of the recording holds anything else.
        MimocError: If the infant cannot grow between these ages.

    Example:
        >>> import mimoc
        >>> short = {"n_steps": 64, "batch_size": 64}  # Much less than it takes to learn.
        >>> training = mimoc.train("reach.yaml", "runs/example", steps=64, envs=1, hyper=short)
        >>> training.curve.steps, training.policy.name
        (64, 'policy.zip')
    """
    refuse_on_device(device, grow=grow, record=record, threads=threads, processes=processes)
    custom, growth = _class_names(task, senses or {}), growth_settings(grow, schedule, grow_steps, steps)
    known = checkpoint_every, hyper or {}, custom, growth
    choose = partial(TrainingSettings.choose, algo, steps, seed)
    if world := world_of(source):
        refuse_in_world(device, processes)
        envs = -(-envs // len(world.infants)) * len(world.infants)
    choose(envs, *known, steps_per_episode, device)  # Fails now if a setting is out of range.
    bundle = world or pipeline.compiled(cast("Bundle", source))
    if isinstance(bundle, WorldBundle):
        open_one: Any = partial(open_world_copy, bundle, task, senses or {})
    else:
        open_one = partial(open_copy, open_variant(bundle), task, senses or {})
    require_matplotlib()  # Fails now, not after hours of training, if matplotlib is missing.
    with closing(open_one()) as env:
        infants: list[Any] = [*infants_of("train", env).values()]
        for one in infants:
            check_learnable(one)
        check_mixture(infants)
        infant = min(infants, key=lambda one: one.max_steps or math.inf)
        settings = choose(envs, *known, episode_limit(infant, steps_per_episode), device)
        _check_recordable(record, processes, [bundle] * (settings.envs // len(infants)))
        open_learner = choose_learner(settings, infant, bundle, open_one, threads, processes, record)
        session = Session(settings, open_learner, progress or (lambda *steps: None), on_row or (lambda row: None))
        with open_run_folder(out, settings, bundle, force=force, origin=origin) as folder, one_thread():
            return run_together([trained(folder, session)])[0]


@dataclass(frozen=True, slots=True)
class Session:
    """What a training has from its first interval to its last, besides its folder."""

    settings: TrainingSettings
    open_learner: LearnerOpener
    """Opens the parallel environments, and what learns from them."""
    report: ProgressCallback
    on_row: RowCallback


def _check_recordable(folder: str | Path | None, processes: bool | None, bundles: Sequence[Any]) -> None:
    """Check that a training can be recorded in a folder, if it is, before anything is written."""
    if folder is None:
        return
    if processes is not None:
        advice = "leave out --processes and --one-process, or the recording"
        raise TrainingError(f"a training is recorded with all environments together; {advice}")
    check_recordable(Path(folder).expanduser(), bundles)


def open_copy(
    infant: Variant,
    task: Any = None,
    senses: Mapping[str, Any] = MappingProxyType({}),
    variants: Variants | None = None,
    kind: type[InfantEnv] = InfantEnv,
) -> InfantEnv:
    """Open one of the parallel environments, with a copy of the model and of a script's objects of its own."""
    return kind(infant.again(), variants=variants, task=deepcopy(task), senses=deepcopy(dict(senses)))


def open_world_copy(
    world: WorldBundle, task: Any, senses: Mapping[str, Any], variants: WorldMaker | None = None
) -> WorldEnv:
    """Open one of the worlds, in which each infant has copies of a script's objects of its own."""
    tasks = {name: deepcopy(task) for name in world.infants} if task is not None else {}
    of_infants = {name: deepcopy(dict(senses)) for name in world.infants}
    return WorldEnv(world, tasks=tasks, senses=of_infants, variants=variants)


def _class_names(task: Any, senses: Mapping[str, Any]) -> dict[str, str]:
    """Return the class of each object that was passed, as `module:Class`."""
    classes = {f"senses.{name}": type(sense) for name, sense in senses.items()}
    classes |= {} if task is None else {"task": type(task)}
    return {name: f"{kind.__module__}:{kind.__qualname__}" for name, kind in classes.items()}


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit torch to one thread: faster for networks this small, and the same result on machines of any size."""
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)


def progress_in(folder: RunFolder) -> Progress:
    """Return how far the run in a folder is."""
    checkpoint = folder.read_checkpoint()
    with _naming_checkpoint_of(folder):
        return Progress() if checkpoint is None else read_progress(checkpoint)


async def trained(folder: RunFolder, session: Session) -> Training:
    """Train until the run in a folder has all its steps."""
    before = reached = progress_in(folder)
    use = None
    if before.steps < session.settings.steps:
        with session.open_learner() as learner:
            reached = await _train_to_end(folder, session, learner)
            use = await learner.use()
    _write_curve(folder, reached)
    return Training(reached.curve, folder.path / POLICY, before.steps, use)


async def _train_to_end(folder: RunFolder, session: Session, learner: Learner) -> Progress:
    """Train from the checkpoint in a folder, if there is one, to the end; write a checkpoint after each interval."""
    checkpoint, reached, plotted_s = folder.read_checkpoint(), Progress(), 0.0
    settings = session.settings
    if checkpoint is not None:
        with _naming_checkpoint_of(folder):
            reached = learner.restore(checkpoint)
    with tracked(folder.path, settings.data(), reached.steps) as logger:
        learner.log_to(logger)
        while reached.steps < settings.steps:
            reached = await _train_interval(folder, session, learner, reached)
            folder.write_checkpoint(reached.steps, learner.policy(), learner.checkpoint(reached))
            folder.write(CURVE, reached.curve.to_csv().encode())
            if reached.wall_s > plotted_s + PLOT_EVERY_S:
                folder.write(PICTURE, _plot(reached))
                plotted_s = reached.wall_s
    return reached


async def _train_interval(folder: RunFolder, session: Session, learner: Learner, before: Progress) -> Progress:
    """Train from one checkpoint to the next; if that is cut short, write what was learnt until then."""
    total = session.settings.steps
    try:
        await learner.learn(before, lambda done: session.report(min(done, total), total), session.on_row)
    except BaseException:  # Ctrl-C, or an error in a task of the user's own.
        with suppress(Exception):  # That one is what matters.
            if learner.has_learnt:
                folder.write(POLICY, learner.policy())
            _write_curve(folder, learner.progress())
        raise
    return learner.progress()


def _write_curve(folder: RunFolder, progress: Progress) -> None:
    folder.write(CURVE, progress.curve.to_csv().encode())
    folder.write(PICTURE, _plot(progress))


def _plot(progress: Progress) -> bytes:
    return encode(learning_sheet({"": [progress.curve.columns()]}))


@contextmanager
def _naming_checkpoint_of(folder: RunFolder) -> Iterator[None]:
    """Add the path of the checkpoint to an error."""
    try:
        yield
    except TrainingError as error:
        raise TrainingError(f"{folder.path / STATE}: {error}") from None
