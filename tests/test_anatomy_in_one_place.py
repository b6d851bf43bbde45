"""What runs names no part of the body: the manifest says which parts there are."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import mimoc
from mimoc.schema.names import PAIRED_GROUPS, STRENGTH_GROUPS, all_limb_bodies, trunk_bodies

ROOT = Path(mimoc.__file__).parent
RUNNING = (
    *("runtime/*.py", "runtime/batch/*.py", "runtime/delays/*.py", "policies/*.py", "policies/control/*.py"),
    *("components/tasks/*/run.py", "components/actuation/run.py", "components/senses/*/run.py", "recording/*.py"),
)
FILES = sorted(path for pattern in RUNNING for path in ROOT.glob(pattern))
# Beginnings of the names of files that build, or whose columns are named like parts of the body.
EXCEPT = ("build", "spec", "movement_groups")

CAMERAS = {"eye_left", "eye_right"}
PARTS = {*trunk_bodies(), *all_limb_bodies(), *(set(STRENGTH_GROUPS) - set(PAIRED_GROUPS)), *CAMERAS}
"""Groups of both sides, such as `legs`, are also words for what a manifest has."""
SIDED = re.compile(r"\b(robot:|act:|(left|right)_[a-z])")


def literals(source: str) -> Iterator[tuple[int, str]]:
    """Yield each text of a module with its line, but for docstrings."""
    tree = ast.parse(source)
    alone = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in alone:
            yield node.lineno, node.value


def names(source: str) -> list[str]:
    """Return the texts of a module that name a part of the body, with their lines."""
    return [f"{line}: {text}" for line, text in literals(source) if text in PARTS or SIDED.search(text)]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_no_part_of_the_body_is_named_where_an_infant_runs(path):
    if not path.name.startswith(EXCEPT):
        assert names(path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    "source", ['model.body("head")', 'HANDS = ("left_hand",)', 'x = f"robot:{side}_elbow"', 'camera("eye_left")']
)
def test_a_module_that_names_one_is_found(source):
    assert names(source)


def test_the_manifest_names_only_what_the_model_has(built):
    for removed in ([], ["left_hand", "right_eye"], ["right_upper_arm", "left_upper_leg", "right_foot"]):
        bundle = built(body={"remove": removed})
        env, anatomy = mimoc.InfantEnv(bundle), bundle.manifest.anatomy
        limbs = (*anatomy.arms, *anatomy.legs)
        bodies = {anatomy.head, *anatomy.trunk, *(limb.root for limb in limbs), *(eye.body for eye in anatomy.eyes)}
        bodies |= {limb.end for limb in limbs if limb.end}
        assert not bodies & set(removed)
        assert all(env.model.body(name).id > 0 for name in bodies)
        assert all(env.model.camera(eye.camera).bodyid[0] == env.model.body(eye.body).id for eye in anatomy.eyes)
        hinges = [joint for group in anatomy.groups.values() for joint in group]
        assert sorted(hinges) == sorted(env.model.joint(index).name for index in range(1, env.model.njnt))
