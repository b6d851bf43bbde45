"""What a behaviour is: target angles of some joints in each control step, and whether it does what it is for."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.base.units import ms_to_s
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.policies.control.frames import find_frame
from mimoc.policies.control.holding.driven import DrivenInfant
from mimoc.policies.reaction import Chance
from mimoc.runtime.sense import FloatArray, IntArray


@dataclass(frozen=True)
class Subject:
    """The infant that behaviours are bound to, in its scene."""

    infant: DrivenInfant
    """Its model, and the n hinges that its actuators drive."""
    manifest: Manifest
    chance: Chance = field(default_factory=Chance)
    """What the times of its reactions are drawn from."""

    @property
    def step_s(self) -> float:
        """Duration of a control step."""
        return ms_to_s(self.manifest.step_ms)

    def moved_by(self, groups: tuple[str, ...]) -> IntArray:
        """Return which driven hinges belong to some groups of muscles, shape (m,), as indices among all n."""
        model, in_groups = self.infant.model, self.manifest.anatomy.groups
        wanted = {model.joint(name).id for group in groups for name in in_groups.get(group, ())}
        return np.flatnonzero(np.isin(self.infant.joints, list(wanted))).astype(np.intp)

    def bodies_below(self, *roots: str) -> frozenset[int]:
        """Return some body parts and all that hang on them."""
        model, prefix = self.infant.model, self.infant.prefix
        ids = [find_frame(root, model, prefix).body for root in roots]
        return frozenset(np.flatnonzero(in_subtrees(model, ids)).tolist())

    def require(self, behaviour: str, *bodies: str) -> None:
        """Raise a PolicyError if the infant lacks some body parts."""
        if missing := [name for name in bodies if not self.infant.has(name)]:
            raise PolicyError(f"'{behaviour}' needs {' and '.join(missing)}, which this infant lacks")


class Behaviour:
    """Proposes angles of some joints; a behaviour of one's own overrides what it needs."""

    joints: IntArray
    """The hinges that it moves, as indices among those of its subject, shape (m,)."""
    start: mujoco.MjData | None = None
    """The posture at the origin, facing along x, that an episode begins in; None to begin where the infant is."""
    is_whole = False
    """Whether it is a posture of the whole body, the rest of which others may move."""
    loose: IntArray | None = None
    """Those of its joints that bear nothing and only move what hangs on them; None for all, or, of a whole posture,
    none."""
    may_touch: frozenset[int] = frozenset()
    """Bodies that it may bring to the floor, which counts against no posture."""

    def begin(self, data: mujoco.MjData) -> None:
        """Begin an episode in a state."""

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angle that each of its joints is to go to, shape (m,), [rad].

        It is asked anew for joints to which commands take longer, each time in the state in which the command takes
        effect, as far as it can be predicted.
        """
        raise NotImplementedError

    def lost(self, data: mujoco.MjData, may_touch: frozenset[int]) -> str:
        """Return why a state is none that it is for, or ""; others may bring the bodies *may_touch* to the floor."""
        return ""

    def watch(self, data: mujoco.MjData, time_s: float) -> None:
        """See the state before each control step, for `metrics`."""

    def metrics(self) -> Mapping[str, float]:
        """Return what the summary of a run tells of this episode, by names with their units."""
        return {}
