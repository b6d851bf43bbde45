"""Strength: what moves each joint, how strongly at 18 months, and with which part's size that grows.

Figures are MIMo's (Mattern et al. 2024). `{side}` stands for a right and a left one.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.body.tree import Motor


@dataclass(frozen=True, slots=True)
class MotorFigures:
    """What moves a joint, at 18 months."""

    name: str
    joint: str
    gear_nm: float
    force_range: tuple[float, float]
    mover: str


TRUNK_MOTORS = (
    MotorFigures("act:hip_bend", "robot:hip_bend1", 10.58, (-1, 0.765), "cb"),
    MotorFigures("act:hip_twist", "robot:hip_rot1", 3.63, (-1, 1), "cb"),
    MotorFigures("act:hip_lean", "robot:hip_lean1", 7.25, (-1, 1), "cb"),
)
HEAD_MOTORS = (
    MotorFigures("act:head_swivel", "robot:head_swivel", 1.8, (-1, 1), "head"),
    MotorFigures("act:head_tilt", "robot:head_tilt", 3.3, (-1, 0.55), "head"),
    MotorFigures("act:head_tilt_side", "robot:head_tilt_side", 1.8, (-1, 1), "head"),
)
EYE_MOTORS = (
    MotorFigures("act:{side}_eye_horizontal", "robot:{side}_eye_horizontal", 0.0054, (-1, 1), "geom:{side}_eye1"),
    MotorFigures("act:{side}_eye_vertical", "robot:{side}_eye_vertical", 0.0054, (-1, 1), "geom:{side}_eye1"),
    MotorFigures("act:{side}_eye_torsional", "robot:{side}_eye_torsional", 0.0037, (-1, 1), "geom:{side}_eye1"),
)
ARM_MOTORS = (
    MotorFigures("act:{side}_shoulder_horizontal", "robot:{side}_shoulder_horizontal", 1.8, (-1, 1), "{side}_uarm1"),
    MotorFigures("act:{side}_shoulder_abduction", "robot:{side}_shoulder_ad_ab", 4, (-0.6875, 1), "{side}_uarm1"),
    MotorFigures("act:{side}_shoulder_internal", "robot:{side}_shoulder_rotation", 2.5, (-1, 0.64), "{side}_uarm1"),
    MotorFigures("act:{side}_elbow", "robot:{side}_elbow", 3.6, (-1, 0.83), "{side}_larm"),
    MotorFigures("act:{side}_wrist_rotation", "robot:{side}_hand1", 0.7, (-1, 1), "geom:{side}_hand1"),
    MotorFigures("act:{side}_wrist_flexion", "robot:{side}_hand2", 1.24, (-1, 0.57), "geom:{side}_hand1"),
    MotorFigures("act:{side}_wrist_ulnar", "robot:{side}_hand3", 0.95, (-0.87, 1), "geom:{side}_hand1"),
    MotorFigures("act:{side}_fingers", "robot:{side}_fingers", 0.69, (-1, 0.33), "geom:{side}_hand1"),
)
LEG_MOTORS = (
    MotorFigures("act:{side}_hip_flex", "robot:{side}_hip1", 8, (-1, 1), "geom:{side}_upper_leg1"),
    MotorFigures("act:{side}_hip_abduction", "robot:{side}_hip2", 6.24, (-1, 1), "geom:{side}_upper_leg1"),
    MotorFigures("act:{side}_hip_rotation", "robot:{side}_hip3", 3.54, (-0.75, 1), "geom:{side}_upper_leg1"),
    MotorFigures("act:{side}_knee", "robot:{side}_knee", 10, (-0.65, 1), "geom:{side}_lower_leg1"),
    MotorFigures("act:{side}_foot_flexion", "robot:{side}_foot1", 3.78, (-1, 0.5), "geom:{side}_foot2"),
    MotorFigures("act:{side}_foot_inversion", "robot:{side}_foot2", 1.16, (-0.91, 1), "geom:{side}_foot2"),
    MotorFigures("act:{side}_foot_rotation", "robot:{side}_foot3", 1.2, (-1, 1), "geom:{side}_foot2"),
    MotorFigures("act:{side}_toes", "robot:{side}_toes", 0.33, (-1, 0.3), "geom:{side}_foot2"),
)
MOTOR_GROUPS: tuple[tuple[tuple[MotorFigures, ...], tuple[str, ...]], ...] = (
    (TRUNK_MOTORS, ("",)),
    (HEAD_MOTORS, ("",)),
    (EYE_MOTORS, ("left", "right")),
    (ARM_MOTORS, ("right", "left")),
    (LEG_MOTORS, ("right", "left")),
)
"""Motors and the sides they come on, in the order of MIMo's actuators."""


def motors(growth: Mapping[str, float]) -> tuple[Motor, ...]:
    """Return the motors in MIMo's order; a gear grows with the volume of the part that moves its joint.

    Args:
        growth: Volume of each geom of `anatomy`, relative to the average child of 18 months.
    """
    return tuple(
        Motor(
            name=figures.name.format(side=side),
            joint=figures.joint.format(side=side),
            gear_nm=figures.gear_nm * growth[figures.mover],
            force_range=figures.force_range,
            mover=figures.mover.format(side=side),
        )
        for group, sides in MOTOR_GROUPS
        for side in sides
        for figures in group
    )
