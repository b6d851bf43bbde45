"""Whole bundles as they were last approved: every config's XML in canonical form, and what MuJoCo makes of it.

Renew with `pytest --snapshot-update`, and read the difference. Numbers may differ by a millionth, since the last
digits depend on the processor; everything else is compared to the letter. Pictures are not in here.
"""

import math
import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from lxml import etree
from support import store
from support.running import CONFIGS
from syrupy.extensions.single_file import SingleFileSnapshotExtension, WriteMode

import mimoc
from mimoc.compiler.model_check import compile_model

PUBLISHED = {  # Infants of the paper, by both hands.
    f"published_{age_months:g}": {
        "mimoc": 1,
        "name": "the_papers_infant",
        "age_months": age_months,
        "development": "published",
        "body": body,
        "senses": {"touch": {}},
    }
    for age_months, body in ((0, {}), (7.5, {"hands": "five_finger", "chest_joint": True}), (24, {"chest_joint": True}))
}
OF_ROOM = re.compile(r"scene\.xml|assets/(toy\d+_|object_|wall_|floor_|ceiling_).*")
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?!\w)")
COUNTS = ("nbody", "njnt", "nq", "nv", "nu", "ngeom", "nsite", "ncam", "nsensor", "ntendon", "nkey", "nmat", "ntex")


def alike(text: str, other: str) -> bool:
    """Return whether two texts are the same but for the last digits of their numbers."""
    if NUMBER.sub("#", text) != NUMBER.sub("#", other):
        return False
    numbers = zip(NUMBER.findall(text), NUMBER.findall(other), strict=True)
    return all(math.isclose(float(a), float(b), rel_tol=1e-6, abs_tol=1e-9) for a, b in numbers)


class Approved(SingleFileSnapshotExtension):
    """One text file for each test, in `test_bundles/`."""

    _write_mode = WriteMode.TEXT
    file_extension = "txt"

    @classmethod
    def dirname(cls, *, test_location) -> str:
        return str(Path(test_location.filepath).with_suffix(""))

    def matches(self, *, serialized_data, snapshot_data) -> bool:
        return alike(serialized_data, snapshot_data)


@pytest.fixture
def approved(snapshot):
    return snapshot.use_extension(Approved)


@pytest.fixture(
    scope="module", params=[*CONFIGS, *PUBLISHED.values()], ids=[*(path.stem for path in CONFIGS), *PUBLISHED]
)
def bundle(request) -> mimoc.Bundle:
    return store.built(request.param)


def canonical(xml: bytes) -> str:
    """Return XML with sorted attributes and one element a line, however it was laid out."""
    return printed(parsed(xml))


def surroundings(bundle: mimoc.Bundle) -> str:
    """Return what a scene has besides its infant, of which it contains all that is in the file of the infant alone."""
    infant, scene = (parsed(bundle.files[name]) for name in ("infant.xml", "scene.xml"))
    if bundle.manifest.has_skin:
        for section in infant:
            same = scene.find(section.tag)
            assert same.attrib.items() >= section.attrib.items()
            for geom in [*section.iter("geom"), *same.iter("geom")]:  # Under a skin, in another group.
                geom.attrib.pop("group", None)
            assert [*map(etree.tostring, same[: len(section)])] == [*map(etree.tostring, section)]
            del same[: len(section)]
            for attribute in section.attrib:
                del same.attrib[attribute]
            if not len(same) and not same.attrib:
                scene.remove(same)
    return printed(scene)


def parsed(xml: bytes) -> etree._Element:
    return etree.fromstring(xml, etree.XMLParser(remove_blank_text=True, remove_comments=True))


def printed(tree: etree._Element) -> str:
    etree.indent(tree, " ")
    return etree.tostring(tree, method="c14n").decode() + "\n"


def compiled(model: mujoco.MjModel) -> str:
    lines = [f"{count} {getattr(model, count)}" for count in COUNTS]
    for body in map(model.body, range(model.nbody)):
        inertia = sorted(body.inertia, reverse=True)
        lines.append(line(f"body {body.name}", mass=body.mass, centre=body.ipos, inertia=inertia))
    for geom in map(model.geom, range(model.ngeom)):
        lines.append(line(f"geom {geom.name}", size=geom.size, pos=geom.pos, rbound=geom.rbound))
    for index, actuator in enumerate(map(model.actuator, range(model.nu))):
        inertia = model.dof_invweight0[model.jnt_dofadr[actuator.trnid[0]]]
        lines.append(line(f"actuator {actuator.name}", acc0=model.actuator_acc0[index], invweight=inertia))
    lines.append(line("statistic", meanmass=model.stat.meanmass, meaninertia=model.stat.meaninertia))
    return "\n".join(lines) + "\n"


def summary(bundle: mimoc.Bundle) -> str:
    """Return a line for each of the large arrays of a bundle: its shape, and what its columns are like."""
    lines = []
    for name, array in bundle.arrays.items():
        columns = array.reshape(-1, array.shape[-1] if array.ndim > 1 else 1)
        spread = {"mean": columns.mean(axis=0), "deviation": columns.std(axis=0)}
        ends = {"first": columns[0], "last": columns[-1]}
        lines.append(line(f"array {name}", shape=array.shape, **spread, **ends))
    return "".join(f"{text}\n" for text in lines)


def line(what: str, **numbers) -> str:
    """Return a line such as `geom head size 0.07 0 0`."""
    shown = (f"{name} {' '.join(f'{number:.8g}' for number in np.ravel(value))}" for name, value in numbers.items())
    return "  ".join((what, *shown))


def test_the_infant_is_as_approved(bundle, approved):
    assert canonical(bundle.files["infant.xml"]) == approved


def test_the_scene_is_as_approved(bundle, approved):
    assert surroundings(bundle) == approved


def test_the_compiled_model_is_as_approved(bundle, approved):
    assert compiled(compile_model(bundle.files)) == approved


def test_what_the_runtime_is_told_is_as_approved(bundle, approved):
    """The manifest, then large arrays; a new field has a default, or the manifest's version goes up."""
    assert bundle.files["manifest.json"].decode() + summary(bundle) == approved


def test_an_infant_takes_at_most_a_megabyte(bundle):
    """Its skin, senses and the origins of its numbers; a room, its toys and objects are not counted."""
    of_infant = {name: file for name, file in bundle.files.items() if not OF_ROOM.fullmatch(name)}
    assert sum(map(len, of_infant.values())) < 1_000_000


@pytest.mark.parametrize(
    ("text", "other", "same"),
    [
        ('size="0.1 0.2"', 'size="0.10000001 0.2"', True),
        ('size="0.1 0.2"', 'size="0.100001 0.2"', False),
        ('size="0.1 0.2"', 'size="0.1 -0.2"', False),
        ('size="0.1 0.2"', 'size="0.1 0.2 0"', False),
        ('pos="0 0 5e-19"', 'pos="0 0 0"', True),
        ('name="hip1"', 'name="hip2"', False),
        ("mass 10.9049", "mass 10.9049\n", False),
    ],
)
def test_only_the_last_digits_may_differ(text, other, same):
    assert alike(text, other) is same
