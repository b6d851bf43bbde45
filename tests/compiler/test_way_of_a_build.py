"""A spec's way through the builder is short: it seldom comes back to a module, or a folder, that it has left."""

import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import pytest
from support.folder_changes import folder_changes

import mimoc
from mimoc.anatomy.anatomy import Anatomy
from mimoc.base.errors import SpecError
from mimoc.body.grow import GrownBody, grow_body
from mimoc.body.masses import Masses
from mimoc.body.reference import Reference
from mimoc.body.shapes import Shapes
from mimoc.body.tree import BodyTree
from mimoc.compiler.building import builder
from mimoc.compiler.mjcf.scene import SceneTree
from mimoc.fits import Measurements

ROOT = Path(mimoc.__file__).parent
FOLDERS = ("anatomy", "body", "compiler", "fits", "schema")
CARRIERS = (mimoc.InfantSpec, Measurements, Anatomy, Reference, Shapes, Masses, BodyTree, GrownBody, SceneTree)
"""The spec, and what the stages of a build make of it."""
MAX_RETURNS = 25


def way_of(build: Callable[[], object]) -> list[str]:
    """Return the modules whose functions get the spec or what became of it, in the order of their calls.

    Calls in a row within one module are one stay. Methods do not count: they belong to the value that is handed on.
    """
    stays: list[str] = []

    def trace(frame: FrameType, event: str, _: object) -> None:
        if event != "call" or not frame.f_code.co_filename.startswith(str(ROOT)):
            return
        module = Path(frame.f_code.co_filename).relative_to(ROOT).as_posix()
        code, arguments = frame.f_code, frame.f_locals
        is_function = not code.co_name.startswith("<") and "self" not in arguments
        carries = any(isinstance(value, CARRIERS) for value in arguments.values())
        if module.startswith(FOLDERS) and is_function and carries and stays[-1:] != [module]:
            stays.append(module)

    sys.setprofile(trace)
    try:
        build()
    finally:
        sys.setprofile(None)
    return stays


def returns(stays: list[str]) -> int:
    """Return how often a way comes back to a module that it has left."""
    return len(stays) - len(set(stays))


@pytest.fixture(params=["published", "maturing"])
def spec(request) -> mimoc.InfantSpec:
    keys = {"senses": {"touch": {}, "vision": {}, "proprioception": {}}, "development": request.param}
    return mimoc.InfantSpec(mimoc=1, name="x", age_months=9, **keys)


def test_a_build_comes_back_to_a_module_at_most_25_times(spec):
    builder(spec)  # What is imported or read from tables at first is no part of the way.
    way = way_of(lambda: builder(spec))
    assert {"compiler/building.py", "body/grow.py", "compiler/assembling.py", "compiler/manifest.py"} < set(way)
    assert returns(way) <= MAX_RETURNS, way


def test_a_body_goes_through_its_stages_once_in_their_order(spec):
    grow_body(spec)
    way = way_of(lambda: grow_body(spec))
    stages = (
        "reference",
        "measurements",
        "shapes",
        "masses",
        "joints",
        "strength",
        "tree",
    )  # `prune` is in `tree`.
    places = [way.index(f"body/{stage}.py") for stage in stages]
    assert places == sorted(places), way
    assert returns(way) <= 7, way


def test_a_spec_that_was_just_read_is_not_validated_again(tmp_path, monkeypatch):
    path = tmp_path / "x.yaml"
    path.write_text("mimoc: 1\nname: x\nage_months: 9\n", encoding="utf-8")
    read = mimoc.load_spec(path)
    monkeypatch.setattr("mimoc.schema.infant.read_spec", None)
    assert builder(read).spec is read


def test_a_spec_that_was_changed_without_validation_is_validated(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text("mimoc: 1\nname: x\nage_months: 9\n", encoding="utf-8")
    changed = mimoc.load_spec(path).model_copy(update={"age_months": 99})
    with pytest.raises(SpecError, match="age_months"):
        builder(changed)


SPEC = Path(__file__).parents[2] / "configs" / "nine_months.yaml"
MAX_CHANGES = 1500


def test_a_build_changes_folder_at_most_1500_times():
    spec = mimoc.load_spec(SPEC)
    mimoc.build(spec)  # What is imported or read from tables at first does not count.
    changes = folder_changes(lambda: mimoc.build(spec))
    assert 300 < changes.total() <= MAX_CHANGES, changes.most_common(10)
