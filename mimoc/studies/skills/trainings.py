"""Trainings of a skill on a device, measured on the CPU."""

from pathlib import Path

import numpy as np

from mimoc.base.errors import SpecError
from mimoc.environments import open_infant
from mimoc.schema.infant import InfantSpec
from mimoc.studies.skills.attempt import Attempt, problem_of
from mimoc.studies.skills.search import FIRST_TEST
from mimoc.training import evaluate, load_policy, train


def trained(spec: InfantSpec, seed: int, steps: int, starts: int, device: str, out: str) -> Attempt:
    """Return what comes of a training on a device, measured on the CPU."""
    run = f"trainings/{spec.age_months:g}_months_{seed}"
    try:
        training = train(spec, Path(out) / run, steps=steps, seed=seed, device=device)
    except SpecError as error:
        return Attempt(age_months=spec.age_months, seed=seed, success=0.0, starts=starts, problem=problem_of(error))
    env = open_infant(spec)
    episodes = evaluate(env, load_policy(training.policy), episodes=starts, seed=FIRST_TEST)
    env.close()
    success = sum(episode.success for episode in episodes) / starts
    curve = tuple(np.nan_to_num(training.curve.column("success_rate")).round(4).tolist())
    made = {"tried": training.curve.steps, "curve": curve, "policy": f"{run}/policy.zip"}
    return Attempt(age_months=spec.age_months, seed=seed, success=success, starts=starts, **made)
