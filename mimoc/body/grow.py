"""The growth of a body in one pass: assemble, measure, shape, weigh, joints, motors, removed parts.

Each stage is one file. It returns one frozen value, which also knows where its numbers come from. Where the two laws of
development differ, `published` and `maturing`, they are two functions in the file of the stage.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from operator import itemgetter

from mimoc.anatomy.anatomy import Anatomy, assemble
from mimoc.anatomy.part import BodyGeometry, ReferenceGeom, ReferencePart
from mimoc.anatomy.parts.trunk import TENDONS
from mimoc.body.impairments import impair
from mimoc.body.joints import match_damping, passive_joints
from mimoc.body.masses import Masses, weigh_parts
from mimoc.body.maturation import AVERAGE, Composition, composition, maturation, relative_volumes
from mimoc.body.measurements import Height, Targets, Weigh, asked_targets, birth_targets, measure_individual
from mimoc.body.published import standing_height
from mimoc.body.reference import CURVES, HEIGHT, Reference, reference_body
from mimoc.body.shapes import NO_SCALES, Scales, Shapes, shape_parts
from mimoc.body.strength import at_strength_of_age, motor_torques, scale_strength
from mimoc.body.tree import Attributes, Body, BodyTree, Geom, Joint, Tendon, mirror, mirror_turn, remove_parts
from mimoc.fits import Measurements, measure
from mimoc.schema.infant import InfantSpec


@dataclass(frozen=True, slots=True)
class GrownBody:
    """The body of a child, and what it was grown from."""

    tree: BodyTree
    reference: Reference
    measurements: Measurements
    masses: Masses


def grow_body(spec: InfantSpec, reference: Reference | None = None) -> GrownBody:
    """Return the body of a spec's child, compared with a *reference* of the same anatomy and any age.

    Raises an IndividualError, a GeometryError or a ContractureError if no child, body or range of a joint is like that.
    """
    reference = reference_of(spec, reference)
    return grow_child(spec, measure_child(spec, reference), reference)


def reference_of(spec: InfantSpec, known: Reference | None = None) -> Reference:
    """Return what a spec's child is compared with; *known* is the same at another age."""
    if known:
        return known.at(spec.corrected_age_months)
    anatomy = assemble(spec.body.hands, spec.body.chest_joint, spec.development, spec.body.extra or ())
    return reference_body(anatomy, spec.corrected_age_months)


def measure_child(spec: InfantSpec, reference: Reference) -> Measurements:
    """Return the measurements of a spec's child, individualised, and replaced as it says, or an IndividualError."""
    return measure_individual(spec, *_measured(spec, reference))


def usual_measures(spec: InfantSpec) -> Targets | None:
    """Return the measures that a spec asks for, or that go with how early its child was born; None are the average."""
    return asked_targets(spec) or birth_targets(spec, *_measured(spec, reference_of(spec)))


def _measured(spec: InfantSpec, reference: Reference) -> tuple[Measurements, Weigh, Height]:
    """Return the average child of a spec's age, and what weighs and measures children."""
    return (
        measure(spec.corrected_age_months, CURVES[spec.development]),
        lambda child: weigh_parts(shape_parts(child, reference), reference).body_kg(reference.anatomy),
        standing_height if spec.development == "published" else itemgetter(HEIGHT),
    )


def grow_child(spec: InfantSpec, child: Measurements, reference: Reference) -> GrownBody:
    """Return the body of a measured child without removed limbs, or a GeometryError or ContractureError."""
    scales = {name: (part.length, part.girth) for name, part in spec.body.parts.items()}
    composed = composition(child, spec)
    tree, masses = _grow(child, reference, scales, composed)
    strength, strength_age_months = spec.actuation.strength, spec.actuation.strength_age_months
    is_own = spec.body.individual or spec.months_early or spec.body.measurements or scales
    if is_own or strength or strength_age_months is not None:
        usual = _average(reference, composed.of_size())
        if strength_age_months is not None:
            tree = at_strength_of_age(tree, usual.motors, _average(reference.at(strength_age_months)).motors)
        tree = match_damping(scale_strength(tree, strength), usual, reference.anatomy)
    if spec.impairments:
        tree = impair(tree, spec.impairments)
    tree = replace(remove_parts(tree, spec.body.remove), clothes=spec.clothes)
    return GrownBody(tree, reference, child, masses)


