"""Measurement of a compiled infant with tape and calipers, in the postures of AnthroKids (Snyder et al. 1977).

The survey's own descriptions of the postures were not at hand (M): lengths of limbs are taken along them with joints at
right angles, breadths and girths on the straight body, girths around the convex hull of a section.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TypeVar

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.primitives import Solids
from mimoc.base.geometry.rotations import FloatArray
from mimoc.base.mujoco_layout import BODY_GROUP, SOLIDS_GROUP
from mimoc.base.units import ms_to_s
from mimoc.bundle.model import in_subtrees, solid_extents
from mimoc.compiler.actuation import build_actuation
from mimoc.compiler.assembling import assemble_infant
from mimoc.compiler.child import child_of
from mimoc.compiler.mjcf import printing
from mimoc.compiler.mjcf.mimo import GEOM
from mimoc.compiler.model_check import compile_model
from mimoc.compiler.placing import SceneAssets, place_in_scene
from mimoc.compiler.variants import at_age, errors_at
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import SIDES
from mimoc.schema.scene import SceneSpec

SAME = 1e-6  # Relative difference from which on a key is said to change a measure; files hold nine digits.
ROOT = "hip"  # The root body of the infant.

IntArray = npt.NDArray[np.intp]
Row = TypeVar("Row")
Progress = Callable[[int, int], None]  # Called with the number of infants measured and their total number.


def compile_infant(spec: InfantSpec) -> mujoco.MjModel:
    """Return the model of a spec, on a flat floor, as MuJoCo compiles it from the files of a bundle."""
    return compile_model(infant_files(spec))


def infant_files(spec: InfantSpec) -> Mapping[str, bytes]:
    """Return the MJCF and assets of a spec's infant on a flat floor, by path in a bundle."""
    tree = child_of(spec).tree
    plain = spec.model_copy(update={"scene": SceneSpec(pose=spec.scene.pose), "task": None})
    actuation = build_actuation(spec.actuation, tree, ms_to_s(spec.control.timestep_ms))
    infant = place_in_scene(assemble_infant(plain, tree, actuation, {}), plain, tree, SceneAssets()).scene
    return printing.render_scene(infant)


def own_solids(model: mujoco.MjModel) -> IntArray:
    """Return the indices of the solids of an infant's body, shape (n,): no clothes, toys or floor."""
    is_infants = model.body_rootid[model.geom_bodyid] == model.body_rootid[model.body(ROOT).id]
    return np.flatnonzero(is_infants & np.isin(model.geom_group, (BODY_GROUP, SOLIDS_GROUP)))


def compare_at_ages(
    spec: InfantSpec,
    ages_months: Sequence[float],
    compare: Callable[[InfantSpec], Iterable[Row]],
    progress: Progress | None,
) -> tuple[Row, ...]:
    """Return the rows of an infant that has grown to each of some ages; *progress* is called after each."""
    rows: list[Row] = []
    for done, age_months in enumerate(ages_months, start=1):
        with errors_at(spec, age_months):
            rows += compare(at_age(spec, age_months, checked=False))
        if progress:
            progress(done, len(ages_months))
    return tuple(rows)


FORWARD, LEFT, UP = np.eye(3)
TRUNK = ("hip", "lower_body", "upper_body", "chest")
THIGHS = ("left_upper_leg", "right_upper_leg")

STRAIGHT: Mapping[str, float] = {}
SITTING = {"{side}_hip1": -90.0, "{side}_knee": -90.0}
LEGS_RAISED = {"{side}_hip1": -90.0}
ELBOWS_BENT = {"{side}_elbow": -90.0}
FIST = {
    **{f"{{side}}_{finger}_knuckle": 90.0 for finger in ("ff", "mf", "rf", "lf")},
    **{f"{{side}}_{finger}_middle": 100.0 for finger in ("ff", "mf", "rf", "lf")},
    "{side}_th_swivel": 62.0,
    "{side}_th_middle": 60.0,
    "{side}_th_distal": 60.0,
}
"""Angles in degrees of the joints that are not at zero, without `robot:`; a fist's thumb lies beside the fingers."""


