"""The Gymnasium vector environment of many infants on a device."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv

from mimoc.base.errors import UnknownNameError
from mimoc.runtime.arousal import checked_arousal
from mimoc.runtime.closing import closable
from mimoc.runtime.device.arrays import present, put, to_library
from mimoc.runtime.device.capacity import Capacity
from mimoc.runtime.device.episodes import AS_BUILT, InitialStates, StartOptions
from mimoc.runtime.device.signals import check_infant, find_device
from mimoc.runtime.device.simulation import DeviceBatch, DeviceOptions
from mimoc.runtime.device.states import Path, Slot, check_states, joined, kept_in, states_of, write_to
from mimoc.runtime.device.world_assignment import WorldAssignment, check_start, variant_of_state
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing import AROUSAL, OBJECTS, POSE, SEED, options_given
from mimoc.runtime.gymnasium_forms import (
    RESET_MASK,
    InfantVectorEnv,
    arousals_of,
    check_mixture,
    options_of,
    refuse_ended,
    reset_indices,
    seeds_of,
)
from mimoc.runtime.infant import AGE

CARRIED = ("physics", "model", "arousal")
STARTS = 256  # Starts that are drawn of each infant whose starts are random.


@closable()
class DeviceEnv(InfantVectorEnv, VectorEnv[Any, Any, Any]):
    """A vector environment of infants on a device, in worlds of MuJoCo Warp.

    They may be of different ages and measures. In numbers of 32 bits, each observes and earns what it would on the CPU;
    small differences grow, as in all simulations with contacts. Episodes begin with one of some starts of each infant,
    which are drawn beforehand as a single environment with the seeds 0, 1, 2... draws them; the infant that is reset
    with seed s begins with start s modulo their number, later ones are chosen at random.

    Observations, rewards and ends are copies for NumPy, or, for `torch` and `warp`, the environment's own memory, which
    the next step writes to: copy what is to be kept.

    An infant whose contacts or constraints do not fit into the room for them has lost some: its episode is truncated
    and it is reported in the info `overflowed`. Before the next step, the room grows; all infants go on as they were.
    """

    def __init__(
        self,
        infants: Sequence[InfantEnv],
        num_envs: int | None = None,
        device: str = "cuda:0",
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        max_episode_steps: int | None = None,
        arrays: str = "numpy",
        touch: str = "bodies",
        starts: int = STARTS,
        contacts: int | None = None,
        constraints: int | None = None,
    ):
        """Put infants on a device.

        Args:
            infants: The different infants, as single environments, which draw the starts; they are closed with this
                one, and repeated in turn.
            num_envs: Number of worlds; by default, as many as infants.
            device: Warp's name of it: `cuda:0`, `cuda` for the present GPU, or `cpu`, which is slow and serves tests.
            autoreset_mode: When an infant whose episode has ended is reset; see Gymnasium.
            max_episode_steps: Control steps after which any episode is truncated.
            arrays: What observations and rewards are: `numpy`, `torch` or `warp`.
            touch: `bodies` for the sum of the forces on each body, `points` for those at all points of the skin.
            starts: Number of starts of each infant whose starts are random.
            contacts: Room for contacts in a world at first; by default, 1.5 times what the infant needs that needs most
                when some of them move at random. All worlds share it, and it grows to 8 times that need.
            constraints: Likewise for rows of constraints in each world; by default, twice the need.

        Raises:
            DeviceError: If there is no such device, or an infant needs what is not there on one.
            BatchMismatchError: If the infants do not sense and command the same.
            WorldsError: If their bodies cannot share one model.
            UnknownNameError: If there is no such kind of arrays or touch.
        """
        self.device = find_device(device)
        check_mixture(infants)
        for infant in infants:
            check_infant(infant)
        self.num_envs = num_envs or len(infants)
        self._give, mode = to_library(arrays), AutoresetMode(autoreset_mode)
        self.arrays = arrays  # What observations and rewards are: `numpy`, `torch` or `warp`.
        which = np.arange(self.num_envs) % len(infants)
        self.assignment = WorldAssignment(tuple(infants), which, which)
        with present(self.device):
            options = DeviceOptions(mode, max_episode_steps, touch, starts, contacts, constraints)
            self.worlds = DeviceBatch(infants, which, options)
            self._ages = self._present_ages()
            self._starts: dict[StartOptions, InitialStates] = {AS_BUILT: self.worlds.default_starts}
            self.worlds.begin(self.worlds.default_starts, self.worlds.default_starts.first)
            self.worlds.observe()
        self._describe(
            infants[0].metadata, infants, [self.worlds.bound.spaces[index] for index in which], mode, max_episode_steps
        )

    @property
    def infants(self) -> tuple[InfantEnv, ...]:
        """The different infants, as single environments that stand for those in the worlds and are not stepped."""
        return self.assignment.infants

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start an episode of each infant, or of those in the option `reset_mask`.

        Args:
            seed: Infant i is reset with `seed + i`, or with the i-th of a list.
            options: `pose` and `objects`, one for all; `arousal`, `age_months` and, if infants were made from specs,
                `scene_seed`, for all or, as a list or an array, for each, where None is none; and `reset_mask`.
        """
        options = options_given(options)
        has_objects = all(infant.manifest.objects for infant in self.infants)
        has_scenes = all(getattr(infant, "has_other_scenes", False) for infant in self.infants)
        known = [POSE, AROUSAL, RESET_MASK, AGE, *([OBJECTS] if has_objects else []), *([SEED] if has_scenes else [])]
        for name in options.keys() - known:
            raise UnknownNameError("reset option on a device", str(name), known)
        seeds = seeds_of(seed, self.num_envs)
        which, given = reset_indices(options, self.num_envs), options_of(options, self.num_envs)
        levels = {world: checked_arousal(given[world][AROUSAL]) for world in which if AROUSAL in given[world]}
        chosen = set(which)
        assignment = self.assignment.become([given[world] if world in chosen else {} for world in range(self.num_envs)])
        for infant in assignment.infants:
            check_start(infant, options)
        with present(self.device):
            self.worlds.settle()
            self._assign(assignment)
            if isinstance(seed, (int, np.integer)):
                self._np_random, self._np_random_seed = seeding.np_random(int(seed))
            starts = self._starts_with(options)
            self.worlds.begin(starts, put(self._choices(starts, seeds, which)))
            self.worlds.arouse(levels)
            self.worlds.ended.ended[which] = False
            self.worlds.observe()
            return self._observed(), {
                AGE: self._give(self._ages),
                f"_{AGE}": self._give(torch.ones_like(self.worlds.ended.ended)),
            }

    def set_arousal(self, levels: Any) -> None:
        """Change the arousal of infants for the rest of their episodes: one for all, or one for each, shape (n,).

        Arrays on the device, of any library that knows DLPack, are clipped to 0 and 2; NumPy's are checked.
        """
        with present(self.device):
            if not hasattr(levels, "__dlpack__") or isinstance(levels, (np.ndarray, np.generic)):
                levels = put(arousals_of(levels, self.num_envs))
            self.worlds.arousal.set(torch.from_dlpack(levels).to(self.worlds.arousal.level).expand(self.num_envs))

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """Apply an action of each infant for one control step; those whose episode has ended are reset as agreed.

        Args:
            actions: Shape (n, actuators), of NumPy, or on the device of any library that knows DLPack; values outside
                the action space are clipped.

        Raises:
            DeviceError: If contacts or constraints of more than 1 % of the infants did not fit in the step before and
                the room for them cannot grow, or if actions were not finite.
        """
        with present(self.device):
            self.worlds.settle()
            if self.autoreset_mode == AutoresetMode.DISABLED:
                refuse_ended(self.worlds.ended.ended.cpu().numpy())
            if isinstance(actions, (np.ndarray, list, tuple)) or np.isscalar(actions):
                actions = torch.tensor(self._checked(actions))
            self._check_shape(actions.shape)
            self.worlds.actions.copy_(torch.from_dlpack(actions))
            self.worlds.step()
            ended = self.worlds.ended
            return self._observed(), *map(self._give, (ended.reward, ended.terminated, ended.truncated)), self._info()

    @property
    def room(self) -> Capacity:
        """The room for contacts and constraints that there is now, in each world."""
        return self.worlds.room.present

    @property
    def overflows(self) -> dict[str, int]:
        """In how many control steps, of all infants together, MuJoCo Warp has set each of its flags (`OverflowType`).

        `epa_horizon`, `iterations` and `ls_iterations` lose nothing: the depth of a contact, or a solution, was less
        exact. The step that was made last is counted when the next one begins.
        """
        return dict(self.worlds.overflows)

    def grow(self, to: Any) -> dict[str, Any]:
        """Let infants have other ages from now on, in the midst of their episodes; see `BatchEnv.grow`.

        They go on as on the CPU (`InfantEnv.grow`), which brings each of them into its new body: some milliseconds.
        Where infants first differ in something that they had in common, physics steps are captured again.
        """
        assignment = self.assignment.become(options_of({AGE: to}, self.num_envs))
        with present(self.device):
            self.worlds.settle()
            former = self.assignment
            worlds = assignment.changed(self.assignment)
            kept = kept_in(self._carried())
            states = states_of(kept)
            for world in worlds:
                now: Any = assignment.infant(world)
                states[world] |= former.infant(world).grown_into(now, states[world])
            self._assign(assignment)
            write_to(self._carried(), joined(states, kept))
            self.worlds.observe()
            return self._observed()

    def get_state(self) -> list[dict[str, Any]]:
        """Return the state of each infant: all that its next steps depend on, the random numbers of the batch included.

        They are arrays of NumPy, numbers and dictionaries, which are independent of the environment and can be pickled.
        """
        with present(self.device):
            states = states_of(kept_in(self.worlds.slots()))
        for world, state in enumerate(states):
            manifest = self.assignment.infant(world).manifest
            state |= {AGE: manifest.child.age_months, SEED: manifest.seed}
            state["random"]["choices"] = self.np_random.bit_generator.state
        return states

    def set_state(self, states: Sequence[dict[str, Any]]) -> dict[str, Any]:
        """Restore the state of each infant, with its age and its scene; return what they observe.

        On a CPU device, all later steps are exactly as they would have been from there; on a GPU, which adds up in any
        order, in single precision. The state of one infant can be given to others of the same parts. Choices of starts
        go on as in the first one. If anything is wrong with a state, nothing has changed.
        """
        with present(self.device):
            kept = kept_in(self.worlds.slots())
            check_states(states, kept)
            choices = _checked_choices(states[0])
            assignment = self.assignment.become(states, variant_of_state)
            restored = joined(states, kept)
            self.worlds.ended.report = None
            self._assign(assignment)
            write_to(self.worlds.slots(), restored)
            self.np_random.bit_generator.state = choices
            self.worlds.observe()
            return self._observed()

    def __reduce__(self) -> Any:
        raise TypeError(
            "infants on a device cannot be copied or pickled; keep what get_state returns, and give it to set_state of "
            "a new environment of the same infants"
        )

    def close_extras(self, **kwargs: Any) -> None:
        """Close the infants from which starts were drawn."""
        for infant in self.infants:
            infant.close()

    def _assign(self, assignment: WorldAssignment) -> None:
        worlds = assignment.changed(self.assignment)
        if len(worlds):
            check_mixture(assignment.infants)
            for infant in assignment.infants:
                check_infant(infant)
            self.worlds.become(assignment.infants, assignment.body, worlds)
            self.assignment = assignment
            self._starts = {AS_BUILT: self.worlds.default_starts}
            self._ages = self._present_ages()

    def _carried(self) -> dict[Path, Slot]:
        """Return the parts of the state that growing reads or changes."""
        return {path: slot for path, slot in self.worlds.slots().items() if path[0] in CARRIED}

    def _present_ages(self) -> torch.Tensor:
        return put([infant.age_months for infant in self.infants])[self.worlds.bound.body]

    def _choices(self, starts: InitialStates, seeds: Sequence[int | None], which: Sequence[int]) -> np.ndarray:
        firsts, counts = starts.first.tolist(), starts.count.tolist()
        choices = np.full(self.num_envs, -1)
        for world in which:
            seed = seeds[world]
            number = self.np_random.integers(counts[world]) if seed is None else seed % counts[world]
            choices[world] = firsts[world] + number
        self.worlds.seed({world: seed for world in which if (seed := seeds[world]) is not None})
        return choices

    def _starts_with(self, options: Mapping[str, Any]) -> InitialStates:
        """Return the starts with a pose and places of objects, which are drawn when first needed."""
        chosen = {name: options[name] for name in (POSE, OBJECTS) if options.get(name)}
        key = json.dumps(chosen, sort_keys=True, default=float)
        if key not in self._starts:
            self._starts[key] = self.worlds.starts(key)
        return self._starts[key]

    def _observed(self) -> dict[str, Any]:
        return {name: self._give(array) for name, array in self.worlds.observation.items()}

    def _info(self) -> dict[str, Any]:
        """Return the info with its masks; with resets in the same step, also the last observation."""
        ended = self.worlds.ended
        info = {
            "is_success": self._give(ended.success),
            "unstable": self._give(ended.unstable),
            "overflowed": self._give(ended.overflowed),
            "reward_terms": {name: self._give(term) for name, term in ended.terms.items()},
            AGE: self._give(self._ages),
        }
        everyone = self._give(torch.ones_like(ended.ended))
        info |= {f"_{name}": everyone for name in info}
        if self.autoreset_mode == AutoresetMode.SAME_STEP:
            info["final_obs"] = {name: self._give(array) for name, array in self.worlds.final.items()}
            info["_final_obs"] = self._give(ended.finished)
        return info


def _checked_choices(state: Any) -> Any:
    try:
        generator = np.random.Generator(np.random.PCG64())
        generator.bit_generator.state = state["random"]["choices"]
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"this state cannot be restored ({error}); give one that get_state returned") from error
    return generator.bit_generator.state
