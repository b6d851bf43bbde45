"""Touch the plain way, contact by contact over all points of the skin: what `senses.touch.run` must equal."""

from dataclasses import dataclass

import mujoco
import numpy as np


@dataclass(frozen=True)
class TouchLoop:
    """The force on each point of a skin, shape (n * 3,), or (n,) if that is the normal force."""

    model: mujoco.MjModel
    bodies: np.ndarray  # Shape (n,).
    points_m: np.ndarray  # Shape (n, 3), in the frames of the bodies.
    spacing_m: dict[int, float]
    quantity: str
    response: str

    def __call__(self, data: mujoco.MjData) -> np.ndarray:
        forces = np.zeros((len(self.bodies), 1 if self.quantity == "normal" else 3))
        for index in range(data.ncon):
            contact, wrench = data.contact[index], np.zeros(6)
            mujoco.mj_contactForce(self.model, data, index, wrench)
            frame = contact.frame.reshape(3, 3)
            for side, sign in enumerate((-1, 1)):
                body = self.model.geom_bodyid[contact.geom[side]]
                if body in self.spacing_m:
                    place = contact.pos + sign * frame[0] * contact.dist / 2
                    push = wrench[0] if self.quantity == "normal" else sign * frame.T @ wrench[:3]
                    self._push(forces, data, body, place, push)
        return forces.ravel()

    def _push(self, forces, data, body, place, push):
        world_from_body = data.xmat[body].reshape(3, 3)
        if self.quantity == "force_vector":
            push = world_from_body.T @ push
        away_m = self.points_m - world_from_body.T @ (place - data.xpos[body])
        distances_m = np.where(self.bodies == body, np.sqrt(np.sum(away_m**2, axis=1)), np.inf)
        weights = np.maximum(1 - distances_m / (2 * self.spacing_m[body]), 0)
        if self.response == "nearest" or not weights.any():
            weights = np.arange(len(self.bodies)) == np.argmin(distances_m)
        forces += np.outer(weights / weights.sum(), push)


def touch_loop(entry, bundle, model) -> TouchLoop:
    ids = [model.body(part.body).id for part in entry.skin]
    assert ids == sorted(ids)
    return TouchLoop(
        model=model,
        bodies=np.repeat(ids, [part.points for part in entry.skin]),
        points_m=bundle.arrays["touch/points_m"],
        spacing_m={body: part.spacing_m for body, part in zip(ids, entry.skin, strict=True)},
        quantity=entry.quantity,
        response=entry.response,
    )


def points(sample):
    return sample.reshape(-1, 3)


def contact_forces(data):
    """Return what MuJoCo says of contacts: of each the two bodies and the force on the second, in the world."""
    for index in range(data.ncon):
        wrench = np.zeros(6)
        mujoco.mj_contactForce(data.model, data, index, wrench)
        contact = data.contact[index]
        yield data.model.geom_bodyid[contact.geom], contact.frame.reshape(3, 3).T @ wrench[:3]
