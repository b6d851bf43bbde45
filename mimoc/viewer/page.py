"""Pages as text: what they know, the program that shows it, and its style, in one file."""

import re
from collections.abc import Mapping
from importlib import resources
from typing import Any

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.variants import Variant
from mimoc.compiler.variants import SpecVariants, spec_of
from mimoc.errors import MimocError
from mimoc.schema.infant import InfantSpec
from mimoc.version import __version__
from mimoc.viewer.appearance import describe_materials, describe_skins
from mimoc.viewer.growth import AGES_MONTHS, SKIN_AGES_MONTHS, describe_growth, describe_touch, own_parts, posed
from mimoc.viewer.packing import Packed
from mimoc.viewer.standards import describe_standards
from mimoc.viewer.surroundings import describe_surroundings

FOLDER = resources.files("mimoc.viewer")
PROGRAM, STYLE, FRAME, LICENCES = "built/viewer.js", "source/style.css", "source/page.html", "built/LICENCES.txt"
"""Files beside this module that go into each page."""
PLACE = re.compile(r"\{\{([a-z]+)\}\}")
"""Where something goes in the frame."""


def page_of(infant: Bundle) -> str:
    """Return the page of an infant: HTML that any browser opens from disk.

    Raises:
        BundleError: If the bundle does not contain its spec.
        SpecError: If the infant cannot be built at some age from 0 to 24 months.
        MimocError: If it has other parts at other ages.
    """
    packed = Packed()
    return fill(packed, describe(packed, infant))


def describe(packed: Packed, infant: Bundle) -> dict[str, Any]:
    """Return what a page knows of an infant: see `page_of`."""
    spec = spec_of(infant)
    at = _Ages(spec)
    grown = [at(age) for age in AGES_MONTHS]
    sparse = [at(age) for age in SKIN_AGES_MONTHS]
    manifest = infant.manifest
    shown = at(manifest.child.age_months)
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
        "surroundings": describe_surroundings(packed, model, data, own_parts(model, manifest)),
    }


def _faces(manifest: Manifest, expression: str, model: mujoco.MjModel) -> dict[str, Any] | None:
    """Return the materials of the face by expression, and the expression that it has; None if it has no face."""
    face = manifest.face
    if face is None:
        return None
    materials = {name: model.material(material).id for name, material in face.materials.items()}
    return {"geom": face.geom, "materials": materials, "shown": expression}


def fill(packed: Packed, data: Mapping[str, Any]) -> str:
    """Return the page that shows some data.

    Raises:
        MimocError: If the program of the page has not been built.
    """
    parts = packed.encode(data)
    parts |= {
        "title": _escaped(str(data["name"])),
        "style": _text(STYLE),
        "licences": _escaped(_text(LICENCES)),
        "program": _text(PROGRAM).replace("</script", "<\\/script"),
    }
    return PLACE.sub(lambda place: parts[place[1]], _text(FRAME))


class _Ages:
    """The infant of a spec with a sense of touch, so that its skin points can be shown; each age is built once."""

    def __init__(self, spec: InfantSpec):
        spec = spec if spec.senses.touch else spec.with_(senses={"touch": {}})
        self._variants, self._seed = SpecVariants(spec), spec.scene.seed
        self._made: dict[float, Variant] = {}

    def __call__(self, age_months: float) -> Variant:
        if age_months not in self._made:
            self._made[age_months] = self._variants(age_months, self._seed)
        return self._made[age_months]


def _text(name: str) -> str:
    try:
        return (FOLDER / name).read_text(encoding="utf-8")
    except FileNotFoundError:
        raise MimocError(f"mimoc/viewer/{name} is missing; in a checkout, `make viewer` builds it") from None


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")
