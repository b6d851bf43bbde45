r"""A mobile: figures that hang from arms around a bell, and swing with the cord that all hang from.

    hook            fixed in the world
     | cord
    hub             where the ribbon begins
arm / \ arm
   |   |   | threads
figure | figure
      bell          struck by figures that swing
"""

import colorsys
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mimoc.base.geometry.rotations import (
    Quaternion,
    Vec3,
    matrix_from_quaternion,
    quaternion_from_axis,
    quaternion_product,
)
from mimoc.base.units import cm_to_m
from mimoc.body.kinematics import FloatArray
from mimoc.body.origins import Entry
from mimoc.compiler.mjcf.elements import Rgba, Site, WorldMaterial
from mimoc.compiler.mjcf.world import MeshFile, ObjectBody, ObjectGeom, ObjectJoint
from mimoc.compiler.objects.built_object import (
    DAMPING_RATIO,
    BuiltObject,
    Surroundings,
    Tie,
    bar,
    moved,
    object_name,
    pendulum_damping,
    seen,
    solid,
    string,
)
from mimoc.compiler.toys import DARK, LIGHT, Tint, Toy, centre_of_mass, materials_of, pieces_of
from mimoc.components.objects import MobileSpec
from mimoc.components.toys.builtin import load_toy

HUB_M, HUB_KG = 0.018, 0.05  # Radius and mass of the wooden hub with its arms.
ARM_M, SLOPE_M = 0.004, 0.04  # Radius of the arms, and how far they go down to their ends.
THREAD_M = 0.05  # Length of the thread from the end of an arm to its figure.
BELL_M, LARGEST_BELL_M, BELL_KG = 0.015, 0.035, 0.03
"""Smallest and largest radius and mass of the bell: a hollow ball of brass."""
ROD_M, ROD_HZ = 0.0025, 8.0  # Radius of the rod that carries the bell, and the frequency at which it vibrates.
GAP_M = 0.008  # Smallest gap between the figures and the bell, and between two figures.
SITE_M = 0.003
ON_ITS_SIDE: Quaternion = quaternion_from_axis((1.0, 0.0, 0.0), math.pi / 2)
"""Turns a toy that stands so that its side faces down, where the infant is."""
WOOD, BRASS, RIBBON = (0.82, 0.66, 0.46, 1.0), (0.86, 0.68, 0.25, 1.0), (0.82, 0.2, 0.35, 1.0)
HUES = (0.0, 0.14, 0.6, 0.36, 0.78, 0.07, 0.5, 0.9)
"""Hues of the figures one after another: red, yellow, blue, green, violet, orange, turquoise and pink."""


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure in a frame with its centre of mass at the origin."""

    geoms: tuple[ObjectGeom, ...]
    materials: tuple[WorldMaterial, ...]
    meshes: tuple[MeshFile, ...]
    half_m: Vec3  # Half lengths of the box around it.


@dataclass(frozen=True, slots=True)
class Layout:
    """Where the parts of a mobile are, and how large the bell is."""

    cord_m: float
    arm_m: float  # How far the ends of the arms are from the middle.
    figure_m: float  # Half the height of its highest figure.
    radius_m: float  # Radius of the bell, which reaches nearly to the figures.

    @property
    def bell_m(self) -> float:
        """How far the middle of the bell is below the hub: as far as the figures'."""
        return SLOPE_M + THREAD_M + self.figure_m

    @property
    def lowest_m(self) -> float:
        """How far its lowest point is below the hook."""
        return self.cord_m + self.bell_m + max(self.radius_m, self.figure_m)

    def end_m(self, turn_rad: float) -> FloatArray:
        """Return where an arm ends, from the hook, shape (3,)."""
        return np.array([self.arm_m * math.cos(turn_rad), self.arm_m * math.sin(turn_rad), -self.cord_m - SLOPE_M])


