"""What did not fit on a device: MuJoCo Warp's flags, which stay set until they are cleared, and how much room was used.

Three of the flags lose nothing: the depth of a contact of two convex shapes (`EPA_HORIZON`) or a solution
(`ITERATIONS`, `LS_ITERATIONS`) is less exact. With all others, contacts or constraints of the infant were lost.
`NEFC`, `NJMAX_NNZ` and `CCD` are set for the worlds that lost something. The lists of pairs of geoms and of contacts
are shared: where one is full, `BROADPHASE` or `NARROWPHASE` is set for all worlds, as any of them may have lost some.
"""

import mujoco_warp as mjw
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


@wp.func
def is_losing(flags: int) -> bool:
    """Return whether contacts or constraints were lost."""
    return (flags & wp.static(LOSING)) != 0


def report(data: mjw.Data, actions: wp.array, unstable: wp.array, overflowed: wp.array, written: wp.array) -> None:
    """Write a report, and clear the flags.

    What an unstable infant would need is no measure of the room: all its geoms may be in one place.

    Args:
        data: The state of all worlds.
        actions: Of the present control step, shape (worlds, n).
        unstable: Which infants are, shape (worlds,).
        overflowed: Which infants lost contacts, shape (worlds,).
        written: The report, zero before, shape (`LENGTH`,).
    """
    inputs = [actions, data.nefc, data.ncollision, data.nacon, unstable, overflowed]
    wp.launch(_report, data.nworld, inputs, [data.overflow, written])


@wp.kernel(enable_backward=False)
def _report(
    actions: wp.array2d[float],
    nefc: wp.array[int],
    ncollision: wp.array[int],
    nacon: wp.array[int],
    unstable: wp.array[int],
    overflowed: wp.array[int],
    overflow: wp.array[int],
    written: wp.array[int],
):
    world = wp.tid()
    for number in range(actions.shape[1]):
        if not wp.isfinite(actions[world, number]):
            wp.atomic_max(written, wp.static(NOT_FINITE), world + 1)
    flags = overflow[world]
    overflow[world] = 0
    if unstable[world] == 0:
        if overflowed[world] == 1:
            wp.atomic_add(written, wp.static(OVERFLOWED), 1)
        wp.atomic_max(written, wp.static(ROWS), nefc[world])
        for bit in range(wp.static(LENGTH - COUNTS)):
            if ((flags >> bit) & 1) == 1:
                wp.atomic_add(written, wp.static(COUNTS) + bit, 1)
    if world == 0:
        written[wp.static(PAIRS)] = wp.max(ncollision[0], nacon[0])
