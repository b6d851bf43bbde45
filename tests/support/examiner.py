"""An examiner, who sets off reflexes: a fingertip, a plate to stand on, hands that hold the trunk, and one that turns
the head."""

from collections.abc import Callable

import mujoco
import numpy as np

import mimoc
from mimoc.bundle.model import mjcf_of, prepare
from mimoc.bundle.variants import Variant
from mimoc.policies.named import policy_of

AWAY_M = (0.0, 0.0, 5.0)
TIP_M = 0.006
SENSES = {"proprioception": {}, "vestibular": {}, "touch": {"density": 0.5}}


class Examiner:
    def __init__(self, bundle: mimoc.Bundle, trunk: str = "upper_body"):
        xml, files = mjcf_of(bundle.files, bundle.manifest.scene)
        spec = mujoco.MjSpec.from_string(xml, assets=files)
        tip = spec.worldbody.add_body(name="fingertip", mocap=True, pos=AWAY_M)
        tip.add_geom(name="fingertip", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[TIP_M, 0, 0])
        plate = spec.worldbody.add_body(name="plate", mocap=True, pos=AWAY_M)
        plate.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.3, 0.3, 0.02])
        spec.worldbody.add_body(name="hands", mocap=True, pos=AWAY_M)
        weld = spec.add_equality(name="held", type=mujoco.mjtEq.mjEQ_WELD, name1="hands", name2=trunk, active=False)
        weld.objtype = mujoco.mjtObj.mjOBJ_BODY
        weld.data[:] = 0.0
        weld.data[[6, 10]] = 1.0  # No turn between them; torques count as forces do.
        turned = spec.add_equality(name="turned", type=mujoco.mjtEq.mjEQ_JOINT, name1="robot:head_swivel", active=False)
        turned.data[:] = 0.0
        model = spec.compile()
        prepare(model)
        self.env, self.trunk = mimoc.InfantEnv(Variant(bundle, model)), trunk
        self.model, self.step_s = model, bundle.manifest.step_ms / 1000

    def start(self, pose: str = "supine", lifted_m: float = 0.0, *, is_held: bool = False) -> None:
        """Let the infant begin in a pose, or above it, and held by the trunk; then it has settled."""
        self.observation, _ = self.env.reset(seed=0, options={"pose": pose})
        self.data, self._depth_m = self.env.data, 0.0
        self.data.qpos[2] += lifted_m
        mujoco.mj_forward(self.model, self.data)
        if is_held:
            self.hold()
            self.watch("zero", 0.3)

    def hold(self, pitch_rad: float = 0.0, roll_rad: float = 0.0) -> None:
        index = self.model.body("hands").mocapid[0]
        if not self.data.eq_active[self.model.equality("held").id]:
            self.held_m = self.data.body(self.trunk).xpos.copy()
            self.held_quat = self.data.body(self.trunk).xquat.copy()
            self.data.eq_active[self.model.equality("held").id] = 1
        turn, quat = np.zeros(4), np.zeros(4)
        size = max(1e-9, np.hypot(pitch_rad, roll_rad))
        mujoco.mju_axisAngle2Quat(turn, np.array([roll_rad, pitch_rad, 0.0]) / size, size)
        mujoco.mju_mulQuat(quat, turn, self.held_quat)
        self.data.mocap_pos[index] = self.held_m
        self.data.mocap_quat[index] = quat

    def turn_head(self, angle_rad: float) -> None:
        equality = self.model.equality("turned").id
        self.model.eq_data[equality][0] = angle_rad
        self.data.eq_active[equality] = 1

    def press(self, body: str, place_m: np.ndarray, inward: np.ndarray, force_n: float = 0.5) -> None:
        """Press the fingertip on a body, at a place and in a direction of its frame.

        It goes on until the force is there; with a force of 0, it goes away.
        """
        index = self.model.body("fingertip").mocapid[0]
        if not force_n:
            self.data.mocap_pos[index], self._depth_m = AWAY_M, 0.0
            return
        self._depth_m += 2e-4 * np.clip(force_n - self._force_n(), -2.0, 2.0)
        world_from_body = self.data.body(body).xmat.reshape(3, 3)
        centre = np.asarray(place_m) - (TIP_M - self._depth_m) * np.asarray(inward)
        self.data.mocap_pos[index] = self.data.body(body).xpos + world_from_body @ centre

    def _force_n(self) -> float:
        force, total = np.zeros(6), 0.0
        for index, contact in enumerate(self.data.contact):
            if self.model.geom("fingertip").id in contact.geom:
                mujoco.mj_contactForce(self.model, self.data, index, force)
                total += force[0]
        return total

    def put_plate(self, height_m: float) -> None:
        index = self.model.body("plate").mocapid[0]
        self.data.mocap_pos[index] = [*self.data.body(self.trunk).xpos[:2], height_m - 0.02]

    def watch(
        self, policy: str, seconds: float, during: Callable[[float], None] = lambda time_s: None
    ) -> dict[str, np.ndarray]:
        """Run a policy, and return the angle of each joint over time, and the actions as `actions`."""
        act, generator = policy_of(self.env, policy), np.random.default_rng(0)
        joints = [self.model.joint(index) for index in range(self.model.njnt) if self.model.jnt_type[index] == 3]
        angles, actions = [], []
        for step in range(round(seconds / self.step_s)):
            during(step * self.step_s)
            actions.append(act(generator, self.observation))
            self.observation, *_ = self.env.step(actions[-1])
            angles.append(self.data.qpos[[joint.qposadr[0] for joint in joints]])
        self.policy = act
        names = [joint.name.removeprefix("robot:") for joint in joints]
        return {**dict(zip(names, np.array(angles).T, strict=True)), "actions": np.array(actions)}
