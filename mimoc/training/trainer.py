"""Training in intervals between checkpoints, which can be interrupted at any time and resumed."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, closing, contextmanager, suppress
from copy import deepcopy
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, Protocol, cast

import torch
from stable_baselines3.common.logger import Logger

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import TrainingError
from mimoc.bundle.io import Bundle
from mimoc.bundle.variants import Variant, Variants, WorldMaker, open_variant
from mimoc.bundle.world import WorldBundle
from mimoc.compiler import building
from mimoc.compiler.worlds import world_of
from mimoc.recording.folder import check_recordable
from mimoc.render.plots import encode, learning_sheet, require_matplotlib
from mimoc.runtime.batch_env import infants_of
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.gymnasium_forms import check_mixture
from mimoc.runtime.world_env import WorldEnv
from mimoc.schema.infant import InfantSpec
from mimoc.schema.world import WorldPlan
from mimoc.training.agents import sb3_learner
from mimoc.training.checkpoint import Progress, read_progress
from mimoc.training.curve import Curve, CurvePoint, DeviceUse
from mimoc.training.run_folder import CURVE, PICTURE, POLICY, STATE, RunFolder, open_run_folder
from mimoc.training.settings import CPU, Number, TrainingSettings, check_learnable, episode_limit
from mimoc.training.tracking import tracked
from mimoc.training.vector_env import growth_of, growth_settings, normalized, rows_together


class Learner(Protocol):
    """An agent and its environments, which learn from one checkpoint to the next."""

    @property
    def has_learnt(self) -> bool:
        """Whether it was updated since it was made or restored."""
        ...

    def log_to(self, logger: Logger) -> None:
        """Tell a logger what is learnt from now on."""

    def restore(self, checkpoint: bytes) -> Progress:
        """Restore a checkpoint, and return the progress at that point."""
        ...

    def begin(self, before: Progress, report: Callable[[int], None], on_row: Callable[[CurvePoint], None]) -> None:
        """Begin an interval; *report* gets the steps so far, *on_row* each new row of the curve."""

    def learn(self, others: Sequence[Any] = ()) -> None:
        """Learn until the end of the interval, in lock-step with others on the same device."""

    def progress(self) -> Progress:
        """Return the progress at the end of what was learnt last, or where that was interrupted."""
        ...

    def policy(self) -> bytes:
        """Return the content of the file of its policy."""
        ...

    def checkpoint(self, reached: Progress) -> bytes:
        """Return the content of a checkpoint file."""
        ...

    def use(self, others: Sequence[Any] = ()) -> list[DeviceUse | None]:
        """Return what it and others took of their device, and what each policy does there; None on the CPU."""
        ...


LearnerOpener = Callable[[], AbstractContextManager[Sequence[Learner]]]
"""Opens the environments of training runs, and a learner for each run."""


def choose_learner(
    settings: TrainingSettings,
    infant: InfantEnv,
    bundle: Bundle | WorldBundle,
    open_one: Callable[..., Any],
    threads: int | None,
    processes: bool | None,
    record: str | Path | None,
) -> LearnerOpener:
    """Return what opens the parallel environments of a training, and what learns from them; see `train`."""
    if settings.device != CPU:
        from mimoc.training.device_learner import check_on_device, device_learners

        check_on_device(settings.device, infant)
        return partial(device_learners, [settings], [infant], [open_one])
    growth = growth_of(bundle, settings)
    infants = len(bundle.infants) if isinstance(bundle, WorldBundle) else 1
    open_rows = partial(rows_together, open_one, settings, growth, threads, processes, infants)
    open_envs = partial(normalized, open_rows, settings)
    return partial(sb3_learner, settings, infant, open_envs, record)


ONLY_ON_CPU = {
    "grow": "infants do not grow in a training on a device; leave out --grow, or --device",
    "record": "a training on a device is not recorded; leave out --record, or --device",
    "threads": "threads are for infants on the CPU; leave out --threads, or --device",
    "processes": "processes are for infants on the CPU; leave out --processes and --one-process, or --device",
}


def refuse_on_device(device: str, **options: Any) -> None:
    """Check that a device is there, and that nothing is asked for that cannot be on one."""
    if device == CPU:
        return
    for name, value in options.items():
        if value is not None:
            raise TrainingError(ONLY_ON_CPU[name])
    from mimoc.runtime.device.signals import find_device
    from mimoc.training import rsl_rl_env  # noqa: F401 - It says if rsl_rl is missing.

    find_device(device.removeprefix("warp:"))


Source = Bundle | InfantSpec | WorldBundle | WorldPlan | Mapping[str, InfantSpec] | str | Path
ProgressCallback = Callable[[int, int], None]
RowCallback = Callable[[CurvePoint], None]

STEPS = 500_000  # Training steps in the paper.
ENVS = 8
PLOT_EVERY_S = 60.0  # Minimum time between plots of the curve: plotting takes longer than saving a checkpoint.


@dataclass(frozen=True, slots=True)
class Training:
    """The result of a training run."""

    curve: Curve
    policy: Path
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
    world = world_of(source)
    if world:
        if device != CPU:
            raise TrainingError("worlds with several infants are simulated on the CPU; leave out --device")
        if processes is not None:
            raise TrainingError("worlds of a training are in one process; leave out --processes and --one-process")
        envs = -(-envs // len(world.infants)) * len(world.infants)
    objects = {f"senses.{name}": sense for name, sense in (senses or {}).items()}
    objects |= {} if task is None else {"task": task}
    custom = {name: f"{type(part).__module__}:{type(part).__qualname__}" for name, part in objects.items()}
    growth = growth_settings(grow, schedule, grow_steps, steps)
    choose = partial(TrainingSettings.choose, algo, steps, seed, envs, checkpoint_every, hyper or {}, custom, growth)
    choose(steps_per_episode, device)  # Fails now if a setting is out of range.
    bundle = world or building.compiled(cast("Bundle", source))
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
        settings = choose(episode_limit(infant, steps_per_episode), device)
        if record is not None:
            if processes is not None:
                advice = "leave out --processes and --one-process, or the recording"
                raise TrainingError(f"a training is recorded with all environments together; {advice}")
            check_recordable(Path(record).expanduser(), [bundle] * (settings.envs // len(infants)))
        open_learner = choose_learner(settings, infant, bundle, open_one, threads, processes, record)
        with open_run_folder(out, settings, bundle, force=force, origin=origin) as folder:
            run = Run(folder, settings, progress or (lambda *steps: None), on_row or (lambda row: None))
            return train_to_end([run], lambda unfinished: open_learner())[0]


@dataclass(frozen=True)
class TrainingJob:
    """A training to be done."""

    source: Bundle | InfantSpec
    out: Path
    seed: int = 0


def train_together(
    jobs: Sequence[TrainingJob],
    device: str,
    *,
    steps: int,
    envs: int,
    hyper: Mapping[str, Number] | None = None,
    checkpoint_every: int | None = None,
    progress: ProgressCallback = lambda done, total: None,
) -> list[Training]:
    """Train a policy for each of several infants on a device, where all of them step at once.

    A simulation of thousands takes little longer for four ages than for one, and each policy learns from fewer infants
    at a time, more often. Each training is what `train` does with the same settings, and has the same folder; where one
    was interrupted, all go on.

    Raises:
        MimocError: As `train` does, and `make_vec` for infants that cannot live in one batch.
    """
    refuse_on_device(device)
    require_matplotlib()
    from mimoc.training.device_learner import check_on_device, device_learners

    def count(run: int, done: int, total: int) -> None:
        steps_done[run] = done
        progress(sum(steps_done), total * len(jobs))

    runs = list[Run]()
    infants = list[InfantEnv]()
    openers = list[Callable[..., InfantEnv]]()
    with ExitStack() as opened:
        for number, job in enumerate(jobs):
            bundle = building.compiled(job.source)
            openers.append(partial(open_copy, open_variant(bundle)))
            infants.append(opened.enter_context(closing(openers[-1]())))
            check_learnable(infants[-1])
            check_on_device(device, infants[-1])
            limit = episode_limit(infants[-1], None)
            settings = TrainingSettings.choose(
                *("ppo", steps, job.seed, envs, checkpoint_every, hyper or {}), steps_per_episode=limit, device=device
            )
            folder = opened.enter_context(open_run_folder(job.out, settings, bundle, force=False))
            runs.append(Run(folder, settings, partial(count, number), lambda row: None))
        steps_done = [run.reached.steps for run in runs]

        def open_learners(unfinished: Sequence[Run]) -> AbstractContextManager[Sequence[Learner]]:
            places = [runs.index(run) for run in unfinished]
            chosen = [run.settings for run in unfinished]
            return device_learners(chosen, [infants[place] for place in places], [openers[place] for place in places])

        return train_to_end(runs, open_learners)


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


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit torch to one thread: faster for networks this small, and the same result on machines of any size."""
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)


