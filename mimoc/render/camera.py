"""Where a camera stands so that all of something is in its picture, and no wall is between them."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.rotations import FloatArray, direction
from mimoc.base.geometry.solvers import root
from mimoc.bundle.model import in_subtrees
from mimoc.render.renderer import Shown

View = tuple[float, float]  # Azimuth and elevation of the direction that a camera looks in, [deg].
FROM_THE_SIDE: View = (160.0, -12.0)  # From the front of an infant, a little to its right and above.
FROM_THE_FRONT: View = (180.0, -4.0)
FROM_ABOVE: View = (160.0, -25.0)  # For what lies around an infant.
RAISED_DEG = 48.0
"""How much higher the camera stands for an infant that lies, so that more of it shows than its feet or its crown."""
FOVY_DEG = 24.0
"""Vertical field of view of a camera that has the space: narrow, from far away, which leaves heads round."""
WIDEST_DEG = 100.0
MARGIN = 1.06  # How much wider the field of view is than what it has to show, if nothing else is said.
CLEARANCE_M = 0.05  # The least distance of a camera from a wall.
PRECISION_DEG = 0.02  # Precision of the narrowest field of view with which a camera is clear of the walls.
TURNS_DEG = (0, 30, -30, 60, -60, 90, -90, 120, -120, 150, -150, 180)  # Other directions to look from, the best first.
TURN_COST = 0.2  # How many degrees wider the field of view may be if the camera then turns by one degree less.
BEHIND_COST = 360.0  # More than anything else costs: no camera looks through a wall if there is another way.


@dataclass(frozen=True, slots=True)
class Spheres:
    """What is to be in the picture, as n spheres."""

    centres_m: FloatArray  # Shape (n, 3), in the world.
    radii_m: FloatArray  # Shape (n,).

    def radius_m(self, middle_m: FloatArray) -> float:
        """Return the radius of the sphere around a point, shape (3,), that holds all of them."""
        return float((np.linalg.norm(self.centres_m - middle_m, axis=1) + self.radii_m).max())


@dataclass(frozen=True, slots=True)
class Planes:
    """The planes around a scene, which can be seen through from behind."""

    points_m: FloatArray  # A point of each, shape (n, 3), in the world.
    normals: FloatArray  # Shape (n, 3), towards where it can be seen from.

    def clearance_m(self, position_m: FloatArray) -> float:
        """Return how far a point is in front of the nearest plane; below 0 if it is behind one."""
        return float(((position_m - self.points_m) * self.normals).sum(axis=1).min(initial=np.inf))


@dataclass(frozen=True, slots=True)
class Shot:
    """A camera's position, direction and field of view."""

    position_m: FloatArray  # The camera's position, shape (3,), in the world.
    depth_m: float  # Distance along its axis to the middle of what it shows.
    view: View
    fovy_deg: float

    @property
    def lookat_m(self) -> FloatArray:
        """The point in the middle of the picture, shape (3,), in the world."""
        return self.position_m + self.depth_m * camera_axes(self.view)[0]

    @property
    def half_height_m(self) -> float:
        """Half of the height of what it shows, in the middle."""
        return self.depth_m * float(np.tan(np.radians(self.fovy_deg) / 2))

    def px_per_m(self, height_px: int) -> float:
        """Return how many pixels of a picture a metre takes in the middle of what it shows."""
        return height_px / (2 * self.half_height_m)

    def from_distance(self, distance_m: float, fovy_deg: float) -> "Shot":
        """Return a shot of the same point in the same direction, whatever it then shows and stands behind."""
        position_m = self.lookat_m - distance_m * camera_axes(self.view)[0]
        return Shot(position_m, distance_m, self.view, fovy_deg)


def fit_shot(
    spheres: Spheres, walls: Planes, view: View, aspect: float, fovy_deg: float = FOVY_DEG, margin: float = MARGIN
) -> Shot:
    """Return a shot that some spheres fill, looking in a direction, for a picture of an aspect, width over height.

    Where walls leave too little space for that, its vertical field of view gets wider. The margin is how much wider it
    is than what it has to show.
    """

    def shot(fovy_deg: float) -> Shot:
        return _closest_shot(spheres, view, aspect, fovy_deg, margin)

    def space_m(fovy_deg: float) -> float:
        return walls.clearance_m(shot(fovy_deg).position_m) - CLEARANCE_M

    if space_m(fovy_deg) >= 0:
        return shot(fovy_deg)
    if space_m(WIDEST_DEG) <= 0:
        return shot(WIDEST_DEG)
    narrowest_deg = root(space_m, fovy_deg, WIDEST_DEG, PRECISION_DEG / 2)
    return shot(min(narrowest_deg + PRECISION_DEG, WIDEST_DEG))


