"""Checking what the steps of a cohort name, before anything is done: a mistake in one word would fail every job."""

from mimoc.errors import MimocError, MissingExtraError, SpecError, UnknownNameError
from mimoc.policies import POLICIES
from mimoc.schema.cohort_file import CohortSpec
from mimoc.schema.cohort_steps import ExperimentStep, RunStep, StepSpec, TrainStep, step_of
from mimoc.schema.source import Source


def check_steps(cohort: CohortSpec, source: Source) -> None:
    """Check that there are the policies, experiments and settings of trainings that the steps of a cohort name.

    Args:
        cohort: The cohort.
        source: Its file.

    Raises:
        SpecError: If some are unknown or impossible; the error lists all, with their places.
        MissingExtraError: If it trains, and Stable-Baselines3 is not installed.
    """
    problems = []
    for index, item in enumerate(cohort.do):
        name, step = step_of(item)
        try:
            _check(step)
        except MissingExtraError:
            raise
        except MimocError as error:
            problems.append(source.problem(("do", index, name), str(error)))
    if problems:
        raise SpecError(problems)


def _check(step: StepSpec) -> None:
    if isinstance(step, RunStep) and not step.policy.endswith(".zip"):
        POLICIES.find(step.policy)
    elif isinstance(step, ExperimentStep):
        from mimoc.experiments import EXPERIMENTS  # Takes time to import, in each process that does jobs.

        if step.name not in EXPERIMENTS:
            raise UnknownNameError("known experiment", step.name, EXPERIMENTS)
    elif isinstance(step, TrainStep):
        from mimoc.training.growth import growth_settings  # Needs Stable-Baselines3.
        from mimoc.training.settings import Settings

        growth_settings(step.grow, step.schedule, step.grow_steps, step.steps)
        settings = step.algo, step.steps, 0, step.envs, step.checkpoint_every, step.hyper
        Settings.choose(*settings, steps_per_episode=step.steps_per_episode)
