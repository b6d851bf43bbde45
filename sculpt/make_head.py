"""Make the head that ships with mimoc, at all ages: `python sculpt/make_skin.py --only head`. It needs scikit-image."""

import head as heads
import meshing
import numpy as np
from faces import MESHED, SHAPES, FaceShape
from fields import Array
from scipy.interpolate import RBFInterpolator

from mimoc.compiler.building import builder
from mimoc.looks.skin.template_mesh import FOLDER
from mimoc.schema.infant import InfantSpec

AGE_MONTHS = 9.0
"""Age of the child whose head's solid all ages are sculpted on."""
SEED = 16


def sculpt_head() -> dict[str, Array]:
    """Return the arrays of the head."""
    sculpted = reference_head()
    verts, faces, twins = heads.mesh(sculpted, SHAPES[MESHED], np.random.default_rng(SEED))
    origin, split, places = heads.split_at_end(sculpted, verts, faces)
    at_ages = [aged(sculpted, verts, twins, SHAPES[age])[origin] for age in SHAPES]
    print("head", len(origin), "vertices, defects", meshing.defects(faces))
    return {
        "ages_months": np.array(list(SHAPES), float),
        "at_ages_m": (np.array(at_ages) / 1000).astype(np.float32),
        "closing_right_m": (heads.closing(sculpted, verts, -1.0)[origin] / 1000).astype(np.float32),
        "closing_left_m": (heads.closing(sculpted, verts, 1.0)[origin] / 1000).astype(np.float32),
        "faces": split.astype(np.uint16),
        "texcoords": places.astype(np.float32),
        "half_axes_m": sculpted.half_axes / 1000,
        "eye_m": sculpted.eye / 1000,
        "eye_radius_m": np.array(sculpted.eye_radius / 1000),
    }


def reference_head() -> heads.Head:
    """Return the solids of the head of an average child."""
    spec = InfantSpec.model_validate({"mimoc": 1, "name": "child", "age_months": AGE_MONTHS})
    tree = builder(spec).tree
    solid, eye = tree.geoms["head"], next(body for body in tree.bodies if body.name == "right_eye")
    middle = np.subtract(eye.pos_m, solid.pos_m)
    return heads.Head(np.array(solid.size_m) * 1000, middle * 1000, tree.geoms["right_eye1"].size_m[0] * 1000)


def aged(head: heads.Head, verts: Array, twins: np.ndarray, shape: FaceShape) -> Array:
    """Return the vertices of the mesh on the head of another age: features go with features.

    Args:
        head: The solids.
        verts: Of the mesh.
        twins: The vertex that each vertex moves with; what is not its own twin leads into the head.
        shape: Of the other age.
    """
    before, after = landmarks(head, SHAPES[MESHED]), landmarks(head, shape)
    moves = RBFInterpolator(before, after - before, kernel="thin_plate_spline")(verts)
    on_field = meshing.onto(heads.field(head, shape), verts + moves, rounds=8, most=2.0)
    from_eye = np.linalg.norm(heads.folded(verts) - head.eye, axis=1) / head.eye_radius
    share = np.clip((from_eye - 1.14) / 0.3, 0, 1)[:, None]
    share = share * share * (3 - 2 * share)
    found = verts + share * (on_field - verts)
    for sign in (-1.0, 1.0):
        found = found + heads.lids_moved(head, verts, sign, *shape.lids)
    inward = np.flatnonzero(twins != np.arange(len(verts)))
    found[inward] = found[twins[inward]] + (verts[inward] - verts[twins[inward]])
    return found


def landmarks(head: heads.Head, shape: FaceShape) -> Array:
    """Return places on a face that correspond between ages, and others that stay."""
    (tip_x, tip_z, _), (mouth_x, mouth_z) = shape.tip, shape.mouth
    chin_x, chin_z, radius = shape.chin
    jaw_x, jaw_z = shape.jaw
    across = [
        (tip_x + 5, 0, tip_z),
        (tip_x - 2, 0, tip_z - 7),
        (tip_x - 4, shape.wing[0] + 3, tip_z - 2),
        (mouth_x - 1, 0, mouth_z + 3),
        (mouth_x, 0, mouth_z),
        (mouth_x - 1, 0, mouth_z - 4),
        (mouth_x - 9, heads.MOUTH_HALF, mouth_z + 1),
        (chin_x, 0, chin_z),
        (chin_x - radius, 0, chin_z - radius),
        (jaw_x, 0, jaw_z - shape.jaw_size[2]),
        (jaw_x, shape.jaw_size[1], jaw_z),
    ]
    ax, ay, az = head.half_axes
    stay = [(ax, 0, 0.3 * az), (0.7 * ax, 0, 0.7 * az), (0, 0, az), (-ax, 0, 0), (-0.5 * ax, 0, -0.8 * az), (0, ay, 0)]
    stay += [(-0.1 * ax, ay, -0.35 * az), (0.5 * ax, 0.8 * ay, 0.2 * az), (0.45 * ax, 0.87 * ay, -0.15 * az)]
    ring = [(0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    stay += [tuple(head.eye * (1, -1, 1) + np.array((6.0, 0, 0)) + 12.0 * np.array(way)) for way in ring]
    points = [*across, *stay]
    return np.array([*points, *((x, -y, z) for x, y, z in points if y)], float)


def main() -> None:
    """Write the head."""
    np.savez_compressed(FOLDER / "head.npz", **sculpt_head())


if __name__ == "__main__":
    main()