def _closest_shot(spheres: Spheres, view: View, aspect: float, fovy_deg: float, margin: float) -> Shot:
    """Return the closest shot that shows all of some spheres.

    Along a camera's axes, a sphere at (a, x, y) of radius r is between two sides of the field of view of a camera at
    (a0, x0, y0), which sees to h on either side, if |x - x0| + r / cos h <= (a - a0) tan h.

    With s = r / cos h - a tan h, the two sides ask for x0 - a0 tan h >= max(x + s) and -x0 - a0 tan h >= max(s - x),
    each over all spheres. The closest camera meets both with equality: x0 is half of the difference of the two maxima,
    and a0 is minus half of their sum, divided by tan h. The same holds for y. Of the two directions, the one that needs
    more distance decides.
    """
    axes = camera_axes(view)
    ahead, *across = axes @ spheres.centres_m.T
    tan_vertical = np.tan(np.radians(fovy_deg) / 2) / margin
    sideways, backs = [], []
    for offset, tan in zip(across, (tan_vertical * aspect, tan_vertical), strict=True):
        s = spheres.radii_m * np.hypot(1, tan) - ahead * tan
        upper, lower = (offset + s).max(), (s - offset).max()
        sideways.append((upper - lower) / 2)
        backs.append(-(upper + lower) / (2 * tan))
    back = min(backs)
    return Shot(np.array([back, *sideways]) @ axes, float(ahead.mean() - back), view, fovy_deg)


def shows(shot: Shot, spheres: Spheres, aspect: float) -> bool:
    """Return whether all of some spheres are in a shot."""
    ahead, right, up = camera_axes(shot.view) @ (spheres.centres_m - shot.position_m).T
    tan_vertical = np.tan(np.radians(shot.fovy_deg) / 2)
    return all(
        (np.abs(offset) + spheres.radii_m * np.hypot(1, tan) <= ahead * tan).all()
        for offset, tan in ((right, tan_vertical * aspect), (up, tan_vertical))
    )


def unobstructed_view(spheres: Spheres, walls: Planes, view: View, aspect: float, fovy_deg: float = FOVY_DEG) -> View:
    """Return a view, turned about the vertical to where the walls leave space, if they do not where it is."""
    azimuth, elevation = view

    def cost(turn_deg: float) -> float:
        shot = fit_shot(spheres, walls, (azimuth + turn_deg, elevation), aspect, fovy_deg)
        behind = walls.clearance_m(shot.position_m) < 0
        return shot.fovy_deg + TURN_COST * abs(turn_deg) + BEHIND_COST * behind

    return azimuth + min(TURNS_DEG, key=cost), elevation


def view_of_body(view: View, data: mujoco.MjData, body: str) -> View:
    """Return a view relative to a body that is turned about the vertical and may lie on its back or its face.

    One that lies is seen from above: from beyond its feet if it is on its back, from beyond its head if on its face.
    """
    world_from_body = data.body(body).xmat.reshape(3, 3)
    across_x, across_y = world_from_body[:2, 1]  # The body's left stays level.
    lying = float(world_from_body[2, 0])  # This is 1 on its back and -1 on its face.
    azimuth, elevation = view
    return azimuth + float(np.degrees(np.arctan2(-across_x, across_y))), elevation - RAISED_DEG * lying**2


def view_of_bodies(view: View, data: mujoco.MjData, bodies: Sequence[str]) -> View:
    """Return a view of one body, see `view_of_body`, or of several, none of which hides another.

    Of the two ways to look across the line from the first to the last, it is the one nearer to the view of the first.
    """
    views = [view_of_body(view, data, body) for body in bodies]
    if len(bodies) == 1:
        return views[0]
    x_m, y_m = (data.body(bodies[-1]).xpos - data.body(bodies[0]).xpos)[:2].tolist()
    across = float(np.degrees(np.arctan2(y_m, x_m))) + 90.0
    ahead = min(across, across + 180.0, key=lambda azimuth: -np.cos(np.radians(azimuth - views[0][0])))
    return ahead, min(elevation for _, elevation in views)


