"""Pages as text: what they know, maybe with physics, the program that shows it, and its style, in one file."""

import base64
import re
from collections.abc import Callable, Sequence
from functools import cache
from itertools import takewhile
from typing import Any
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import SpecError
from mimoc.base.rounding import rounded
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import mjcf_of
from mimoc.bundle.variants import Variant
from mimoc.compiler.variants import SpecVariants, spec_of
from mimoc.schema.infant import InfantSpec
from mimoc.version import __version__
from mimoc.viewer.appearance import describe_face, describe_materials, describe_skins, describe_surroundings
from mimoc.viewer.encoding import EncodedArrays, built, compressed, source
from mimoc.viewer.growth import (
    AGES_MONTHS,
    SKIN_AGES_MONTHS,
    describe_growth,
    describe_standards,
    describe_touch,
    own_parts,
    posed,
)

ENGINE, WASM = "mujoco.js", "mujoco.wasm.gz"
PHYSICS_AGES_MONTHS = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0, 15.0, 18.0, 24.0)
"""Ages that a page has models of, besides the infant's own."""
SHOWN_ONLY = ("material", "texture", "skin")
"""Elements of MJCF that physics does not need."""


def describe_physics(variants: Sequence[Variant]) -> dict[str, Any]:
    """Return the models of an infant at some ages as MJCF, and what of them is the infant's."""
    model, manifest = variants[0].model, variants[0].bundle.manifest
    parts = own_parts(model, manifest)
    return {
        "models": [_model(variant) for variant in variants],
        "bodies": parts.bodies,
        "qpos": parts.qpos,
        "around": [model.body(body).name for body in range(model.nbody)],
        "step_s": manifest.step_ms / 1000,
        "commanded": np.array(
            [model.actuator(one.name).id for one in manifest.actuation.actuators if one.commanded], int
        ),
    }


def _model(variant: Variant) -> dict[str, Any]:
    scene, files = mjcf_of(variant.bundle.files, variant.bundle.manifest.scene)
    bare = {name: _bare(content.decode()) for name, content in files.items() if name.endswith(".xml")}
    needed = {name: bare.get(name, files[name]) for name in files if name.endswith((".xml", ".obj", ".stl", ".msh"))}
    return {"age_months": variant.bundle.manifest.child.age_months, "scene": _bare(scene), "files": needed}


def _bare(mjcf: str) -> bytes:
    root = ElementTree.fromstring(mjcf)
    for parent in list(root.iter()):
        parent.attrib.pop("material", None)
        parent[:] = [child for child in parent if child.tag not in SHOWN_ONLY]
    return ElementTree.tostring(root)


Progress = Callable[[int, int], None]
PROGRAM, LICENCES = "viewer.js", "LICENCES.txt"
PLACE = re.compile(r"\{\{([a-z]+)\}\}")
"""Where something goes in the frame."""


def page_of(infant: Bundle, physics: bool = False, progress: Progress = lambda *_: None) -> str:
    """Return the page of an infant: HTML that any browser opens from disk.

    With *physics* it contains MuJoCo, so that the infant can fall, be pulled and act.

    Raises:
        BundleError: If the bundle does not contain its spec.
        MimocError: If it has other parts at other ages.
    """
    built(PROGRAM)
    return fill(describe(infant, physics, progress))


def describe(infant: Bundle, physics: bool = False, progress: Progress = lambda *_: None) -> dict[str, Any]:
    """Return what a page knows of an infant: see `page_of`."""
    spec = spec_of(infant)
    at, grown, shown_months = _grown(spec, progress)
    sparse = [at(age, True) for age in SKIN_AGES_MONTHS]
    manifest = infant.manifest
    shown = at(manifest.child.age_months, True)
    simulated_months = sorted({*PHYSICS_AGES_MONTHS, manifest.child.age_months}) if physics else []
    simulated = [at(age, age in SKIN_AGES_MONTHS) for age in simulated_months]
    model, data, face = shown.model, posed(shown), manifest.face
    return {
        "name": manifest.name,
        "version": __version__,
        "age_months": manifest.child.age_months,
        "sex": manifest.child.sex,
        "pose": manifest.pose,
        "bounds": _bounds(*shown_months),
        "groups": manifest.anatomy.groups,
        "trunk": manifest.anatomy.trunk,
        "faces": face
        and {
            "geom": face.geom,
            "materials": {name: model.material(material).id for name, material in face.materials.items()},
            "shown": spec.body.expression,
            "shapes": describe_face(sparse, SKIN_AGES_MONTHS),
        },
        **describe_growth(grown, AGES_MONTHS),
        "standards": describe_standards([variant.bundle.manifest.child for variant in grown]),
        "touch": describe_touch(sparse, SKIN_AGES_MONTHS),
        "skins": describe_skins(sparse, SKIN_AGES_MONTHS),
        **describe_materials(model),
        "physics": describe_physics(simulated) if physics else None,
        "surroundings": describe_surroundings(model, data, own_parts(model, manifest)),
    }


