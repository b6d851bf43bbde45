"""Buoyancy and drag of what is in water, for MuJoCo, whose own fluid is everywhere and lifts nothing."""

from typing import Any

import mujoco
import numpy as np

from mimoc.base.geometry import primitives
from mimoc.bundle.model import in_subtrees
from mimoc.bundle.world import manifests_of
from mimoc.runtime.companion import Companion
from mimoc.runtime.model_fields import ModelField
from mimoc.runtime.sense import FloatArray
from mimoc.schema.objects import WATER_KG_M3, WaterEntry

VISCOSITY_PA_S = 0.0009
"""Viscosity of water at 25 °C (CRC Handbook of Chemistry and Physics, from memory); at the speed of limbs, it hardly
matters."""
COEFFICIENTS = (0.5, 0.25, 1.5, 1.0, 1.0)
"""MuJoCo's defaults (`fluidcoef`): blunt, slender and angular drag, Kutta and Magnus lift."""
MIN_COEFFICIENT = 1e-99
"""Coefficient of a geom outside of water. With 0 for all geoms of a body, MuJoCo would slow it by another model; this
adds less than any rounding."""
PRIMITIVES: dict[int, primitives.Kind] = {
    mujoco.mjtGeom.mjGEOM_SPHERE: "sphere",
    mujoco.mjtGeom.mjGEOM_CAPSULE: "capsule",
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: "ellipsoid",
    mujoco.mjtGeom.mjGEOM_CYLINDER: "cylinder",
    mujoco.mjtGeom.mjGEOM_BOX: "box",
}


