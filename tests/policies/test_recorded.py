"""What infants do under a sum of policies is recorded, and comes out again."""

from pathlib import Path

import pytest

CONFIGS = Path(__file__).parents[2] / "configs"


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


@pytest.mark.parametrize(
    ("policy", "says"),
    [
        ("zero++random", "a policy is missing beside a '+'"),
        ("zero:3", "takes nothing after a colon"),
        ("reflexes:late", "expected by how many months they are late"),
    ],
)
def test_a_bad_policy_is_one_line_and_nothing_is_written(policy, says, tmp_path, invoke):
    recording = tmp_path / "recording"
    code, said, error = invoke("run", CONFIGS / "newborn.yaml", "--policy", policy, "--steps", 5, "--record", recording)
    assert (code, said, error.count("\n")) == (2, "", 1)
    assert says in error
    assert not recording.exists()
