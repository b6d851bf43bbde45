import dataclasses
import re

import pytest

from mimoc.errors import ModelError
from mimoc.runtime.check import MAX_ENERGY_J_PER_KG, PoseCheck, check_stability


def changed(bundle, pattern, replacement):
    """Return a bundle whose body says something else."""
    body, count = re.subn(pattern, replacement, bundle.files["infant.xml"].decode())
    assert count
    return dataclasses.replace(bundle, files={**bundle.files, "infant.xml": body.encode()})


@pytest.mark.matrix
def test_every_config_stays_calm_in_every_pose(config):
    for check in check_stability(config):
        assert check.passed
        assert check.warnings == ()
        assert 0 < check.energy_j_per_kg < MAX_ENERGY_J_PER_KG / 4


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
    ("warnings", "energy_j_per_kg", "passed"),
    [
        ((), 1.0, True),
        ((), MAX_ENERGY_J_PER_KG, True),
        ((), MAX_ENERGY_J_PER_KG + 1, False),
        ((), float("inf"), False),
        (("CONTACTFULL",), 1.0, False),
    ],
)
def test_a_pose_passes_without_warnings_or_too_much_motion(warnings, energy_j_per_kg, passed):
    assert PoseCheck("supine", warnings, energy_j_per_kg).passed == passed
