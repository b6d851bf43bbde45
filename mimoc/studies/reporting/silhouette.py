"""The outline of an infant, drawn from the solids of its body as it stands upright, seen from the front."""

import math
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.model import solid_extents
from mimoc.compiler.measuring import Figure, own_solids
from mimoc.render.plots.drawing import Point, Shape, area

CORNERS = 24  # Corners of the polygon that approximates the outline of a solid.

Points = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Silhouette:
    """The outlines of an infant's solids, those behind first."""

    outlines_m: tuple[Points, ...]  # To the infant's left and up from its soles, shape (corners, 2) each.
    height_m: float
    half_width_m: float  # From its middle to the outermost point on either side.
    figure: Figure  # The posed infant.
    sole_m: float  # Height of its soles in the model.

    def at(self, point_m: Points, scale: float, foot: Point) -> Point:
        """Return where a point of the world, shape (3,), is in a drawing with some units in a metre.

        Its y axis points down, and the middle between the soles is at *foot*.
        """
        return foot[0] + scale * float(point_m[1]), foot[1] - scale * (float(point_m[2]) - self.sole_m)

    def shapes(self, scale: float, foot: Point) -> list[Shape]:
        """Return the drawing of the body; see `at`."""
        return [
            area([(foot[0] + scale * float(y), foot[1] - scale * float(z)) for y, z in outline], "skin")
            for outline in self.outlines_m
        ]


def silhouette(model: mujoco.MjModel) -> Silhouette:
    """Return the outline of the infant in a model, its arms at its sides."""
    figure = Figure(model)
    geoms = own_solids(model)
    rotations = figure.data.geom_xmat[geoms].reshape(-1, 3, 3)
    angles_rad = np.arange(CORNERS) * (2 * math.pi / CORNERS)
    around = np.stack((np.zeros(CORNERS), np.cos(angles_rad), np.sin(angles_rad)), axis=-1)
    local = np.einsum("nij,mi->mnj", rotations, around)
    farthest = solid_extents(model, geoms).farthest(local)
    points_m = figure.data.geom_xpos[geoms] + np.einsum("nij,mnj->mni", rotations, farthest)
    sole_m = float(points_m[..., 2].min())
    flat_m = points_m[..., 1:] - (0.0, sole_m)
    from_behind = np.argsort(figure.data.geom_xpos[geoms, 0], kind="stable")
    return Silhouette(
        outlines_m=tuple(flat_m[:, solid] for solid in from_behind),
        height_m=float(flat_m[..., 1].max()),
        half_width_m=float(np.abs(flat_m[..., 0]).max()),
        figure=figure,
        sole_m=sole_m,
    )
