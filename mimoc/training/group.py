"""Trainings of several infants on one device, side by side."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from mimoc.bundle.io import Bundle
from mimoc.bundle.variants import open_variant
from mimoc.compiler import pipeline
from mimoc.render.plots.file import require_matplotlib
from mimoc.runtime.env import InfantEnv
from mimoc.schema.infant import InfantSpec
from mimoc.training.device_learner import DeviceLearner, check_on_device, shared_device
from mimoc.training.learner_choice import refuse_on_device
from mimoc.training.run_folder import RunFolder, open_run_folder
from mimoc.training.settings import Number, TrainingSettings, check_learnable, episode_limit
from mimoc.training.shares import Share
from mimoc.training.together import run_together
from mimoc.training.trainer import Session, Training, one_thread, open_copy, progress_in, trained


@dataclass(frozen=True)
class Wish:
    """A training that is wished for."""

    source: Bundle | InfantSpec
    out: Path
    seed: int = 0


def train_together(
    wishes: Sequence[Wish],
    device: str,
    *,
    steps: int,
    envs: int,
    hyper: Mapping[str, Number] | None = None,
    checkpoint_every: int | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> list[Training]:
    """Train a policy for each of some infants on a device, where all of them step at once.

    A simulation of thousands takes little longer for four ages than for one, and each policy learns from fewer infants
    at a time, more often. Each training is what `train` does with the same settings, and has the same folder; where one
    was interrupted, all go on.

    Raises:
        MimocError: As `train` does, and `make_vec` for infants that cannot live in one batch.
    """
    choose = partial(
        TrainingSettings.choose, "ppo", steps, envs=envs, checkpoint_every=checkpoint_every, hyper=hyper or {}
    )
    refuse_on_device(device)
    require_matplotlib()
    with ExitStack() as opened:
        runs = [opened.enter_context(_opened(wish, device, partial(choose, seed=wish.seed))) for wish in wishes]
        if unfinished := [run for run in runs if run.done < steps]:
            openers = [run.open_one for run in unfinished]
            shares = opened.enter_context(shared_device(unfinished[0].settings, openers))
            for run, share in zip(unfinished, shares, strict=True):
                run.share = share

        def report() -> None:
            progress(sum(run.done for run in runs), steps * len(runs))

        with one_thread():
            return run_together([trained(run.folder, run.session(report)) for run in runs])


@dataclass
class _Run:
    """A training whose folder and infant are open."""

    folder: RunFolder
    settings: TrainingSettings
    infant: InfantEnv
    open_one: Callable[..., InfantEnv]
    done: int
    share: Share | None = None
    """Its infants on the device; None if it is finished."""

    def session(self, report: Callable[[], None]) -> Session:

        def count(done: int, _: int) -> None:
            self.done = done
            report()

        return Session(self.settings, self._open_learner, count, lambda row: None)

    @contextmanager
    def _open_learner(self) -> Iterator[DeviceLearner]:
        if self.share is not None:
            yield DeviceLearner(self.settings, self.infant, self.share)


@contextmanager
def _opened(wish: Wish, device: str, choose: Callable[..., TrainingSettings]) -> Iterator[_Run]:
    bundle = pipeline.compiled(wish.source)
    open_one = partial(open_copy, open_variant(bundle))
    with closing(open_one()) as infant:
        check_learnable(infant)
        check_on_device(device, infant)
        settings = choose(steps_per_episode=episode_limit(infant, None), device=device)
        with open_run_folder(wish.out, settings, bundle, force=False, origin=None) as folder:
            yield _Run(folder, settings, infant, open_one, progress_in(folder).steps)
