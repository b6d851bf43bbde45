"""Gaze: eyes that jump, follow and stabilise, and a head that turns with them, by the age of the infant.

A direction of gaze is kept in the frame of the head. In each control step it is turned against the head (the
vestibulo-ocular reflex), with what is followed (smooth pursuit) and with the whole field (optokinetic stabilisation);
saccades replace it. What it is turned to was seen by the eyes a delay ago, and stands where they pointed then, as far
as the infant knows that (`ahead`, then).
"""

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.base.geometry.rotations import cross
from mimoc.base.units import ms_to_s
from mimoc.policies.behaviours import oculomotor as law
from mimoc.policies.behaviours.aiming import JUMP_M, LEAD_S, MARGIN_RAD, Aim, Target
from mimoc.policies.behaviours.behaviour import SIGHT, Behaviour, Reaction, Subject
from mimoc.policies.control.dynamics import VIEW
from mimoc.policies.control.holding import EYE_FREQUENCY_RAD_S, FREQUENCY_RAD_S
from mimoc.policies.control.infant import DrivenInfant
from mimoc.policies.control.objectives import turn_towards
from mimoc.runtime.sense import FloatArray, IntArray, Observation

HORIZONTAL, VERTICAL = 0, 1
BALANCE = "vestibular"
BRAKING = (
    1.2  # Deceleration of a planned saccade by what its muscles give: damping and the orbit brake as well (fitted).
)
APPROACH_PER_S = 80.0  # Speed of the end of a saccade by what is left of it (fitted: more overshoots).
FINE_RAD = math.radians(0.7)  # What is left of a saccade when it is over, and the servo holds the eye.
OVERDUE_S = 0.15  # A saccade that takes so much longer than it should is over.
HEAD_PER_S, HEAD_RAD_S = 4.0, math.radians(60.0)
"""Speed of the head by how far it is to turn, and at most: 45 degrees a second for turns to sounds (Morrongiello &
Rocca 1987), the rest a choice."""
NECK_DAMPING = 0.1  # Below it, a Jacobian counts as zero (a choice).
VELOCITY_S = 0.08  # Time over which the speed of what is seen is estimated (a guess).
SUPPRESSED_S = 0.05  # For so long after a saccade nothing is taken of what eyes see (saccadic suppression).
PULLED_RAD, HELD_RAD = 0.4, 0.1  # How far from where it is a neck is pulled that is to turn, or held (choices).


@dataclass(frozen=True)
class Eye:
    """An eye that turns about a horizontal and a vertical axis; of the m joints of a behaviour, those that it has."""

    camera: int
    body: int
    head: int
    joints: list[int]  # Indices among the joints of the behaviour, of both directions that it can turn in.
    directions: list[int]  # Which of them each is, `HORIZONTAL` or `VERTICAL`.
    signs: FloatArray  # Rotation to the left or upwards by that of each joint.
    torsion: list[int]  # Joints about the line of sight, which stay where they rest.
    base: FloatArray  # From the frame of the eye, all its angles at 0, to that of the head, shape (3, 3).

    def angles_rad(self, direction: FloatArray) -> FloatArray:
        """Return the angle of each of its joints that points it in a direction in the frame of the head."""
        return self.signs * _angles_of(self.base.T @ direction)[self.directions]


def _angles_of(direction: FloatArray) -> FloatArray:
    """Return how far to the left and upwards of +x a direction is, shape (2,), [rad]."""
    x, y, z = direction
    return np.array([math.atan2(y, x), math.atan2(z, math.hypot(x, y))])


def _direction_of(angles_rad: FloatArray) -> FloatArray:
    left, up = angles_rad
    return np.array([math.cos(up) * math.cos(left), math.cos(up) * math.sin(left), math.sin(up)])


def _turned(vector: FloatArray, rotation: FloatArray) -> FloatArray:
    """Return a vector after a rotation, a rotation vector in [rad]; both have the shape (3,)."""
    angle = math.sqrt(rotation @ rotation)
    if angle < 1e-12:
        return vector
    axis = rotation / angle
    cosine, sine = math.cos(angle), math.sin(angle)
    return cosine * vector + sine * cross(axis, vector) + (1.0 - cosine) * (axis @ vector) * axis