class Water(Companion):
    """All water of a scene.

    Each geom counts as the ellipsoid with half axes a that MuJoCo's fluid takes for it. Along a unit vector n it
    reaches e = |A R' n| from its centre, with A = diag(a) and its rotation R. A plane at t e from the centre has the
    share

        s(t) = (2 + 3 t - t³) / 4,  -1 <= t <= 1,

    of its volume below it, whose centre is 3 (1 - t²)² / (16 s) x R A² R' n / e below its own. With the sides and the
    bottom of the water in the same way, the product of the shares along its three axes is the share S of a geom in it.
    It scales MuJoCo's drag and lift of the geom, and rho g V S, at the centre of what is below the surface, is its
    buoyancy. V is its volume; for the infant, V adds up to a body's mass by `infant_kg_m3`.
    """

    def bind(self, model: mujoco.MjModel, bundle: Any, generator: np.random.Generator) -> None:
        """Look up what moves, and fill the model with water that no geom is in yet."""
        self._model = model
        roots = [manifest.root_body for manifest in manifests_of(bundle).values()]
        is_infant = in_subtrees(model, [model.body(root).id for root in roots])
        moves = (model.body_dofnum[model.body_weldid] > 0) & (model.body_mass > 0)
        touches = (model.geom_contype | model.geom_conaffinity) > 0
        has_touching = np.bincount(model.geom_bodyid[touches], minlength=model.nbody) > 0
        self._geoms = np.flatnonzero(moves[model.geom_bodyid] & (touches | ~has_touching[model.geom_bodyid]))
        self._bodies = model.geom_bodyid[self._geoms]
        self._half_axes = np.array([_half_axes(model, geom) for geom in self._geoms.tolist()]).reshape(-1, 3)
        volumes = np.array([_volume(model, geom) for geom in self._geoms.tolist()])
        masses = model.body_mass[self._bodies] * volumes / np.bincount(self._bodies, volumes)[self._bodies]
        self._waters = [
            (
                model.body(item.body).id,
                *_corners(item.water),
                np.where(is_infant[self._bodies], masses / item.water.infant_kg_m3, volumes),
            )
            for item in bundle.manifest.objects
            if item.water
        ]
        self._others_n = np.zeros((model.nbody, 6))
        model.opt.density, model.opt.viscosity = WATER_KG_M3, VISCOSITY_PA_S
        model.geom_fluid[self._geoms, : len(COEFFICIENTS) + 1] = (MIN_COEFFICIENT, *COEFFICIENTS)
        self.model_fields = (ModelField("geom_fluid", self._geoms),)

    def before_step(self, data: mujoco.MjData) -> None:
        """Find out what is in water, set its drag, and add its buoyancy to the forces that others apply."""
        model = self._model
        mujoco.mj_kinematics(model, data)
        self._others_n[:] = data.xfrc_applied
        turns = data.geom_xmat[self._geoms].reshape(-1, 3, 3)
        centres = data.geom_xpos[self._geoms]
        total = np.zeros(len(self._geoms))
        for body, low, high, volumes in self._waters:
            share, places = self._immersed(turns, centres, data, body, low, high)
            forces = -WATER_KG_M3 * (share * volumes)[:, None] * model.opt.gravity
            torques = np.cross(places - data.xipos[self._bodies], forces)
            np.add.at(data.xfrc_applied, self._bodies, np.hstack([forces, torques]))
            total += share
        model.geom_fluid[self._geoms, 0] = np.clip(total, MIN_COEFFICIENT, 1.0)

    def after_step(self, data: mujoco.MjData) -> None:
        """Leave the forces that others apply."""
        data.xfrc_applied[:] = self._others_n

    def _immersed(
        self, turns: FloatArray, centres: FloatArray, data: mujoco.MjData, body: int, low: FloatArray, high: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the share of each geom in some water, shape (n,), and the centre of what is below its surface, (n, 3).

        The water is between two corners in the frame of its body, whose z axis is vertical.
        """
        frame = data.xmat[body].reshape(3, 3)
        axes = self._half_axes[:, None] ** 2 * (frame.T @ turns)  # Row i: A² R' n for the axis i of the water.
        reach = np.sqrt(np.einsum("gij,gij->gi", axes, frame.T @ turns))
        place = (centres - data.xpos[body]) @ frame
        until_high = np.clip((high - place) / reach, -1.0, 1.0)
        below_high = _share_below(until_high)
        share = (below_high - _share_below((low - place) / reach)).prod(axis=1)
        lowered = (
            3 / 16 * (1 - until_high[:, 2] ** 2) ** 2 / np.maximum(below_high[:, 2], MIN_COEFFICIENT) / reach[:, 2]
        )
        return share, centres - lowered[:, None] * np.einsum("gij,gj->gi", turns, axes[:, 2])


def _share_below(heights: FloatArray) -> FloatArray:
    """Return the share of a sphere's volume below planes, by their heights above its centre in radii."""
    t = np.clip(heights, -1.0, 1.0)
    return (2 + 3 * t - t**3) / 4


def _corners(water: WaterEntry) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and the highest corner of water in the frame of its body, shape (3,) each, [m]."""
    x_m, y_m = water.half_sides_m
    return np.array([-x_m, -y_m, 0.0]), np.array([x_m, y_m, water.depth_m])


def _half_axes(model: mujoco.MjModel, geom: int) -> FloatArray:
    """Return the half axes of the ellipsoid that MuJoCo's fluid takes a geom for, shape (3,), [m]."""
    size = model.geom_size[geom]
    kind = PRIMITIVES.get(int(model.geom_type[geom]))
    if kind == "sphere":
        return np.repeat(size[0], 3)
    if kind in ("capsule", "cylinder"):
        return np.array([size[0], size[0], size[1] + (size[0] if kind == "capsule" else 0.0)])
    return size.copy()


def _volume(model: mujoco.MjModel, geom: int) -> float:
    if kind := PRIMITIVES.get(int(model.geom_type[geom])):
        return primitives.volume(kind, model.geom_size[geom].tolist())
    mesh = model.mesh(int(model.geom_dataid[geom]))
    corners = model.mesh_vert[mesh.vertadr[0] :][model.mesh_face[mesh.faceadr[0] :][: mesh.facenum[0]]].astype(float)
    return float(np.einsum("ni,ni->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6)


bind = Water
