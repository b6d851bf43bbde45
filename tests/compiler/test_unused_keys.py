"""A key of a spec that is about an option that was not chosen is noted in the bundle."""

from pathlib import Path

import pytest

from mimoc.compiler.manifest import unused_keys
from mimoc.schema import InfantSpec, read_spec, to_data
from mimoc.schema.source import parse, read

HEAD = "mimoc: 1\nname: x\nage_months: 9\n"
CONFIGS = sorted((Path(__file__).parents[2] / "configs").glob("*.yaml"))

NOTED = {
    "scene: {kind: flat, room: {size_m: [[3, 4], [3, 4], [2, 3]]}}": "'scene.room' has no effect: scene.kind is 'flat'",
    "scene: {toys: {root: toys}}": "'scene.toys.root' has no effect: "
    "scene.toys.source is 'builtin', which needs no folder",
    "scene: {kind: crib, textures: {wall: a.png}}": "'scene.textures.wall' has no effect: "
    "scene.kind 'crib' has no wallpaper",
    "senses: {vision: {acuity: off, acuity_profile: mimo_v2}}": "'senses.vision.acuity_profile' has no effect: "
    "senses.vision.acuity follows no age",
    "senses: {vision: {foveation_radius: edge}}": "'senses.vision.foveation_radius' has no effect: "
    "senses.vision.foveation is 0",
    "senses: {vision: {fovea: age}}": "'senses.vision.fovea' has no effect: senses.vision.foveation is 0",
    "senses: {vision: {acuity: off, contrast: mimo3}}": "'senses.vision.contrast' has no effect: "
    "senses.vision.acuity is off",
    "senses: {touch: {density: 2, spacing_cm: {head: 1}}}": "'senses.touch.density' has no effect: "
    "senses.touch.spacing_cm gives the distances",
    "delays: {sensory_ms: 50}": "'delays.sensory_ms' has no effect: all senses are off",
    "senses: {touch: {}}\ndelays: {sensory_ms: 50, touch_ms: 20}": "'delays.sensory_ms' has no effect: "
    "every sense has a delay of its own",
    "actuation: {locked: [arms], strength: {left_arm: 2, legs: 2}}": "'actuation.strength.left_arm' has no effect: "
    "these joints are locked",
    "scene: {caregiver: {answers: {to: vocalisation}}}": "'scene.caregiver.answers' has no effect: "
    "actuation.voice is off, so that there is nothing to answer",
}


def of(text: str) -> InfantSpec:
    return read_spec(parse(HEAD + text + "\n", "spec.yaml"))


@pytest.mark.parametrize("text", NOTED)
def test_an_option_that_was_not_chosen_is_noted(text):
    assert unused_keys(of(text)) == (NOTED[text],)


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_nothing_in_a_config_is_without_effect_nor_are_defaults(path):
    spec = read_spec(read(path))
    assert unused_keys(spec) == unused_keys(InfantSpec.model_validate(to_data(spec))) == ()
