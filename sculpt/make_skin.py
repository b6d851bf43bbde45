"""Make the skins that ship with mimoc: `python sculpt/make_skin.py`, or `make skin`. It needs scikit-image."""

import argparse
from collections.abc import Mapping
from pathlib import Path

import clothes
import figure
import meshing
import numpy as np
import resting
import shading
import stretching
import weights
from fields import Array
from make_head import sculpt_head

from mimoc.body.head_surface import head_radius
from mimoc.body.kinematics import frames, pose
from mimoc.body.tree import BodyTree
from mimoc.compiler.building import builder
from mimoc.looks.skin.deformation import boxes
from mimoc.looks.skin.surface_distance import height_above, surface_distance
from mimoc.looks.skin.template_mesh import FOLDER, assembled
from mimoc.schema.infant import InfantSpec

AGE_MONTHS = 9.0
SPREAD_DEG = 14.0
"""How far the fingers are spread, so that they are not meshed as one."""
ANGLES_DEG = {
    "shoulder_ad_ab": 50,
    "shoulder_horizontal": 25,
    "elbow": -65,
    "hip1": -60,
    "hip2": -20,
    "knee": -65,
    "fingers": -60,
    "foot1": -5,
    "th_swivel": 30,
    "th_adduction": -30,
    "th_middle": 22,
    "th_distal": 22,
    **{
        f"{finger}_{joint}": angle
        for finger in ("ff", "mf", "rf", "lf")
        for joint, angle in (("knuckle", 35), ("middle", 40), ("distal", 30))
    },
    "ff_side": SPREAD_DEG,
    "rf_side": -SPREAD_DEG / 2,
    "lf_side": -SPREAD_DEG,
}
"""The pose that the skin is bound in: near the middle of the joints' ranges, with limbs clear of each other, [deg]."""
TOES_DEG = {"big_toe": 28, "toes": -12}
"""Where a big toe moves on its own, it is apart from the others."""
LOW, HIGH = np.array((-80.0, -280.0, -260.0)), np.array((270.0, 280.0, 320.0))
SEED = 16
ROUNDS, PRESSED = 14, 3
"""How often the skin is pressed onto the floor and its weights are eased, at most, and after how often it is flat."""
ENOUGH = 3.4
"""Stretch that is small enough to stop."""


