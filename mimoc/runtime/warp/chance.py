"""Random numbers on a device: each is a function of its world's seed, of the time since that was given, and of a place.

So they depend neither on the other worlds nor on the order in which kernels run.
"""

from collections.abc import Mapping

import warp as wp

PLACES = 1 << 23
"""How many places a channel has: numbers that noise acts on."""
SEEDS = 2**31
"""How many different seeds worlds can have."""


class Chance:
    """The random numbers of all worlds."""

    def __init__(self, seeds: wp.array):
        """Begin with some seeds, shape (worlds,), which may change later."""
        self.seeds = seeds
        self.steps = wp.zeros(seeds.shape[0], dtype=int)
        """Physics steps of each world since it was seeded."""

    def advance(self) -> None:
        """Go on to other numbers in the next physics step."""
        wp.launch(_advance, self.steps.shape, [], [self.steps])

    def restart(self, seeds: Mapping[int, int]) -> None:
        """Begin again in worlds that get a new seed."""
        worlds = list(seeds)
        ours, steps = self.seeds.numpy(), self.steps.numpy()
        ours[worlds], steps[worlds] = [seed % SEEDS for seed in seeds.values()], 0
        self.seeds.assign(ours)
        self.steps.assign(steps)


@wp.func
def generator(seeds: wp.array[int], steps: wp.array[int], world: int, place: int) -> wp.uint32:
    """Return the state of a generator; places in which two coincide now differ at the next step."""
    ours = wp.rand_init(seeds[world], steps[world])
    theirs = wp.rand_init(place, steps[world])
    return wp.rand_init(wp.int32(ours), wp.int32(theirs))


@wp.kernel(enable_backward=False)
def _advance(steps: wp.array[int]):
    world = wp.tid()
    steps[world] = steps[world] + 1
