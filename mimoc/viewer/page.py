"""Pages as text: what they know, the program that shows it, and its style, in one file."""

import re
from collections.abc import Callable, Mapping
from typing import Any

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.variants import Variant
from mimoc.compiler.variants import SpecVariants, spec_of
from mimoc.errors import SpecError
from mimoc.schema.infant import InfantSpec
from mimoc.version import __version__
from mimoc.viewer.appearance import describe_materials, describe_skins, describe_surroundings
from mimoc.viewer.growth import (
    AGES_MONTHS,
    SKIN_AGES_MONTHS,
    describe_growth,
    describe_standards,
    describe_touch,
    own_parts,
    posed,
)
from mimoc.viewer.packing import EncodedArrays, built, source
from mimoc.viewer.physics import AGES_MONTHS as PHYSICS_AGES_MONTHS
from mimoc.viewer.physics import describe_physics, engine

Progress = Callable[[int, int], None]
PROGRAM, LICENCES = "viewer.js", "LICENCES.txt"
PLACE = re.compile(r"\{\{([a-z]+)\}\}")
"""Where something goes in the frame."""


def page_of(infant: Bundle, physics: bool = False, progress: Progress = lambda *_: None) -> str:
    """Return the page of an infant: HTML that any browser opens from disk.

    Args:
        infant: The infant.
        physics: Whether it contains MuJoCo, so that the infant can fall, be pulled and act.
        progress: Called with the number of ages that are built and their total.

    Raises:
        BundleError: If the bundle does not contain its spec.
        SpecError: If the infant cannot be built at some age from 0 to 24 months.
        MimocError: If it has other parts at other ages.
    """
    built(PROGRAM)
    packed = EncodedArrays()
    return fill(packed, describe(packed, infant, physics, progress))


def describe(
    packed: EncodedArrays, infant: Bundle, physics: bool = False, progress: Progress = lambda *_: None
) -> dict[str, Any]:
    """Return what a page knows of an infant: see `page_of`."""
    spec = spec_of(infant)
    at, grown = _grown(spec, progress)
    sparse = [at(age) for age in SKIN_AGES_MONTHS]
    manifest = infant.manifest
    shown = at(manifest.child.age_months)
    simulated_months = sorted({*PHYSICS_AGES_MONTHS, manifest.child.age_months}) if physics else []
    simulated = [at(age, age in SKIN_AGES_MONTHS) for age in simulated_months]
    model, data = shown.model, posed(shown)
    return {
        "name": manifest.name,
        "version": __version__,
        "age_months": manifest.child.age_months,
        "sex": manifest.child.sex,
        "pose": manifest.pose,
        "groups": manifest.anatomy.groups,
        "trunk": manifest.anatomy.trunk,
        "faces": _faces(manifest, spec.body.expression, model),
        **describe_growth(packed, grown, AGES_MONTHS),
        "standards": describe_standards(packed, [variant.bundle.manifest.child for variant in grown]),
        "touch": describe_touch(packed, sparse, SKIN_AGES_MONTHS),
        "skins": describe_skins(packed, sparse, SKIN_AGES_MONTHS),
        **describe_materials(packed, model),
        "physics": describe_physics(packed, simulated) if physics else None,
        "surroundings": describe_surroundings(packed, model, data, own_parts(model, manifest)),
    }


def _grown(spec: InfantSpec, progress: Progress) -> tuple["_Ages", list[Variant]]:
    """Return an infant at all ages of a page; without its task and toys, if these do not suit it at some of them."""
    at, grown = _Ages(spec), list[Variant]()
    try:
        for age in AGES_MONTHS:
            progress(len(grown), len(AGES_MONTHS))
            grown.append(at(age, dressed=age in SKIN_AGES_MONTHS))
    except SpecError:
        toys = {"count": [0, 0]} if spec.scene.kind == "room" else None
        alone = spec.with_(task=None, scene={"toys": toys})
        if alone == spec:
            raise
        return _grown(alone, progress)
    return at, grown


def _faces(manifest: Manifest, expression: str, model: mujoco.MjModel) -> dict[str, Any] | None:
    """Return the materials of the face by expression, and the expression that it has; None if it has no face."""
    face = manifest.face
    if face is None:
        return None
    materials = {name: model.material(material).id for name, material in face.materials.items()}
    return {"geom": face.geom, "materials": materials, "shown": expression}


def fill(packed: EncodedArrays, data: Mapping[str, Any]) -> str:
    """Return the page that shows some data.

    Raises:
        MimocError: If the program of the page has not been built.
    """
    parts = packed.encode(data)
    licences = built(LICENCES).decode()
    if data["physics"]:
        parts |= engine()
        licences += "\n\n" + source("mujoco_licences.txt")
    parts |= {
        "title": _escaped(str(data["name"])),
        "style": source("style.css"),
        "licences": _escaped(licences),
        "program": built(PROGRAM).decode(),
    }
    parts = {name: part.replace("</script", "<\\/script") for name, part in parts.items()}
    return PLACE.sub(lambda place: parts.get(place[1], ""), source("page.html"))


class _Ages:
    """The infant of a spec with a sense of touch, so that its skin points can be shown; each age is built once.

    Undressed, without the smooth skin of its spec, it takes half the time.
    """

    def __init__(self, spec: InfantSpec):
        spec = spec if spec.senses.touch else spec.with_(senses={"touch": {}})
        seen = {"senses": {"vision": {"body": "solids"}}} if spec.senses.vision else {}
        bare = spec.with_(body={"skin": False}, **seen)
        self._variants, self._seed = {True: SpecVariants(spec), False: SpecVariants(bare)}, spec.scene.seed
        self._made: dict[tuple[float, bool], Variant] = {}

    def __call__(self, age_months: float, dressed: bool = True) -> Variant:
        key = age_months, dressed
        if key not in self._made:
            self._made[key] = self._variants[dressed](age_months, self._seed)
        return self._made[key]


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")