def bounding_spheres(model: mujoco.MjModel, data: mujoco.MjData, seen: npt.NDArray[np.bool_]) -> Spheres:
    """Return the bounding sphere of each geom that is *seen*, shape (ngeom,)."""
    return Spheres(data.geom_xpos[seen], model.geom_rbound[seen])


def planes_of(model: mujoco.MjModel, data: mujoco.MjData) -> Planes:
    """Return the planes of a model."""
    planes = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE
    return Planes(data.geom_xpos[planes], data.geom_xmat[planes].reshape(-1, 3, 3)[:, :, 2])


def camera_axes(view: View) -> FloatArray:
    """Return the unit vectors ahead, right and up of a camera, in rows."""
    azimuth, elevation = np.radians(view)
    ahead = direction(azimuth, elevation)
    right = direction(azimuth - np.pi / 2, 0.0)
    return np.array([ahead, right, np.cross(right, ahead)])


FILLED = 0.78  # Share of a portrait's height or width that an infant takes.
FILLED_BY_HEAD = 0.84  # Share of a portrait of a head alone that the head takes.
FACE_ASIDE, FACE_AHEAD, LOW_DEG = 128.0, 147.0, -18.0
"""Azimuths and elevation of the view of an infant on its belly or on all fours, from beyond its head and to its right,
if its face lies to a side, and if it looks ahead (D)."""
ABOVE_DEG = -78.0  # Elevation of the view of an infant on its back, which shows its face and not its chin (D).
FACE_TO_FACE: View = (-20.0, -6.0)
"""View of a head: how far it is turned from the camera, and the camera's elevation if it is upright (D)."""
SIDEWAYS = 0.35  # Component of a face's direction along the infant's left from which on it looks to a side.
VERTICAL = 0.75  # Component of a face's direction along the vertical from which on it looks up or down.
STEEP_DEG, LEVEL_DEG = 75.0, 4.0  # Elevation of a camera above a face that looks up, and the least above any face.


def portrait_view(data: mujoco.MjData, root: str, head: str | None) -> View:
    """Return the direction that shows an infant best: from its front, or from above where it lies on its back.

    One that lies on its face is seen from where it looks, and not from far above.
    """
    lying = float(_axis(data, root, 0)[2])  # This is 1 on its back and -1 on its face.
    if lying > -0.5:
        azimuth, elevation = view_of_body(FROM_THE_SIDE, data, root)
        return azimuth, min(elevation, ABOVE_DEG) if lying > 0.5 else elevation
    aside = 0.0 if head is None else float(_axis(data, head, 0) @ _axis(data, root, 1))
    azimuth = FACE_ASIDE if abs(aside) > SIDEWAYS else FACE_AHEAD
    usual, _ = view_of_body((360.0 - azimuth if aside > SIDEWAYS else azimuth, 0.0), data, root)
    return usual, LOW_DEG


def view_of_head(data: mujoco.MjData, head: str) -> View:
    """Return the direction that shows a head from before it, a little to its right and above."""
    ahead = _axis(data, head, 0)
    crown = _axis(data, head, 2)
    turned_deg, elevation = FACE_TO_FACE
    if ahead[2] > VERTICAL:
        return _azimuth_deg(crown) + turned_deg, -STEEP_DEG
    if ahead[2] < -VERTICAL:  # The camera stands before its crown, as low as it may.
        return _azimuth_deg(-crown) + turned_deg, -LEVEL_DEG
    level_deg = float(np.degrees(np.arcsin(np.clip(ahead[2], -1, 1))))
    return _azimuth_deg(-ahead) + turned_deg, min(elevation - level_deg, -LEVEL_DEG)


def _axis(data: mujoco.MjData, body: str, axis: int) -> FloatArray:
    return data.body(body).xmat.reshape(3, 3)[:, axis]


def _azimuth_deg(vector: FloatArray) -> float:
    return float(np.degrees(np.arctan2(vector[1], vector[0])))


