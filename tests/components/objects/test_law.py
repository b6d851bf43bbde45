"""Whatever objects a spec asks for: nothing starts inside of anything, all come to rest, and MuJoCo warns of nothing.

Scenes are drawn from the JSON Schema, of all kinds of objects but furniture (`test_furniture.py`).
"""

from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import mujoco
import numpy as np
import pytest
from fuzz.mutations import OMITTED, Drawing
from support.scenes_of_objects import TOUCH_M, deepest_m, drift_m

import mimoc
from mimoc.base.errors import SpecError
from mimoc.bundle.model import load_posed
from mimoc.components.objects import OF_MOTIONS, SIZES
from mimoc.schema.json_schema import json_schema
from mimoc.schema.objects import USUAL

SETTLING_S = 20.0
"""Of an infant that may fall, whose ribbon may pull a mobile, which swings for several seconds."""
STILL_M = 1e-2
"""How far something at rest moves in half a second. A ball that a falling infant pushes rolls on slowly for half a
minute: MuJoCo's rolling friction is soft, and a push of 6 cm/s falls to a third in 9 s."""
ROLLING = 0.7
"""What is left of the speed of a ball that a falling infant hits, after another ten seconds: .57."""
PARTS = ("head", "chest", "right_hand", "left_hand", "right_foot", "left_foot")
HINTS: dict[str, Any] = {
    "root": lambda generator: OMITTED,
    "mesh": lambda generator: OMITTED,
    "above": lambda generator: OMITTED,
    "at": lambda generator: OMITTED,
    "yaw_deg": lambda generator: round(float(generator.uniform(-180, 180)), 1),
    "toy": lambda generator: str(generator.choice(["cup", "bunny", "car", "ball", "bowl", "drum", "key"])),
    "radius_cm": lambda generator: round(float(generator.uniform(0.5, 8)), 2),
    "length_cm": lambda generator: round(float(generator.uniform(2, 20)), 2),
    "sides_cm": lambda generator: [round(float(side), 2) for side in generator.uniform(2, 15, 3)],
    "size_cm": lambda generator: round(float(generator.uniform(4, 12)), 2),
    "mass_g": lambda generator: round(float(generator.uniform(5, 500)), 1),
    "density_kg_m3": lambda generator: round(float(generator.uniform(100, 3000))),
    "friction": lambda generator: round(float(generator.uniform(0.2, 2)), 2),
    "slide_cm": lambda generator: [-10.0, 10.0],
    "height_cm": lambda generator: OMITTED,
    "distance_cm": lambda generator: OMITTED,
    "figures": lambda generator: generator.choice(["fish", "bus", "pig", "ball"], generator.integers(2, 6)).tolist(),
    "cord_cm": lambda generator: round(float(generator.uniform(10, 60)), 1),
    "arm_cm": lambda generator: OMITTED,
}


def scenes(seed: int) -> Iterator[dict[str, Any]]:
    """Yield specs of infants with objects, without end."""
    generator, schema = np.random.default_rng(seed), json_schema()
    items = [schema["$defs"][name] for name in ("ShapeSpec", "MobileSpec")]
    drawing = Drawing(schema, HINTS, generator)
    while True:
        drawn = [drawing.value(items[int(generator.random() < 0.2)]) for _ in range(generator.integers(1, 5))]
        objects = [_placed(data, number, generator) for number, data in enumerate(drawn)]
        yield {
            "mimoc": 1,
            "name": "x",
            "age_months": float(generator.choice([0, 3, 6, 12, 18, 24])),
            "body": {"skin": False},
            "scene": {
                "kind": str(generator.choice(["flat", "flat", "crib", "room"])),
                "seed": int(generator.integers(100)),
                "pose": str(generator.choice(["supine", "prone", "sitting"])),
                "objects": objects,
            },
        }


def _placed(drawn: dict[str, Any], number: int, generator: np.random.Generator) -> dict[str, Any]:
    """Return an object with a name and a place, without keys that contradict others."""
    data = {**drawn, "name": f"thing{number}"}
    if data.get("kind", USUAL) == USUAL:
        data = _consistent(data)
    hangs = data.get("motion") in ("hanging", "fixed") or data.get("kind", USUAL) == "mobile"
    turn = int(generator.integers(5))
    if (hangs and turn < 3) or data.get("kind") == "mobile":
        data |= {"above": str(generator.choice(PARTS)), "height_cm": round(float(generator.uniform(15, 40)), 1)}
    elif turn == 0:
        data["at"] = f"within reach of {generator.choice(['right_hand', 'left_hand'])}"
    elif turn == 1:
        data["at"] = f"beside {generator.choice(PARTS)}"
    elif turn == 2 and number:
        data["at"] = f"on thing{generator.integers(number)}"
    else:
        x_cm, y_cm = generator.uniform(-60, 60, 2)
        data["at"] = {"x_cm": round(float(x_cm), 1), "y_cm": round(float(y_cm), 1), "frame": "infant"}
    return data


def _consistent(data: dict[str, Any]) -> dict[str, Any]:
    source = "toy" if "toy" in data else data.get("shape", "sphere")
    gone = {key for keys in SIZES.values() for key in keys} - set(SIZES[source])
    gone |= {key for key, motion in OF_MOTIONS.items() if data.get("motion") != motion}
    gone |= {"shape"} if "toy" in data else set()
    gone |= {"density_kg_m3"} if "mass_g" in data else set()
    return {key: value for key, value in data.items() if key not in gone}


def check(count: int, seed: int) -> None:
    """Check a number of scenes that can be built; others are refused in one line."""
    checked, refusals = 0, list[SpecError]()
    for data in scenes(seed):
        try:
            bundle = mimoc.build(mimoc.InfantSpec.model_validate(data))
        except SpecError as refusal:
            refusals.append(refusal)
            continue
        _check_scene(bundle, data)
        checked += 1
        if checked == count:
            break
    assert all(len(refusal.problems) == 1 and "scene.objects[" in str(refusal) for refusal in refusals)
    assert len(refusals) < 2 * count


def _check_scene(bundle: mimoc.Bundle, data: dict[str, Any]) -> None:
    for pose in bundle.manifest.poses:
        assert deepest_m(bundle, *load_posed(bundle, pose)) < TOUCH_M, (pose, data)
    model, state = load_posed(bundle)
    drifts_m = []
    for _ in range(2):
        mujoco.mj_step(model, state, round(SETTLING_S / 2 / model.opt.timestep))
        drifts_m.append(drift_m(bundle, model, state))
    assert not state.warning.number.any(), data
    assert drifts_m[1] < max(STILL_M, ROLLING * drifts_m[0]), data


@pytest.mark.full
def test_so_it_is_in_two_hundred_scenes():
    check(200, 1)


def test_the_same_scene_gives_the_same_bytes():
    for data in scenes(4):
        spec = mimoc.InfantSpec.model_validate(data)
        with suppress(SpecError):
            first = mimoc.build(spec)
            break
    assert mimoc.build(spec).files == first.files
