"""A component that others add is a record with a spec, `build` and `bind`: all else knows of it as of mimoc's own."""

from typing import Any

import gymnasium
import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from support.added_components import ADDED, TRIPLED
from support.registering import registered
from support.scenes_of_objects import drift_m, started

import mimoc
from mimoc.base.errors import SpecError
from mimoc.bundle.model import load_model
from mimoc.compiler.explain import entries_of, explain
from mimoc.schema.infant import read_spec
from mimoc.schema.json_schema import json_schema
from mimoc.schema.source import parse

TINY = {"n_steps": 32, "batch_size": 64, "n_epochs": 1, "width": 8, "layers": 1}


@pytest.fixture(scope="module", autouse=True)
def _registered():
    with registered(TRIPLED, *(added.record for added in ADDED.values())):
        yield


def spec_of(**keys: Any) -> mimoc.InfantSpec:
    usual = {"mimoc": 1, "name": "x", "age_months": 9, "senses": {"proprioception": {}}}
    return mimoc.InfantSpec.model_validate({**usual, **keys})


def built(what: str, **keys: Any) -> mimoc.Bundle:
    return mimoc.build(spec_of(**ADDED[what].keys, **keys))


@pytest.mark.parametrize("what", ADDED)
def test_it_is_built_and_gymnasium_has_nothing_against_it(what):
    bundle = built(what)
    check_env(mimoc.InfantEnv(bundle), skip_render_check=True)
    env = gymnasium.make("mimoc/Infant-v0", bundle=bundle)
    env.reset(seed=0)
    assert np.isfinite(env.step(env.action_space.sample())[1])


@pytest.mark.parametrize("what", ADDED)
def test_its_number_is_explained_and_the_bundle_says_that_it_is_not_mimocs_own(what):
    added, bundle = ADDED[what], built(what)
    explained = explain(bundle, added.number)
    assert explained.lines[0].startswith(added.told)
    assert explain(bundle, f"plugins.{added.plugin}").lines
    assert bundle.manifest.plugins == {added.plugin: ""}
    assert f"- '{added.plugin}' is a plug-in that a script registered" in bundle.files["README.md"].decode()
    assert not any(key.startswith("plugins.") for key in entries_of(mimoc.build(spec_of())))


HEAD = "mimoc: 1\nname: x\nage_months: 6\n"


@pytest.mark.parametrize(
    ("keys", "problem"),
    [
        ("task: {kind: lifd}", "task.kind: 'lifd' is not a choice; did you mean 'lift'"),
        ("task: {kind: lift, hand: left}", "task.hand: unknown key of 'lift'; remove it"),
        ("task: {kind: reach, body: head}", "task.body: unknown key of 'reach'; remove it (it belongs to lift)"),
        ("task: {kind: lift}\nscene: {kind: crib}", "task 'lift' requires scene.kind: flat"),
        ("senses: {height: {max_m: -1}}", "senses.height.max_m: -1 is too small"),
        ("senses: {height: {min_m: 0}}", "senses.height.min_m: unknown key"),
        ("senses: {height: {}}\ndelays: {height_ms: 3}", "delays.height_ms: "),
        ("senses: {height: {}}\nnoise: {height_m: 2}", "noise.height_m: 2 is too large; give 0 to 1 m"),
        ("scene: {kind: step, step: {height_m: 3}}", "scene.step.height_m: 3 is too large"),
        ("scene: {kind: stepp}", "did you mean 'step'"),
        ("actuation: {model: weak, weak: {shar: 1}}", "actuation.weak.shar: unknown key; did you mean 'share'"),
        ("scene: {objects: [{name: a, kind: stool, stool_cm: 2}]}", "[0].stool_cm: 2 is too small; give 5 to 60 cm"),
    ],
)
def test_the_spec_language_knows_it(keys, problem):
    with pytest.raises(mimoc.MimocError) as error:
        read_spec(parse(f"{HEAD}{keys}\n", "spec.yaml"))
    assert problem in str(error.value)