def main() -> None:
    """Write the skins of both kinds of hands, and the head."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cell", type=float, default=1.0, help="edge of a cell of marching cubes on the body, in mm")
    parser.add_argument("--only", choices=("mitten", "five_finger", "head"), help="make only this")
    asked = parser.parse_args()
    FOLDER.mkdir(exist_ok=True)
    for hands in ("mitten", "five_finger"):
        if asked.only in (None, hands):
            _save(FOLDER / f"{hands}.npz", sculpt(hands, asked.cell))
    if asked.only in (None, "head"):
        _save(FOLDER / "head.npz", sculpt_head())


def _save(path: Path, arrays: Mapping[str, Array]) -> None:
    np.savez_compressed(path, **arrays)
    print(
        path,
        f"{path.stat().st_size / 1000:.0f} kB",
        {name: len(each) for name, each in arrays.items() if name.endswith("verts_m")},
    )


def child(hands: str) -> BodyTree:
    """Return the body that is sculpted on: an average child."""
    return builder(
        InfantSpec.model_validate({"mimoc": 1, "name": "child", "age_months": AGE_MONTHS, "body": {"hands": hands}})
    ).tree


def sculpt(hands: str, cell_mm: float) -> dict[str, Array]:
    """Return the arrays of the skin for a kind of hands."""
    tree = child(hands)
    wanted = {
        f"robot:{side}_{joint}": np.radians(angle) for side in ("left", "right") for joint, angle in ANGLES_DEG.items()
    }
    apart = {f"robot:{side}_{toe}": np.radians(angle) for side in ("left", "right") for toe, angle in TOES_DEG.items()}
    wanted |= apart if hands == "five_finger" else {}
    angles = {joint: angle for joint, angle in wanted.items() if joint in tree.joints}
    placed = frames(tree, angles)
    sculpted = figure.build(placed, hands)
    parts = [body.name for body in tree.bodies if "eye" not in body.name]
    rng = np.random.default_rng(SEED)
    skin = _skin(sculpted, cell_mm, rng)
    held = weights.weights(*skin, sculpted.solids, parts)
    found = _common(tree, parts, angles, placed)
    layers, twins = {"body": (*skin, held)}, {}
    sewn = {cloth.name: cloth for cloth in (clothes.shirt(sculpted, placed), clothes.trousers(sculpted, placed))}
    for name, cloth in sewn.items():
        verts, faces, twins[name] = _cloth(cloth, cell_mm, rng)
        below = weights.eased(held, parts, name, skin[0])
        layers[name] = (verts, faces, weights.carried_over(skin[0], below, verts, faces, twins[name]))
    layers["body"] = _uncovered(*layers["body"], parts, sewn)
    twins["body"] = np.arange(len(layers["body"][0]))
    head = sculpt_head()
    colours = {name: shading.texcoords(name, layer[0], layer[1], sculpted, hands) for name, layer in layers.items()}
    best, least = found, np.inf
    for number in range(ROUNDS):
        for name, (verts, faces, own) in layers.items():
            arrays = _layer(tree, angles, verts, faces, own, colours[name])
            found |= {f"{name}/{key}": array for key, array in arrays.items()}
        sculpted_skin = assembled(found, head)
        moves, stretch = resting.pressed(sculpted_skin, hands), stretching.stretches(sculpted_skin, hands)
        flat = {name: f"{1000 * np.linalg.norm(move, axis=1).max():.2f} mm" for name, move in moves.items()}
        print("pressed flat by", flat, "stretched", {name: f"{each.max():.2f}" for name, each in stretch.items()})
        worst = max(each.max() for each in stretch.values())
        if number >= PRESSED and worst < least:
            best, least = dict(found), worst
        if least < ENOUGH:
            break
        layers = {
            name: (verts + 1000 * moves[name], faces, stretching.eased(own, twins[name], faces, stretch[name]))
            for name, (verts, faces, own) in layers.items()
        }
    return best


def _skin(sculpted: figure.Figure, cell_mm: float, rng: np.random.Generator) -> tuple[Array, np.ndarray]:
    field = sculpted.field()
    dense = meshing.largest(*meshing.surface(field, LOW, HIGH, cell_mm))
    verts, faces, _ = meshing.remesh(*dense, lambda points: _sizes(sculpted, points), rng)
    print("skin", len(dense[0]), "->", len(verts), "defects", meshing.defects(faces))
    verts = meshing.relax(field, meshing.onto(field, verts), faces, rounds=3)
    return meshing.without_slivers(verts, faces, SLIVER_MM)


SIZES = {"hand": 4.4, "lfmetacarpal": 4.0, "thbase": 3.6, "foot": 5.6, "toes": 3.3, "big_toe": 3.7, "fingers": 3.4}
SLIVER_MM = 0.9
"""Shorter edges are drawn together."""
TRUNK_SIZE, LIMB_SIZE, FINGER_SIZE = 11.0, 9.0, 3.1
"""Lengths of the skin's edges, [mm]."""


def _sizes(sculpted: figure.Figure, points: Array) -> Array:
    owners = weights.owners(points, sculpted.solids)
    limbs = {"upper_arm": LIMB_SIZE, "lower_arm": LIMB_SIZE, "upper_leg": 10.0, "lower_leg": 9.5}
    trunk = dict.fromkeys(("hip", "lower_body", "upper_body", "chest", "head"), TRUNK_SIZE)
    table = {**SIZES, **limbs, **trunk}
    names = {
        name: table.get(name.removeprefix("left_").removeprefix("right_"), FINGER_SIZE) for name in np.unique(owners)
    }
    return np.array([names[name] for name in owners])


