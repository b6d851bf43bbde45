"""Room for contacts and constraints, which MuJoCo Warp sets aside before the first step, and how it grows.

MuJoCo Warp's flags tell what did not fit, and stay set until they are cleared. Three of them lose nothing: the
depth of a contact of two convex shapes (`EPA_HORIZON`) or a solution (`ITERATIONS`, `LS_ITERATIONS`) is less exact.
With all others, contacts or constraints of the infant were lost. `NEFC`, `NJMAX_NNZ` and `CCD` are set for the worlds
that lost something. The lists of pairs of geoms and of contacts are shared: where one is full, `BROADPHASE` or
`NARROWPHASE` is set for all worlds, as any of them may have lost some.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import mujoco_warp as mjw
import numpy as np
import torch

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import IntArray
from mimoc.runtime.worlds import Worlds

FLAGS = {str(flag.name).lower(): flag.bit_length() - 1 for flag in mjw.OverflowType}  # The bit of each flag.
HARMLESS = int(mjw.OverflowType.EPA_HORIZON | mjw.OverflowType.ITERATIONS | mjw.OverflowType.LS_ITERATIONS)
LOSING = int(mjw.OverflowType.ALL) & ~HARMLESS
NOT_FINITE, NO_REWARD, OVERFLOWED, ROWS, PAIRS, COUNTS = range(6)
"""Places in a report of a control step: the last infant plus one whose commands, and whose reward, were not finite; how
many infants lost contacts; the rows of constraints of the infant with the most; pairs or contacts of all, whichever are
more; then, of how many infants each flag was set, by its bit."""
LENGTH = COUNTS + max(FLAGS.values()) + 1
SHARED = [COUNTS + FLAGS[name] for name in ("broadphase", "narrowphase", "ccd")]
"""Places of the flags of the lists that all worlds share."""
OWN = [COUNTS + FLAGS[name] for name in ("nefc", "njmax_nnz")]  # Places of the flags of the rows that each world has.


def is_losing(worlds: Worlds) -> torch.Tensor:
    """Return in which worlds contacts or constraints were lost, shape (worlds,)."""
    return (worlds.overflow & LOSING) != 0


def report(
    worlds: Worlds, actions: torch.Tensor, rewards: torch.Tensor, unstable: torch.Tensor, overflowed: torch.Tensor
) -> torch.Tensor:
    """Return a report, shape (`LENGTH`,), of which infants are unstable and which lost contacts, and clear the flags.

    What an unstable infant would need is no measure of the room: all its geoms may be in one place.
    """
    flags = worlds.overflow
    numbers = torch.arange(1, len(flags) + 1, device=flags.device)
    not_finite = (numbers * ~actions.isfinite().all(dim=1)).max(), (numbers * ~rewards.isfinite()).max()
    used = (worlds.nefc * ~unstable).max(), torch.maximum(worlds.ncollision[0], worlds.nacon[0])
    bits = torch.arange(LENGTH - COUNTS, device=flags.device)
    counts = ((flags[:, None] >> bits) & ~unstable[:, None]).sum(dim=0)
    flags.zero_()
    return torch.cat([torch.stack([*not_finite, overflowed.sum(), *used]), counts])


SPARE_CONTACTS, SPARE_CONSTRAINTS = 1.5, 2.0
"""Factors between what the infant needs that needs most while it moves at random, and the room at first, which grows.

All worlds share the room for contacts, and the mean infant needs 60 to 65 % of what that one does; each has its own
rows of constraints, of which some infant needs 1.4 to 1.6 times as many in 42,000 physics steps as in the 1,400 that
are tried (measured supine at seven ages, with mitten hands and five fingers)."""
LARGEST = 8.0  # Factor between the same and the room at most.
FULL = 0.8  # Share of the room from which on it grows, mostly before anything is lost.
GROWTH = 1.5  # Factor between what was needed, or what was there if that is more, and the new room.
RARE = 0.01  # Share of the infants that may lose contacts in a control step when the room cannot grow; they begin anew.
STEPS = 200  # Physics steps for which each infant moves at random.
HELD = 20  # Physics steps for which it holds each command: long enough for limbs to hit something.
BODIES = 8  # Number of bodies that are tried, evenly among all; infants of one topology need about the same.


@dataclass(frozen=True, slots=True)
class Capacity:
    """Room for contacts and rows of constraints in each world."""

    contacts: int
    constraints: int


@dataclass(slots=True)
class Room:
    """The room in each world, and how far it may grow."""

    present: Capacity
    largest: Capacity  # How far it grows.
    worlds: int

    @classmethod
    def at_first(
        cls, infants: Sequence[InfantEnv], pairs: IntArray, contacts: int | None, constraints: int | None, worlds: int
    ) -> "Room":
        """Return the given room, or where none is given, that which `measured` suggests."""
        needed = measured([infant.model for infant in infants], [infant.manifest.pose for infant in infants], pairs)
        present = Capacity(
            contacts or int(SPARE_CONTACTS * needed.contacts),
            constraints or int(SPARE_CONSTRAINTS * needed.constraints),
        )
        return cls(present, Capacity(int(LARGEST * needed.contacts), int(LARGEST * needed.constraints)), worlds)

    def after(self, report: IntArray) -> Capacity:
        """Return the room for the next control step from the report of the last one."""
        pairs = math.ceil(report[PAIRS] / self.worlds)
        return Capacity(
            _next(self.present.contacts, self.largest.contacts, pairs, bool(report[SHARED].any())),
            _next(self.present.constraints, self.largest.constraints, int(report[ROWS]), bool(report[OWN].any())),
        )


def measured(models: Sequence[mujoco.MjModel], poses: Sequence[str], pairs: IntArray, seed: int = 0) -> Capacity:
    """Return the most that infants need who move at random; MuJoCo Warp tests *pairs* of geoms, shape (p, 2)."""
    generator = np.random.default_rng(seed)
    contacts = 0
    constraints = 0
    for index in np.unique(np.linspace(0, len(models) - 1, BODIES).astype(int)).tolist():
        model = models[index]
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key(poses[index]).id)
        low, high = model.actuator_ctrlrange.T
        for step in range(STEPS):
            if step % HELD == 0:
                data.ctrl[:] = np.where(generator.random(model.nu) < 0.5, low, high)
            mujoco.mj_step(model, data)
            contacts = max(contacts, data.ncon, _near(model, data, pairs))
            constraints = max(constraints, data.nefc)
    return Capacity(max(contacts, 1), max(constraints, 1))


def _near(model: mujoco.MjModel, data: mujoco.MjData, pairs: IntArray) -> int:
    """Count the pairs of geoms whose bounding spheres meet, which MuJoCo Warp tests further."""
    first, second = pairs.T
    offsets_m = data.geom_xpos[second] - data.geom_xpos[first]
    is_plane = model.geom_rbound[first] == 0.0  # Planes are the first of a pair.
    above_m = np.einsum("ij,ij->i", offsets_m, data.geom_xmat[first].reshape(-1, 3, 3)[:, :, 2])
    apart_m = np.where(is_plane, above_m, np.linalg.norm(offsets_m, axis=1))
    bounds_m = model.geom_rbound + model.geom_margin
    return int((apart_m <= bounds_m[first] + bounds_m[second]).sum())


def _next(present: int, largest: int, needed: int, is_short: bool) -> int:
    if not is_short and needed <= FULL * present:
        return present
    return max(present, min(math.ceil(GROWTH * max(present, needed)), largest))