def grow_tree(child: Measurements, anatomy: Anatomy, scales: Scales = NO_SCALES) -> BodyTree:
    """Return the body of a child of some strength, with *scales* of single parts, or raise a GeometryError."""
    return _grow(child, reference_body(anatomy, child.age_months), scales)[0]


def grow_average(age_months: float, anatomy: Anatomy) -> BodyTree:
    """Return the body of the average child of an age."""
    return grow_tree(measure(age_months, CURVES[anatomy.development]), anatomy)


def _grow(
    child: Measurements, reference: Reference, scales: Scales = NO_SCALES, composed: Composition = AVERAGE
) -> tuple[BodyTree, Masses]:
    anatomy = reference.anatomy
    shapes = shape_parts(child, reference, scales)
    masses = weigh_parts(shapes, reference)
    volumes = relative_volumes(shapes, reference)
    growth = maturation(child, volumes, masses.head_gain, reference, composed)
    joints = passive_joints(shapes, reference, growth)
    motors = motor_torques(volumes, reference, growth)
    tree = BodyTree(
        age_months=child.age_months,
        hands=anatomy.hands,
        bodies=tuple(_body(part, side, shapes, masses, joints) for side, part in anatomy.parts),
        motors=motors,
        tendons=tuple(Tendon(name, (-half, half), factors) for name, half, factors in TENDONS),
        excluded=anatomy.excluded,
        frictionless=anatomy.frictionless,
        extra=anatomy.extra,
        development=anatomy.development,
        growth=growth,
    )
    return tree, masses


def _average(reference: Reference, composed: Composition = AVERAGE) -> BodyTree:
    """Return the body of the average child of an age, or of one of its size that matures at another rate."""
    child = measure(reference.age_months, CURVES[reference.anatomy.development])
    return _grow(child, reference, composed=composed)[0]


def _body(part: ReferencePart, side: str, shapes: Shapes, masses: Masses, joints: Mapping[str, Joint]) -> Body:
    left, dimensions = side == "left", shapes.built[side]
    return Body(
        name=part.name.format(side=side),
        parent=part.parent and part.parent.format(side=side),
        pos_m=mirror(dimensions.origins[part.name], left),
        euler_deg=mirror_turn(part.euler_deg, left),
        joints=tuple(joints[figures.name.format(side=side)] for figures in part.joints),
        geoms=tuple(_geom(figures, side, dimensions, masses) for figures in part.geoms),
        region=part.region,
        group=part.group.format(side=side),
        skin_spacing_m=part.skin_spacing_m,
        torque_site=part.torque_site.format(side=side),
    )


GRIPPING: Attributes = (("priority", (1.0,)), ("solref", (0.01, 1.0)), ("solimp", (0.999, 0.9999, 0.001, 0.5, 1.0)))
"""Contacts of a hand that holds on: those of the hand, whatever it touches, and so stiff that they hardly slip.

MuJoCo's friction is soft: with other geoms' contacts, 1 to 2 N squeeze a rod out of a newborn's hand (D)."""
SLIPPERY: Attributes = (("priority", (2.0,)),)  # Contacts of an eye: without friction, whatever it touches.


def _geom(figures: ReferenceGeom, side: str, dimensions: BodyGeometry, masses: Masses) -> Geom:
    left = side == "left"
    solid = dimensions.shapes[figures.name]
    return Geom(
        name=figures.name.format(side=side),
        type=figures.type,
        size_m=solid.size_m,
        pos_m=mirror(solid.pos_m, left),
        euler_deg=mirror_turn(figures.euler_deg, left),
        mass_kg=masses.kg[side][figures.name],
        friction=figures.friction,
        contype=figures.contype,
        conaffinity=figures.conaffinity,
        condim=figures.condim,
        material=figures.material.format(side=side),
        settings=GRIPPING if figures.grips else SLIPPERY if figures.slippery else (),
    )