def drawn_spheres(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    scene: mujoco.MjvScene,
    bodies: Sequence[str],
    drawn: npt.NDArray[np.bool_],
    shown: Shown,
) -> Spheres:
    """Return what is drawn of the given bodies, and of those below them, as spheres; vertices have a radius of 0."""
    held = in_subtrees(model, [model.body(body).id for body in bodies])
    vertices_m = np.reshape(scene.skinvert, (-1, 3))
    skins = [
        vertices_m[scene.skinvertadr[number] : scene.skinvertadr[number] + scene.skinvertnum[number]]
        for number in range(scene.nskin)
        if shown == "skin" and held[_bones(model, number)].all()
    ]
    geoms = held[model.geom_bodyid]
    solids = tight_spheres(model, data, geoms & drawn if skins else geoms)
    points_m = np.concatenate([solids.centres_m, *skins])
    return Spheres(points_m, np.concatenate([solids.radii_m, np.zeros(len(points_m) - len(solids.radii_m))]))


def _bones(model: mujoco.MjModel, skin: int) -> npt.NDArray[np.int32]:
    start = model.skin_boneadr[skin]
    count = model.skin_bonenum[skin]
    return model.skin_bonebodyid[start : start + count]


CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
ENDS = np.array([(0, 0, -1), (0, 0, 1)], float)
SPHERE, CAPSULE = mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_CAPSULE
ELLIPSOID, CYLINDER = mujoco.mjtGeom.mjGEOM_ELLIPSOID, mujoco.mjtGeom.mjGEOM_CYLINDER


def tight_spheres(model: mujoco.MjModel, data: mujoco.MjData, geoms: npt.NDArray[np.bool_]) -> Spheres:
    """Return spheres whose convex hull contains the geoms that are given, shape (ngeom,).

    They are a sphere itself, the two ends of a capsule, and, with a radius of 0, the corners of the box around any
    other geom.
    """
    parts = [_of_geom(model, data, number) for number in np.flatnonzero(geoms).tolist()]
    if not parts:
        return Spheres(np.empty((0, 3)), np.empty(0))
    return Spheres(np.concatenate([part.centres_m for part in parts]), np.concatenate([part.radii_m for part in parts]))


def _of_geom(model: mujoco.MjModel, data: mujoco.MjData, number: int) -> Spheres:
    kind = model.geom_type[number]
    size_m = model.geom_size[number]
    if kind == SPHERE:
        local_m, radius_m = np.zeros((1, 3)), size_m[0]
    elif kind == CAPSULE:
        local_m, radius_m = ENDS * size_m[1], size_m[0]
    else:
        local_m, radius_m = model.geom_aabb[number, :3] + CORNERS * model.geom_aabb[number, 3:], 0.0
    centres_m = data.geom_xpos[number] + local_m @ data.geom_xmat[number].reshape(3, 3).T
    return Spheres(centres_m, np.full(len(centres_m), radius_m))


def lowest_m(model: mujoco.MjModel, data: mujoco.MjData, geoms: npt.NDArray[np.bool_]) -> float:
    """Return the height of the lowest point of the geoms that are given, shape (ngeom,)."""
    return min(
        float(data.geom_xpos[number, 2]) - _drop_m(model, data, number) for number in np.flatnonzero(geoms).tolist()
    )


def _drop_m(model: mujoco.MjModel, data: mujoco.MjData, number: int) -> float:
    """Return how far a geom reaches below its origin: the support function of its kind for straight down."""
    vertical = data.geom_xmat[number].reshape(3, 3)[2]  # The world's z axis in the geom's axes.
    kind = model.geom_type[number]
    size_m = model.geom_size[number]
    if kind == SPHERE:
        return float(size_m[0])
    if kind == CAPSULE:
        return float(size_m[0] + size_m[1] * abs(vertical[2]))
    if kind == ELLIPSOID:
        return float(np.linalg.norm(size_m * vertical))
    if kind == CYLINDER:
        return float(size_m[0] * np.hypot(vertical[0], vertical[1]) + size_m[1] * abs(vertical[2]))
    return float((np.abs(vertical) * model.geom_aabb[number, 3:]).sum() - vertical @ model.geom_aabb[number, :3])
