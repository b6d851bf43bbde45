"""What a skin costs: to build and to carry to another age, to draw, and in bytes.

    python benchmarks/skin.py [--rounds 15]

Times are CPU times taken in turn, with and without the skin, of an average infant of nine months.
"""

import argparse
from contextlib import closing
from functools import partial

import mujoco
from measuring import cpu_medians_s

import mimoc
from mimoc.bundle.model import load_model
from mimoc.compiler.building import builder
from mimoc.compiler.looks.skin import skin_of
from mimoc.compiler.variants import SpecVariants, skin_at
from mimoc.components.senses.vision.eyes import Eyes
from mimoc.render.body_camera import BodyCamera
from mimoc.render.soft_light import ONCE

CHOICES = {"skin": True, "solids": False}
CAMERAS, OWN_HEAD, EYE_PX = ("eye_left", "eye_right"), ("head", "left_eye", "right_eye"), 64
PICTURE_PX = (640, 480)


def main() -> None:
    """Print a table for each kind of hands."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15)
    rounds = parser.parse_args().rounds
    for hands in ("mitten", "five_finger"):
        keys = {"mimoc": 1, "name": "infant", "age_months": 9, "body": {"hands": hands}}
        compare(mimoc.InfantSpec.model_validate(keys), rounds)


def compare(spec: mimoc.InfantSpec, rounds: int) -> None:
    """Print times and sizes with a skin and without."""
    print(spec.body.hands)
    bundles = {choice: builder(spec, skin=skin)(0) for choice, skin in CHOICES.items()}
    row("bundle [kB]", {choice: sum(map(len, each.files.values())) / 1000 for choice, each in bundles.items()})
    row("build [ms]", times({choice: partial(build, spec, skin) for choice, skin in CHOICES.items()}, rounds))
    row("carry [ms]", times({"skin": partial(carry, spec)}, rounds))
    grown = {choice: SpecVariants(spec, skin=skin) for choice, skin in CHOICES.items()}
    row("another age [ms]", times({choice: Ages(each) for choice, each in grown.items()}, rounds))
    models = {choice: load_model(each) for choice, each in bundles.items()}
    datas = {choice: posed(model) for choice, model in models.items()}
    cameras = {choice: BodyCamera(model, ["hip"], *PICTURE_PX, exposure=ONCE) for choice, model in models.items()}
    eyes = {choice: Eyes(model, CAMERAS, EYE_PX, EYE_PX, OWN_HEAD, "skin") for choice, model in models.items()}
    row("portrait [ms]", times({each: partial(cameras[each].render, datas[each]) for each in CHOICES}, rounds))
    both = times({each: partial(eyes[each], datas[each]) for each in CHOICES}, 20 * rounds)
    row("both eyes [ms]", both)
    print(f"  {'both eyes, ratio':18} {both['skin'] / both['solids']:.2f}")
    for drawing in (*cameras.values(), *eyes.values()):
        with closing(drawing):
            pass


class Ages:
    """Makes an infant at one new age after another."""

    def __init__(self, variants: SpecVariants):
        self._variants, self._age_months = variants, 9.0

    def __call__(self) -> None:
        """Make the next one."""
        self._age_months += 0.25
        self._variants(self._age_months % 24, 0)


def build(spec: mimoc.InfantSpec, skin: bool) -> None:
    skin_of.cache_clear()
    builder(spec, skin=skin)(0, check=False)


def carry(spec: mimoc.InfantSpec) -> None:
    skin_of.cache_clear()
    skin_at(spec)


def posed(model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("sitting").id)
    mujoco.mj_forward(model, data)
    return data


def times(calls: dict, rounds: int) -> dict[str, float]:
    return {choice: 1000 * seconds for choice, seconds in cpu_medians_s(calls, rounds).items()}


def row(what: str, found: dict[str, float]) -> None:
    print(f"  {what:18}", ", ".join(f"{choice} {value:.1f}" for choice, value in found.items()))


if __name__ == "__main__":
    main()