def find_eyes(infant: DrivenInfant, joints: IntArray, cameras: Sequence[int]) -> tuple[Eye, ...]:
    """Return the eyes behind some cameras, with which of some driven hinges turn them."""
    model, found = infant.model, list[Eye]()
    for camera in cameras:
        body = int(model.cam_bodyid[camera])
        own = [slot for slot, joint in enumerate(infant.joints[joints]) if model.jnt_bodyid[joint] == body]
        axes = np.array([model.jnt_axis[infant.joints[joints[slot]]] for slot in own]).reshape(-1, 3)
        across = [int(np.argmax(np.abs(axis))) for axis in axes]
        turning = [number for number, axis in enumerate(across) if axis != 0]
        towards = [axes[number][2] if across[number] == 2 else -axes[number][1] for number in turning]
        base = np.empty(9)
        mujoco.mju_quat2Mat(base, model.body_quat[body])
        found.append(
            Eye(
                camera,
                body,
                int(model.body_parentid[body]),
                [own[number] for number in turning],
                [HORIZONTAL if across[number] == 2 else VERTICAL for number in turning],
                np.sign(towards),
                [slot for slot, axis in zip(own, across, strict=True) if axis == 0],
                base.reshape(3, 3),
            )
        )
    return tuple(found)


@dataclass(frozen=True, slots=True)
class Pose:
    """Where the eyes are and point, as the infant takes it."""

    places_m: FloatArray  # Shape (eyes, 3).
    axes: FloatArray  # From the frames of the cameras to that of the world, shape (eyes, 3, 3).
    is_steady: bool  # Whether no saccade is under way.

    def place_m(self, from_eyes_m: FloatArray) -> FloatArray:
        """Return the place of something from where it is in the frames of all cameras, or the first ones."""
        count = len(from_eyes_m)
        return np.mean(self.places_m[:count] + np.einsum("eij,ej->ei", self.axes[:count], from_eyes_m), axis=0)


@dataclass(frozen=True, slots=True)
class Sample:
    """Where something is on the retinas, in the frames of the cameras, and which of the stimuli so far it is."""

    number: int
    from_eyes_m: FloatArray  # Shape (eyes, 3).


@dataclass(frozen=True, slots=True)
class Seen:
    """What the infant looks at, where it takes it to be."""

    number: int
    place_m: FloatArray
    velocity_m_s: FloatArray

    def after(self, place_m: FloatArray | None, time_s: float, smoothed_s: float) -> "Seen":
        """Return it some time later, seen at a place, or nowhere: then it is taken to go on.

        A critically damped filter of second order estimates place and velocity over a time.
        """
        expected_m = self.place_m + time_s * self.velocity_m_s
        if place_m is None:
            return replace(self, place_m=expected_m)
        error_m = place_m - expected_m
        kept = math.exp(-time_s / smoothed_s)
        velocity_m_s = self.velocity_m_s + (1.0 - kept) ** 2 * error_m / time_s
        return Seen(self.number, expected_m + (1.0 - kept**2) * error_m, velocity_m_s)


@dataclass(frozen=True, slots=True)
class State:
    """What the gaze of an episode depends on, before a control step."""

    aim: FloatArray  # Where the gaze is to be at its end, a unit vector in the frame of the head.
    nearness_per_m: float = 0.0  # 1 over the distance that the eyes converge at.
    seen: Seen | None = None
    size_rad: float = 0.0  # Size of the saccade under way; 0 for none.
    begun_s: float = 0.0  # When the last saccade began.
    ready_s: float = 0.0  # When the next step of this look may follow.
    step_rad: float = 0.0  # How large its steps are.
    number: int = 0  # The stimulus that the last saccade was to.
    saccades: int = 0
    ended_s: float = -math.inf  # When the last saccade was over.
    head_from_s: float = math.inf  # When the head may turn.
    eyes_alone_rad: float = 0.0  # How far from straight ahead the head leaves the eyes.
    drift_rad_s: FloatArray = field(default_factory=lambda: np.zeros(3))  # Optokinetic, in the world.
    neck_rad: FloatArray = field(default_factory=lambda: np.zeros(0))  # Where the neck is to be, shape (necks,).