def build(spec: MobileSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a mobile that hangs still."""
    name, count = object_name(spec.name), len(spec.figures)
    figures = [_figure(spec, number, f"{name}_figure{number + 1}") for number in range(count)]
    # How long arms must be: figures across them do not reach the bell, nor beyond halfway to the next one.
    long_m = max(figure.half_m[0] for figure in figures)
    halfway = math.tan(math.pi / len(figures)) if len(figures) > 2 else math.inf
    arm_m = max(cm_to_m(spec.arm_cm or 0.0), _thickest_m(figures) + GAP_M + max(BELL_M, long_m / halfway))
    reach_m = arm_m + max(math.hypot(*figure.half_m[:2]) for figure in figures)
    layout = Layout(cm_to_m(spec.cord_cm), arm_m, max(figure.half_m[2] for figure in figures), 0.0)
    layout = replace(layout, radius_m=min(arm_m - _thickest_m(figures) - GAP_M, LARGEST_BELL_M))
    mass_kg = HUB_KG + BELL_KG + count * spec.figure_g / 1000
    rule = f"hub {HUB_KG:g} kg, bell {BELL_KG:g} kg, and {count} figures of {spec.figure_g:g} g"
    mass: Entry = {"value": mass_kg, "unit": "kg", "rule": rule, "from": ["spec.scene.objects"]}
    return BuiltObject(
        root=_hanging(name, spec, layout, figures),
        materials=(
            WorldMaterial(f"{name}_wood", WOOD),
            WorldMaterial(f"{name}_bell", BRASS, specular=0.6, shininess=0.6),
            *(material for figure in figures for material in figure.materials),
        ),
        motion="hanging",
        material="wood",
        radius_m=reach_m,
        height_m=layout.lowest_m,
        size_m=2 * reach_m,
        mass_kg=mass_kg,
        meshes=tuple(mesh for figure in figures for mesh in figure.meshes),
        bells=(f"{name}_bell",),
        tie=Tie(spec.tied_to, f"{name}_hub", cm_to_m(spec.slack_cm), RIBBON) if spec.tied_to else None,
        origins={"mass": mass},
    )


def _thickest_m(figures: Sequence[Figure]) -> float:
    return max(figure.half_m[1] for figure in figures)


def _hanging(name: str, spec: MobileSpec, layout: Layout, figures: Sequence[Figure]) -> ObjectBody:
    """Return cord, hub and arms, which swing about the hook; figures and bell hang on them."""
    wood, hub_m = f"{name}_wood", (0.0, 0.0, -layout.cord_m)
    hub = replace(seen(f"{name}_hub", wood, "sphere", (HUB_M,), hub_m), mass_kg=HUB_KG)
    arms, children = list[ObjectGeom](), [_bell(name, layout)]
    for number, figure in enumerate(figures):
        turn_rad = math.tau * (number + 0.5) / len(figures)
        end_m = layout.end_m(turn_rad)
        arms.append(bar(f"{name}_arm{number + 1}", wood, ARM_M, np.array(hub_m), end_m))
        children.append(_hung(f"{name}_figure{number + 1}", wood, spec, figure, end_m, turn_rad))
    low_m = layout.cord_m + layout.bell_m
    figures_kg = len(figures) * spec.figure_g / 1000
    bodies = (HUB_KG, layout.cord_m, HUB_M), (BELL_KG, low_m, layout.radius_m), (figures_kg, low_m, layout.arm_m)
    damping = pendulum_damping(*bodies)
    return ObjectBody(
        name,
        pos_m=(0.0, 0.0, layout.lowest_m),
        joints=(ObjectJoint(f"{name}_cord", "ball", damping),),
        geoms=(string(f"{name}_cord", wood, layout.cord_m), hub, *arms),
        sites=(Site(f"{name}_hub", hub_m, SITE_M),),
        children=tuple(children),
    )


def _bell(name: str, layout: Layout) -> ObjectBody:
    """Return the bell on its rod, which bends a little.

    Without that, MuJoCo would let figures pass through the bell: bodies do not touch what they hang on.
    """
    bell = f"{name}_bell"
    inertia_kgm2 = BELL_KG * (layout.bell_m**2 + 0.4 * layout.radius_m**2)
    stiffness = inertia_kgm2 * (math.tau * ROD_HZ) ** 2
    rod = ObjectJoint(bell, "ball", 2 * DAMPING_RATIO * math.sqrt(stiffness * inertia_kgm2), stiffness=stiffness)
    ball = solid(bell, bell, "sphere", (layout.radius_m,), (0.0, 0.0, -layout.bell_m), BELL_KG)
    return ObjectBody(
        bell,
        pos_m=(0.0, 0.0, -layout.cord_m),
        joints=(rod,),
        geoms=(bar(f"{bell}_rod", f"{name}_wood", ROD_M, np.zeros(3), np.array([0.0, 0.0, -layout.bell_m])), ball),
    )


def _hung(name: str, wood: str, spec: MobileSpec, figure: Figure, end_m: FloatArray, turn_rad: float) -> ObjectBody:
    """Return a figure on its thread, its length across the arm."""
    low_m = THREAD_M + figure.half_m[2]
    x_m, y_m, z_m = end_m.tolist()
    damping = pendulum_damping((spec.figure_g / 1000, low_m, max(figure.half_m)))
    return ObjectBody(
        name,
        pos_m=(x_m, y_m, z_m),
        quat=quaternion_from_axis((0.0, 0.0, 1.0), turn_rad + math.pi / 2),
        joints=(ObjectJoint(name, "ball", damping),),
        geoms=(string(f"{name}_thread", wood, THREAD_M), *(moved(geom, (0.0, 0.0, -low_m)) for geom in figure.geoms)),
    )


def _figure(spec: MobileSpec, number: int, name: str) -> Figure:
    model = load_toy(spec.figures[number])
    size_m = cm_to_m(spec.size_cm)
    density_kg_m3 = spec.figure_g / 1000 / (model.volume * size_m**3)
    hue = HUES[number]
    colours: dict[Tint, Rgba] = {
        "main": _rgba(hue),
        "accent": _rgba((hue + 0.5) % 1.0, 0.45),
        "dark": DARK,
        "light": LIGHT,
    }
    toy = Toy(replace(model, density_kg_m3=density_kg_m3), size_m, 0.0, colours)
    pieces = pieces_of(toy, name, name)
    turn = matrix_from_quaternion(ON_ITS_SIDE)
    corners = np.concatenate([part.mesh.vertices for part in model.parts]) * size_m @ turn.T
    centre_m = turn @ centre_of_mass(toy, [geom for geom, _ in pieces])
    x_m, y_m, z_m = (-centre_m).tolist()
    half_x_m, half_y_m, half_z_m = np.abs(corners - centre_m).max(axis=0).tolist()
    return Figure(
        geoms=tuple(moved(_turned(geom), (x_m, y_m, z_m)) for geom, _ in pieces),
        materials=materials_of(toy, name),
        meshes=tuple(mesh for _, mesh in pieces if mesh),
        half_m=(half_x_m, half_y_m, half_z_m),
    )


def _rgba(hue: float, saturation: float = 0.8) -> Rgba:
    red, green, blue = (round(channel, 4) for channel in colorsys.hsv_to_rgb(hue, saturation, 0.9))
    return red, green, blue, 1.0


def _turned(geom: ObjectGeom) -> ObjectGeom:
    x_m, y_m, z_m = (matrix_from_quaternion(ON_ITS_SIDE) @ geom.pos_m).tolist()
    return replace(geom, pos_m=(x_m, y_m, z_m), quat=quaternion_product(ON_ITS_SIDE, geom.quat))
