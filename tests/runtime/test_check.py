import dataclasses
import re

import numpy as np
import pytest

from mimoc.base.errors import ModelError
from mimoc.bundle.model import load_model
from mimoc.runtime.check import COMMANDS, MAX_BEYOND_DEG, MAX_ENERGY_J_PER_KG, PoseCheck, check_stability


def changed(bundle, pattern, replacement):
    """Return a bundle whose body says something else."""
    body, count = re.subn(pattern, replacement, bundle.files["scene.xml"].decode())
    assert count
    return dataclasses.replace(bundle, files={**bundle.files, "scene.xml": body.encode()})


@pytest.mark.matrix
def test_every_config_stays_calm_in_every_pose(config):
    for check in check_stability(config):
        assert check.passed
        assert check.warnings == ()
        assert 0 < check.energy_j_per_kg < MAX_ENERGY_J_PER_KG / 2
        assert check.beyond_deg < MAX_BEYOND_DEG / 1.3


def test_a_body_that_explodes_fails_quietly(bundle, capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    explosive = changed(bundle, 'gear="[^"]+"', 'gear="1e9"')
    checks = list(check_stability(explosive))
    assert not any(check.passed for check in checks)
    assert all(set(check.warnings) & {"BADQPOS", "BADQVEL", "BADQACC"} for check in checks)
    assert capfd.readouterr() == ("", "")
    assert not list(tmp_path.iterdir())


def test_a_body_that_is_far_too_strong_fails(bundle):
    strong = changed(bundle, 'gear="([^"]+)"', lambda gear: f'gear="{30 * float(gear[1])}"')
    assert not all(check.passed for check in check_stability(strong))


def test_the_same_bundle_is_judged_the_same(bundle):
    assert list(check_stability(bundle)) == list(check_stability(bundle))


def test_a_bundle_that_does_not_compile_is_an_error(bundle):
    with pytest.raises(ModelError):
        list(check_stability(changed(bundle, "<joint ", "<jiont ")))


@pytest.mark.parametrize(
    ("warnings", "energy_j_per_kg", "beyond_deg", "passed"),
    [
        ((), 1.0, 0.0, True),
        ((), MAX_ENERGY_J_PER_KG, MAX_BEYOND_DEG, True),
        ((), MAX_ENERGY_J_PER_KG + 1, 0.0, False),
        ((), float("inf"), 0.0, False),
        ((), 1.0, MAX_BEYOND_DEG + 1, False),
        (("CONTACTFULL",), 1.0, 0.0, False),
    ],
)
def test_a_pose_passes_without_warnings_and_within_bounds(warnings, energy_j_per_kg, beyond_deg, passed):
    assert PoseCheck(warnings, energy_j_per_kg, beyond_deg, "robot:left_knee", "supine").passed == passed


def test_a_joint_that_is_flung_out_fails_and_is_named(bundle):
    """An elbow with a motor forty times as strong."""
    strong = changed(bundle, '(name="act:left_elbow".*? gear)="[^"]+"', r'\1="150"')
    found = list(check_stability(strong))
    assert not any(check.warnings for check in found)
    flung = {check.joint for check in found if not check.passed}
    assert flung
    assert flung <= {"robot:left_elbow", "robot:left_fingers"}


@pytest.mark.parametrize("model", ["torque", "muscle", "position"])
def test_alternating_commands_push_every_joint_to_and_fro(built, model):
    """At full command each way, switched every 50 to 100 ms; of two muscles one pulls and the other rests."""
    infant = load_model(built(actuation={"model": model}))
    stream = COMMANDS["alternating"](infant, np.random.default_rng(0), 0.01)
    rows = np.array([next(stream) for _ in range(1000)])
    low, high = infant.actuator_ctrlrange.T
    assert set(np.unique(rows)) == {low[0], high[0]}
    ways = (rows - low) / (high - low) * 2 - 1
    pulls = ways * np.sign(infant.actuator_gear[:, 0])
    assert (pulls == pulls[:, :1]).all()
    switches = np.flatnonzero(np.diff(pulls[:, 0]))
    assert set(np.diff(switches)) == {5, 6, 7, 8, 9, 10}


def test_every_pose_of_the_manifest_is_checked(bundle):
    assert [check.pose for check in check_stability(bundle)] == list(bundle.manifest.poses)