class Gaze(Behaviour):
    """Turns eyes and head to what is seen; who inherits says what that is."""

    name = "look_at"

    def __init__(self, subject: Subject, is_told: bool = False):
        """Bind it to an infant; raise a PolicyError if the infant has no eyes. With *is_told*, sight has no delay."""
        infant, model = subject.infant, subject.infant.model
        self.joints = subject.moved_by(("neck", "eyes"))
        self._cameras = [model.camera(eye.camera).id for eye in subject.manifest.anatomy.eyes]
        if not self._cameras or not self.joints.size:
            raise PolicyError(f"'{self.name}' needs eyes and muscles of eyes or neck, which this infant lacks")
        self._is_eye = np.isin(self.joints, subject.moved_by(("eyes",)))
        self.frequency_rad_s = np.where(self._is_eye, EYE_FREQUENCY_RAD_S, FREQUENCY_RAD_S)
        self._model, self._subject, self._infant = model, subject, infant
        self._eyes = find_eyes(infant, self.joints, self._cameras)
        self._head = self._eyes[0].head
        self._law = law.Oculomotor.of(subject.manifest)
        self._necks = np.flatnonzero(~self._is_eye)
        self._neck = Aim(infant, self.joints[self._necks], np.ones(len(self._necks)), NECK_DAMPING)
        self._step_s = subject.step_s
        delays, vestibular = dict(subject.manifest.delays), subject.manifest.senses.vestibular
        sight_s = 0.0 if is_told else ms_to_s(delays[SIGHT].ms)
        ahead_s = ms_to_s(_lead_ms(subject))
        self._sight_steps = math.ceil(sight_s / self._step_s - 1e-6)
        self._pose_steps = round((self._sight_steps * self._step_s + ahead_s) / self._step_s)
        self._foreseen_s = self._sight_steps * self._step_s + ahead_s
        is_felt = not is_told and vestibular is not None and vestibular.gyro is not None
        self._felt_steps = round((ms_to_s(delays[BALANCE].ms) + ahead_s) / self._step_s) if is_felt else None
        self._reactions = self._reactions_of(is_told)

    def _reactions_of(self, is_told: bool) -> tuple[Reaction[int], Reaction[int]]:
        first = law.look_reaction(self._subject.manifest, is_told)
        return first, law.after_a_turn(first, self._subject.manifest)

    def begin(self, data: mujoco.MjData) -> None:
        """Begin with the gaze where it is; see `Behaviour`."""
        self._begun_rad = data.qpos[self._infant.angles[self.joints]].copy()
        ahead_of_head = np.mean([data.cam_xmat[camera].reshape(3, 3) @ VIEW for camera in self._cameras], axis=0)
        aim = data.xmat[self._head].reshape(3, 3).T @ ahead_of_head
        self._state = self._next = State(aim / np.linalg.norm(aim), neck_rad=self._begun_rad[self._necks])
        self._at_s = -math.inf
        self._poses = deque([self._pose(data, is_steady=True)], maxlen=self._pose_steps + 1)
        self._turns = deque[FloatArray](maxlen=1 + (self._felt_steps or 0))
        self._felt_rad_s: FloatArray | None = None
        self._slips = deque[FloatArray](maxlen=self._sight_steps + 1)
        self._pause_s = self._law.pause_s
        self._paused = 0
        for reaction in self._reactions:
            reaction.begin()

    def sense(self, observation: Observation, time_s: float, generator: np.random.Generator) -> None:
        """Feel how fast the head turned a delay ago; see `Behaviour`."""
        if self._felt_steps is not None:
            self._felt_rad_s = np.asarray(observation[BALANCE][-3:], np.float64)

    def watch(self, data: mujoco.MjData, time_s: float) -> None:
        """Let the field slip over the retina, and draw how long a pause follows a saccade; see `Behaviour`."""
        self._slips.append(self._turning(data))
        if self._paused != self._state.saccades:
            self._paused = self._state.saccades
            self._pause_s = self._law.pause_of(self._subject.chance.drawn_from.standard_normal())

    def _perceived(self, seen: Seen | None, time_s: float) -> Seen | None:
        """Return what is looked at in a control step, after what was in the last."""
        raise NotImplementedError

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angles of eyes and neck; see `Behaviour`.

        It may be asked several times in a control step, always from the same state of the gaze.
        """
        if time_s == self._at_s:
            self._poses.pop()
            self._turns.pop()
        else:
            self._at_s, self._state = time_s, self._next
        is_steady = not self._state.size_rad and time_s > self._state.ended_s + SUPPRESSED_S
        self._poses.append(self._pose(ahead, is_steady))
        head = self._surprised(_Head.of(self._model, ahead, self._head, self._cameras))
        state = replace(self._state, seen=self._perceived(self._state.seen, time_s))
        targets_rad = self._begun_rad.copy()
        now_rad = ahead.qpos[self._infant.angles[self.joints]]
        speeds_rad_s = ahead.qvel[self._infant.dofs[self.joints]]
        state = self._settled(state, now_rad, speeds_rad_s, head, time_s)
        moved = self._stabilised(state, head)
        self._next = self._aimed(moved, head, time_s)
        for number, eye in enumerate(self._eyes):
            before, after = (self._eye_rad(number, item, head) for item in (state, moved))
            goal = after if self._next.aim is moved.aim else self._eye_rad(number, self._next, head)
            joints = eye.joints
            targets_rad[joints] = self._followed(
                now_rad[joints], speeds_rad_s[joints], goal, (after - before) / self._step_s, self._next.size_rad
            )
            targets_rad[eye.torsion] = 0.0
        if self._necks.size:
            goal_rad, speeds_rad_s = self._neck_goal(ahead, self._next, head, time_s)
            self._next = replace(self._next, neck_rad=goal_rad)
            targets_rad[self._necks] = goal_rad + LEAD_S * speeds_rad_s
        return targets_rad

    def _surprised(self, head: "_Head") -> "_Head":
        """Return the head as it turns if what it was felt to turn faster than expected goes on."""
        self._turns.append(head.axes.T @ head.turns_rad_s)
        if self._felt_rad_s is None or len(self._turns) < (self._turns.maxlen or 0):
            return head
        return replace(head, turns_rad_s=head.turns_rad_s + head.axes @ (self._felt_rad_s - self._turns[0]))

    def _pose(self, data: mujoco.MjData, is_steady: bool) -> Pose:
        return Pose(
            data.cam_xpos[self._cameras].copy(), data.cam_xmat[self._cameras].reshape(-1, 3, 3).copy(), is_steady
        )

    def _known(self, time_s: float) -> int:
        """Return the stimulus that was reacted to last; 0 before the first."""
        return max(reaction.at(time_s) or 0 for reaction in self._reactions)

    def _settled(self, state: State, now_rad: FloatArray, speeds: FloatArray, head: "_Head", time_s: float) -> State:
        """Return the state after the end of a saccade, if it has arrived or is overdue."""
        if not state.size_rad:
            return state
        left = 0.0
        for number, eye in enumerate(self._eyes):
            left = max([left, *np.abs(self._eye_rad(number, state, head) - now_rad[eye.joints])])
        due_s = state.begun_s + self._step_s + 0.021 + 2.2e-3 * math.degrees(state.size_rad) + OVERDUE_S
        if left > FINE_RAD and time_s < due_s:
            return state
        return replace(state, size_rad=0.0, ended_s=time_s, ready_s=time_s + self._pause_s)

    def _stabilised(self, state: State, head: "_Head") -> State:
        """Return the state after reflexes and pursuit have turned the gaze for a control step."""
        gain, seen = self._law.vestibular_gain, state.seen
        meant_rad_s = np.zeros(3)
        nearness = state.nearness_per_m
        if seen is not None:
            away_m = self._expected_m(seen) - head.middle_m
            distance_m = max(float(np.linalg.norm(away_m)), 0.01)
            direction = away_m / distance_m
            followed = cross(direction, seen.velocity_m_s) / distance_m
            speed = max(float(np.linalg.norm(followed)), 1e-9)
            pursuit_rad_s = followed / speed * self._law.pursuit_rad_s(speed)
            meant_rad_s = pursuit_rad_s - gain * cross(direction, head.moves_m_s) / distance_m
            nearness += (1.0 / distance_m - nearness) * min(1.0, self._step_s / law.VERGENCE_S)
        drift = self._drift(state, meant_rad_s)
        turn_rad_s = meant_rad_s + drift + (1.0 - gain) * head.turns_rad_s
        world = _turned(head.axes @ state.aim, self._step_s * turn_rad_s)
        aim = head.axes.T @ _turned(world, -self._step_s * head.turns_rad_s)
        return replace(state, aim=self._in_reach(aim), nearness_per_m=nearness, drift_rad_s=drift)

    def _drift(self, state: State, meant_rad_s: FloatArray) -> FloatArray:
        """Return the optokinetic drift after a control step: it follows the field where it slips unmeant."""
        if len(self._slips) <= self._sight_steps or state.size_rad or not self._poses[0].is_steady:
            return state.drift_rad_s
        slip = self._slips[0] - meant_rad_s
        rate = self._step_s / law.OPTOKINETIC_S
        return state.drift_rad_s - rate * (state.drift_rad_s + self._law.optokinetic_gain * slip)

    def _expected_m(self, seen: Seen) -> FloatArray:
        return seen.place_m + self._law.foresight * self._foreseen_s * seen.velocity_m_s

    def _aimed(self, state: State, head: "_Head", time_s: float) -> State:
        """Return the state with the next saccade begun, if one is due."""
        if state.size_rad or state.seen is None:
            return state
        wanted = self._in_reach(_unit(head.axes.T @ (self._expected_m(state.seen) - head.middle_m)))
        turn = turn_towards(state.aim, wanted)
        away_rad = float(np.linalg.norm(turn))
        is_new = state.seen.number != state.number
        if away_rad < math.radians(law.ON_TARGET_DEG) or (time_s < state.ready_s and not is_new):
            return replace(state, number=state.seen.number)
        planned = self._law.step_rad(away_rad)
        step_rad = planned if is_new else min(away_rad, max(state.step_rad, planned))
        aim = _turned(state.aim, turn * (step_rad / away_rad))
        changes = {"aim": aim / np.linalg.norm(aim), "size_rad": step_rad, "begun_s": time_s}
        changes |= {"saccades": state.saccades + 1, "number": state.seen.number}
        if is_new:
            eccentric_rad = float(np.linalg.norm(_angles_of(_unit(head.axes.T @ (state.seen.place_m - head.middle_m)))))
            changes |= {"step_rad": step_rad, "head_from_s": time_s + self._law.head_late_s}
            changes["eyes_alone_rad"] = self._eyes_alone_rad(eccentric_rad)
        return replace(state, **changes)

    def _eyes_alone_rad(self, eccentric_rad: float) -> float:
        """Return how far from straight ahead eyes stay that have turned so far: the head takes its share."""
        alone, reach = math.radians(law.EYES_ALONE_DEG), math.radians(law.EYES_REACH_DEG)
        return min(alone + (1.0 - self._law.head_share) * max(eccentric_rad - alone, 0.0), reach)

    def _neck_goal(
        self, ahead: mujoco.MjData, state: State, head: "_Head", time_s: float
    ) -> tuple[FloatArray, FloatArray]:
        """Return where the neck is to be after a control step, and how fast it turns: the head follows the eyes."""
        now_rad = ahead.qpos[self._infant.angles[self.joints[self._necks]]]
        speeds_rad_s = np.zeros(len(now_rad))
        if state.seen is not None and time_s >= state.head_from_s:
            direction = _unit(head.axes.T @ (state.seen.place_m - head.middle_m))
            turn = turn_towards(np.array([1.0, 0.0, 0.0]), direction)
            eccentric_rad = float(np.linalg.norm(turn))
            further_rad = eccentric_rad - max(state.eyes_alone_rad, math.radians(law.EYES_ALONE_DEG))
            if further_rad > 0:
                velocity = head.axes @ turn / eccentric_rad * min(HEAD_PER_S * further_rad, HEAD_RAD_S)
                jacobian = np.empty((3, self._model.nv))
                mujoco.mj_jacBody(self._model, ahead, None, jacobian, self._head)
                speeds_rad_s = (self._neck.angles(ahead, velocity, jacobian, now_rad) - now_rad) / LEAD_S
        goal_rad = state.neck_rad + self._step_s * speeds_rad_s
        most_rad = PULLED_RAD if speeds_rad_s.any() else HELD_RAD
        return np.clip(goal_rad, now_rad - most_rad, now_rad + most_rad), speeds_rad_s

    def _eye_rad(self, number: int, state: State, head: "_Head") -> FloatArray:
        """Return the angles of an eye's joints at the gaze of a state, as far as it converges, within their ranges."""
        eye = self._eyes[number]
        between_m = head.axes.T @ (head.middle_m - head.places_m[number])
        direction = state.aim + self._law.vergence * state.nearness_per_m * between_m
        low_rad, high_rad = self._ranges_rad
        angles_rad = eye.angles_rad(direction)
        return np.minimum(np.maximum(angles_rad, low_rad[eye.joints]), high_rad[eye.joints])

    @cached_property
    def _ranges_rad(self) -> tuple[FloatArray, FloatArray]:
        low_rad, high_rad = self._model.jnt_range[self._infant.joints[self.joints]].T
        margin_rad = np.minimum(MARGIN_RAD, (high_rad - low_rad) / 4)
        return low_rad + margin_rad, high_rad - margin_rad

    @cached_property
    def _reach_rad(self) -> tuple[FloatArray, FloatArray]:
        """How far to the right and down, and to the left and up, both eyes can turn, shape (2,) each."""
        low, high = np.full(2, -np.pi), np.full(2, np.pi)
        for eye in self._eyes:
            for joint, direction, sign in zip(eye.joints, eye.directions, eye.signs, strict=True):
                ends = sorted(sign * limits[joint] for limits in self._ranges_rad)
                low[direction], high[direction] = max(low[direction], ends[0]), min(high[direction], ends[1])
        return low, high

    def _in_reach(self, aim: FloatArray) -> FloatArray:
        """Return the direction of gaze in reach of both eyes that is nearest to one, all in the frame of the head."""
        angles_rad = _angles_of(aim)
        low, high = self._reach_rad
        clipped = np.minimum(np.maximum(angles_rad, low), high)
        return aim if (clipped == angles_rad).all() else _direction_of(clipped)

    def _followed(
        self, now: FloatArray, speeds: FloatArray, goal: FloatArray, goal_speeds: FloatArray, size_rad: float
    ) -> FloatArray:
        """Return the angles to go to such that an eye comes to a goal, as fast as it can if that is far.

        For an acceleration a, in the middle of the control step, at the angle q and the speed v there, a servo of
        frequency w that is evaluated implicitly over physics steps h, against passive damping b, goes to

            q + h v + ((2 w + b) v + (1 + 2 w h) a) / w².
        """
        step_s, frequency, physics_s = self._step_s, EYE_FREQUENCY_RAD_S, self._model.opt.timestep
        left = goal - now
        distance = float(np.linalg.norm(left))
        if not size_rad or distance < FINE_RAD:
            return goal + (2.0 / frequency - step_s / 2) * goal_speeds
        along = left / distance
        wanted = self._saccade_speed(distance, float(speeds @ along), size_rad) * along
        acceleration = (wanted - speeds) / step_s
        middle_s = (step_s - physics_s) / 2
        speed = speeds + middle_s * acceleration
        place = now + middle_s * speeds + middle_s**2 / 2 * acceleration
        torque = (2 * frequency + self._plant.damping_per_s) * speed + (1 + 2 * frequency * physics_s) * acceleration
        return place + physics_s * speed + torque / frequency**2

    def _saccade_speed(self, distance: float, speed: float, size_rad: float) -> float:
        """Return the speed after a control step at which an eye still stops where it is to, [rad/s]."""
        step_s, braking = self._step_s, BRAKING * self._plant.strength_rad_s2
        rest = max(distance - speed * step_s / 2, 0.0)
        by_strength = braking * (math.sqrt(step_s**2 / 4 + 2.0 * rest / braking) - step_s / 2)
        by_servo = APPROACH_PER_S * rest / (1.0 + APPROACH_PER_S * step_s / 2)
        return min(law.peak_rad_s(size_rad), by_strength, by_servo)

    def _turning(self, data: mujoco.MjData) -> FloatArray:
        """Return how fast the line of sight turns in the world, shape (3,), by which the still field slips."""
        velocity, total = np.empty(6), np.zeros(3)
        for eye in self._eyes:
            mujoco.mj_objectVelocity(self._model, data, mujoco.mjtObj.mjOBJ_XBODY, eye.body, velocity, 0)
            total += velocity[:3] / len(self._eyes)
        return total

    @cached_property
    def _plant(self) -> "_Plant":
        """The weakest joint of the eyes."""
        model, infant = self._model, self._infant
        found = list[_Plant]()
        for joint in infant.joints[self.joints[self._is_eye]]:
            driving = np.flatnonzero(model.actuator_trnid[:, 0] == joint)
            body, dof = model.jnt_bodyid[joint], model.jnt_dofadr[joint]
            inertia = float(model.dof_armature[dof] + model.body_inertia[body].max())
            strength = float(np.abs(model.actuator_gear[driving, 0]).max()) / inertia
            found.append(_Plant(strength, float(model.dof_damping[dof]) / inertia))
        return min(found, key=lambda plant: plant.strength_rad_s2, default=_Plant(1.0, 0.0))