class Run:
    """A training run whose folder is open, and how far it is."""

    def __init__(
        self, folder: RunFolder, settings: TrainingSettings, report: ProgressCallback, on_row: RowCallback
    ) -> None:
        """Read the progress in a folder; *report* gets the steps done and their total, *on_row* each new row."""
        self.folder, self.settings, self._report, self.on_row = folder, settings, report, on_row
        self.reached = Progress()
        """Progress at the last checkpoint."""
        self.checkpoint = folder.read_checkpoint()
        """The checkpoint to resume from; None if there is none yet."""
        if self.checkpoint is not None:
            with _naming_checkpoint_of(folder):
                self.reached = read_progress(self.checkpoint)
        self._plotted_s = 0.0

    @property
    def is_finished(self) -> bool:
        """Whether it has all its steps."""
        return self.reached.steps >= self.settings.steps

    def report(self, steps: int) -> None:
        """Report the control steps done so far."""
        self._report(min(steps, self.settings.steps), self.settings.steps)

    def write_checkpoint(self, learner: Learner) -> None:
        """Write what was learnt until the end of an interval."""
        self.reached = learner.progress()
        self.folder.write_checkpoint(self.reached.steps, learner.policy(), learner.checkpoint(self.reached))
        self.folder.write(CURVE, self.reached.curve.to_csv().encode())
        if self.reached.wall_s > self._plotted_s + PLOT_EVERY_S:
            self.folder.write(PICTURE, _plot(self.reached))
            self._plotted_s = self.reached.wall_s

    def write_interrupted(self, learner: Learner) -> None:
        """Write the policy and the curve where an interval was interrupted; errors on the way are passed over."""
        with suppress(Exception):  # What has interrupted it is what matters.
            if learner.has_learnt:
                self.folder.write(POLICY, learner.policy())
            _write_curve(self.folder, learner.progress())


