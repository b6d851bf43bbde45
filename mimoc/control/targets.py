"""Targets: places that hands can reach, drawn by chance."""

from collections.abc import Sequence

import mujoco
import numpy as np

from mimoc.bundle.model import in_subtrees
from mimoc.control.frames import Frame, find_frame
from mimoc.control.limbs import chest_of, joints_between, limb_of
from mimoc.errors import ControlError
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import FloatArray

HANDS = ("right_hand", "left_hand")
"""Bodies; MIMo's names."""
EYES = ("eye_left", "eye_right")
"""Cameras; MIMo's names."""
SHARE = 0.8
"""Of the range of each joint, about its middle, from which its angle is drawn."""
VIEW_RAD = np.deg2rad(70.0)
"""How far from straight ahead of the chest a target may be, as the eyes see it."""
MOST_DRAWS = 1000
"""After which there is said to be no such place."""


class Reachable:
    """Draws a place for each hand: where it is when the joints of its arm have angles drawn by chance.

    The arms then touch nothing, neither the infant nor its world, and the eyes can look at the places.
    """

    def __init__(self, env: InfantEnv):
        """Find the arms of an infant.

        Raises:
            ControlError: If it has no hand.
        """
        self._env = env
        self.hands = _commanded(env, HANDS, mujoco.mjtObj.mjOBJ_BODY)
        self.eyes = _commanded(env, EYES, mujoco.mjtObj.mjOBJ_CAMERA)
        if not self.hands:
            raise ControlError("this infant has no hand to reach with; build one that has an arm which takes commands")
        self._bind()

    def draw(self, generator: np.random.Generator) -> tuple[FloatArray, ...] | None:
        """Return a place in the world for each of `hands`, shape (3,), [m], for an infant that is where it is now.

        It is None if much trying finds no such places, as of an infant that lies on its arms.
        """
        if self._env.model is not self._model:
            self._bind()
        model, data = self._model, self._data
        data.qpos[:] = self._env.data.qpos
        for _ in range(MOST_DRAWS):
            data.qpos[self._angles] = generator.uniform(self._low_rad, self._high_rad)
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_camlight(model, data)
            places_m = tuple(frame.place_m(data).copy() for frame in self._frames)
            if all(map(self._is_in_view, places_m)) and not self._touches():
                return places_m
        return None

    def _bind(self) -> None:
        self._model = model = self._env.model
        self._data = mujoco.MjData(model)
        self._frames = [find_frame(hand, model) for hand in self.hands]
        joints = [joint for frame in self._frames for joint in _arm_joints(frame, model)]
        self._angles, self._chest = model.jnt_qposadr[joints], chest_of(model)
        low_rad, high_rad = model.jnt_range[joints].T
        middle_rad, reach_rad = (low_rad + high_rad) / 2, SHARE * (high_rad - low_rad) / 2
        self._low_rad, self._high_rad = middle_rad - reach_rad, middle_rad + reach_rad
        arms = [in_subtrees(model, [limb_of(model, frame.body)]) for frame in self._frames]
        self._is_arm = np.append(np.any(arms, axis=0)[model.geom_bodyid], False)  # The last is for what has no geom.
        self._eyes = [find_frame(eye, model) for eye in self.eyes]

    def _is_in_view(self, place_m: FloatArray) -> bool:
        if not self._eyes:
            return True
        ahead = self._data.body(self._chest).xmat.reshape(3, 3)[:, 0]
        away_m = place_m - np.mean([eye.place_m(self._data) for eye in self._eyes], axis=0)
        return float(away_m @ ahead) > np.cos(VIEW_RAD) * float(np.linalg.norm(away_m))

    def _touches(self) -> bool:
        mujoco.mj_collision(self._model, self._data)
        contact = self._data.contact
        return bool((self._is_arm[contact.geom].any(axis=1) & (contact.dist < 0)).any())


def _commanded(env: InfantEnv, names: Sequence[str], kind: mujoco.mjtObj) -> tuple[str, ...]:
    """Return those hands or eyes that the infant has and that commands move."""
    model = env.model
    moved = set(model.actuator_trnid[env.actuation.actuators, 0].tolist())
    here = [name for name in names if mujoco.mj_name2id(model, kind, name) >= 0]
    return tuple(name for name in here if moved.intersection(_arm_joints(find_frame(name, model), model)))


def _arm_joints(frame: Frame, model: mujoco.MjModel) -> list[int]:
    return joints_between(model, frame.body, limb_of(model, frame.body))