@dataclass(frozen=True, slots=True)
class _Plant:
    """An eye in its orbit."""

    strength_rad_s2: float  # Acceleration by its muscles.
    damping_per_s: float


@dataclass(frozen=True, slots=True)
class _Head:
    """Pose and motion of the head in a state that has them computed."""

    axes: FloatArray  # From its frame to the world, shape (3, 3).
    places_m: FloatArray  # Of the eyes, shape (eyes, 3).
    middle_m: FloatArray  # Midway between them.
    turns_rad_s: FloatArray  # Its angular velocity in the world.
    moves_m_s: FloatArray  # Velocity of what is midway between the eyes.

    @classmethod
    def of(cls, model: mujoco.MjModel, data: mujoco.MjData, body: int, cameras: Sequence[int]) -> "_Head":
        velocity = np.empty(6)
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, velocity, 0)
        places_m = data.cam_xpos[list(cameras)].copy()
        middle_m = places_m.mean(axis=0)
        moves = velocity[3:] + cross(velocity[:3], middle_m - data.xpos[body])
        return cls(data.xmat[body].reshape(3, 3).copy(), places_m, middle_m, velocity[:3].copy(), moves)


def _lead_ms(subject: Subject) -> float:
    """Return how far ahead of now the state is that behaviours get.

    It is that in which commands to the eyes act, or, as the infant takes it to be by its own senses, commands to all.
    """
    motor = dict(subject.manifest.delays)["motor"]
    if not subject.estimates:
        return motor.ms
    return max(motor.ms, motor.legs_ms or 0.0, *(part.ms for part in motor.parts))


