"""Which infant each world of a device simulates, at which age and in which scene, and what samples its resets."""

import copy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.base.errors import MimocError
from mimoc.base.kinds import function_of
from mimoc.base.state_form import require
from mimoc.bundle.model import pose_of
from mimoc.bundle.variants import Variant
from mimoc.runtime import growing
from mimoc.runtime.device.episodes import VISION, changed_rows
from mimoc.runtime.device.states import PHYSICS
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing import SEED
from mimoc.runtime.infant import AGE
from mimoc.runtime.objects import Objects
from mimoc.runtime.sense import IntArray, Sense
from mimoc.schema.kinds import SENSES
from mimoc.schema.objects import checked_moves, names_of

Find = Callable[[InfantEnv, Any], Variant | None]
"""Returns the infant with the age and the scene of options or of a state, or None if it has these already."""


def variant_of_options(infant: InfantEnv, options: Mapping[str, Any]) -> Variant | None:
    """Return the infant with the age and the scene of options of a reset; see `growing.find_variant`."""
    ages = {"": options[AGE]} if AGE in options else {}
    return infant.simulation.find(ages, options.get(SEED))


def variant_of_state(infant: InfantEnv, state: Any) -> Variant | None:
    """Return the infant that a state is of; see `growing.variant_of_state`."""
    require(isinstance(state, Mapping) and {AGE, SEED} <= state.keys(), "", state)
    return infant.simulation.find_in_state({"": state[AGE]}, state[SEED])


class ResetSampler(InfantEnv):
    """A single environment from which a device draws starts; it needs no OpenGL, as the device draws for its eyes."""

    def _former_senses(self) -> Mapping[str, Sense]:
        """Return vision without pictures, which binding then keeps."""
        on_device: Any = SENSES[VISION].device
        return {VISION: function_of(on_device, "NoVision")(), **super()._former_senses()}

    def _stands_for_others(self, *given: Any) -> Any:
        raise MimocError(
            "infants of a device are in the arrays of its 'worlds'; those in 'infants' stand for them, as they start"
        )

    keypoints = effort = play = set_arousal = set_expression = _stands_for_others
    skin = property(_stands_for_others)  # pyright: ignore[reportIncompatibleMethodOverride] - Refused likewise.

    @property
    def has_other_scenes(self) -> bool:
        """Whether it can be in the scene of another seed."""
        return self.simulation.variants is not None and self.simulation.variants.has_other_scenes

    def at(self, wanted: Any, find: Find) -> "ResetSampler":
        """Return the environment of the infant with the wanted age and scene, which may be this one."""
        variant = find(self, wanted)
        if variant is None:
            return self
        objects = copy.deepcopy({"task": self._custom.task, "senses": self._custom.senses})
        infant = ResetSampler(variant, variants=self.simulation.variants, **objects)
        growing.check_same_space(self.observation_space, infant.observation_space)
        return infant

    def grown_into(self, infant: "ResetSampler", state: dict[str, Any]) -> dict[str, Any]:
        """Return physics and model fields of a state after growing into the infant of another age."""
        growing.check_same_body(self.simulation.bare, infant.simulation.bare)
        mujoco.mj_resetData(self.model, self.data)
        self.binding.fields.forget()
        for name, values in state["physics"].items():
            if name == "time":
                self.data.time = values
            else:
                getattr(self.data, name)[:] = values
        rows = changed_rows(self)
        for name, which in rows.items():
            built = getattr(self.model, name)[which]
            given = state["model"][name].reshape(built.shape)  # MuJoCo Warp has vectors and matrices.
            getattr(self.model, name)[which] = np.where(given == built.astype(given.dtype), built, given)
        self.binding.arousal.level = state["arousal"]
        infant.binding.fields.forget()
        growing.carry_body([self.binding], [infant.binding])
        physics = {name: np.array(getattr(infant.data, name)) for name in PHYSICS}
        model = {name: getattr(infant.model, name)[which].copy() for name, which in rows.items()}
        for bound in (self.binding, infant.binding):
            bound.arousal.level = bound.arousal.as_built
            bound.fields.forget()
        return {"physics": physics, "model": model}


def check_start(infant: InfantEnv, options: Mapping[str, Any]) -> None:
    """Check the pose and the places of objects in the options of a reset."""
    pose = pose_of(infant.manifest, options.get(growing.POSE))
    if growing.OBJECTS in options:
        moves = checked_moves(options[growing.OBJECTS], names_of(infant.manifest.objects))
        Objects(infant.manifest, infant.model).find_poses(
            lambda data: mujoco.mj_resetDataKeyframe(data.model, data, data.model.key(pose).id), moves
        )


@dataclass(frozen=True)
class WorldAssignment:
    """Which infant each world simulates."""

    infants: tuple[InfantEnv, ...]  # The different ones, each at the ages and in the scenes that some world has it at.
    body: IntArray  # Which of them it is, shape (worlds,).
    source: IntArray  # Which of the environment's original infants it is an age of, shape (worlds,).

    def become(self, wanted: Sequence[Mapping[str, Any]], find: Find = variant_of_options) -> "WorldAssignment":
        """Return the assignment once worlds have the `age_months` and `scene_seed` that are wanted."""
        if not any(map(_is_change, wanted)):
            return self
        made: dict[Any, InfantEnv] = {}
        known = {self._key(world, self.infant(world)): self.infant(world) for world in range(len(self.body))}
        now: list[InfantEnv] = []
        for world, options in enumerate(wanted):
            infant = self.infant(world)
            if _is_change(options):
                question = self.body[world], self.source[world], repr(_asked(options))
                if question not in made:
                    infant = _at(infant, options, find)
                    made[question] = known.setdefault(self._key(world, infant), infant)
                infant = made[question]
            now.append(infant)
        different = list({id(infant): infant for infant in now}.values())
        places = {id(infant): place for place, infant in enumerate(different)}
        return WorldAssignment(tuple(different), np.array([places[id(infant)] for infant in now]), self.source)

    def infant(self, world: int) -> InfantEnv:
        """Return the environment of the infant in a world."""
        return self.infants[self.body[world]]

    def changed(self, former: "WorldAssignment") -> IntArray:
        """Return the worlds that simulate another infant than before, shape (n,)."""
        pairs = enumerate(zip(self.body, former.body, strict=True))
        return np.array([world for world, (now, then) in pairs if self.infants[now] is not former.infants[then]], int)

    def _key(self, world: int, infant: InfantEnv) -> Any:
        return int(self.source[world]), infant.age_months, infant.manifest.seed


def _is_change(options: Any) -> bool:
    """Return whether options, or a state, name an age or a scene; what is no dictionary is refused later."""
    return not isinstance(options, Mapping) or AGE in options or SEED in options


def _asked(options: Any) -> Any:
    return [options.get(name) for name in (AGE, SEED)] if isinstance(options, Mapping) else None


def _at(infant: InfantEnv, wanted: Any, find: Find) -> InfantEnv:
    if not isinstance(infant, ResetSampler):
        raise MimocError("these infants were opened by their class and keep their ages; make them by mimoc.make_vec")
    return infant.at(wanted, find)
