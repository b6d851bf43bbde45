"""An infant with its senses, motors and clothes, before it is put into its world."""

from mimoc.actuation.drives import DRIVES
from mimoc.body import FREE_JOINT, Body, BodyTree, Geom, Joint
from mimoc.body.poses import standing_height
from mimoc.looks.appearance import GEOM_MATERIALS, HEAD_FEATURES, HeadFeature, dress
from mimoc.mjcf import sensor_sites
from mimoc.mjcf.keyframes import keyframes
from mimoc.mjcf.keypoints import keypoint_sites
from mimoc.mjcf.tree import Node, PrintedGeom, PrintedJoint, PrintedTendon, SceneTree, Solver, World
from mimoc.schema.infant import InfantSpec
from mimoc.senses.touch.skin_points import grow_skin
from mimoc.units import deg_to_rad, ms_to_s

BODY_GROUP, LOOKS_GROUP = 0, 1


def compose(spec: InfantSpec, tree: BodyTree) -> SceneTree:
    """Return the scene of a spec around a grown body, its poses at the origin of a world without anything."""
    fovy_deg = spec.senses.vision.fovy_deg if spec.senses.vision else 60.0
    sites, cameras = sensor_sites.sites(tree), sensor_sites.cameras(tree, fovy_deg)

    touch = spec.senses.touch
    points, drive = keypoint_sites(tree), DRIVES[spec.actuation.model]
    joints = drive.joints(tree)

    def node(body: Body) -> Node:
        is_root = body.parent is None
        return Node(
            name=body.name,
            pos_m=(0.0, 0.0, standing_height(tree)) if is_root else body.pos_m,
            euler_rad=_radians(body.euler_deg),
            free_joints=(FREE_JOINT,) if is_root else (),
            joints=tuple(_joint(joints[joint.name]) for joint in body.joints),
            geoms=(*map(_geom, body.geoms), *_features(body)),
            sites=(*sites.get(body.name, ()), *points.get(body.name, ())),
            cameras=cameras.get(body.name, ()),
            children=tuple(node(child) for child in tree.bodies if child.parent == body.name),
        )

    return SceneTree(
        name=spec.name,
        solver=Solver(timestep_s=ms_to_s(spec.control.timestep_ms), integrator=drive.integrator),
        roots=tuple(node(body) for body in tree.bodies if body.parent is None),
        appearance=dress(spec.body.expression),
        tendons=tuple(PrintedTendon(tendon.name, tendon.range_rad, tendon.coefficients) for tendon in tree.tendons),
        frictionless=tree.frictionless,
        excluded=tree.excluded,
        actuator_defaults=drive.defaults,
        actuators=drive.actuators(tree, ms_to_s(spec.control.timestep_ms)),
        sensors=(*sensor_sites.VESTIBULAR_SENSORS, *sensor_sites.torque_sensors(tree)),
        world=World(),
        keyframes=tuple(drive.keyframe(tree, keyframe) for keyframe in keyframes(tree)),
        skin=grow_skin(tree, touch.density, touch.regions) if touch else None,
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
    )


def _geom(geom: Geom) -> PrintedGeom:
    return PrintedGeom(
        name=geom.name,
        type=geom.type,
        size_m=geom.size_m,
        pos_m=geom.pos_m,
        euler_rad=_radians(geom.euler_deg),
        mass_kg=geom.mass_kg,
        material=GEOM_MATERIALS.get(geom.name, "skin"),
        friction=geom.friction,
        contype=geom.contype,
        conaffinity=geom.conaffinity,
        condim=geom.condim,
        group=BODY_GROUP,
    )


def _features(body: Body) -> tuple[PrintedGeom, ...]:
    """Return what the head shows and physics does not know: nose, ears, lids."""
    if body.name != "head":
        return ()
    (head,) = body.geoms
    return tuple(_feature(feature, head) for feature in HEAD_FEATURES)


def _feature(feature: HeadFeature, head: Geom) -> PrintedGeom:
    radius_m = head.size_m[0]
    x, y, z = (middle + radius_m * offset for middle, offset in zip(head.pos_m, feature.pos, strict=True))
    return PrintedGeom(
        name=feature.name,
        type=feature.type,
        size_m=tuple(radius_m * size for size in feature.size),
        pos_m=(x, y, z),
        euler_rad=_radians(feature.euler_deg),
        mass_kg=0.0,
        material=feature.material,
        friction=(1.0, 0.005, 0.0002),
        contype=0,
        conaffinity=0,
        condim=3,
        group=LOOKS_GROUP,
    )


def _radians(euler_deg: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, z = map(deg_to_rad, euler_deg)
    return x, y, z