def _unit(vector: FloatArray) -> FloatArray:
    return vector / max(float(np.linalg.norm(vector)), 1e-9)


class Look(Gaze):
    """Turns eyes and head to a target that the simulation knows.

    Its place on the retinas reaches the infant after the delay of sight (`delays.vision_ms`). It is new where it
    appears and wherever it jumps to, and is reacted to after the latency of the age.
    """

    def __init__(self, subject: Subject, target: Target, is_told: bool = False):
        super().__init__(subject, is_told)
        self._named = target

    def begin(self, data: mujoco.MjData) -> None:
        """Choose the nearest of several targets; see `Behaviour`."""
        super().begin(data)
        self._target = self._named.nearest(data, np.mean(data.cam_xpos[self._cameras], axis=0))
        self._samples = deque[Sample](maxlen=self._sight_steps + 1)
        self._number = 0
        self._was_m: FloatArray | None = None
        self._errors_rad = list[float]()

    def watch(self, data: mujoco.MjData, time_s: float) -> None:
        """See the target on the retinas, and note how far the gaze is from it; see `Behaviour`."""
        super().watch(data, time_s)
        place_m = self._target.place_m(data).copy()
        if self._was_m is None or float(np.linalg.norm(place_m - self._was_m)) > JUMP_M:
            was_followed = self._number > 0 and self._known(time_s) == self._number
            self._number += 1
            self._reactions[was_followed].see(self._number, time_s, self._subject.chance.drawn_from)
        self._was_m = place_m
        away_m = place_m - data.cam_xpos[self._cameras]
        axes = data.cam_xmat[self._cameras].reshape(-1, 3, 3)
        self._samples.append(Sample(self._number, np.einsum("eji,ej->ei", axes, away_m)))
        turns = [turn_towards(axes[eye] @ VIEW, _unit(away_m[eye])) for eye in range(len(axes))]
        self._errors_rad.append(max(float(np.linalg.norm(turn)) for turn in turns))

    def metrics(self) -> Mapping[str, float]:
        """Return the median error of the worse eye; see `Behaviour`."""
        return {"gaze_error_deg": float(np.degrees(np.median(self._errors_rad)))} if self._errors_rad else {}

    def _perceived(self, seen: Seen | None, time_s: float) -> Seen | None:
        """Return the target after what is on the retinas now, which is from where the eyes pointed a delay ago."""
        if len(self._samples) <= self._sight_steps:
            return seen
        sample, pose = self._samples[0], self._poses[0]
        if sample.number > self._known(time_s):
            return seen if seen is None else replace(seen, velocity_m_s=np.zeros(3))
        if seen is None or seen.number != sample.number:
            return Seen(sample.number, pose.place_m(sample.from_eyes_m), np.zeros(3))
        place_m = pose.place_m(sample.from_eyes_m) if pose.is_steady else None
        return seen.after(place_m, self._step_s, VELOCITY_S)
