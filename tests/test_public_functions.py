"""Every public function takes each kind of environment, or says in one line why not."""

from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from typing import Any

import gymnasium
import pytest
from contracts.capabilities import functions_of
from contracts.kinds import MANY, ONE, WORLD, WORLDS
from gymnasium.error import ClosedEnvironmentError

import mimoc
from mimoc.base.errors import MissingExtraError

SPEC = mimoc.InfantSpec(mimoc=1, name="kim", age_months=9, senses={"proprioception": {}})
NONE = "no environment is given to it"


def _call(name: str, env: Any) -> Any:
    return getattr(mimoc, name)(env)


TAKE_IT_ALONE = (
    *("InfantEnv", "Posture", "build", "build_world", "contacts_and_gaze", "load_policy", "load_spec"),
    *("make", "make_parallel", "make_vec", "measure_movement", "measure_recordings", "read_bundle"),
    *("read_cohort", "read_points", "read_recording", "read_retargeted", "read_world_bundle", "register"),
    *("retarget", "sb3_vec_env", "torque_limits", "validate_milestones", "validate_movement"),
    *("verify_bench", "view", "world_vec_env"),
)
USES: dict[str, str | Callable[[Any], Any]] = {  # What each public name does with an environment, or that it gets none.
    **dict.fromkeys(("Camera", "Caregiver", "Cohort", "Companion", "Gains", "InfantSpec", "Judgement"), NONE),
    **dict.fromkeys(("MimocError", "PointRecording", "Task", "Term", "Verdict", "View", "__version__"), NONE),
    **dict.fromkeys(("Bundle", "WorldBundle", "growth_schedule"), NONE),
    **{name: partial(_call, name) for name in TAKE_IT_ALONE},
    "GazeTask": lambda env: mimoc.GazeTask("eye_left", env),
    "GrowthWrapper": lambda env: mimoc.GrowthWrapper(env, lambda steps: 9.0),
    "InverseDynamics": lambda env: mimoc.InverseDynamics(env, env, env),
    "OrientationTask": lambda env: mimoc.OrientationTask("head", env),
    "PositionTask": lambda env: mimoc.PositionTask("right_hand", env),
    "Recorder": lambda env: mimoc.Recorder(env, f"recorded_{id(env)}").recording.close(),
    "evaluate": lambda env: mimoc.evaluate(env, "random", episodes=1, steps_per_episode=2),
    "export_recording": lambda env: mimoc.export_recording(env, "csv", "exported"),
    "policy_vec": lambda env: mimoc.policy_vec("random", env),
    "record": lambda env: mimoc.record(env, "random", "film.gif", steps=1, height_px=48),
    "replay_recording": lambda env: list(mimoc.replay_recording(env)),
    "report": lambda env: mimoc.report(env, "report.html"),
    "rsl_rl_env": lambda env: mimoc.rsl_rl_env([env]),
    "run_bench": lambda env: mimoc.run_bench(env, "results.json"),
    "run_experiment": lambda env: mimoc.run_experiment(env, "experiment"),
    "train": lambda env: mimoc.train(env, "run"),
    "write_bundle": lambda env: mimoc.write_bundle(env, "written"),
    "write_points": lambda env: mimoc.write_points(env, "points.csv"),
    "write_retargeted": lambda env: mimoc.write_retargeted(env, "retargeted"),
}

KINDS = {"one": ONE, "wrapped": ONE, "many": MANY, "a world": WORLD, "many worlds": WORLDS}
CLOSED = {"closed": {"GrowthWrapper", "policy_vec", "view"}, "many that are closed": {"policy_vec", "view"}}
"""What works with environments that are closed; all else says why it does not."""
MISSING = "a library is missing"


def closed(env: Any) -> Any:
    env.close()
    return env


@pytest.fixture(scope="module")
def environments() -> Iterator[dict[str, Any]]:
    bundle = mimoc.build(SPEC)
    kinds = {
        "one": mimoc.InfantEnv(bundle),
        "wrapped": gymnasium.wrappers.FlattenObservation(mimoc.make(bundle, max_episode_steps=5)),
        "many": mimoc.make_vec(bundle, 2),
        "a world": mimoc.make_parallel({"anna": SPEC, "ben": SPEC}),
        "many worlds": mimoc.make_vec({"anna": SPEC, "ben": SPEC}, 4),
        "closed": closed(mimoc.make(bundle)),
        "many that are closed": closed(mimoc.make_vec(bundle, 2)),
        "somebody else's": gymnasium.make("CartPole-v1"),
    }
    yield kinds
    for env in kinds.values():
        with suppress(Exception):
            env.close()


def test_no_public_name_is_forgotten():
    assert sorted(USES) == sorted(mimoc.__all__)


@pytest.mark.parametrize("name", sorted(name for name, use in USES.items() if use is not NONE))
def test_it_works_or_says_in_one_line_why_not(environments, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    use: Any = USES[name]
    for kind, env in environments.items():
        works = functions_of(KINDS[kind]) if kind in KINDS else CLOSED.get(kind, set())
        if name != "view" or name not in works:  # Pages take seconds, and are tested elsewhere.
            said = reason(use, env)
            assert (said is None) == (name in works) or said == MISSING, f"{name} of {kind}: {said}"


def reason(use: Callable[[Any], Any], env: Any) -> str | None:
    """Return why something does not work, in one line that a user can act on; None if it does."""
    try:
        use(env)
    except MissingExtraError:
        return MISSING
    except (mimoc.MimocError, TypeError, ClosedEnvironmentError) as error:
        said = str(error)
    else:
        return None
    is_sentence = "\n" not in said and len(said.split()) > 4
    is_raw = "object has no attribute" in said or "os.PathLike" in said
    return said if is_sentence and not is_raw else pytest.fail(said)
