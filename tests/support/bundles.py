"""Small bundles, each of whose files says which one it is."""

import json
from pathlib import Path

from mimoc.bundle.io import MANIFEST, Bundle, lock_files

CHILD = {"age_months": 9, "length_cm": 70, "weight_kg": 9, "head_circumference_cm": 44, "arm_circumference_cm": 14}
MANIFEST_DATA = {"child": CHILD, "root_body": "hip", "root_joint": "free", "timestep_ms": 5, "step_ms": 10}
MANIFEST_DATA |= {"pose": "supine", "poses": ["supine"], "actuation": {"actuators": []}, "senses": {}}


def make_bundle(mark: str = "one", **changes: object) -> Bundle:
    files = {f"assets/{n}.png": f"{mark} {n}".encode() * 3000 for n in range(8)}
    manifest = json.dumps({**MANIFEST_DATA, "name": mark, **changes}).encode()
    return lock_files({"infant.xml": mark.encode(), **files, MANIFEST: manifest}, {"mimoc": "1"}, {"who.csv": b"1,2"})


ONE, TWO = make_bundle("one"), make_bundle("two")


def contents(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
