"""Physics for a page: MuJoCo compiled for browsers, and the infant's models without what only shows."""

import base64
from collections.abc import Mapping, Sequence
from typing import Any
from xml.etree import ElementTree

import numpy as np

from mimoc.bundle.model import mjcf_of
from mimoc.bundle.variants import Variant
from mimoc.viewer.growth import own_parts
from mimoc.viewer.packing import EncodedArrays, built

ENGINE, WASM = "mujoco.js", "mujoco.wasm.gz"
AGES_MONTHS = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0, 15.0, 18.0, 24.0)
"""Ages that a page has models of, besides the infant's own."""
SHOWN_ONLY = ("material", "texture", "skin")
"""Elements of MJCF that physics does not need."""


def describe_physics(packed: EncodedArrays, variants: Sequence[Variant]) -> dict[str, Any]:
    """Return the models of an infant at some ages as MJCF, and what of them is the infant's.

    Args:
        packed: Where the arrays go.
        variants: The infant at each age.
    """
    model, manifest = variants[0].model, variants[0].bundle.manifest
    parts = own_parts(model, manifest)
    return {
        "models": [_model(packed, variant) for variant in variants],
        "bodies": packed.put(parts.bodies),
        "qpos": packed.put(parts.qpos),
        "around": [model.body(body).name for body in range(model.nbody)],
        "step_s": manifest.step_ms / 1000,
        "commanded": packed.put(
            np.array([model.actuator(one.name).id for one in manifest.actuation.actuators if one.commanded], int)
        ),
    }


def engine() -> Mapping[str, str]:
    """Return what a page with physics contains besides: MuJoCo's program, and its WebAssembly in base64.

    Raises:
        MimocError: If it has not been built.
    """
    # MuJoCo's program makes functions of text when it starts; without physics, a page forbids itself that.
    return {"eval": " 'unsafe-eval'", "engine": built(ENGINE).decode(), "wasm": base64.b64encode(built(WASM)).decode()}


def _model(packed: EncodedArrays, variant: Variant) -> dict[str, Any]:
    """Return a model and the files that it refers to, bare: MJCF and meshes."""
    scene, files = mjcf_of(variant.bundle.files, variant.bundle.manifest.scene)
    bare = {name: _bare(content.decode()) for name, content in files.items() if name.endswith(".xml")}
    needed = {name: bare.get(name, files[name]) for name in files if name.endswith((".xml", ".obj", ".stl", ".msh"))}
    return {
        "age_months": variant.bundle.manifest.child.age_months,
        "scene": packed.put(np.frombuffer(_bare(scene), np.uint8)),
        "files": {name: packed.put(np.frombuffer(content, np.uint8)) for name, content in needed.items()},
    }


def _bare(mjcf: str) -> bytes:
    """Return MJCF without what only shows."""
    root = ElementTree.fromstring(mjcf)
    for parent in list(root.iter()):
        parent.attrib.pop("material", None)
        for child in [element for element in parent if element.tag in SHOWN_ONLY]:
            parent.remove(child)
    return ElementTree.tostring(root)
