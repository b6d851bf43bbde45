"""Gaze that goes where the infant's own pictures, as late as they reach it, show something."""

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError, UnknownNameError
from mimoc.policies.behaviours import oculomotor as law
from mimoc.policies.behaviours.aiming import find_target
from mimoc.policies.behaviours.behaviour import Reaction, Subject, read_arguments
from mimoc.policies.behaviours.gaze import Gaze, Look, Pose, Seen
from mimoc.policies.behaviours.seen import CONTRAST, FACE, FEATURES, MOTION, Retina, contrast_of, face_of, motion_of
from mimoc.runtime.sense import FloatArray, Observation

SEEN_M = 0.5  # How far away things are taken to be that are only seen (a guess: no depth is made of two pictures).
WEIGHTS: Mapping[str, law.Table] = {
    CONTRAST: {0: 1.0},
    MOTION: {0: 2.0},
    FACE: {0: 0.3, 1: 0.15, 2: 0.4, 4: 0.8, 6: 1.2},
}
"""What features count for, by months: guesses. Newborns follow faces, which fades at one and is back at two months
(Johnson & Morton 1991); looks at faces become more until six (Belteki et al. 2025)."""
CHOOSINESS = 3.0  # Power of what stands out by which it is chosen: 0 is blindly, infinity always the most (a choice).
LEAST = 0.02  # What stands out less is not looked at (a choice).
LOOKED_AT_DEG, FORGOTTEN_S = 8.0, 1.5  # Inhibition of return: how far around, and how long (guesses).
MOTION_S = 0.1  # Time between the two pictures of which motion is made.
STILL_DEG = 0.5  # Largest turn of the eye between them.
EVERY_S = 0.05  # How often a seen target is looked for.
SMOOTHED_S = 0.25  # Time over which its speed is estimated (a choice: cells are coarse).
SLOW_M_S = 0.02  # Slower than this, at that distance, a seen target counts as still.
ELSEWHERE_DEG, ELSEWHERE_RATIO = 8.0, 1.3  # From how far away something counts as another, and how much clearer it is.


@dataclass(frozen=True, slots=True)
class Glance:
    """A picture, and how the eyes were when it was taken."""

    cells: FloatArray
    pose: Pose


