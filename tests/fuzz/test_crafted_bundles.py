"""Every bundle that was ever made to do harm is refused in one line, and nothing outside of it is opened."""

import json
import re
from pathlib import Path

import pytest
from fuzz.crafted_bundles import CRAFTED, PLANTED
from fuzz.fuzzing import Canaries, is_clear
from fuzz.strange_infants import CANARIES, VARIATIONS, honest_files, write_resealed

import mimoc
from mimoc.base.errors import MimocError
from mimoc.bundle.model import load_model

CONFIGS = Path(__file__).resolve().parents[2] / "configs"


@pytest.fixture
def outside(tmp_path):
    canaries = Canaries(tmp_path / "outside", CANARIES)
    yield canaries
    canaries.close()


def refusal(folder) -> str:
    with pytest.raises(MimocError) as error:
        mimoc.make(folder).close()
    assert is_clear(error.value)
    return str(error.value)


@pytest.mark.parametrize("name", CRAFTED)
def test_a_crafted_bundle_is_refused_in_one_line(name, tmp_path, outside):
    craft, said = CRAFTED[name]
    files = dict(honest_files(0))
    craft(files, outside.folder)
    assert said in refusal(write_resealed(files, tmp_path / "bundle"))
    assert outside.opened() == []


def test_a_gaze_without_locks_is_refused(tmp_path):
    files = honest_files(1)
    manifest = json.loads(files["manifest.json"])
    assert manifest["task"]["gaze"]
    manifest["constraints"]["locks"] = []
    folder = write_resealed({**files, "manifest.json": json.dumps(manifest).encode()}, tmp_path / "bundle")
    assert "its gaze turns 'robot:head_swivel', which is not locked" in refusal(folder)


@pytest.mark.parametrize("name", PLANTED)
def test_what_is_not_a_regular_file_of_the_bundle_is_refused(name, tmp_path, outside):
    plant, said = PLANTED[name]
    folder = write_resealed(honest_files(0), tmp_path / "bundle")
    plant(folder, outside.folder)
    assert said in refusal(folder)
    assert outside.opened() == []


def test_the_canaries_see_what_is_opened_made_or_removed(outside):
    (outside.folder / "canary.xml").read_bytes()
    assert outside.opened() == ["canary.xml"]
    (outside.folder / "canary.xml").rename(outside.folder / "other")
    (outside.folder / "eye.png").unlink()
    (outside.folder / "folder").mkdir()
    assert outside.opened() == ["canary.xml", "eye.png", "folder", "other"]
    list(outside.folder.iterdir())
    assert outside.opened() == ["."]


@pytest.mark.parametrize("number", range(len(VARIATIONS)))
def test_an_honest_bundle_of_any_kind_is_opened(number, tmp_path):
    env = mimoc.make(write_resealed(honest_files(number), tmp_path / "bundle"))
    env.reset(seed=0)
    env.step(env.action_space.sample())
    env.close()


@pytest.mark.parametrize("impairments", [{"preset": "hemiparesis", "side": "left"}, {"preset": "diplegia"}])
def test_the_stretch_reflexes_beside_muscles_are_no_muscles(impairments, tmp_path):
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "actuation": {"model": "muscle"}, "impairments": impairments}
    files = dict(mimoc.build(mimoc.InfantSpec.model_validate(spec)).files)
    env = mimoc.make(write_resealed(files, tmp_path / "bundle"))
    env.reset(seed=0)
    env.step(env.action_space.sample())
    env.close()


def test_a_muscle_by_defaults_that_stand_after_it_is_one(tmp_path):
    files = dict(honest_files(2))
    text = files["infant.xml"].decode()
    assert 'biastype="muscle"' in text
    defaults = text[text.index("<default>") : text.rindex("</default>") + 10]
    text = text.replace(defaults, "").replace("</mujoco>", f"{defaults}</mujoco>")
    files["infant.xml"] = re.sub(' lengthrange="[^"]*"', "", text).encode()
    assert "a muscle without a lengthrange" in refusal(write_resealed(files, tmp_path / "bundle"))


@pytest.mark.parametrize("config", sorted(CONFIGS.glob("*.yaml")), ids=lambda path: path.stem)
def test_the_bundle_of_each_config_is_one_that_mimoc_could_have_written(config, tmp_path):
    folder = mimoc.write_bundle(mimoc.build(config), tmp_path / "bundle")
    assert load_model(mimoc.read_bundle(folder)).nbody > 10
