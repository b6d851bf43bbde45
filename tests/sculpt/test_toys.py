"""The toys that ship with mimoc are those that the programs in `sculpt/` make."""

import json

import make_toys
import numpy as np
import pytest

from mimoc.bundle.io import pack_arrays
from mimoc.components.toys.builtin import FIGURES, MESHES, NAMES

MADE = {toy.name: toy for toy in make_toys.make_toys()}


def test_every_toy_that_is_made_is_shipped():
    assert tuple(MADE) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_making_it_again_gives_the_same_toy(name):
    """Numbers may differ in their last digits between processors."""
    kept = json.loads(FIGURES.read_text(encoding="utf-8"))[name]
    made = json.loads(json.dumps(make_toys.figures(MADE[name])))
    assert made.keys() == kept.keys()
    assert (made["source"], made["tints"]) == (kept["source"], kept["tints"])
    assert (made["volume"], made["density_kg_m3"]) == pytest.approx((kept["volume"], kept["density_kg_m3"]), rel=1e-12)
    assert [solid["type"] for solid in made["solids"]] == [solid["type"] for solid in kept["solids"]]
    for one, other in zip(made["solids"], kept["solids"], strict=True):
        for key in ("size", "pos", "quat"):
            assert one[key] == pytest.approx(other[key], abs=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_making_it_again_gives_the_same_meshes(name):
    with np.load(MESHES) as kept:
        for key, array in make_toys.arrays(MADE[name]).items():
            assert kept[key].dtype == array.dtype
            np.testing.assert_allclose(array, kept[key], rtol=0, atol=1e-12 if key.endswith("vertices") else 0)


def test_the_archive_holds_nothing_else_and_no_date():
    with np.load(MESHES) as kept:
        assert set(kept.files) == {key for toy in MADE.values() for key in make_toys.arrays(toy)}
        assert pack_arrays(dict(kept)) == MESHES.read_bytes()
