"""Pain: pressure of contacts and strain of joints beyond their thresholds, which fades."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import mujoco
import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.components.senses.pain import PainEntry
from mimoc.runtime.filter import Filter
from mimoc.runtime.sense import FloatArray, IntArray, TermSense
from mimoc.runtime.term import Term
from mimoc.runtime.worlds import Worlds

MAX_SCORE = 100.0  # Bound of the observation; falls on the head reach some tens.


@dataclass(frozen=True)
class Pain(Term):
    """How far the worst of a region exceeds its threshold, in thresholds, shape (k, g).

    With the largest force F of a contact on a region, the angle b of its joint that is forced farthest beyond its
    range, and their thresholds F₀ and b₀: max(F / F₀ - 1, b / b₀ - 1, 0).
    """

    region_of_geom: IntArray  # Region of each geom, or -1, shape (ngeom,).
    threshold_n: FloatArray  # F₀, shape (g,).
    addresses: IntArray  # Addresses of the m joints in `qpos`, shape (m,).
    low_rad: FloatArray  # Ends of their ranges, shape (m,).
    high_rad: FloatArray
    joints: IntArray  # Joints of each region, as indices among the m; m stands for none, shape (g, most).
    strain_rad: FloatArray  # b₀, shape (1,).

    def __call__(self, worlds: Worlds) -> Any:
        """Return the pain now."""
        xp = worlds.xp
        angles = xp.take(worlds.qpos, self.addresses, axis=1)
        beyond = xp.maximum(self.low_rad - angles, angles - self.high_rad) / self.strain_rad
        strains = xp.concat([beyond, xp.zeros_like(beyond[:, :1])], axis=1)
        strained = xp.take(strains, xp.reshape(self.joints, (-1,)), axis=1)
        worst = xp.max(xp.reshape(strained, (strained.shape[0], *self.joints.shape)), axis=-1)
        return xp.maximum(xp.maximum(worlds.loads(self.region_of_geom) / self.threshold_n, worst) - 1.0, 0.0)


@dataclass(frozen=True)
class Fading(Filter):
    """What fades within a time constant T, unless there is more now: max(now, before exp(-t / T))."""

    time_constant_s: FloatArray  # T, shape (1,).

    def __call__(self, xp: Any, elapsed_s: float, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return what is left, which is the state, too; see `Filter`."""
        left = sample if state is None else xp.maximum(sample, state * xp.exp(-elapsed_s / self.time_constant_s))
        return left, left


def bind(entry: PainEntry, model: mujoco.MjModel, bundle: Bundle) -> TermSense:
    """Find the regions of *entry* in *model*."""
    region_of_body = np.full(model.nbody, -1)
    for number, region in enumerate(entry.regions):
        region_of_body[[model.body(name).id for name in region.bodies]] = number
    joints = [name for region in entry.regions for name in region.joints]
    ends = np.cumsum([0, *(len(region.joints) for region in entry.regions)])
    table = np.full((len(entry.regions), max(1, *np.diff(ends))), len(joints))
    for number, (first, last) in enumerate(pairwise(ends)):
        table[number, : last - first] = np.arange(first, last)
    ids = np.array([model.joint(name).id for name in joints], np.intp)
    low_rad, high_rad = np.where(model.jnt_limited[ids], model.jnt_range[ids].T, [[-np.inf], [np.inf]])
    pain = Pain(
        region_of_body[model.geom_bodyid].astype(np.intp),
        np.array([region.threshold_n for region in entry.regions]),
        model.jnt_qposadr[ids].astype(np.intp),
        low_rad,
        high_rad,
        table.astype(np.intp),
        np.array([math.radians(entry.strain_deg)]),
    )
    bodies = np.array([model.body(region.bodies[0]).id for region in entry.regions], np.intp)
    sense = TermSense("pain", pain, [f"{region.name} [thresholds]" for region in entry.regions], 0.0, MAX_SCORE, bodies)
    sense.filter = Fading(np.array([ms_to_s(entry.decay_ms)]))
    return sense
