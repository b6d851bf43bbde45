"""The programs in docs/own_scene.md run as printed."""

import re
import runpy
from pathlib import Path

import mujoco
import numpy as np
import pytest

import mimoc

ROOT = Path(__file__).parents[1]
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", (ROOT / "docs" / "own_scene.md").read_text(), re.DOTALL)
PYTHON = [code for language, code in BLOCKS if language == "python"]
(ONE, TWO), (MJCF,) = [code for code in PYTHON if "dm_control" not in code], [c for kind, c in BLOCKS if kind == "xml"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("own")
    mimoc.write_bundle(mimoc.build(mimoc.load_spec(ROOT / "configs" / "nine_months.yaml")), folder / "out/nine_months")
    return folder


@pytest.fixture(autouse=True)
def here(folder, monkeypatch):
    monkeypatch.chdir(folder)


def ran(code: str, folder: Path) -> dict:
    (folder / "program.py").write_text(code)
    return runpy.run_path(str(folder / "program.py"))


def alone() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path("out/nine_months/infant.xml")


def same_options(model: mujoco.MjModel) -> bool:
    names = ("timestep", "integrator", "cone", "jacobian", "solver", "iterations", "ls_iterations", "tolerance")
    wanted = alone().opt
    return all(getattr(model.opt, name) == getattr(wanted, name) for name in (*names, "disableflags"))


def test_an_infant_hosts_what_is_added_to_it(folder):
    model = ran(ONE, folder)["model"]
    assert (model.nbody, model.nu) == (alone().nbody + 1, alone().nu)
    assert same_options(model)


def test_two_infants_sit_in_a_scene_made_with_mjspec(folder):
    told = ran(TWO, folder)
    model, data = told["model"], told["data"]
    assert same_options(model)
    assert (model.nu, model.nsensor) == (2 * alone().nu, 2 * alone().nsensor)
    assert (model.npair, model.nexclude) == (2 * alone().npair, 2 * alone().nexclude)
    for prefix, (x, y) in told["PLACES"].items():
        np.testing.assert_allclose(data.body(prefix + "hip").xpos[:2], (x, y), atol=0.1)
        assert 0.03 < data.body(prefix + "hip").xpos[2] < 0.15
    assert not any(warning.number for warning in data.warning)


def test_two_infants_stand_in_a_scene_of_plain_mjcf(folder):
    (folder / "nursery.xml").write_text(MJCF)
    model = mujoco.MjModel.from_xml_path("nursery.xml")
    assert same_options(model)
    assert model.nu == 2 * alone().nu
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    soles = data.body("anna_left_foot").xpos[2], data.body("ben_left_foot").xpos[2]
    assert soles[0] == pytest.approx(soles[1])
    assert 0.0 < soles[0] < 0.05