def _cloth(cloth: clothes.Cloth, cell_mm: float, rng: np.random.Generator) -> tuple[Array, np.ndarray, np.ndarray]:
    dense = meshing.largest(*meshing.surface(cloth.layer, LOW, HIGH, 2 * cell_mm))
    near = cloth.cut(dense[0]) < 20
    dense = meshing.only(*dense, near)
    verts, faces, _ = meshing.remesh(*dense, lambda points: np.where(cloth.cut(points) > -10, 5.8, 13.0), rng)
    verts = meshing.relax(cloth.layer, meshing.onto(cloth.layer, verts), faces, rounds=2)
    found = clothes.sewn(cloth, verts, faces)
    print(cloth.name, len(dense[0]), "->", len(found[0]))
    return found


COVERED_MM = 22.0
"""How far inside of a hem the skin ends."""


CLOTHED = ("hip", "lower_body", "upper_body", "chest", "upper_arm", "upper_leg")
"""Bodies that clothes cover."""


def _uncovered(
    verts: Array, faces: np.ndarray, own: Array, parts: list[str], sewn: Mapping[str, clothes.Cloth]
) -> tuple[Array, np.ndarray, Array]:
    """Return the skin without what is deep under clothes or in the head."""
    under = np.min([-cloth.bare(verts) for cloth in sewn.values()], axis=0)
    trunk = np.isin(np.array(parts)[own.argmax(axis=1)], [part for part in parts if part.endswith(CLOTHED)])
    keep = ~(trunk & (under > COVERED_MM)) & (verts[:, 2] < 300)
    number = np.arange(len(verts))
    kept, small = meshing.only(np.column_stack((verts, number)), faces, keep)
    return kept[:, :3], small, own[kept[:, 3].astype(int)]


def _common(tree: BodyTree, parts: list[str], angles: Mapping[str, float], placed: Mapping) -> dict[str, Array]:
    corners = boxes(tree)
    by_name = {body.name: body for body in tree.bodies}
    return {
        "parts": np.array(parts),
        "parents": np.array([by_name[part].parent or "" for part in parts]),
        "origins_m": np.array([placed[part][0] for part in parts]),
        "turns": np.array([placed[part][1] for part in parts]),
        "low_m": np.array([corners[part][0] for part in parts]),
        "high_m": np.array([corners[part][1] for part in parts]),
        "solids": np.array(list(tree.geoms)),
        "joints": np.array(list(angles)),
        "angles_rad": np.array(list(angles.values())),
        "head_radius_m": np.array(head_radius(tree.geoms["head"])),
    }


NEAR = 4


def _layer(
    tree: BodyTree, angles: Mapping[str, float], verts: Array, faces: np.ndarray, own: Array, colours: Array
) -> dict[str, Array]:
    """Return the arrays of one layer."""
    verts_m = verts / 1000
    order = np.argsort(-own, axis=1)[:, : weights.BONES]
    posed = pose(tree, angles)
    usable = [index for index, geom in enumerate(posed.geoms) if "eye" not in geom.name and geom.name != "head"]
    far = np.full((len(verts), len(posed.geoms)), np.inf)
    for index in usable:
        local = (verts_m - posed.centres[index]) @ posed.rotations[index]
        geom = posed.geoms[index]
        sizes = np.broadcast_to((*geom.size_m, *(0.0,) * (3 - len(geom.size_m))), local.shape)
        far[:, index] = height_above(geom.type, sizes, local)[0]
    near = np.argsort(far, axis=1)[:, :NEAR]
    fine = np.array(
        [
            ("hand" in name or "finger" in name or name.split("_")[-1][:2] in ("ff", "mf", "rf", "lf", "th"))
            or "toe" in name
            or "foot" in name
            for name in tree.geoms
        ]
    )
    blend_m = np.where(fine[near[:, 0]], 0.0015, 0.006)
    offsets_m, _ = surface_distance(posed, list(tree.geoms), near, blend_m, verts_m)
    return {
        "verts_m": verts_m.astype(np.float32),
        "faces": faces.astype(np.uint16),
        "texcoords": colours.astype(np.float32),
        "bones": order.astype(np.uint8),
        "weights": np.rint(255 * np.take_along_axis(own, order, axis=1)).astype(np.uint8),
        "solids": near.astype(np.uint8),
        "offsets_m": offsets_m.astype(np.float32),
        "blend_m": blend_m.astype(np.float32),
    }


if __name__ == "__main__":
    main()
