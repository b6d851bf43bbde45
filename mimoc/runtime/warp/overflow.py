"""What did not fit on a device: MuJoCo Warp's flags, which stay set until they are cleared, and how much room was used.

Three of the flags lose nothing: the depth of a contact of two convex shapes (`EPA_HORIZON`) or a solution
(`ITERATIONS`, `LS_ITERATIONS`) is less exact. With all others, contacts or constraints of the infant were lost.
`NEFC`, `NJMAX_NNZ` and `CCD` are set for the worlds that lost something. The lists of pairs of geoms and of contacts
are shared: where one is full, `BROADPHASE` or `NARROWPHASE` is set for all worlds, as any of them may have lost some.
"""

import mujoco_warp as mjw
import torch
import warp as wp

FLAGS = {str(flag.name).lower(): flag.bit_length() - 1 for flag in mjw.OverflowType}
"""The bit of each flag."""
HARMLESS = int(mjw.OverflowType.EPA_HORIZON | mjw.OverflowType.ITERATIONS | mjw.OverflowType.LS_ITERATIONS)
LOSING = int(mjw.OverflowType.ALL) & ~HARMLESS
SHARED = ("broadphase", "narrowphase", "ccd")
"""Flags of the lists that all worlds share."""
OWN = ("nefc", "njmax_nnz")
"""Flags of the rows that each world has."""
NOT_FINITE, OVERFLOWED, ROWS, PAIRS, COUNTS = range(5)
"""Places in a report of a control step: the last infant plus one whose commands were not finite; how many infants lost
contacts; the rows of constraints of the infant with the most; pairs or contacts of all, whichever are more; then, of
how many infants each flag was set, by its bit."""
LENGTH = COUNTS + max(FLAGS.values()) + 1


def is_losing(data: mjw.Data) -> torch.Tensor:
    """Return in which worlds contacts or constraints were lost, shape (worlds,)."""
    return (wp.to_torch(data.overflow) & LOSING) != 0


def report(data: mjw.Data, actions: wp.array, unstable: torch.Tensor, overflowed: torch.Tensor) -> torch.Tensor:
    """Return a report, shape (`LENGTH`,), and clear the flags.

    What an unstable infant would need is no measure of the room: all its geoms may be in one place.

    Args:
        data: The state of all worlds.
        actions: Of the present control step, shape (worlds, n).
        unstable: Which infants are, shape (worlds,).
        overflowed: Which infants lost contacts, shape (worlds,).
    """
    flags, rows, pairs, contacts = map(wp.to_torch, (data.overflow, data.nefc, data.ncollision, data.nacon))
    numbers = torch.arange(1, len(flags) + 1, device=flags.device)
    not_finite = (numbers * ~wp.to_torch(actions).isfinite().all(dim=1)).max()
    used = (rows * ~unstable).max(), torch.maximum(pairs[0], contacts[0])
    bits = torch.arange(LENGTH - COUNTS, device=flags.device)
    counts = ((flags[:, None] >> bits) & ~unstable[:, None]).sum(dim=0)
    flags.zero_()
    return torch.cat([torch.stack([not_finite, overflowed.sum(), *used]), counts])
