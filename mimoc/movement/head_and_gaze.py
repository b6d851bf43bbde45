"""Measures of head and gaze: how long they are in the midline, and how fast they turn."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from mimoc.motion.point_recording import FloatArray

MIDLINE_DEG = 20.0  # A head or a gaze turned aside by less is in the midline (a choice).
FACE_POINTS = "nose", "left_ear", "right_ear", "left_shoulder", "right_shoulder"
"""Points by which it is known how the face is turned on the trunk."""


def head_measures(places_m: Mapping[str, FloatArray], rate_hz: float) -> dict[str, float]:
    """Return how the head of a recording is turned; nothing if points are missing.

    With n the nose, m the middle of the ears, l and r the shoulders, and the unit vectors f along n - m and a along
    l - r, the head is turned aside by asin(f . a): 90 degrees if the face is along the line of the shoulders.

    Args:
        places_m: Places of points without what is faster than 6 Hz, shape (t, 3) each, by name.
        rate_hz: Frames per second.
    """
    if not set(FACE_POINTS) <= places_m.keys():
        return {}
    face = places_m["nose"] - (places_m["left_ear"] + places_m["right_ear"]) / 2
    aside_deg = _aside_deg(face, places_m["left_shoulder"] - places_m["right_shoulder"])
    return {
        "head_midline_share": float((np.abs(aside_deg) < MIDLINE_DEG).mean()),
        "head_aside_deg": float(np.median(np.abs(aside_deg))),
        "head_turning_deg_s": float(np.abs(np.gradient(aside_deg) * rate_hz).mean()),
    }


def gaze_midline_share(columns: Mapping[str, Any]) -> float:
    """Return the share of rows in which the line of sight is turned aside by less than 20 degrees, as for the head."""
    shoulders_m = _points(columns, "left_shoulder_{}_m") - _points(columns, "right_shoulder_{}_m")
    return float((np.abs(_aside_deg(_points(columns, "gaze_direction_{}"), shoulders_m)) < MIDLINE_DEG).mean())


def gaze_turning_deg_s(columns: Mapping[str, Any]) -> float | None:
    """Return the mean speed at which the line of sight turns in the world; None of fewer than two rows."""
    towards = _points(columns, "gaze_direction_{}")
    if len(towards) < 2:
        return None
    across = np.linalg.norm(np.cross(towards[1:], towards[:-1]), axis=1)
    turned_rad = np.arctan2(across, (towards[1:] * towards[:-1]).sum(axis=1))
    seconds = float(columns["time_s"][-1]) - float(columns["time_s"][0])
    return math.degrees(float(turned_rad.sum())) / seconds


def _points(columns: Mapping[str, Any], name: str) -> FloatArray:
    return np.stack([np.asarray(columns[name.format(axis)], float) for axis in "xyz"], axis=-1)


def _aside_deg(towards: FloatArray, to_the_left: FloatArray) -> FloatArray:
    """Return by how much directions, shape (t, 3), are turned to the left out of the plane across another."""
    lengths = np.linalg.norm(towards, axis=1) * np.linalg.norm(to_the_left, axis=1)
    cosines = (towards * to_the_left).sum(axis=1) / np.maximum(lengths, 1e-12)
    return np.degrees(np.arcsin(np.clip(cosines, -1.0, 1.0)))