class SeeingGaze(Gaze):
    """Gaze that knows of things only what the pictures of the first eye show."""

    def __init__(self, subject: Subject, name: str):
        """Bind it to an infant; raise a PolicyError if it cannot see."""
        self.name = name
        vision = subject.manifest.senses.vision
        if vision is None:
            raise PolicyError(f"'{name}' looks at what the infant sees, but it has no vision; add senses.vision")
        super().__init__(subject)
        camera = vision.cameras[0]
        model = subject.infant.model
        self._picture = subject.manifest.of_infant(camera)
        self._cameras = sorted(self._cameras, key=lambda index: model.camera(index).name != camera)
        self._eyes = tuple(sorted(self._eyes, key=lambda eye: self._cameras.index(eye.camera)))
        fovy_deg = float(model.cam_fovy[self._cameras[0]])
        self._retina = Retina(vision.width_px, vision.height_px, fovy_deg, vision.foveation, vision.foveation_radius)
        self._glances_kept = max(2, round(MOTION_S / self._step_s) + 1)

    def _reactions_of(self, is_told: bool) -> tuple[Reaction[int], Reaction[int]]:
        """Return the reactions to what is in pictures, whose delay is over when they are seen."""
        first, later = super()._reactions_of(is_told)
        return (
            Reaction(0.0, first.mean_s, first.variation),
            Reaction(0.0, later.mean_s, later.variation),
        )

    def begin(self, data: mujoco.MjData) -> None:
        """Begin without having seen anything; see `Behaviour`."""
        super().begin(data)
        self._glances = deque[Glance](maxlen=self._glances_kept)
        self._number = 0
        self._found: Seen | None = None

    def sense(self, observation: Observation, time_s: float, generator: np.random.Generator) -> None:
        """Look at a picture, which is from where the eyes pointed a delay ago; see `Behaviour`."""
        super().sense(observation, time_s, generator)
        index = 1 if len(self._poses) == self._poses.maxlen and len(self._poses) > 1 else 0
        self._glances.append(Glance(self._retina.cells(observation[self._picture]), self._poses[index]))

    def _feature(self, name: str) -> FloatArray:
        """Return how much each cell of the last picture stands out by a feature, shape (rows, columns)."""
        glance = self._glances[-1]
        if name == MOTION:
            if not self._has_motion():
                return np.zeros(self._retina.shape)
            return motion_of(glance.cells, self._glances[0].cells)
        return contrast_of(glance.cells) if name == CONTRAST else face_of(glance.cells)

    def _has_motion(self) -> bool:
        first, last = self._glances[0], self._glances[-1]
        if len(self._glances) < self._glances_kept or not all(glance.pose.is_steady for glance in self._glances):
            return False
        turn = np.trace(first.pose.axes[0].T @ last.pose.axes[0])
        return math.degrees(math.acos(min(1.0, max(-1.0, (turn - 1) / 2)))) < STILL_DEG

    def _place_m(self, standing_out: FloatArray, cell: tuple[int, int]) -> FloatArray:
        """Return where what is around a cell is taken to be, shape (3,)."""
        rows, columns = (slice(max(at - 1, 0), at + 2) for at in cell)
        weights = standing_out[rows, columns, None]
        direction = (weights * self._retina.directions[rows, columns]).sum(axis=(0, 1))
        direction /= max(float(np.linalg.norm(direction)), 1e-9)
        return self._glances[-1].pose.place_m(SEEN_M * direction[None])

    def _angles_deg(self, place_m: FloatArray) -> FloatArray:
        """Return how far the cells of the last picture are from a place, shape (rows, columns)."""
        pose = self._glances[-1].pose
        direction = pose.axes[0].T @ (place_m - pose.places_m[0])
        cosines = self._retina.directions @ (direction / max(float(np.linalg.norm(direction)), 1e-9))
        return np.degrees(np.arccos(cosines.clip(-1.0, 1.0)))


class LookAround(SeeingGaze):
    """Looks at one thing after another: at what stands out in its pictures, and was not looked at just before."""

    def __init__(self, subject: Subject):
        super().__init__(subject, "look_around")
        months = subject.manifest.child.corrected_age_months
        self._weights = {name: law.at_age(table, months) for name, table in WEIGHTS.items()}

    def begin(self, data: mujoco.MjData) -> None:
        """Begin with nothing looked at; see `Behaviour`."""
        super().begin(data)
        self._until_s: float | None = None
        self._looked_at = list[tuple[FloatArray, float]]()
        self._seen_s = 0.0

    def sense(self, observation: Observation, time_s: float, generator: np.random.Generator) -> None:
        """Choose what is looked at next, when a fixation is over; see `Behaviour`."""
        super().sense(observation, time_s, generator)
        self._seen_s = time_s
        if self._until_s is None:  # It has to see the first picture before it can choose.
            self._until_s = time_s + self._foreseen_s + self._reactions[0].draw_s(generator)
        if time_s < self._until_s or self._next.size_rad or not self._glances[-1].pose.is_steady:
            return
        self._until_s = time_s + self._law.fixation_of(generator.standard_normal())
        standing_out = self._standing_out(time_s)
        if standing_out.max() < LEAST:
            return
        chances = np.maximum(standing_out.ravel(), 0.0) ** CHOOSINESS  # Filters round below 0.
        row, column = divmod(int(generator.choice(chances.size, p=chances / chances.sum())), standing_out.shape[1])
        place_m = self._place_m(standing_out, (row, column))
        self._number += 1
        self._found = Seen(self._number, place_m, np.zeros(3))
        self._looked_at = [(place, at_s) for place, at_s in self._looked_at if time_s - at_s < 4 * FORGOTTEN_S]
        self._looked_at.append((place_m, time_s))

    def metrics(self) -> Mapping[str, float]:
        """Return how often it looks at something else; see `Behaviour`."""
        return {"fixations_per_min": 60.0 * self._number / max(self._seen_s, self._step_s)}

    def _perceived(self, seen: Seen | None, time_s: float) -> Seen | None:
        return self._found

    def _standing_out(self, time_s: float) -> FloatArray:
        """Return how much each cell attracts the gaze, shape (rows, columns)."""
        total = sum((weight * self._feature(name) for name, weight in self._weights.items()), np.zeros(1))
        total = total * self._retina.is_shown
        for place_m, at_s in self._looked_at:
            around = np.exp(-((self._angles_deg(place_m) / LOOKED_AT_DEG) ** 2) / 2)
            total = total * (1.0 - around * math.exp(-(time_s - at_s) / FORGOTTEN_S))
        return total


