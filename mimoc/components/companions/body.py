"""The body of a caregiver in a simulation: where head and hands are, how they move, and what they touch of infants."""

import math
from collections.abc import Collection
from dataclasses import dataclass
from itertools import chain
from typing import Any

import mujoco
import numpy as np

from mimoc.base.geometry.adult import SIDES, Adult, Palm, Side, neck
from mimoc.base.geometry.reach import Frame, leaning_pose
from mimoc.base.geometry.rotations import FloatArray, cross, quaternion_from_matrix
from mimoc.base.mujoco_layout import WELD_ANCHOR, WELD_PLACE, WELD_TURN
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.runtime.model_fields import ModelField
from mimoc.schema.caregiver import CaregiverEntry

PEAK_M_S = 0.6
"""Peak speed of a hand: about that of reaches over 30 cm without haste (Flash & Hogan 1985, J Neurosci 5: 1688; from
memory)."""
PEAK_RAD_S = math.radians(150)
"""Peak speed of a turn of the head: about that of gaze shifts of 60 deg without haste (Guitton & Volle 1987, J
Neurophysiol 58: 427; from memory)."""
PEAK = 1.875  # Peak speed of a movement of minimum jerk, by its mean speed (Flash & Hogan 1985).
SHORTEST_S = 0.3  # Duration of the shortest movements; an assumption.
PARTS = ("head", "neck", "trunk")
AWAY_RAD = math.radians(75)  # How far the head is turned to look away.
SEEN_M = 0.001  # How far the infant's face moves until the head that looks at it follows.
TOUCHING_M = 0.001  # Depth of a contact beyond which a hand moves no further into the infant.
WIDER_M = (0.0, 0.05, 0.1, 0.15, 0.2, 0.25)
"""How much farther out hands rest where they would touch the infant at the start; the first that does not is taken."""


class Infant:
    """An infant as a caregiver sees it, by names of the manifest."""

    def __init__(self, manifest: Manifest, model: mujoco.MjModel):
        anatomy = manifest.anatomy
        self.root = model.body(manifest.root_body).id
        inside = in_subtrees(model, [self.root])
        self.is_its_geom = inside[model.geom_bodyid]
        """Whether a geom is the infant's, shape (ngeom,)."""
        self.head = model.body(anatomy.head or manifest.root_body).id
        self.weight_n = float(model.body_subtreemass[self.root] * -model.opt.gravity[2])
        self.legs = [(model.body(leg.root).id, model.body(leg.end).id) for leg in anatomy.legs if leg.end]
        self.hands = [model.body(arm.end).id for arm in anatomy.arms if arm.end]
        self._cameras = [model.camera(eye.camera).id for eye in anatomy.eyes]
        entry = manifest.caregiver
        assert entry
        self._face_m = np.array(entry.infant_face_m)

    def face_m(self, data: mujoco.MjData) -> FloatArray:
        """Return a point between its eyes, shape (3,)."""
        return data.xpos[self.head] + data.xmat[self.head].reshape(3, 3) @ self._face_m

    def face(self, data: mujoco.MjData) -> tuple[FloatArray, FloatArray]:
        """Return a point between its eyes, shape (3,), and the axes of its head, shape (3, 3)."""
        return self.face_m(data), data.xmat[self.head].reshape(3, 3).copy()

    def gaze(self, data: mujoco.MjData) -> tuple[FloatArray, FloatArray]:
        """Return where it looks from and to: the mean of its eyes, or where its head points to."""
        if not self._cameras:
            place_m, turn = self.face(data)
            return place_m, turn[:, 0]
        way = -data.cam_xmat[self._cameras].reshape(-1, 3, 3)[:, :, 2].mean(axis=0)
        return data.cam_xpos[self._cameras].mean(axis=0), way / np.linalg.norm(way)

    def leg_lengths_m(self, data: mujoco.MjData) -> list[float]:
        """Return the distance from hip to foot of each leg."""
        return [math.dist(data.xpos[foot], data.xpos[hip]) for hip, foot in self.legs]


def minimum_jerk(share: float) -> float:
    """Return how much of a movement is done after a share of its time: 10 s³ - 15 s⁴ + 6 s⁵ (Flash & Hogan 1985)."""
    share = min(max(share, 0.0), 1.0)
    return share**3 * (10 - 15 * share + 6 * share**2)


def duration_s(length: float, peak: float) -> float:
    """Return how long a movement takes, from its length and its peak speed, in any unit of length."""
    return max(PEAK * length / peak, SHORTEST_S)


