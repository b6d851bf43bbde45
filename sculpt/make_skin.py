"""Make the skins that ship with mimoc: `python sculpt/make_skin.py`, or `.ci/task skin`. It needs scikit-image."""

import argparse
from collections.abc import Mapping
from pathlib import Path

import cutting
import features
import figure
import meshing
import numpy as np
import stretching
import tailoring
import weights
from cutting import PLANE, Drawn
from fields import Array
from figure import Figure
from make_head import sculpt_head
from pictures.cloth import BANDS, PLACES, shade_of
from tailoring import GARMENTS, Cut
from weights import owners

from mimoc.base.arrays import read_arrays, together
from mimoc.body.kinematics import Frame, frames, pose
from mimoc.body.tree import BodyTree, head_radius
from mimoc.compiler.building import builder
from mimoc.compiler.looks.sculpture import FOLDER, assembled
from mimoc.compiler.looks.skin import boxes, height_above, surface_distance
from mimoc.schema.infant import InfantSpec

LOW, HIGH = np.array((-80.0, -280.0, -300.0)), np.array((270.0, 280.0, 320.0))
TOP = 308.0  # Above this height the neck is in the head.
SIZES = {
    "hand": 4.9,
    "lfmetacarpal": 4.6,
    "thbase": 4.6,
    "foot": 6.4,
    "toes": 3.9,
    "big_toe": 4.2,
    "fingers": 3.6,
    "upper_arm": 9.5,
    "lower_arm": 9.0,
    "upper_leg": 10.0,
    "lower_leg": 10.0,
    **dict.fromkeys(("hip", "lower_body", "upper_body", "chest", "head"), 12.5),
}
FINGER_SIZE = 3.3  # Lengths of edges, by body.
SEPARATE = {"hand": 5.3, "lfmetacarpal": 4.9, "thbase": 4.8, "toes": 4.3, "big_toe": 4.5, "foot": 6.8}
SEPARATE_FINGER_SIZE = 3.7  # The same of hands with five fingers, which have more bodies for a file to name.


def mesh(
    sculpted: figure.Figure, frames: Mapping[str, Frame], cell_mm: float, rng: np.random.Generator
) -> tuple[cutting.Drawn, Mapping[str, cutting.Curve]]:
    """Return the mesh and the hems."""
    field, curves = sculpted.field(), tailoring.hems(frames)
    fined = features.finer(frames)

    def size(points: Array) -> Array:
        return fined(points, sizes(sculpted, points))

    dense = meshing.largest(*meshing.surface(field, LOW, HIGH, cell_mm))
    dense = meshing.only(*dense, dense[0][:, 2] < TOP)
    verts, faces = meshing.remesh(*dense, size, rng)
    verts = meshing.relax(field, meshing.onto(field, verts), faces, rounds=3)
    half = cutting.right_half(field, verts, meshing.without_fins(faces))
    drawn = cutting.embedded(field, half, tuple(curves.values()), size)
    whole = cutting.mirrored(drawn)
    print("body", len(dense[0]), "->", len(whole.verts), "defects", meshing.defects(whole.faces))
    return whole, curves


def sizes(sculpted: figure.Figure, points: Array) -> Array:
    """Return the length of edges that is wanted at some points."""
    owners = weights.owners(points, sculpted.solids)
    is_separate = any("thbase" in solid.part for solid in sculpted.solids)
    table, finger = (SIZES | SEPARATE, SEPARATE_FINGER_SIZE) if is_separate else (SIZES, FINGER_SIZE)
    parts = {name: table.get(name.removeprefix("left_").removeprefix("right_"), finger) for name in set(owners)}
    return np.array([parts[name] for name in owners])