class LookAtSeen(SeeingGaze):
    """Looks at what moves, at what stands out by contrast, or at what looks like a face, in its pictures."""

    def __init__(self, subject: Subject, feature: str):
        super().__init__(subject, "look_at")
        self._looked_for = feature

    def begin(self, data: mujoco.MjData) -> None:
        """Begin with nothing found; see `Behaviour`."""
        super().begin(data)
        self._candidate: Seen | None = None
        self._next_s = -math.inf

    def sense(self, observation: Observation, time_s: float, generator: np.random.Generator) -> None:
        """Look for the feature; see `Behaviour`."""
        super().sense(observation, time_s, generator)
        if time_s < self._next_s or not self._glances[-1].pose.is_steady:
            return
        self._next_s = time_s + EVERY_S - self._step_s / 2
        standing_out = self._feature(self._looked_for) * self._retina.is_shown
        row, column = divmod(int(standing_out.argmax()), standing_out.shape[1])
        if standing_out[row, column] < LEAST:
            return
        before = self._candidate
        if before is not None:
            near = np.where(self._angles_deg(before.place_m) < ELSEWHERE_DEG, standing_out, 0.0)
            if near.max() * ELSEWHERE_RATIO >= standing_out[row, column]:
                row, column = divmod(int(near.argmax()), near.shape[1])
                place_m = self._place_m(standing_out, (row, column))
                self._candidate = before.after(place_m, EVERY_S, SMOOTHED_S)
                return
        self._number += 1
        self._reactions[before is not None].see(self._number, time_s, generator)
        self._candidate = Seen(self._number, self._place_m(standing_out, (row, column)), np.zeros(3))

    def metrics(self) -> Mapping[str, float]:
        """Return how often it looks at something else; see `Behaviour`."""
        return {"fixations_per_min": 60.0 * self._number / max(self._at_s, self._step_s)}

    def _perceived(self, seen: Seen | None, time_s: float) -> Seen | None:
        """Return what was found, as far as it was reacted to."""
        candidate = self._candidate
        if candidate is None or self._known(time_s) != candidate.number:
            return seen
        speed = float(np.linalg.norm(candidate.velocity_m_s))
        return candidate if speed > SLOW_M_S else Seen(candidate.number, candidate.place_m, np.zeros(3))


def bind_look(subject: Subject, text: str) -> Gaze:
    """Return the behaviour that looks at what a text names: a target, or a feature of what the infant sees.

    A thing of the scene that is called as a feature (`face`) goes first; see `find_target`.
    """
    names = read_arguments("look_at", text, {}, most_words=1).words
    if not names:
        raise PolicyError("'look_at' needs one target: write look_at:toy, look_at:0.3,0,0.2 or look_at:motion")
    try:
        target = find_target(subject, "look_at", names[0])
    except UnknownNameError:
        if names[0] not in FEATURES:
            raise
        return LookAtSeen(subject, names[0])
    return Look(subject, target, is_told=subject.reads_truth)


def bind_look_around(subject: Subject, text: str = "") -> LookAround:
    """Return the behaviour that looks around."""
    read_arguments("look_around", text, {})
    return LookAround(subject)