def train_to_end(
    runs: Sequence[Run], open_learners: Callable[[Sequence[Run]], AbstractContextManager[Sequence[Learner]]]
) -> list[Training]:
    """Train runs side by side until each has all its steps, with the learners that are opened for unfinished runs."""
    resumed_at = [run.reached.steps for run in runs]
    uses = dict[int, DeviceUse | None]()
    if unfinished := [run for run in runs if not run.is_finished]:
        with one_thread(), open_learners(unfinished) as learners:
            _learn_to_end(unfinished, learners)
            uses = dict(zip(map(id, unfinished), learners[0].use(learners[1:]), strict=True))
    for run in runs:
        _write_curve(run.folder, run.reached)
    return [
        Training(run.reached.curve, run.folder.path / POLICY, start, uses.get(id(run)))
        for run, start in zip(runs, resumed_at, strict=True)
    ]


def _learn_to_end(runs: Sequence[Run], learners: Sequence[Learner]) -> None:
    """Go on from the checkpoints in the folders; write checkpoints after each interval.

    If an interval is cut short, write what was learnt until then.
    """
    learning = list(zip(runs, learners, strict=True))
    with ExitStack() as opened:
        for run, learner in learning:
            if run.checkpoint is not None:
                with _naming_checkpoint_of(run.folder):
                    learner.restore(run.checkpoint)
                run.checkpoint = None
            logger = opened.enter_context(tracked(run.folder.path, run.settings.data(), run.reached.steps))
            learner.log_to(logger)
        while learning := [(run, learner) for run, learner in learning if not run.is_finished]:
            try:
                for run, learner in learning:
                    learner.begin(run.reached, run.report, run.on_row)
                first, *others = (learner for _, learner in learning)
                first.learn(others)
            except BaseException:  # Ctrl-C, or an error in a task of the user's own.
                for run, learner in learning:
                    run.write_interrupted(learner)
                raise
            for run, learner in learning:
                run.write_checkpoint(learner)


def _write_curve(folder: RunFolder, progress: Progress) -> None:
    folder.write(CURVE, progress.curve.to_csv().encode())
    folder.write(PICTURE, _plot(progress))


def _plot(progress: Progress) -> bytes:
    return encode(learning_sheet({"": [progress.curve.columns()]}))


@contextmanager
def _naming_checkpoint_of(folder: RunFolder) -> Iterator[None]:
    try:
        yield
    except TrainingError as error:
        raise TrainingError(f"{folder.path / STATE}: {error}") from None
