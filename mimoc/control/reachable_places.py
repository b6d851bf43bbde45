"""Random targets that hands can reach and eyes can see."""

import mujoco
import numpy as np

from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.control.frames import Frame, find_frame
from mimoc.control.limbs import joints_between, limb_of, trunk_of
from mimoc.errors import ControlError
from mimoc.senses.sense import FloatArray

SHARE = 0.8
"""Fraction of each joint's range, about its middle, from which its angle is drawn."""
VIEW_RAD = np.deg2rad(70.0)
"""Largest angle between a target, as seen from the eyes, and the forward direction of the chest."""
MOST_DRAWS = 1000
"""Number of draws after which the search is given up."""


class ReachablePlaces:
    """Draws a random position for each hand, where the hand is for random angles of the joints of its arm.

    With these angles, the arms have no contacts with the infant or its world, and the positions are in view.
    """

    def __init__(self, model: mujoco.MjModel, manifest: Manifest):
        """Find the arms of an infant.

        Raises:
            ControlError: If no commanded joint moves a hand.
        """
        self._model, self._data = model, mujoco.MjData(model)
        self._trunk = trunk_of(manifest.anatomy, model)
        moved = {model.joint(actuator.joint).id for actuator in manifest.actuation.actuators if actuator.commanded}
        hands = [limb.end for limb in manifest.anatomy.arms if limb.end]
        self.hands = tuple(hand for hand in hands if moved.intersection(self._joints_to(hand)))
        """Bodies of the hands that commanded joints move."""
        eyes = [eye.camera for eye in manifest.anatomy.eyes]
        self.eyes = tuple(eye for eye in eyes if moved.intersection(self._joints_to(eye)))
        """Cameras of the eyes that commanded joints move."""
        if not self.hands:
            raise ControlError("this infant has no hand with a commanded arm; add 'arms' to actuation.regions")
        self._frames = [find_frame(hand, model) for hand in self.hands]
        self._eyes = [find_frame(eye, model) for eye in self.eyes]
        joints = [joint for hand in self.hands for joint in self._joints_to(hand)]
        self._angles = model.jnt_qposadr[joints]
        low_rad, high_rad = model.jnt_range[joints].T
        middle_rad, half_rad = (low_rad + high_rad) / 2, SHARE * (high_rad - low_rad) / 2
        self._low_rad, self._high_rad = middle_rad - half_rad, middle_rad + half_rad
        arms = [in_subtrees(model, [limb_of(frame.body, self._trunk, model)]) for frame in self._frames]
        self._is_arm = np.append(np.any(arms, axis=0)[model.geom_bodyid], False)  # The last is for what has no geom.

    def draw(self, data: mujoco.MjData, generator: np.random.Generator) -> tuple[FloatArray, ...] | None:
        """Return a position in the world for each of `hands`, shape (3,), [m], for an infant in a state.

        Returns None if `MOST_DRAWS` draws find none, as for an infant that lies on its arms.
        """
        model, posed = self._model, self._data
        posed.qpos[:] = data.qpos
        for _ in range(MOST_DRAWS):
            posed.qpos[self._angles] = generator.uniform(self._low_rad, self._high_rad)
            mujoco.mj_kinematics(model, posed)
            mujoco.mj_comPos(model, posed)
            mujoco.mj_camlight(model, posed)
            places_m = tuple(frame.place_m(posed).copy() for frame in self._frames)
            if all(map(self._is_in_view, places_m)) and not self._touches():
                return places_m
        return None

    def _joints_to(self, name: str) -> list[int]:
        """Return the joints from the trunk to a body or a camera."""
        frame: Frame = find_frame(name, self._model)
        return joints_between(self._model, frame.body, limb_of(frame.body, self._trunk, self._model))

    def _is_in_view(self, place_m: FloatArray) -> bool:
        if not self._eyes:
            return True
        ahead = self._data.xmat[self._trunk[-1]].reshape(3, 3)[:, 0]
        away_m = place_m - np.mean([eye.place_m(self._data) for eye in self._eyes], axis=0)
        return float(away_m @ ahead) > np.cos(VIEW_RAD) * float(np.linalg.norm(away_m))

    def _touches(self) -> bool:
        mujoco.mj_collision(self._model, self._data)
        contact = self._data.contact
        return bool((self._is_arm[contact.geom].any(axis=1) & (contact.dist < 0)).any())