def test_a_task_judges_and_ends():
    bundle = built("task")
    assert (bundle.manifest.task.kind, bundle.manifest.step_ms) == ("lift", 20.0)
    env = mimoc.InfantEnv(bundle)
    env.reset(seed=0)
    ends = [env.step(env.action_space.low) for _ in range(4)]
    assert [truncated for *_, truncated, _ in ends] == [False, False, False, True]
    assert ends[0][1] == pytest.approx(sum(ends[0][4]["reward_terms"].values()))
    assert ends[0][4]["reward_terms"]["effort"] == pytest.approx(-env.action_space.shape[0])


def test_what_a_task_changes_in_the_model_is_part_of_a_state():
    bundle = built("task")
    first, other = mimoc.InfantEnv(bundle), mimoc.InfantEnv(bundle)
    first.reset(seed=1)
    other.reset(seed=2)
    head = first.model.body("head").id
    assert first.model.body_gravcomp[head] != other.model.body_gravcomp[head]
    other.set_state(first.get_state())
    assert first.model.body_gravcomp[head] == other.model.body_gravcomp[head]


@pytest.mark.extras
@pytest.mark.slow
@pytest.mark.parametrize("keys", [ADDED["task"].keys, {**ADDED["actuation"].keys, "task": {"kind": "reach"}}])
def test_a_policy_is_trained_with_it(keys, tmp_path):
    bundle = mimoc.build(spec_of(**{**keys, "task": {**keys["task"], "steps": 30}}))
    options = {"steps": 64, "envs": 2, "checkpoint_every": 64, "hyper": TINY, "processes": False}
    training = mimoc.train(bundle, tmp_path / "run", **options)
    (episode,) = mimoc.evaluate(mimoc.make(bundle), mimoc.load_policy(training.policy), episodes=1)
    assert 0 < episode.steps <= 30


def heights(count: int, command: float = 0.0, **keys: Any) -> list[float]:
    env = mimoc.InfantEnv(built("sense", age_months=12, **keys))
    env.reset(seed=0)
    action = np.full(env.action_space.shape, command, np.float32)
    return [float(env.step(action)[0]["height"][0]) for _ in range(count)]


def test_a_sense_is_observed_in_its_unit_and_within_its_bounds():
    env = mimoc.InfantEnv(built("sense"))
    observation, _ = env.reset(seed=0)
    assert observation["height"] == pytest.approx(env.data.geom("head").xpos[2])
    assert env.layout("height") == ("head [m]",)
    assert env.observation_space["height"].high == [1.5]


def test_a_sense_is_late_by_its_own_delay_in_whole_physics_steps():
    prompt, late = (heights(12, 1.0, delays={"height_ms": ms}) for ms in (0, 40))
    assert late[4:] == prompt[:-4]
    assert len(set(prompt)) == len(prompt)
    delayed = built("sense", delays={"height_ms": 40})
    assert entries_of(delayed)["delays.height.ms"]["from"] == ["spec.delays.height_ms"]


def test_a_preset_knows_the_delay_of_a_sense_at_an_age():
    """The delay of the legs does not matter to a sense that does not say in which bodies it measures."""
    preset = {"preset": "physiological"}
    delays = built("sense", age_months=12, delays=preset).manifest.delays.height
    assert (delays.ms, delays.legs_ms) == (40, 60)
    assert heights(12, delays=preset)[4:] == heights(12)[:-4]


def test_a_sense_has_the_noise_of_its_record_and_the_jitter_of_all():
    noisy = built("sense", noise={"height_m": 0.0625})
    assert noisy.manifest.noise.height_m == 0.0625
    assert explain(noisy, "noise.height_m").lines[0].endswith("0.0625 m")
    errors = np.subtract(heights(12, noise={"height_m": 0.0625}), heights(12))
    assert set(np.round(errors, 6)) == {-0.0625, 0.0625}
    late = {"delays": {"height_ms": 20}}
    assert heights(40, noise={"delay_jitter_ms": 20}, **late) != heights(40, **late)


def test_a_scene_has_toys_on_its_floor_and_no_footprint_without_them():
    bundle = built("scene")
    assert load_model(bundle).geom("step").size.tolist() == [0.2, 0.5, 0.1]
    assert len(bundle.manifest.toys) == 2
    mimoc.build(spec_of(scene={"kind": "step"}))