AGE_MONTHS = 9.0
SIDES = ("left", "right")
SPREAD_DEG = 14.0  # How far the fingers are spread, so that they are not meshed as one.
ANGLES_DEG = {
    "shoulder_ad_ab": 50,
    "shoulder_horizontal": 25,
    "elbow": -65,
    "hip1": -42,
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
TOES_DEG = {"big_toe": 28, "toes": -12}  # Where a big toe moves on its own, it is apart from the others.
SEED = 16
ROUNDS, PRESSED = 16, 3
"""How often the skin is pressed onto the floor and its weights are eased, at most, and after how often it is flat."""
ENOUGH = 2.25  # Stretch that is small enough to stop.


def main() -> None:
    """Write the skins of both kinds of hands, and the head."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cell", type=float, default=1.0, help="edge of a cell of marching cubes on the body, in mm")
    parser.add_argument("--only", choices=("mitten", "five_finger", "head"), help="make only this")
    asked = parser.parse_args()
    FOLDER.mkdir(exist_ok=True)
    if asked.only in (None, "head"):
        _save(FOLDER / "head.npz", sculpt_head())
    for hands in ("mitten", "five_finger"):
        if asked.only in (None, hands):
            _save(FOLDER / f"{hands}.npz", sculpt(hands, asked.cell))


def _save(path: Path, arrays: Mapping[str, Array]) -> None:
    np.savez_compressed(path, **arrays)
    print(path, f"{path.stat().st_size / 1000:.0f} kB", f"{len(arrays['faces'])} faces")


def child(hands: str) -> BodyTree:
    """Return the body that is sculpted on: an average child."""
    return builder(
        InfantSpec.model_validate({"mimoc": 1, "name": "child", "age_months": AGE_MONTHS, "body": {"hands": hands}})
    ).tree


def sculpt(hands: str, cell_mm: float) -> dict[str, np.ndarray]:
    """Return the arrays of the skin for a kind of hands."""
    tree = child(hands)
    angles = bound(tree)
    placed = frames(tree, angles)
    sculpted = figure.build(placed, hands)
    parts = [part.name for part in tree.bodies if "eye" not in part.name]
    drawn, curves = mesh(sculpted, placed, cell_mm, np.random.default_rng(SEED))
    above = {part.name: part.parent or "" for part in tree.bodies}
    held = weights.weights(drawn, sculpted, placed, {part: above[part] for part in parts})
    cut = tailoring.cut_out(drawn, curves, placed)
    fixed = together(
        _common(tree, parts, angles, placed),
        {"faces": drawn.faces.astype(np.uint16)},
        texcoords(drawn, sculpted, cut, _hanging_mm(tree, parts, placed, drawn.verts, held)),
        features.arrays(drawn.verts, held, parts, placed, hands),
    )
    head = read_arrays(FOLDER / "head.npz")
    best, least = fixed, np.inf
    for number in range(ROUNDS):
        arrays = together(fixed, _shape(tree, angles, drawn.verts), _moving(held), tailoring.arrays(cut))
        skin = assembled(arrays, head)
        pressed, room_mm = stretching.pressed(skin, hands, features.softness(drawn.verts, placed))
        fixed["fullness_100um"] = arrays["fullness_100um"] = pressed
        cut = tailoring.thinned(cut, room_mm)
        edges, stretch = stretching.stretches(skin, hands)
        print("round", number, "room", f"{room_mm.min():.2f} mm", "stretched", f"{stretch.max():.2f}", flush=True)
        if number >= PRESSED and stretch.max() < least:
            best, least = dict(arrays), stretch.max()
        if least < ENOUGH:
            break
        held = stretching.eased(held, edges, stretch, drawn.twins, parts)
        drawn = stretching.spaced(sculpted.field(), drawn, (PLANE, *curves.values()), edges, stretch)
    return best


def bound(tree: BodyTree) -> dict[str, float]:
    """Return the pose that the skin is bound in, by joint, [rad]."""
    wanted = {f"robot:{side}_{joint}": angle for side in SIDES for joint, angle in ANGLES_DEG.items()}
    if tree.hands == "five_finger":
        wanted |= {f"robot:{side}_{toe}": angle for side in SIDES for toe, angle in TOES_DEG.items()}
    return {joint: np.radians(angle) for joint, angle in wanted.items() if joint in tree.joints}


def _hanging_mm(tree: BodyTree, parts: list[str], placed: Mapping[str, Frame], verts: Array, held: Array) -> Array:
    """Return the height of each vertex where arms hang and legs are straight: stripes are level then."""
    straight, height = frames(tree, {}), np.zeros(len(verts))
    for index, part in enumerate(parts):
        (origin, turn), (other, other_turn) = placed[part], straight[part]
        moved = (verts - origin * 1000) @ (other_turn @ turn.T).T + other * 1000
        height += held[:, index] * moved[:, 2]
    return height


def _common(tree: BodyTree, parts: list[str], angles: Mapping[str, float], placed: Mapping) -> dict[str, np.ndarray]:
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
FINE = ("hand", "finger", "_ff", "_mf", "_rf", "_lf", "_th", "toe", "foot")
"""What geoms are called above which the skin is hardly blended."""


def _shape(tree: BodyTree, angles: Mapping[str, float], verts: Array) -> dict[str, np.ndarray]:
    """Return the arrays of vertices and of their heights above the solids."""
    verts_m = verts / 1000
    posed = pose(tree, angles)
    usable = [index for index, geom in enumerate(posed.geoms) if "eye" not in geom.name and geom.name != "head"]
    far = np.full((len(verts_m), len(posed.geoms)), np.inf)
    for index in usable:
        local = (verts_m - posed.centres[index]) @ posed.rotations[index]
        geom = posed.geoms[index]
        sizes = np.broadcast_to((*geom.size_m, *(0.0,) * (3 - len(geom.size_m))), local.shape)
        far[:, index] = height_above(geom.type, sizes, local)[0]
    near = np.argsort(far, axis=1, kind="stable")[:, :NEAR]
    is_fine = np.array([any(word in name for word in FINE) for name in tree.geoms])
    blend_m = np.where(is_fine[near[:, 0]], 0.0015, 0.006)
    offsets_m, _ = surface_distance(posed, list(tree.geoms), near, blend_m, verts_m)
    return {
        "verts_m": verts_m.astype(np.float32),
        "near": near.astype(np.uint8),
        "offsets_um": np.rint(offsets_m * 1e6).astype(np.int32),
        "blend_m": blend_m.astype(np.float32),
    }


def _moving(held: Array) -> dict[str, np.ndarray]:
    order = np.argsort(-held, axis=1, kind="stable")[:, : weights.BONES]
    return {
        "bones": order.astype(np.uint8),
        "weights": np.rint(255 * np.take_along_axis(held, order, axis=1)).astype(np.uint8),
    }


STRIPE_MM = 26.0  # Breadth of a light and a dark stripe of the shirt together.
REACH_MM = (1.5, 3.0, 6.0, 11.0)  # Distances from the surface at which it is asked how much of the space is filled.


def texcoords(drawn: Drawn, figure: Figure, cut: Cut, hanging_mm: Array) -> dict[str, np.ndarray]:
    """Return places in the texture of skin, along the pattern of cloth, and in the shades of each garment."""
    free = openness(figure, drawn.verts)
    shades = [shade_of(PLACES[name], cut.hem_mm[name] / BANDS[name], free) for name in GARMENTS]
    return {
        "texcoords": np.column_stack((0.02 + 0.96 * rosiness(figure, drawn.verts), 0.02 + 0.96 * free)).astype(
            np.float32
        ),
        "pattern": (hanging_mm / STRIPE_MM).astype(np.float32),
        "shades": np.rint(255 * np.array(shades)).astype(np.uint8),
    }


def openness(figure: Figure, verts: Array) -> Array:
    """Return how much of the space above each vertex is free, 0 to 1."""
    field = figure.field()
    normal = meshing.gradient(field, verts)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
    base = field(verts)
    free = [np.clip((field(verts + far * normal) - base) / far, 0, 1) for far in REACH_MM]
    return np.clip((np.mean(free, axis=0) - 0.35) / 0.65, 0, 1)


def rosiness(figure: Figure, verts: Array) -> Array:
    """Return how rosy the skin is, 0 to 1: knees, elbows, fingers, toes, palms and soles."""
    names = owners(verts, figure.solids)
    fingers = np.array([any(word in name for word in ("finger", "toe", "distal", "middle")) for name in names])
    rosy = 0.35 * fingers
    for side in ("left", "right"):
        for part, radius, most in (
            ("lower_leg", 24, 0.7),
            ("lower_arm", 22, 0.6),
            ("foot", 18, 0.7),
        ):
            joint = figure.joints[f"{side}_{part}"]
            rosy = np.maximum(rosy, most * np.exp(-(((np.linalg.norm(verts - joint, axis=1) - 14) / radius) ** 2)))
    return np.clip(rosy, 0, 1)


if __name__ == "__main__":
    main()
