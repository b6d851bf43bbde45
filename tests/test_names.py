"""Names in bundles, of which other tools make paths, are identifiers; names in the code say what something is."""

import re
from pathlib import Path

import pytest
import yaml
from support import words

import mimoc
from mimoc.compiler import model_check, pipeline
from mimoc.schema import InfantSpec

CONFIGS = sorted((Path(__file__).parents[1] / "configs").glob("*.yaml"))
IDENTIFIER = re.compile(r"^[A-Za-z_][A-Za-z0-9_]*$", re.ASCII)
PACKAGE = Path(mimoc.__file__).parent


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


def test_no_name_in_the_code_is_a_word_that_names_nothing():
    """A name is a noun that says what it is."""
    given = {path: words.refused_names(path.read_text(encoding="utf-8")) for path in PACKAGE.rglob("*.py")}
    assert {path: names for path, names in given.items() if names} == {}


@pytest.mark.parametrize(
    "source",
    [
        "each = 1",
        "for each in []: pass",
        "[0 for each in []]",
        "lambda each: 0",
        "def f(*each): ...",
        "def each(): ...",
        "class each: ...",
        "class A:\n    each: int",
        "self.each = 1",
        "a, *each = []",
        "import a as each",
        "with a as (b, each): ...",
        "try: ...\nexcept E as each: ...",
        "match a:\n    case [*each]: ...",
        "match a:\n    case {**each}: ...",
        "(each := 1)",
    ],
)
def test_a_word_that_names_nothing_is_seen_wherever_a_name_is_given(source):
    assert words.refused_names(source) == ["each"]


def test_names_that_others_gave_are_not_ours():
    assert words.refused_names("from a import each\nf(each, found=each.told)\nteach = {'here': 1}") == []
