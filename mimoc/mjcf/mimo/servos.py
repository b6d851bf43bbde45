"""Servos that take angles, as MIMo's do, and not commands from -1 to 1."""

from collections.abc import Sequence
from dataclasses import replace

from mimoc.mjcf.infant import Actuator
from mimoc.mjcf.scene import Keyframe
from mimoc.mujoco_layout import AffineBias

Range = tuple[float, float]


def by_angle(servo: Actuator, range_rad: Range) -> Actuator:
    """Return a servo whose command is the angle of its hinge, in [rad]; it goes where it went."""
    middle, half = _halves(range_rad)
    settings = dict(servo.settings)
    (gain, *others), bias = settings["gainprm"], AffineBias(*settings["biasprm"])
    moved = bias._replace(at_zero=bias.at_zero - gain * middle / half)
    changed = {"gainprm": (gain / half, *others), "biasprm": moved}
    return replace(servo, control_range=range_rad, settings=tuple({**settings, **changed}.items()))


def pose_by_angle(keyframe: Keyframe, ranges_rad: Sequence[Range]) -> Keyframe:
    """Return a state whose servos, with these ranges, hold its pose."""
    return replace(keyframe, settings=tuple((name, _angles(values, ranges_rad)) for name, values in keyframe.settings))


def _angles(commands: Sequence[float], ranges_rad: Sequence[Range]) -> tuple[float, ...]:
    halves = map(_halves, ranges_rad)
    return tuple(middle + half * command for command, (middle, half) in zip(commands, halves, strict=True))


def _halves(range_rad: Range) -> Range:
    """Return middle and half width."""
    low, high = range_rad
    return (low + high) / 2, (high - low) / 2
