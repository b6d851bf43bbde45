"""Composition of an infant with its poses from body, senses, actuators and looks, before it is placed in its world."""

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Literal

from mimoc.base.kinds import function_of
from mimoc.base.mujoco_layout import BODY_GROUP, SOLIDS_GROUP
from mimoc.base.units import ms_to_s
from mimoc.body.joints import limits_of
from mimoc.body.poses import poses_of, resting_states, standing_height
from mimoc.body.tree import FREE_JOINT, Body, BodyTree, Geom, head_radius, on_head
from mimoc.compiler.actuation import ActuationSetup
from mimoc.compiler.looks.appearance import HEAD_FEATURES, add_materials, dress_skin
from mimoc.compiler.looks.sculpture import HEAD
from mimoc.compiler.looks.skin import skin_of
from mimoc.compiler.manifest import EYE, EYE_SIDES
from mimoc.compiler.mjcf import sensor_sites
from mimoc.compiler.mjcf.elements import Node
from mimoc.compiler.mjcf.scene import Keyframe, Placed, SceneTree, Solver
from mimoc.compiler.mjcf.world import World
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import SENSES
from mimoc.schema.names import bodies_of
from mimoc.schema.scene import SceneSpec

UPRIGHT = frozenset(("upper_body", "chest", "head"))
"""Parts of which each, if it is held, keeps a sitting infant upright."""


def keyframes(tree: BodyTree, held: Collection[str] = ()) -> tuple[Keyframe, ...]:
    """Return every pose of this body as a state that rests on the ground, z = 0; some of its parts may be held."""
    poses = poses_of(tree, upright=not UPRIGHT.isdisjoint(held))
    return tuple(map(Keyframe, poses, resting_states(tree, list(poses.values()))))


LOOKS_GROUP = 1
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
    cameras = dict(sensor_sites.cameras(tree))
    sites_by_source = [sensor_sites.sites(tree)]
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
            euler_deg=body.euler_deg,
            free_joints=(FREE_JOINT,) if is_root else (),
            joints=tuple(actuation.joints[joint.name] for joint in body.joints),
            geoms=(*(replace(geom, group=group) for geom in body.geoms), *_features(body, has_skin)),
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
        tendons=tree.tendons,
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


def _features(body: Body, has_skin: bool) -> tuple[Geom, ...]:
    if body.name != "head":
        return ()
    head = next(geom for geom in body.geoms if geom.name == body.name)
    return tuple(
        Geom(
            name=feature.name,
            type=feature.type,
            size_m=tuple(head_radius(head) * size for size in feature.size),
            pos_m=on_head(head, feature.pos),
            euler_deg=feature.euler_deg,
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