def test_toys_of_a_source_are_as_heavy_as_its_keys_say_and_it_may_note_something():
    bundle = built("toys")
    masses_kg = {"brick": 500 * 0.1 * 0.05**2, "plank": 500 * 0.1 * 0.02**2}
    assert len(bundle.manifest.toys) == 3
    for toy in bundle.manifest.toys:
        assert toy.mass_kg == pytest.approx(masses_kg[toy.object])
        assert explain(bundle, f"toy.{toy.body}.mass").lines
    assert "- the bricks are made of wood" in bundle.files["README.md"].decode()


def test_an_unknown_toy_of_a_source_is_pointed_at(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text(f"{HEAD}scene:\n  toys: {{source: bricks, subset: [brick, plunk]}}\n")
    with pytest.raises(SpecError, match=r":5:42: scene\.toys\.subset\[1\]: 'plunk' is no brick; did you mean 'plank'"):
        mimoc.build(path)


@pytest.mark.full
def test_the_strength_of_an_actuation_follows_what_was_asked():
    torques = mimoc.torque_limits(mimoc.build(spec_of(age_months=18, actuation={"model": "torque"})))
    for joint, limits_nm in mimoc.torque_limits(built("actuation")).items():
        assert limits_nm == pytest.approx(0.25 * np.array(torques[joint])), joint


def test_the_effort_of_an_actuation_is_between_nothing_and_all():
    env = mimoc.InfantEnv(built("actuation"))
    env.reset(seed=0)
    env.step(env.action_space.high)
    assert 0 < env.effort() < 1


def test_numbers_of_an_actuation_are_explained_whether_it_says_so_or_not():
    weak = built("actuation")
    first, second = (actuator.name for actuator in weak.manifest.actuation.actuators[:2])
    assert "as measured" in explain(weak, f"actuator.{first}.forcerange").lines
    assert "set by the actuation model 'weak'" in explain(weak, f"actuator.{second}.forcerange").lines
    assert not [line for line in explain(weak, "actuator.act:left_elbow.gear").lines if "xml" in line]


def test_proprioception_asks_an_actuation_for_its_drive():
    """Here nothing in the MJCF limits the torque, and the bounds of the observation are the same at every age."""
    actuation = {"model": "tripled", "regions": ["arms"]}
    env = mimoc.InfantEnv(
        mimoc.build(spec_of(senses={"proprioception": {"include": ["actuation"]}}, actuation=actuation))
    )
    env.reset(seed=0)
    sensed, actuators = env.step(env.action_space.high)[0]["proprioception"], env.manifest.actuation.actuators
    felt = dict(zip(env.layout("proprioception"), sensed, strict=True))
    for actuator in actuators:
        assert felt[f"{actuator.name} excitation [1]"] == float(actuator.commanded)
        torque_nm = 3 * env.model.actuator(actuator.name).gear[0] if actuator.commanded else 0.0
        assert felt[f"{actuator.name} torque [N m]"] == pytest.approx(torque_nm)


def test_an_actuation_is_built_for_mimos_code_with_its_actuators_as_they_are():
    spec = spec_of(**ADDED["actuation"].keys)
    model, other = load_model(mimoc.build(spec)), load_model(mimoc.build(spec, "mimo"))
    names = [model.actuator(index).name for index in range(model.nu)]
    assert [other.actuator(name).gear[0] for name in names] == [model.actuator(name).gear[0] for name in names]


def test_inverse_dynamics_says_why_it_cannot_use_an_actuation():
    env = mimoc.InfantEnv(built("actuation"))
    with pytest.raises(mimoc.MimocError, match="which the actuation model 'weak' does not accept"):
        mimoc.InverseDynamics(env.model, env.data, env.manifest)


def test_an_object_is_placed_bears_others_and_is_in_the_schema():
    bundle = built("object", body={"skin": False})
    entry, cup = bundle.manifest.objects
    assert (entry.kind, entry.motion, entry.joint) == ("stool", "fixed", None)
    model, data = started(bundle)
    np.testing.assert_allclose(data.body(entry.body).xpos, (0.6, 0.0, 0.06))
    assert data.body(cup.body).xpos[2] - cup.origin_m == pytest.approx(0.12)
    mujoco.mj_step(model, data, 300)
    assert drift_m(bundle, model, data) < 1e-3
    assert "StoolSpec" in json_schema()["$defs"]
