"""Trainings of a skill on a device, all ages and seeds side by side, measured on the CPU."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from mimoc.base.errors import SpecError
from mimoc.compiler import pipeline
from mimoc.runtime.opening.environments import open_infant
from mimoc.schema.infant import InfantSpec
from mimoc.studies.jobs import Progress, run_jobs
from mimoc.studies.skills.search import FIRST_TEST, Attempt, Job, problem_of
from mimoc.training import Training, evaluate, load_policy
from mimoc.training.trainer import TrainingJob, train_together

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
) -> Iterator[tuple[int, Attempt]]:
    """Train policies for infants with seeds on a device side by side; yield the place of each and what came of it."""
    wanted, names = dict[int, TrainingJob](), dict[int, str]()
    for place, (spec, seed) in enumerate(jobs):
        try:
            infant = pipeline.compiled(while_learning(spec))
        except SpecError as error:
            attempt = Attempt(age_months=spec.age_months, seed=seed, success=0.0, starts=starts)
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


def _measured(spec: InfantSpec, seed: int, name: str, training: Training, starts: int) -> Attempt:
    env = open_infant(spec)
    episodes = evaluate(env, load_policy(training.policy), episodes=starts, seed=FIRST_TEST)
    env.close()
    return Attempt(
        age_months=spec.age_months,
        seed=seed,
        success=sum(episode.success for episode in episodes) / starts,
        starts=starts,
        tried=training.curve.steps,
        curve=tuple(np.nan_to_num(training.curve.column("success_rate")).round(4).tolist()),
        policy=f"{name}/policy.zip",
        success_on_device=training.use.success if training.use else None,
    )
