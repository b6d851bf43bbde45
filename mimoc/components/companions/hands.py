"""What the hands of a caregiver do: rest, bring an object within the infant's reach, hold or carry a part of it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.base.geometry.adult import SIDES, Palm, Side
from mimoc.base.geometry.reach import UP
from mimoc.base.geometry.rotations import FloatArray
from mimoc.components.companions.body import CaregiverBody, HandPath, Infant

ABOVE_M = 0.025  # Distance from the top of an object to the middle of the palm that holds it.
WITHIN_REACH_M = 0.06  # Distance from the infant's hand to the surface of an object that is offered; an assumption.
WAITING_S = 0.2  # How long a hand waits that touches the infant before it counts as arrived; an assumption.
AROUND_M = 0.12  # How far beside or above its end the last part of a movement begins; an assumption.
OVER_M = 0.6  # Height of the control point of a movement over the infant, above its ends; an assumption.
TRIES = 3  # How often a hand tries to get over the infant.
TAKING_OVER_S = 0.3  # Time in which a hand takes over its share of the infant's weight; an assumption.


@dataclass(frozen=True, slots=True)
class Offered:
    """An object that can be offered."""

    body: int
    radius_m: float  # Radius of a sphere around its centre that encloses it.


class Hands:
    """What each hand does: its task.

    An order gives a hand a new task, whatever it did before; it goes on to the next task by itself::

        offer ----> fetch --arrived--> carry --arrived--> give
                      |
                      +--blocked more than TRIES times--> give up

        hold -----> approach --arrived--> held, by one hand; or support, by both, each with half of the share

        release --> rest

    A hand that the infant has blocked for WAITING_S in the second half of its movement counts as arrived. On the way to
    an object, in either half, it tries to get over the infant instead. A hand that gives up rests until the next order.

    A hand that holds a part of the infant is welded to it, softly; two hands that carry a share s of its weight W push
    the part upwards with s W, and follow it.
    """

    def __init__(self, body: CaregiverBody, infants: Mapping[str, Infant], objects: Mapping[str, Offered]):
        self._body = body
        self._infants = infants
        self._objects = objects
        self.reset()

    def reset(self) -> None:
        """Begin an episode with resting hands."""
        self._tasks: dict[Side, dict[str, Any]] = {side: {"does": "rest"} for side in SIDES}
        self._pushed: tuple[int, float] | None = None

    def offer(self, name: str, infant: str, data: mujoco.MjData) -> None:
        """Bring an object within reach of an infant's nearest hand."""
        item = self._objects[name]
        place_m = data.xpos[item.body]
        side = self._nearest_hand(place_m)
        self._free(side, data)
        self._tasks[side] = {"does": "fetch", "object": name, "infant": infant, "waits": 0, "tries": 0}
        palm = Palm(place_m + (item.radius_m + ABOVE_M) * UP, -UP)
        self._body.move(side, palm, palm.place_m + AROUND_M * UP)

    def hold(self, body: int, infant: str, weight_share: float | None, data: mujoco.MjData) -> None:
        """Hold a part of an infant: with the nearest hand, or carry a share of its weight with both."""
        middle_m = data.xipos[body].copy()
        carries = weight_share is not None
        for side in SIDES if carries else (self._nearest_hand(middle_m),):
            self._free(side, data)
            self._tasks[side] = {"does": "approach", "part": body, "infant": infant, "share": weight_share, "waits": 0}
            outward = self._body.outward(side) + (0.3 if carries else 0.7) * UP
            outward = outward / np.linalg.norm(outward)
            self._body.move(side, Palm(middle_m, -outward), middle_m + 2 * AROUND_M * outward)

    def release(self, data: mujoco.MjData) -> None:
        """Let go of all, and rest."""
        for side in SIDES:
            if self._tasks[side]["does"] != "rest":
                self._free(side, data)
                self._tasks[side] = {"does": "rest"}
                palm = self._body.resting[side]
                self._body.move(side, palm, (self._body.palms[side].place_m + palm.place_m) / 2 + AROUND_M * UP)

    @property
    def carried(self) -> dict[Side, int]:
        """The object that each hand carries, if any."""
        carrying: list[Side] = [side for side, task in self._tasks.items() if task["does"] in ("carry", "give")]
        return {side: self._objects[self._tasks[side]["object"]].body for side in carrying}

    def advance(self, data: mujoco.MjData) -> None:
        """Go on to what comes next, and carry the infant, before a physics step."""
        for side, task in self._tasks.items():
            if task["does"] in ("fetch", "carry", "approach") and self._has_arrived(side, task, data):
                self._go_on(side, task, data)
            elif task["does"] == "support":
                place_m = data.xpos[task["part"]] + np.array(task["beside_m"])
                self._body.follow(side, place_m, data)
        self._carry(data)

    def _nearest_hand(self, place_m: FloatArray) -> Side:
        return min(SIDES, key=lambda side: float(np.linalg.norm(self._body.shoulder_m(side) - place_m)))

    def _has_arrived(self, side: Side, task: dict[str, Any], data: mujoco.MjData) -> bool:
        path = self._body.paths[side]
        is_past_half = path is None or path.done > 0.5 * path.steps
        is_waiting = (is_past_half or task["does"] == "fetch") and self._body.is_blocked(side, data)
        task["waits"] = task["waits"] + 1 if is_waiting else 0
        has_waited = task["waits"] * self._body.timestep_s >= WAITING_S
        if has_waited and path and task["does"] == "fetch":
            self._go_over(side, task, path, data)
            return False
        return path is None or path.is_done or has_waited

    def _go_over(self, side: Side, task: dict[str, Any], path: HandPath, data: mujoco.MjData) -> None:
        """Move to the same end over the infant, which is in between; give up after a few times."""
        task |= {"waits": 0, "tries": task["tries"] + 1}
        if task["tries"] > TRIES:
            self._tasks[side] = {"does": "give up"}
            self._body.move(side, self._body.resting[side], self._body.palms[side].place_m + OVER_M * UP)
            return
        middle_m = (path.end_m + self._body.palms[side].place_m) / 2
        self._body.move(side, Palm(path.end_m, path.end_normal), middle_m + OVER_M * UP)

    def _go_on(self, side: Side, task: dict[str, Any], data: mujoco.MjData) -> None:
        self._body.paths[side] = None
        if task["does"] == "fetch":
            item = self._objects[task["object"]]
            self._body.grip(side, item.body, data)
            task |= {"does": "carry", "waits": 0}
            palm = self._offering(item, self._infants[task["infant"]], data)
            self._body.move(side, palm, (self._body.palms[side].place_m + palm.place_m) / 2 + AROUND_M * UP)
        elif task["does"] == "carry":
            task["does"] = "give"
        elif task["share"] is None:
            self._body.grip(side, task["part"], data)
            task["does"] = "held"
        else:
            beside_m = self._body.palms[side].place_m - data.xpos[task["part"]]
            task |= {"does": "support", "beside_m": beside_m.tolist(), "since": data.time}

    def _offering(self, item: Offered, infant: Infant, data: mujoco.MjData) -> Palm:
        """Return where a palm holds an object within reach of the infant's nearest hand."""
        places_m = [data.xpos[hand] for hand in infant.hands] or [infant.face_m(data)]
        nearest_m = min(places_m, key=lambda place_m: float(np.linalg.norm(place_m - data.xpos[item.body])))
        to_face = self._body.face_m(data) - nearest_m
        to_face = to_face / np.linalg.norm(to_face)
        return Palm(nearest_m + (WITHIN_REACH_M + item.radius_m) * to_face + (item.radius_m + ABOVE_M) * UP, -UP)

    def _free(self, side: Side, data: mujoco.MjData) -> None:
        self._body.let_go(side, data)
        self._body.paths[side] = None

    def _carry(self, data: mujoco.MjData) -> None:
        """Push the part that both hands carry upwards by the share of the infant's weight; take back the last push."""
        carrying = [task for task in self._tasks.values() if task["does"] == "support"]
        if self._pushed:
            body, newtons = self._pushed
            data.xfrc_applied[body, 2] -= newtons
            self._pushed = None
        if carrying:
            newtons = 0.0
            for task in carrying:
                ramp = min((data.time - task["since"]) / TAKING_OVER_S, 1.0)
                newtons += ramp * task["share"] * self._infants[task["infant"]].weight_n / len(SIDES)
            self._pushed = carrying[0]["part"], newtons
            data.xfrc_applied[carrying[0]["part"], 2] += newtons

    @property
    def state(self) -> dict[str, Any]:
        """What each hand does, and what is pushed."""
        return {"tasks": self._tasks, "pushed": self._pushed}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        self._tasks = state["tasks"]
        self._pushed = state["pushed"] and (state["pushed"][0], state["pushed"][1])