class Figure:
    """A compiled infant that can be posed and measured, in [m]."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model, self.data = model, mujoco.MjData(model)
        self.bodies = frozenset(model.body(index).name for index in range(model.nbody))
        self._solids = own_solids(model)
        self.pose(STRAIGHT)

    def pose(self, angles_deg: Mapping[str, float]) -> "Figure":
        """Bend joints, named with `{side}`, and let the upper arms hang vertically; all others are straight."""
        self.data.qpos[:] = 0
        self.data.qpos[3] = 1
        for side in ("left", "right"):
            for joint, angle_deg in angles_deg.items():
                self._bend(f"robot:{joint.format(side=side)}", math.radians(angle_deg))
        mujoco.mj_kinematics(self.model, self.data)
        for side in ("left", "right"):
            if f"{side}_upper_arm" in self.bodies:
                along = self.axes(f"{side}_upper_arm")[2]
                self._bend(f"robot:{side}_shoulder_ad_ab", -float(np.arctan2(np.hypot(*along[:2]), -along[2])))
        mujoco.mj_kinematics(self.model, self.data)
        return self

    def _bend(self, joint: str, angle_rad: float) -> None:
        number = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, joint)
        if number >= 0:
            self.data.qpos[self.model.jnt_qposadr[number]] = angle_rad

    def axes(self, body: str) -> FloatArray:
        """Return the axes of a body, one in each row, shape (3, 3)."""
        return self.data.body(body).xmat.reshape(3, 3).T

    def solids(self, *bodies: str) -> Solids:
        """Return the solids of some bodies, of those that this infant has."""
        wanted = [self.model.body(name).id for name in bodies if name in self.bodies]
        return self._of(self._solids[np.isin(self.model.geom_bodyid[self._solids], wanted)])

    def geoms(self, *names: str) -> Solids:
        """Return some geoms."""
        return self._of(np.array([self.geom(name) for name in names]))

    def geom(self, name: str) -> int:
        """Return the index of a geom; in a model for MIMo 3 it may have another name."""
        number = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_GEOM, GEOM + name)
        return number if number >= 0 else self.model.geom(name).id

    def limb(self, *roots: str) -> Solids:
        """Return the solids of some bodies and of all that is attached to them."""
        inside = in_subtrees(self.model, [self.model.body(name).id for name in roots])
        return self._of(self._solids[inside[self.model.geom_bodyid[self._solids]]])

    def centre(self, geom: str) -> FloatArray:
        """Return the centre of a geom, shape (3,)."""
        return self.data.geom_xpos[self.geom(geom)]

    def directions(self, geom: str) -> FloatArray:
        """Return the axes of a geom, one in each row, shape (3, 3)."""
        return self.data.geom_xmat[self.geom(geom)].reshape(3, 3).T

    def anchor(self, joint: str) -> FloatArray:
        """Return the anchor of a joint, shape (3,)."""
        return self.data.joint(f"robot:{joint}").xanchor

    def _of(self, geoms: IntArray) -> Solids:
        rotations = self.data.geom_xmat[geoms].reshape(-1, 3, 3)
        return Solids(solid_extents(self.model, geoms), self.data.geom_xpos[geoms], rotations)


Measure = Callable[[Figure, str], float]  # From an infant and the side to measure to a length in [m].


def _length(low_and_high: tuple[float, float]) -> float:
    return low_and_high[1] - low_and_high[0]


def _girth_of(geom: str) -> Measure:
    def measure(figure: Figure, side: str) -> float:
        name = geom.format(side=side)
        axis = figure.directions(name)[2]
        body = figure.model.body(figure.model.geom_bodyid[figure.geom(name)]).name
        return figure.solids(body).girth(axis, float(axis @ figure.centre(name)))

    return measure


def _level_girth(geom: str, *limbs: str) -> Measure:
    """Return the measurement with a tape around the trunk, and some bodies, at the height of a geom."""

    def measure(figure: Figure, side: str) -> float:
        return figure.solids(*TRUNK, *limbs).girth(UP, float(figure.centre(geom)[2]))

    return measure


def _chest_breadth(figure: Figure, side: str) -> float:
    reach = figure.solids(*TRUNK).section_reach(UP, float(figure.centre("ub2")[2]), np.array([LEFT, -LEFT]))
    return float(reach.sum())


def _rump_sole(figure: Figure, side: str) -> float:
    back_m, _ = figure.pose(LEGS_RAISED).solids("hip").span(FORWARD)
    return figure.limb(f"{side}_foot").span(FORWARD)[1] - back_m


def _rump_knee(figure: Figure, side: str) -> float:
    back_m, _ = figure.pose(SITTING).solids("hip").span(FORWARD)
    return figure.solids(f"{side}_upper_leg", f"{side}_lower_leg").span(FORWARD)[1] - back_m


def _knee_sole(figure: Figure, side: str) -> float:
    sole_m, _ = figure.pose(SITTING).limb(f"{side}_foot").span(UP)
    knee = figure.solids(f"{side}_upper_leg", f"{side}_lower_leg")
    top_m = knee.section_reach(FORWARD, float(figure.anchor(f"{side}_knee")[0]), UP[None])
    return float(top_m[0]) - sole_m


def _elbow_hand(figure: Figure, side: str) -> float:
    along = figure.pose(ELBOWS_BENT).axes(f"{side}_lower_arm")[2]
    return _length(figure.limb(f"{side}_upper_arm").span(along))


def _hand_length(figure: Figure, side: str) -> float:
    along = figure.axes(f"{side}_lower_arm")[2]
    return figure.limb(f"{side}_hand").span(along)[1] - float(figure.anchor(f"{side}_hand3") @ along)


def _hand_breadth(figure: Figure, side: str) -> float:
    """Return the breadth across the knuckles, without the thumb."""
    mitten = (f"{side}_fingers",)
    knuckles = mitten if mitten[0] in figure.bodies else (f"{side}_hand", f"{side}_lfmetacarpal")
    return _length(figure.solids(*knuckles).span(figure.axes(f"{side}_lower_arm")[0]))


def _fist_breadth(figure: Figure, side: str) -> float:
    """Return the breadth across the knuckles and the thumb; the palm of a mitten is as broad as a fist."""
    if f"{side}_fingers" in figure.bodies:
        return _length(figure.geoms(f"{side}_hand1").span(figure.axes(f"{side}_lower_arm")[0]))
    fist = figure.pose(FIST).limb(f"{side}_hand")
    return _length(fist.span(figure.axes(f"{side}_lower_arm")[0]))


def _extent(root: str, direction: FloatArray) -> Measure:
    return lambda figure, side: _length(figure.limb(root.format(side=side)).span(direction))


def _span(direction: FloatArray, *bodies: str, posture: Mapping[str, float] = STRAIGHT) -> Measure:
    return lambda figure, side: _length(
        figure.pose(posture).solids(*(body.format(side=side) for body in bodies)).span(direction)
    )


def _head_extent(direction: FloatArray) -> Measure:
    return lambda figure, side: _length(figure.geoms("head").span(direction))


def _diameter(geom: str) -> Measure:
    return lambda figure, side: _length(
        figure.geoms(geom.format(side=side)).span(figure.directions(geom.format(side=side))[0])
    )


MEASURES: Mapping[str, tuple[Measure, tuple[str, ...]]] = {
    "ankle_circumference": (_girth_of("{side}_lower_leg2"), ("{side}_lower_leg",)),
    "calf_circumference": (_girth_of("{side}_lower_leg1"), ("{side}_lower_leg",)),
    "chest_breadth": (_chest_breadth, ()),
    "chest_circumference": (_level_girth("ub2"), ()),
    "crown_rump_length": (_span(UP, "head", *TRUNK, *THIGHS, posture=SITTING), ()),
    "crown_sole_length": (_extent("hip", UP), ("{side}_foot",)),
    "elbow_hand_length": (_elbow_hand, ("{side}_hand",)),
    "foot_breadth": (_extent("{side}_foot", LEFT), ("{side}_foot",)),
    "foot_length": (_extent("{side}_foot", FORWARD), ("{side}_foot",)),
    "forearm_circumference": (_girth_of("{side}_larm"), ("{side}_lower_arm",)),
    "hand_breadth": (_hand_breadth, ("{side}_hand", "{side}_fingers|{side}_lfmetacarpal")),
    "hand_length": (_hand_length, ("{side}_hand",)),
    "head_breadth": (_head_extent(LEFT), ()),
    "head_circumference": (
        lambda figure, side: figure.geoms("head").girth(UP, float(figure.centre("head")[2])),
        (),
    ),
    "head_length": (_head_extent(FORWARD), ()),
    "hip_breadth": (_span(LEFT, "hip", *THIGHS), ()),
    "hip_circumference": (_level_girth("lb", *THIGHS), ()),
    "knee_sole_length": (_knee_sole, ("{side}_foot",)),
    "maximum_fist_breadth": (_fist_breadth, ("{side}_hand",)),
    "mid_thigh_circumference": (_girth_of("{side}_upper_leg1"), ("{side}_upper_leg",)),
    "middle_finger_diameter": (_diameter("{side}_mfknuckle1"), ("{side}_mfknuckle",)),
    "rump_knee_length": (_rump_knee, ("{side}_lower_leg",)),
    "rump_sole_length": (_rump_sole, ("{side}_foot",)),
    "shoulder_breadth": (_span(LEFT, "left_upper_arm", "right_upper_arm"), ("left_upper_arm", "right_upper_arm")),
    "shoulder_elbow_length": (
        _span(UP, "{side}_upper_arm", "{side}_lower_arm", posture=ELBOWS_BENT),
        ("{side}_lower_arm",),
    ),
    "thumb_diameter": (_diameter("{side}_thbase1"), ("{side}_thbase",)),
    "upper_arm_circumference": (_girth_of("{side}_uarm1"), ("{side}_upper_arm",)),
    "waist_circumference": (_level_girth("cb"), ()),
}
"""How each measurement is taken, and the bodies that it needs; of bodies with `|` between them, one."""


def measure_body(model: mujoco.MjModel) -> dict[str, float]:
    """Return every measurement of a compiled infant that it has the parts for, in [m], by AnthroKids name.

    Limbs are measured on the left, or on the right where the left one is missing.
    """
    figure, measured = Figure(model), {}
    for name, (measure, needed) in MEASURES.items():
        for side in SIDES:
            if all(figure.bodies.intersection(bodies.format(side=side).split("|")) for bodies in needed):
                measured[name] = measure(figure.pose(STRAIGHT), side)
                break
    return measured
