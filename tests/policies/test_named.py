"""Names of policies, and sums of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import PolicyError, UnknownNameError
from mimoc.policies.named import policy_of
from mimoc.policies.rollout import Run
from mimoc.policies.spec import parse_policy, trained_policies, usage
from mimoc.schema.kinds import POLICIES, PolicyKind

CONFIGS = Path(__file__).parents[2] / "configs"
BIAS = PolicyKind("bias", "commands the same always", lambda env, text: Bias(float(text), env), argument="COMMAND")


class Bias:
    """Commands the same always."""

    steps_per_episode = 3

    def __init__(self, command, env):
        self.command, self.size, self.episodes = command, len(env.actuation.low), 0

    def __call__(self, generator, observation):
        return np.full(self.size, self.command, np.float32)

    def reset(self):
        self.episodes += 1

    def metrics(self):
        return {"command": self.command}


@pytest.fixture
def bias():
    mimoc.register(BIAS)
    yield BIAS
    POLICIES.remove("bias")


def commands(env, name, count=4, seed=0):
    generator, policy = np.random.default_rng(seed), policy_of(env, name)
    observation, _ = env.reset(seed=seed)
    return np.array([policy(generator, observation) for _ in range(count)])


@pytest.mark.parametrize("name", ["random+zero", "zero+random", "zero+random+zero"])
def test_zero_adds_nothing_to_the_bit(env, name):
    assert commands(env, name).tobytes() == commands(env, "random").tobytes()


def test_commands_add_and_are_clipped_to_their_ranges(env, bias):
    low, high = env.actuation.low, env.actuation.high
    expected = np.clip(commands(env, "random") + 0.5, low, high)
    assert commands(env, "random+bias:0.5") == pytest.approx(expected, abs=1e-6)


def test_policies_of_a_sum_draw_one_after_the_other(env):
    generator, (observation, _) = np.random.default_rng(0), env.reset(seed=0)
    random = policy_of(env, "random")
    expected = random(generator, observation).astype(float) + random(generator, observation)
    low, high = env.actuation.low, env.actuation.high
    assert commands(env, "random+random", 1)[0] == pytest.approx(np.clip(expected, low, high), abs=1e-6)


def test_an_episode_of_a_sum_ends_first_and_metrics_are_merged(env, bias):
    run = Run(env, "bias:0.1+bias:0.2+zero", seed=0)
    for _ in range(7):
        run.step()
    summary = run.summary()
    assert summary.finished == 2
    assert summary.metrics == {"bias_command": 0.1, "bias_2_command": 0.2}


def test_a_policy_is_reset_when_an_episode_begins(env, bias):
    kept = []
    run = Run(env, lambda env: kept.append(Bias(0.0, env)) or kept[0], seed=0)
    for _ in range(7):
        run.step()
    assert kept[0].episodes == 3


def test_a_trained_policy_can_be_part_of_a_sum(env):
    loaded = []

    def load(path):
        loaded.append(path)
        return lambda env: Bias(0.25, env)

    generator, (observation, _) = np.random.default_rng(0), env.reset(seed=0)
    action = policy_of(env, "runs/policy.zip+zero", load)(generator, observation)
    assert loaded == ["runs/policy.zip"]
    assert (action == np.float32(0.25)).all()


def test_paths_of_trained_policies_may_have_a_plus():
    assert trained_policies("runs/a+b/policy.zip") == ("runs/a+b/policy.zip",)
    assert trained_policies("random+one.zip+./b.zip") == ("one.zip", "./b.zip")
    assert trained_policies("random") == ()


@pytest.mark.parametrize(
    ("text", "error", "says"),
    [
        ("rnadom+zero", UnknownNameError, "'rnadom' is not a policy; did you mean 'random'"),
        ("random++zero", PolicyError, "'random\\+\\+zero': a policy is missing beside a '\\+'; write NAME\\+NAME"),
        ("random+", PolicyError, "a policy is missing beside a '\\+'"),
        ("zero:5", PolicyError, "'zero:5': the policy 'zero' takes nothing after a colon; write zero"),
        ("bias", PolicyError, "'bias': the policy 'bias' needs more than its name; write bias:COMMAND"),
        ("random+bias:", PolicyError, "'bias:': nothing stands after the colon; write bias:COMMAND"),
        ("", UnknownNameError, "'' is not a policy"),
        ("random+my.zip", PolicyError, "'my.zip': pass what mimoc.load_policy returns of it"),
    ],
)
def test_what_is_no_policy_is_one_line(env, bias, text, error, says):
    with pytest.raises(error, match=says) as raised:
        policy_of(env, text)
    assert "\n" not in str(raised.value)


def test_usage_says_what_stands_after_the_colon(bias):
    assert usage(bias) == "bias:COMMAND"
    assert usage(replace(bias, argument="TARGET[,HAND]")) == "bias:TARGET[,HAND]"
    assert usage(replace(bias, argument="[MONTHS]")) == "bias[:MONTHS]"
    assert [part.label for part in parse_policy("zero+bias:2")] == ["zero", "bias"]


@pytest.mark.slow
def test_general_movements_with_reflexes_are_recorded_and_replayed(tmp_path, invoke):
    spec = tmp_path / "infant.yaml"
    spec.write_text(
        "mimoc: 1\nname: infant\nage_months: 1\nactuation: {model: muscle}\n"
        "senses: {proprioception: {}, vestibular: {}, touch: {density: 0.3}}\nscene: {kind: flat, pose: supine}\n"
    )
    recording = tmp_path / "recording"
    policy = "general_movements+reflexes"
    assert invoke("run", spec, "--policy", policy, "--steps", 60, "--seed", 3, "--record", recording)[0] == 0
    code, said, _ = invoke("replay", recording)
    assert (code, said) == (0, "ok: all numbers of 1 episode, 60 control steps, came out again\n")


def test_a_bad_policy_is_one_line_and_nothing_is_written(tmp_path, invoke):
    spec, recording = CONFIGS / "newborn.yaml", tmp_path / "recording"
    code, said, error = invoke("run", spec, "--policy", "zero:3", "--steps", 5, "--record", recording)
    assert (code, said, error.count("\n")) == (2, "", 1)
    assert "takes nothing after a colon" in error
    assert not recording.exists()