@dataclass
class HandPath:
    """A movement of a palm along a parabola: from its start by way of a point to its end."""

    start_m: FloatArray
    by_m: FloatArray  # Control point of the parabola: the palm comes to its end from there.
    end_m: FloatArray
    start_normal: FloatArray
    end_normal: FloatArray
    steps: int  # Physics steps that it takes.
    done: int = 0

    @classmethod
    def between(cls, start: Palm, end: Palm, by_m: FloatArray, timestep_s: float) -> "HandPath":
        """Return a movement that begins now."""
        length_m = float(np.linalg.norm(by_m - start.place_m) + np.linalg.norm(end.place_m - by_m))
        steps = math.ceil(duration_s(length_m, PEAK_M_S) / timestep_s)
        return cls(start.place_m, by_m, end.place_m, start.normal, end.normal, steps)

    @property
    def is_done(self) -> bool:
        """Whether the palm is at its end."""
        return self.done >= self.steps

    def at(self, done: int) -> Palm:
        """Return where the palm is after some of its steps."""
        share = minimum_jerk(done / self.steps)
        rest = 1 - share
        place_m = rest**2 * self.start_m + 2 * rest * share * self.by_m + share**2 * self.end_m
        normal = rest * self.start_normal + share * self.end_normal
        length = float(np.linalg.norm(normal))
        return Palm(place_m, normal / length if length > 1e-6 else self.end_normal)

    @property
    def state(self) -> dict[str, Any]:
        """All of it, to be copied."""
        return dict(vars(self))


def turned(start: FloatArray, end: FloatArray, share: float) -> FloatArray:
    """Return the rotation after a share of the shortest turn from one to another, shape (3, 3)."""
    axis, angle_rad = turn_between(start, end)
    return _about(axis, share * angle_rad) @ start


def turn_between(start: FloatArray, end: FloatArray) -> tuple[FloatArray, float]:
    """Return axis and angle of the shortest turn from one rotation to another."""
    turn = end @ start.T
    angle_rad = math.acos(min(max((float(np.trace(turn)) - 1) / 2, -1.0), 1.0))
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    length = float(np.linalg.norm(axis))
    return (axis / length, angle_rad) if length > 1e-9 else (np.array([0.0, 0.0, 1.0]), 0.0)


