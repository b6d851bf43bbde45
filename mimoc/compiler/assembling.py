"""Composition of an infant with its poses from body, senses, actuators and looks, before it is placed in its world."""

from collections.abc import Collection, Mapping
from typing import Literal

from mimoc.base.kinds import function_of
from mimoc.base.mujoco_layout import BODY_GROUP, SOLIDS_GROUP
from mimoc.base.units import deg_to_rad, ms_to_s
from mimoc.body.head_surface import head_radius, on_head
from mimoc.body.limits import limits_of
from mimoc.body.poses import poses_of, resting_states, standing_height
from mimoc.body.tree import FREE_JOINT, Body, BodyTree, Geom, Joint
from mimoc.compiler.actuation.setup import ActuationSetup
from mimoc.compiler.looks.appearance import HEAD_FEATURES, add_materials, dress_skin
from mimoc.compiler.looks.skin.deformation import skin_of
from mimoc.compiler.looks.skin.template_mesh import HEAD
from mimoc.compiler.manifest import EYE, EYE_SIDES
from mimoc.compiler.mjcf import sensor_sites
from mimoc.compiler.mjcf.elements import Node, PrintedGeom, PrintedJoint, PrintedTendon
from mimoc.compiler.mjcf.scene import Keyframe, Placed, SceneTree, Solver
from mimoc.compiler.mjcf.world import World
from mimoc.schema.components.senses import SENSES
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import bodies_of
from mimoc.schema.scene import SceneSpec

GRIPPING = (("priority", (1.0,)), ("solref", (0.01, 1.0)), ("solimp", (0.999, 0.9999, 0.001, 0.5, 1.0)))
"""Contacts of a hand that holds on: those of the hand, whatever it touches, and so stiff that they hardly slip.

MuJoCo's friction is soft: with other geoms' contacts, 1 to 2 N squeeze a rod out of a newborn's hand (D)."""


UPRIGHT = frozenset(("upper_body", "chest", "head"))
"""Parts of which each, if it is held, keeps a sitting infant upright."""


def keyframes(tree: BodyTree, held: Collection[str] = ()) -> tuple[Keyframe, ...]:
    """Return every pose of this body as a state that rests on the ground, z = 0; some of its parts may be held."""
    poses = poses_of(tree, upright=not UPRIGHT.isdisjoint(held))
    return tuple(map(Keyframe, poses, resting_states(tree, list(poses.values()))))


LOOKS_GROUP = 1
SLIPPERY = (("priority", (2.0,)),)
"""Contacts of an eye: without friction, whatever it touches."""
EYEBALLS = tuple(EYE[0].format(side=side) for side in EYE_SIDES)


def place_senses(spec: InfantSpec, tree: BodyTree) -> dict[str, Placed]:
    """Return the senses of a spec, built on a body, by name."""
    asked = {name: getattr(spec.senses, name) for name in SENSES}
    return {
        name: function_of(SENSES[name].build, "build")(section, tree)
        for name, section in asked.items()
        if section is not None
    }


def multiccd(scene: SceneSpec) -> Literal["enable", "disable"]:
    """Return whether MuJoCo looks for several contacts of two convex geoms, without which a cup on a table creeps."""
    return "enable" if any(item.carries for item in scene.objects) else "disable"


