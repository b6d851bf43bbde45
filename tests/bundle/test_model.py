import dataclasses
import logging
import warnings

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.base.errors import ModelError
from mimoc.bundle.model import is_unstable, load_model, simulation_warnings

SPARSE, DENSE = mujoco.mjtJacobian.mjJAC_SPARSE, mujoco.mjtJacobian.mjJAC_DENSE


def numbers(model):
    """Return everything a model consists of, except the paths of its files and their size."""
    values = {name: getattr(model, name) for name in dir(model) if "path" not in name}
    return {name: value for name, value in values.items() if isinstance(value, np.ndarray) and name != "_sizes"}


@pytest.mark.matrix
def test_the_model_is_the_one_that_mujoco_reads_from_the_folder(bundle, tmp_path):
    scene = mimoc.write_bundle(bundle, tmp_path / "out") / "scene.xml"
    on_disk, in_memory = numbers(mujoco.MjModel.from_xml_path(str(scene))), numbers(load_model(bundle))
    assert len(on_disk) > 300
    assert [name for name in on_disk if not np.array_equal(on_disk[name], in_memory[name])] == []


@pytest.mark.parametrize("release", ["3.5.0", "3.17.0", "4.0.1", "4.1.0"])
def test_other_releases_of_mujoco_use_the_sparse_solver(bundle, release, monkeypatch):
    monkeypatch.setattr(mujoco, "__version__", release)
    assert load_model(bundle).opt.jacobian == SPARSE


def test_the_faulty_release_of_mujoco_uses_the_dense_solver_and_says_so_once(bundle, monkeypatch):
    monkeypatch.setattr(mujoco, "__version__", "4.0.0")
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("default")
        models = [load_model(bundle) for _ in range(3)]
    assert {model.opt.jacobian for model in models} == {DENSE}
    assert len(said) == 1
    assert "MuJoCo 4.0.0" in str(said[0].message)
    assert "pip install 'mujoco!=4.0.0'" in str(said[0].message)


@pytest.mark.matrix
@pytest.mark.parametrize("content", [b"", b"<mujoco>", b"<mujoco><worldbody><geom size='-1'/></worldbody></mujoco>"])
def test_a_model_that_mujoco_rejects_is_one_clear_line(bundle, content):
    broken = dataclasses.replace(bundle, files={**bundle.files, "scene.xml": content})
    with pytest.raises(ModelError, match=f"MuJoCo {mujoco.__version__} rejects the bundle: ") as refusal:
        load_model(broken)
    assert "\n" not in str(refusal.value)


@pytest.mark.matrix
def test_a_calm_simulation_has_no_warnings(bundle):
    model = load_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 10)
    assert simulation_warnings(data) == ()
    assert not is_unstable(data)


@pytest.mark.matrix
@pytest.mark.parametrize(
    ("array", "kind", "broken"), [("qpos", "BADQPOS", True), ("qvel", "BADQVEL", True), ("ctrl", "BADCTRL", False)]
)
def test_warnings_are_reported_by_kind_and_logged(bundle, array, kind, broken, capfd, caplog):
    model = load_model(bundle)
    data = mujoco.MjData(model)
    getattr(data, array)[10] = np.nan
    with caplog.at_level(logging.INFO, "mimoc"):
        mujoco.mj_step(model, data)
    assert simulation_warnings(data) == (kind,)
    assert is_unstable(data) == broken
    assert kind.removeprefix("BAD") in caplog.text
    assert capfd.readouterr() == ("", "")


def test_an_existing_handler_of_mujocos_warnings_is_kept(bundle):
    """mimoc redirects MuJoCo's warnings only if no handler is set."""
    heard, quiet = [], mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(heard.append)
    try:
        model = load_model(bundle)
        data = mujoco.MjData(model)
        data.qvel[0] = np.nan
        mujoco.mj_step(model, data)
    finally:
        mujoco.set_mju_user_warning(quiet)
    assert len(heard) == 1