NOW = "now"
"""The pose that an environment is in, on its page."""


def with_posture(
    about: dict[str, Any], packed: EncodedArrays, qpos: npt.NDArray[np.float64], length_cm: float
) -> dict[str, Any]:
    """Return what a page knows of an infant that is in a posture now; at other ages the same, as high as it is long."""
    lengths_cm = packed.arrays[about["standards"]["charts"]["length_cm"]["plot"]["lines"][-1]["y"]["array"]]
    posture = np.tile(qpos, (len(lengths_cm), 1))
    posture[:, 2] *= lengths_cm / length_cm
    return {**about, "poses": {**about["poses"], NOW: packed.put(posture)}, "pose": NOW}


At = Callable[[float, bool], Variant]
"""Builds an infant at an age in months, dressed or not."""
Range = tuple[float, float]


def _grown(spec: InfantSpec, progress: Progress) -> tuple[At, list[Variant], Range]:
    """Return what builds an infant at the ages of a page, the infant at all of them, and within which there is one.

    Where its task or what lies around does not suit some ages, it is alone. At ages at which there is no such child at
    all, it is as at the nearest one at which there is: before term, or where a contracture leaves a joint no range.
    """
    build = _builder(spec)
    ages = _lasting(build, spec)
    if ages != (spec.earliest_months, AGES_MONTHS[-1]):
        toys = {"count": [0, 0]} if spec.scene.kind == "room" else None
        alone = spec.with_(task=None, scene={"toys": toys, "objects": (), "start_at": None, "caregiver": None})
        if alone != spec:
            return _grown(alone, progress)

    def at(age_months: float, dressed: bool) -> Variant:
        return build(min(max(age_months, ages[0]), ages[1]), dressed)

    grown = list[Variant]()
    for age in AGES_MONTHS:
        progress(len(grown), len(AGES_MONTHS))
        grown.append(at(age, age in SKIN_AGES_MONTHS))
    return at, grown, ages


def _lasting(build: At, spec: InfantSpec) -> Range:
    """Return between which ages around its own an infant can be built; of those between a page's, its own counts."""

    def exists(age_months: float) -> bool:
        try:
            build(age_months, age_months in SKIN_AGES_MONTHS)
        except SpecError:
            return False
        return True

    own, first = rounded(spec.age_months), spec.earliest_months
    younger = takewhile(exists, (max(age, first) for age in reversed(AGES_MONTHS) if age < own))
    older = takewhile(exists, (age for age in AGES_MONTHS if age > own))
    return min((own, *younger)), max((own, *older))


def _bounds(least: float, most: float) -> str:
    """Return what a page says of the ages at which there is no such child, if there are any."""
    beyond = [f"before {least:g} months"] if least > AGES_MONTHS[0] else []
    beyond += [f"after {most:g} months"] if most < AGES_MONTHS[-1] else []
    text = " or ".join(beyond)
    return f"There is no such child {text}; it is shown as it is then." if beyond else ""


def fill(data: dict[str, Any], packed: EncodedArrays | None = None) -> str:
    """Return the page that shows some data; MimocError if the program of the page, or MuJoCo's, is not built."""
    parts = (packed or EncodedArrays()).encode(data)
    licences = built(LICENCES).decode()
    if data["physics"]:
        # MuJoCo's program makes functions of text when it starts; without physics, a page forbids itself that.
        wasm = base64.b64encode(built(WASM)).decode()
        parts |= {"eval": " 'unsafe-eval'", "engine": built(ENGINE).decode(), "wasm": wasm}
        licences += "\n\n" + source("mujoco_licences.txt")
    parts |= {
        "title": _escaped(str(data["name"])),
        "bounds": _escaped(data["bounds"]),
        "style": source("style.css"),
        "licences": _escaped(licences),
        "program": compressed(built(PROGRAM)),
    }
    parts = {name: part.replace("</script", "<\\/script") for name, part in parts.items()}
    return PLACE.sub(lambda place: parts.get(place[1], ""), source("page.html"))


def _builder(spec: InfantSpec) -> At:
    """Return what builds the infant of a spec at an age, once, with touch so that its skin points can be shown.

    Undressed, without the smooth skin of its spec, it takes half the time.
    """
    spec = spec if spec.senses.touch else spec.with_(senses={"touch": {}})
    seen = {"senses": {"vision": {"body": "solids"}}} if spec.senses.vision else {}
    variants = {True: SpecVariants(spec), False: SpecVariants(spec.with_(body={"skin": False}, **seen))}
    return cache(lambda age_months, dressed: variants[dressed](age_months, spec.scene.seed))


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")