def assemble_infant(
    spec: InfantSpec, tree: BodyTree, actuation: ActuationSetup, senses: Mapping[str, Placed], has_skin: bool = False
) -> SceneTree:
    """Return a scene with the infant of a spec, with its poses at the origin of an empty world."""
    # Under a skin, only what it does not cover is drawn.
    hip_m = (0.0, 0.0, standing_height(tree))
    cameras, sites_by_source = dict(sensor_sites.cameras(tree)), [sensor_sites.sites(tree)]
    sites_by_source += [*(placed.sites for placed in senses.values()), sensor_sites.keypoint_sites(tree)]
    for placed in senses.values():
        cameras |= placed.cameras
    uncovered = {*EYEBALLS, *(name for kind in tree.extra for name in bodies_of(kind))}
    parts: dict[str, Node] = {}
    for body in reversed(tree.bodies):
        is_root = body.parent is None
        group = SOLIDS_GROUP if has_skin and body.name not in uncovered else BODY_GROUP
        parts[body.name] = Node(
            name=body.name,
            pos_m=hip_m if is_root else body.pos_m,
            euler_rad=_radians(body.euler_deg),
            free_joints=(FREE_JOINT,) if is_root else (),
            joints=tuple(_joint(actuation.joints[joint.name]) for joint in body.joints),
            geoms=(*(_geom(geom, group) for geom in body.geoms), *_features(body, has_skin)),
            sites=tuple(site for sites in sites_by_source for site in sites.get(body.name, ())),
            cameras=cameras.get(body.name, ()),
            children=tuple(parts[child.name] for child in tree.bodies if child.parent == body.name),
        )
    skin = skin_of(tree).showing(spec.body.expression, HEAD) if has_skin else None
    round_head = tree.geoms["head"].type == "sphere"
    expression = spec.body.expression
    return SceneTree(
        name=spec.name,
        solver=Solver(
            timestep_s=ms_to_s(spec.control.timestep_ms),
            integrator=actuation.integrator,
            multiccd=multiccd(spec.scene),
        ),
        roots=tuple(parts[body.name] for body in tree.bodies if body.parent is None),
        appearance=dress_skin(expression, skin.names, spec.body.looks, spec.clothes, round_head=round_head)
        if skin
        else add_materials(expression, spec.body.looks, spec.clothes, round_head=round_head),
        tendons=tuple(PrintedTendon(tendon.name, tendon.range_rad, tendon.coefficients) for tendon in tree.tendons),
        excluded=tree.excluded,
        frictionless=tree.frictionless,
        joint_defaults=limits_of(tree.development),
        actuator_defaults=actuation.defaults,
        actuators=actuation.actuators,
        reflexes=actuation.reflexes,
        sensors=(
            *sensor_sites.VESTIBULAR_SENSORS,
            *sensor_sites.torque_sensors(tree),
            *(sensor for placed in senses.values() for sensor in placed.sensors),
        ),
        world=World(),
        keyframes=tuple(actuation.at_rest(keyframe) for keyframe in keyframes(tree, spec.scene.held)),
        skin=skin,
    )


def _joint(joint: Joint) -> PrintedJoint:
    low, high = joint.range_deg
    return PrintedJoint(
        name=joint.name,
        axis=joint.axis,
        pos_m=joint.anchor_m,
        range_rad=(deg_to_rad(low), deg_to_rad(high)),
        stiffness_nm_per_rad=joint.stiffness_nm_per_rad,
        damping_nms_per_rad=joint.damping_nms_per_rad,
        frictionloss_nm=joint.frictionloss_nm,
        armature_kgm2=joint.armature_kgm2,
        springref_rad=deg_to_rad(joint.springref_deg),
        settings=(("margin", deg_to_rad(joint.margin_deg)),) if joint.margin_deg else (),
    )


def _geom(geom: Geom, group: int) -> PrintedGeom:
    return PrintedGeom(
        name=geom.name,
        type=geom.type,
        size_m=geom.size_m,
        pos_m=geom.pos_m,
        euler_rad=_radians(geom.euler_deg),
        mass_kg=geom.mass_kg,
        material=geom.material,
        friction=geom.friction,
        contype=geom.contype,
        conaffinity=geom.conaffinity,
        condim=geom.condim,
        group=group,
        settings=GRIPPING if geom.grips else SLIPPERY if geom.slippery else (),
    )


def _features(body: Body, has_skin: bool) -> tuple[PrintedGeom, ...]:
    if body.name != "head":
        return ()
    head = next(geom for geom in body.geoms if geom.name == body.name)
    return tuple(
        PrintedGeom(
            name=feature.name,
            type=feature.type,
            size_m=tuple(head_radius(head) * size for size in feature.size),
            pos_m=on_head(head, feature.pos),
            euler_rad=_radians(feature.euler_deg),
            mass_kg=0.0,
            material=feature.material,
            friction=(1.0, 0.005, 0.0002),
            contype=0,
            conaffinity=0,
            condim=3,
            group=SOLIDS_GROUP if has_skin else LOOKS_GROUP,
        )
        for feature in HEAD_FEATURES
    )


def _radians(euler_deg: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, z = map(deg_to_rad, euler_deg)
    return x, y, z
