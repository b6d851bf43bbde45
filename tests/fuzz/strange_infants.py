"""The honest bundles that strangers begin with, and the files outside that they would like to read."""

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from fuzz.crafted_bundles import png

import mimoc
from mimoc.bundle.io import LOCK, digests

SPEC = {
    "mimoc": 1,
    "name": "child",
    "age_months": 9,
    "senses": {"proprioception": {}, "vestibular": {}, "touch": {}, "vision": {"width_px": 16, "height_px": 16}},
    "delays": {"preset": "physiological"},
    "noise": {"motor": 0.1, "proprioception_deg": 1.0},
}
VARIATIONS = (
    {},
    {"task": {"kind": "reach"}, "noise": {}},
    {"task": {"kind": "selfbody"}, "actuation": {"model": "muscle"}, "body": {"hands": "five_finger"}},
    {"task": {"kind": "catch"}, "noise": {"motor": 0.0}, "actuation": {"model": "position"}},
    {"task": {"kind": "rollover"}},
    {"task": {"kind": "standup"}},
    {"scene": {"kind": "crib", "seed": 3, "held": ["hip"], "toys": {"count": [1, 2]}}},
    {"scene": {"kind": "room", "seed": 7, "toys": {"count": [2, 3]}}, "actuation": {"locked": ["neck"]}},
)
"""What is added to the spec: together they have every sense, task, actuation and kind of scene."""
CANARIES = {
    "canary.png": png(1, 1, b"\0\0"),
    "canary.xml": b"<mujoco/>",
    "canary.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n",
    "canary.skn": bytes(16),
    "eye.png": png(1, 1, b"\0\0"),
}
"""Files that nobody may open."""


@cache
def honest_bundle(number: int) -> mimoc.Bundle:
    spec = {**SPEC, **VARIATIONS[number]}
    return mimoc.build(mimoc.InfantSpec.model_validate(spec))


def honest_files(number: int) -> dict[str, bytes]:
    return dict(honest_bundle(number).files)


def write_resealed(files: Mapping[str, bytes], folder: Path) -> Path:
    listed = {name: content for name, content in files.items() if name != LOCK}
    lock = json.dumps({"lock": 1, "versions": {}, "inputs": {}, "files": digests(listed)}).encode()
    for name, content in {**listed, LOCK: lock}.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return folder
