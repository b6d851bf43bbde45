"""Where a camera stands so that all of something is in its picture, and no wall is between them."""

from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.geometry.rotations import FloatArray, direction

View = tuple[float, float]
"""Azimuth and elevation of the direction that a camera looks in, [deg]."""
FROM_THE_SIDE: View = (160.0, -12.0)
"""From before an infant, a little to its right and above."""
FROM_BEFORE: View = (180.0, -4.0)
FROM_ABOVE: View = (160.0, -25.0)
"""As one looks at what lies around an infant."""
RAISED_DEG = 48.0
"""How much more from above an infant is seen that lies on its back, so that its face shows."""
LENS_DEG = 24.0
"""Vertical field of view of a camera that has the space: a long lens, which leaves heads round."""
WIDEST_DEG = 100.0
MARGIN = 1.06
"""How much wider the lens is than what it has to show, if nothing else is said."""
OFF_THE_WALL_M = 0.05
"""How near a camera may be to what is behind it."""
HALVINGS = 12
"""Of the range of lenses, until the narrowest is found whose camera stands in the room: to .02 degrees."""
TURNS_DEG = (0, 30, -30, 60, -60, 90, -90, 120, -120, 150, -150, 180)
"""From where else things can be seen, the best first."""
TURN_COST = 0.2
"""How many degrees wider a lens may be if the camera then has to turn one degree less."""
BEHIND_COST = 360.0
"""More than of anything else: a wall is not looked through if there is any other way."""


@dataclass(frozen=True, slots=True)
class Balls:
    """What is to be in the picture: n balls."""

    centres_m: FloatArray
    """Shape (n, 3), in the world."""
    radii_m: FloatArray
    """Shape (n,)."""


@dataclass(frozen=True, slots=True)
class Walls:
    """The planes around a scene, which can be seen through from behind."""

    points_m: FloatArray
    """A point of each, shape (n, 3), in the world."""
    normals: FloatArray
    """Shape (n, 3), towards where it can be seen from."""

    def before_m(self, place_m: FloatArray) -> float:
        """Return how far a place is before the nearest plane; below 0 if it is behind one."""
        return float(((place_m - self.points_m) * self.normals).sum(axis=1).min(initial=np.inf))


@dataclass(frozen=True, slots=True)
class Shot:
    """A camera's place, direction and lens."""

    place_m: FloatArray
    """Where the camera is, shape (3,), in the world."""
    depth_m: float
    """How far away from it, along its axis, the middle is of what it shows."""
    view: View
    fovy_deg: float
    """Vertical field of view."""

    @property
    def lookat_m(self) -> FloatArray:
        """The point in the middle of the picture, shape (3,), in the world."""
        return self.place_m + self.depth_m * camera_axes(self.view)[0]


def frame(
    balls: Balls, walls: Walls, view: View, aspect: float, fovy_deg: float = LENS_DEG, margin: float = MARGIN
) -> Shot:
    """Return a shot that some balls fill; where walls leave too little space for the lens, it gets wider.

    Args:
        balls: What is to be seen.
        walls: What the camera must not get behind.
        view: From where.
        aspect: Width of the picture over its height.
        fovy_deg: Vertical field of view, if there is space for it.
        margin: How much wider the lens is than what it has to show.
    """

    def fits(found: Shot) -> bool:
        return walls.before_m(found.place_m) >= OFF_THE_WALL_M

    narrow, wide = fovy_deg, WIDEST_DEG
    shot = _fill(balls, view, aspect, narrow, margin)
    if fits(shot):
        return shot
    shot = _fill(balls, view, aspect, wide, margin)
    for _ in range(HALVINGS):
        middle = (narrow + wide) / 2
        found = _fill(balls, view, aspect, middle, margin)
        narrow, wide, shot = (narrow, middle, found) if fits(found) else (middle, wide, shot)
    return shot


def _fill(balls: Balls, view: View, aspect: float, fovy_deg: float, margin: float) -> Shot:
    """Return the nearest shot of some balls that a lens shows all of.

    Along a camera's axes, a ball at (a, x, y) of radius r is between two sides of a lens at (a0, x0, y0), which sees to
    h on either side, if |x - x0| + r / cos h <= (a - a0) tan h.
    """
    axes = camera_axes(view)
    ahead, *across = axes @ balls.centres_m.T
    tan_vertical = np.tan(np.radians(fovy_deg) / 2) / margin
    place, backs = [], []
    for offset, tan in zip(across, (tan_vertical * aspect, tan_vertical), strict=True):
        reach = balls.radii_m * np.hypot(1, tan) - ahead * tan
        one, other = (offset + reach).max(), (reach - offset).max()
        place.append((one - other) / 2)
        backs.append(-(one + other) / (2 * tan))
    back = min(backs)
    return Shot(np.array([back, *place]) @ axes, float(ahead.mean() - back), view, fovy_deg)


def shows(shot: Shot, balls: Balls, aspect: float) -> bool:
    """Return whether all of some balls are in a shot."""
    ahead, right, up = camera_axes(shot.view) @ (balls.centres_m - shot.place_m).T
    tan_vertical = np.tan(np.radians(shot.fovy_deg) / 2)
    return all(
        (np.abs(offset) + balls.radii_m * np.hypot(1, tan) <= ahead * tan).all()
        for offset, tan in ((right, tan_vertical * aspect), (up, tan_vertical))
    )


def clearest(balls: Balls, walls: Walls, view: View, aspect: float, fovy_deg: float = LENS_DEG) -> View:
    """Return a view, turned about the vertical to where the walls leave space, if they do not where it is."""
    azimuth, elevation = view

    def cost(turn_deg: float) -> float:
        shot = frame(balls, walls, (azimuth + turn_deg, elevation), aspect, fovy_deg)
        behind = walls.before_m(shot.place_m) < 0
        return shot.fovy_deg + TURN_COST * abs(turn_deg) + BEHIND_COST * behind

    return azimuth + min(TURNS_DEG, key=cost), elevation


def towards(view: View, data: mujoco.MjData, body: str) -> View:
    """Return a view as a body sees it that is turned about the vertical and may lie on its back or its face.

    One that lies on its back is seen from above, one on its face from beyond its head.
    """
    world_from_body = data.body(body).xmat.reshape(3, 3)
    across_x, across_y = world_from_body[:2, 1]  # Its left, which stays level.
    facing_up = max(float(world_from_body[2, 0]), 0.0)
    azimuth, elevation = view
    return azimuth + float(np.degrees(np.arctan2(-across_x, across_y))), elevation - RAISED_DEG * facing_up**2


def balls_of(model: mujoco.MjModel, data: mujoco.MjData, seen: npt.NDArray[np.bool_]) -> Balls:
    """Return a ball around each geom that is *seen*, shape (ngeom,)."""
    return Balls(data.geom_xpos[seen], model.geom_rbound[seen])


def walls_of(model: mujoco.MjModel, data: mujoco.MjData) -> Walls:
    """Return the planes of a model."""
    planes = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE
    return Walls(data.geom_xpos[planes], data.geom_xmat[planes].reshape(-1, 3, 3)[:, :, 2])


def camera_axes(view: View) -> FloatArray:
    """Return the unit vectors ahead, right and up of a camera, in rows."""
    azimuth, elevation = np.radians(view)
    ahead = direction(azimuth, elevation)
    right = direction(azimuth - np.pi / 2, 0.0)
    return np.array([ahead, right, np.cross(right, ahead)])
