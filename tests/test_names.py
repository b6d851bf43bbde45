"""Names in bundles, of which other tools make paths, are identifiers."""

import re
from pathlib import Path

import pytest
import yaml

from mimoc.compiler import model_check, pipeline
from mimoc.schema import InfantSpec

CONFIGS = sorted((Path(__file__).parents[1] / "configs").glob("*.yaml"))
IDENTIFIER = re.compile(r"^[A-Za-z_][A-Za-z0-9_]*$", re.ASCII)


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_geoms_meshes_textures_and_cameras_are_named_by_identifiers_of_their_own(path):
    """MuJoCo's USD exporter makes prims of geoms and cameras; MIMo has no names for geoms that are against it."""
    model = model_check.compile_model(pipeline.build(InfantSpec.model_validate(yaml.safe_load(path.read_text()))).files)
    kinds = {"geom": model.ngeom, "mesh": model.nmesh, "tex": model.ntex, "camera": model.ncam, "light": model.nlight}
    for kind, count in kinds.items():
        names = [getattr(model, kind)(index).name for index in range(count)]
        assert [name for name in names if not IDENTIFIER.match(name)] == [], kind
        assert len(set(names)) == len(names), kind


def test_toys_are_named_by_identifiers():
    data = {"mimoc": 1, "name": "x", "age_months": 9, "scene": {"kind": "room", "toys": {"count": [20, 20]}}}
    model = model_check.compile_model(pipeline.build(InfantSpec.model_validate(data)).files)
    toys = [model.body(body).name for body in range(model.nbody) if model.body(body).name.startswith("toy")]
    assert len(toys) == 20
    assert all(map(IDENTIFIER.match, toys))
