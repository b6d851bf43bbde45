"""What pages with physics contain: the same physics as the bundle's, without what only shows."""

import json
import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from support import store
from support.pages import read_page

import mimoc
from mimoc.bundle.model import load_model
from mimoc.viewer.page import describe, fill

CONFIGS = Path(__file__).parents[2] / "configs"


@pytest.fixture(scope="module")
def bundle() -> mimoc.Bundle:
    return store.built(CONFIGS / "nine_months.yaml")


@pytest.fixture(scope="module")
def pages(bundle) -> tuple[str, str]:
    """Return the page with physics, and the same without."""
    data = describe(bundle, physics=True)
    return fill(data), fill({**data, "physics": None})


@pytest.fixture(scope="module")
def physics(pages) -> dict:
    return read_page(pages[0])["physics"]


def bare(described: dict) -> mujoco.MjModel:
    """Return one of the models of a page."""
    files = {name: content.tobytes() for name, content in described["files"].items()}
    return mujoco.MjModel.from_xml_string(described["scene"].tobytes().decode(), files)


def test_a_model_of_a_page_moves_as_the_bundle_does_to_the_bit(physics, bundle):
    (own,) = [model for model in physics["models"] if model["age_months"] == 9]
    moved = []
    for model in (bare(own), load_model(bundle)):
        model.opt.disableflags = 0  # The bundle's is prepared for this machine.
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("sitting").id)
        data.ctrl[:] = np.linspace(-1, 1, model.nu)
        mujoco.mj_step(model, data, 100)
        moved.append(data.qpos.copy())
    assert np.array_equal(*moved)


def test_models_of_a_page_have_no_pictures_and_are_of_many_ages(physics):
    ages = [described["age_months"] for described in physics["models"]]
    assert (ages[0], ages[-1], len(ages)) == (0, 24, 11)
    masses = [float(bare(described).body_mass.sum()) for described in physics["models"][::5]]
    assert masses == sorted(masses)
    assert bare(physics["models"][0]).ntex == 0


def test_what_is_commanded_is_what_an_action_commands(physics, bundle):
    env = mimoc.InfantEnv(bundle)
    assert env.action_space.shape == (len(physics["commanded"]),)
    assert physics["step_s"] == bundle.manifest.step_ms / 1000
    own = load_model(bundle)
    assert own.body(physics["bodies"][0]).name == bundle.manifest.root_body


def test_only_a_page_with_physics_contains_mujoco_and_its_licences(pages):
    page, plain = pages
    assert json.loads(re.findall(r'id="data">(.*?)</script>', plain, re.DOTALL)[0])["physics"] is None
    assert "Apache License" in page
    assert "Apache License" not in plain
    assert len(page) - len(plain) > 3e6
    assert "'unsafe-eval'" not in plain
