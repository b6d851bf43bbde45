"""Infants for worlds with several of them, and places of these."""

from pathlib import Path
from typing import Any

from support.store import made_once

import mimoc
from mimoc.bundle.world import WorldBundle
from mimoc.schema import source
from mimoc.schema.reading import read_keys
from mimoc.schema.world import WorldPlan, WorldSpec, checked_plan, read_world

TOUCHING = {"proprioception": {}, "vestibular": {}, "touch": {"density": 0.3, "quantity": "force_vector_global"}}
ANNA: dict[str, Any] = {"mimoc": 1, "name": "anna", "age_months": 9, "senses": TOUCHING}
BEN: dict[str, Any] = {"mimoc": 1, "name": "ben", "age_months": 3, "senses": TOUCHING}


def written(folder: Path, text: str, **infants: dict[str, Any]) -> Path:
    """Write a world and the specs of infants into a folder, each with its own name; return the path of the world."""
    for name, data in infants.items():
        spec = mimoc.InfantSpec.model_validate(data)
        (folder / f"{name}.yaml").write_text(mimoc.schema.infant.as_written(spec).text)
    (folder / "world.yaml").write_text("mimoc: 1\nname: pair\n" + text)
    return folder / "world.yaml"


def plan(path: Path) -> WorldPlan:
    return read_world(source.read(path))


def placed(infants: dict[str, dict[str, Any]], *places: dict[str, Any], **keys: Any) -> WorldBundle:
    return mimoc.build_world(plan_of(infants, *places, **keys))


def plan_of(infants: dict[str, dict[str, Any]], *places: dict[str, Any], **keys: Any) -> WorldPlan:
    entries = [{"spec": name, "name": name, **place} for name, place in zip(infants, places, strict=True)]
    data = {"mimoc": 1, "name": "placed", "infants": entries, **keys}
    spec = read_keys(WorldSpec, source.in_memory_as_text(data, "<placed>", Path()))
    return checked_plan(spec, [mimoc.InfantSpec.model_validate(item) for item in infants.values()])


def world(scene: dict[str, Any] | None = None, **infants: dict[str, Any]) -> WorldBundle:
    """Return the bundle of infants by name, side by side, built once in a run of the tests."""
    keys = {"scene": scene} if scene else {}
    specs = {name: mimoc.InfantSpec.model_validate(data) for name, data in infants.items()}
    return made_once(f"world {infants} {scene}", lambda: mimoc.build_world(specs, **keys))