def _about(axis: FloatArray, angle_rad: float) -> FloatArray:
    """Return the rotation about a unit vector, shape (3, 3) (Rodrigues 1840)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle_rad) * cross + (1 - math.cos(angle_rad)) * (cross @ cross)


class CaregiverBody:
    """The bodies of a caregiver, which MuJoCo's mocap moves."""

    def __init__(self, entry: CaregiverEntry, model: mujoco.MjModel, infants: Collection[Infant]):
        """Look up its parts in a model, of which it changes the material of its face and its grips.

        It pushes into none of the infants.
        """
        self._is_infants_geom = np.any([infant.is_its_geom for infant in infants], axis=0)
        self._entry = entry
        self._model = model
        self.timestep_s = model.opt.timestep
        self.adult = Adult(entry.scale)
        self.head = model.body(entry.head).id
        arms = dict(zip(SIDES, entry.arms, strict=True))
        bodies: dict[Side, list[int]] = {
            side: [model.body(name).id for name in arm.bodies] for side, arm in arms.items()
        }
        self.hands = {side: ids[-1] for side, ids in bodies.items()}
        whole = [self.head, model.body(entry.neck).id, model.body(entry.trunk).id, *chain(*bodies.values())]
        self._mocap: dict[str, int] = dict(zip(PARTS, model.body_mocapid[whole[:3]].tolist(), strict=True))
        self._of_arms = {side: model.body_mocapid[ids].tolist() for side, ids in bodies.items()}
        self._of_arm = {side: np.isin(model.geom_bodyid, ids) for side, ids in bodies.items()}
        self.is_its_geom = np.isin(model.geom_bodyid, whole)
        self.grips: dict[Side, int] = {side: model.equality(arm.grip).id for side, arm in arms.items()}
        self._face = model.geom(entry.face).id
        self._materials = {name: model.material(material).id for name, material in entry.materials.items()}

    @property
    def model_fields(self) -> tuple[ModelField, ...]:
        """What it changes in the model."""
        grips = np.array(list(self.grips.values()))
        return (
            ModelField("geom_matid", np.array([self._face])),
            ModelField("eq_data", grips),
            ModelField("eq_obj2id", grips),
        )

    def start(self, data: mujoco.MjData, infant: Infant) -> None:
        """Be where the spec says by an infant in its pose, looking at it, with resting hands that do not touch it."""
        entry = self._entry
        to_left = entry.side == "left"
        leaning = leaning_pose(
            self.adult.figure, infant.face(data), entry.place, to_left, entry.distance_m, entry.height_m
        )
        self._head_m, self._head_turn = leaning.head
        self._trunk, self._neck = leaning.trunk, neck(leaning)
        self._turn: dict[str, Any] = {"at": True, "from": self._head_turn, "steps": 1, "done": 1, "seen_m": [0.0] * 3}
        self.paths: dict[Side, HandPath | None] = dict.fromkeys(SIDES)
        for wider_m in WIDER_M:
            self.palms = {side: self.adult.resting(self._trunk, side, wider_m) for side in SIDES}
            for name, frame in self._placed.items():
                _write(self._mocap[name], frame, data)
            for side in SIDES:
                self.put(side, self.palms[side], data)
            mujoco.mj_forward(self._model, data)
            if not self.touches(data):
                break
        self.resting = dict(self.palms)

    def show(self, expression: str) -> None:
        """Show a facial expression."""
        self._model.geom_matid[self._face] = self._materials[expression]

    def look(self, at_infant: bool, data: mujoco.MjData, infant: Infant) -> None:
        """Begin to turn the head to the infant, or away from it."""
        start = self._gaze(data, infant)
        self._turn = {**self._turn, "at": at_infant, "from": start, "steps": 1, "done": 0}
        _, angle_rad = turn_between(start, self._aim(data, infant))
        self._turn["steps"] = math.ceil(duration_s(angle_rad, PEAK_RAD_S) / self.timestep_s)

    def move(self, side: Side, palm: Palm, by_m: FloatArray) -> None:
        """Begin to move a hand to a place, which it comes to from another."""
        self.paths[side] = HandPath.between(self.palms[side], palm, by_m, self.timestep_s)

    def advance(self, data: mujoco.MjData, infant: Infant, held: dict[Side, int]) -> None:
        """Go on with all movements by a physics step; *held* is the body that each hand carries, if any."""
        self._turn_head(data, infant)
        for side, path in self.paths.items():
            if path and not path.is_done:
                palm = path.at(path.done + 1)
                if not self._would_push(side, palm.place_m - self.palms[side].place_m, data, held):
                    path.done = path.done + 1
                    self.put(side, palm, data)

    def follow(self, side: Side, place_m: FloatArray, data: mujoco.MjData) -> None:
        """Bring a hand nearer to a place that moves, as fast as a hand moves, in a physics step."""
        palm = self.palms[side]
        way_m = place_m - palm.place_m
        way_m = way_m * min(1.0, PEAK_M_S * self.timestep_s / max(float(np.linalg.norm(way_m)), 1e-9))
        if not self._would_push(side, way_m, data, {}):
            self.put(side, Palm(palm.place_m + way_m, palm.normal), data)

    def put(self, side: Side, palm: Palm, data: mujoco.MjData) -> None:
        """Put a hand somewhere, and its arm with it."""
        self.palms[side] = palm
        for mocap, frame in zip(self._of_arms[side], self.adult.arm(self._trunk, side, palm), strict=True):
            _write(mocap, frame, data)

    def face_m(self, data: mujoco.MjData) -> FloatArray:
        """Return the middle of its face, shape (3,)."""
        return self._head_m + self.adult.figure.face_m * data.xmat[self.head].reshape(3, 3)[:, 0]

    def shoulder_m(self, side: Side) -> FloatArray:
        """Return a shoulder, shape (3,)."""
        return self.adult.shoulder_m(self._trunk, side)

    def outward(self, side: Side) -> FloatArray:
        """Return the direction to its own side, a unit vector, shape (3,)."""
        return self._trunk[1][:, 1] * (1.0 if side == "left" else -1.0)

    def touches(self, data: mujoco.MjData, infant: Infant | None = None) -> bool:
        """Return whether anything of it touches an infant, or any infant."""
        return bool(self._contacts(self.is_its_geom, data, infant).any())

    def is_blocked(self, side: Side, data: mujoco.MjData) -> bool:
        """Return whether an arm is in contact with an infant."""
        return bool(self._contacts(self._of_arm[side], data).any())

    def grip(self, side: Side, body: int, data: mujoco.MjData) -> None:
        """Hold a body where it is relative to the hand; the body must be that of the state."""
        hand, equality = self.hands[side], self.grips[side]
        turn = data.xmat[hand].reshape(3, 3)
        numbers = self._model.eq_data[equality]
        numbers[WELD_ANCHOR] = 0.0
        numbers[WELD_PLACE] = turn.T @ (data.xpos[body] - data.xpos[hand])
        numbers[WELD_TURN] = quaternion_from_matrix(turn.T @ data.xmat[body].reshape(3, 3))
        self._model.eq_obj2id[equality] = body
        data.eq_active[equality] = True

    def let_go(self, side: Side, data: mujoco.MjData) -> None:
        """Hold nothing with a hand."""
        data.eq_active[self.grips[side]] = False

    @property
    def state(self) -> dict[str, Any]:
        """All that it remembers."""
        paths = {side: path and path.state for side, path in self.paths.items()}
        frames = {name: list(frame) for name, frame in self._placed.items()}
        both = self.palms, self.resting
        palms, resting = ([[palm.place_m, palm.normal] for palm in kept.values()] for kept in both)
        return {"turn": self._turn, "paths": paths, "frames": frames, "palms": palms, "resting": resting}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        self._turn = state["turn"]
        self.paths = {side: path and HandPath(**path) for side, path in state["paths"].items()}
        frames = {name: (frame[0], frame[1]) for name, frame in state["frames"].items()}
        (self._head_m, self._head_turn), self._trunk, self._neck = frames["head"], frames["trunk"], frames["neck"]
        self.palms, self.resting = (
            {side: Palm(*palm) for side, palm in zip(SIDES, state[name], strict=True)} for name in ("palms", "resting")
        )

    @property
    def _placed(self) -> dict[str, Frame]:
        return {"head": (self._head_m, self._head_turn), "trunk": self._trunk, "neck": self._neck}

    def _aim(self, data: mujoco.MjData, infant: Infant) -> FloatArray:
        up = self._head_turn[:, 2]
        if self._turn["at"]:
            gaze = infant.face_m(data) - self._head_m
        else:
            forward, left = self._head_turn[:, 0], self._head_turn[:, 1]
            gaze = math.cos(AWAY_RAD) * forward + math.sin(AWAY_RAD) * left
        gaze = gaze / np.linalg.norm(gaze)
        up = up - (up @ gaze) * gaze
        up /= np.linalg.norm(up)
        return np.column_stack([gaze, cross(up, gaze), up])

    def _gaze(self, data: mujoco.MjData, infant: Infant) -> FloatArray:
        aim, turn = self._aim(data, infant), self._turn
        if turn["done"] >= turn["steps"]:
            return aim
        return turned(turn["from"], aim, minimum_jerk(turn["done"] / turn["steps"]))

    def _turn_head(self, data: mujoco.MjData, infant: Infant) -> None:
        """Turn the head by a physics step, if it is being turned or follows the infant, which has moved."""
        turn, face_m = self._turn, infant.face_m(data)
        if turn["done"] < turn["steps"]:
            turn["done"] += 1
        elif not turn["at"] or math.dist(face_m, turn["seen_m"]) < SEEN_M:
            return
        turn["seen_m"] = face_m.tolist()
        _write(self._mocap["head"], (self._head_m, self._gaze(data, infant)), data)

    def _contacts(self, geoms: np.ndarray, data: mujoco.MjData, infant: Infant | None = None) -> np.ndarray:
        """Return which contacts are of some geoms with an infant, or any, with the sign of their side: 1 is first."""
        first, second = data.contact.geom.T
        is_infants = self._is_infants_geom if infant is None else infant.is_its_geom
        signs = (geoms[first] & is_infants[second]).astype(int) - (geoms[second] & is_infants[first]).astype(int)
        return np.where(data.contact.dist < 0.0, signs, 0)

    def _would_push(self, side: Side, way_m: FloatArray, data: mujoco.MjData, held: dict[Side, int]) -> bool:
        """Return whether a hand, or what it carries, that moves some way would get deeper into an infant."""
        geoms = self._of_arm[side] | (self._model.geom_bodyid == held[side] if side in held else False)
        signs = self._contacts(geoms, data)
        deep = (signs != 0) & (data.contact.dist < -TOUCHING_M)
        return bool((deep & (signs * (data.contact.frame[:, :3] @ way_m) > 0)).any())


def _write(mocap: int, frame: Frame, data: mujoco.MjData) -> None:
    data.mocap_pos[mocap], data.mocap_quat[mocap] = frame[0], quaternion_from_matrix(frame[1])
