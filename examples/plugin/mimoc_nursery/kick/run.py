"""Kicking: the reward is the speed of the mobile, as in conjugate reinforcement (Rovee & Rovee 1969)."""

from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.runtime.task import Task, Verdict
from mimoc_nursery.kick.spec import KickEntry


class Kick(Task):
    """A mobile on a spring, pulled by a ribbon that is just taut when an episode starts.

    Spring and ribbon are forces that are set once for each control step.
    """

    def __init__(self, entry: KickEntry, model: mujoco.MjModel, step_s: float):
        """Find foot and mobile in *model*."""
        super().__init__(entry.steps)
        self._entry, self._step_s = entry, step_s
        self._foot, self._mobile = model.body(entry.foot).id, model.body(entry.mobile).id
        self._velocity = model.body(entry.mobile).dofadr[0] + np.arange(3)
        self._mass_kg = float(model.body_mass[self._mobile])
        self._weight_n = -self._mass_kg * model.opt.gravity
        self._home_m, self._ribbon_m, self._path_m = np.zeros(3), 0.0, 0.0

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Hang the mobile where it is, and tie the ribbon."""
        self._home_m = data.xpos[self._mobile].copy()
        self._ribbon_m = float(np.linalg.norm(data.xpos[self._foot] - self._home_m))
        self._path_m = 0.0
        self._pull(data)

    def judge(self, data: mujoco.MjData, action: np.ndarray, effort: Callable[[], float]) -> Verdict:
        """Return the mobile's speed as the reward, and set the forces of the next control step."""
        speed_m_s = float(np.linalg.norm(data.qvel[self._velocity]))
        self._path_m += speed_m_s * self._step_s
        self._pull(data)
        return Verdict({"mobile": speed_m_s}, success=self._path_m >= self._entry.success_m)

    @property
    def state(self) -> dict[str, Any]:
        """Where the mobile hangs, how long the ribbon is, and how far the mobile has moved."""
        return {"home_m": self._home_m, "ribbon_m": self._ribbon_m, "path_m": self._path_m}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        self._home_m, self._ribbon_m, self._path_m = state["home_m"], state["ribbon_m"], state["path_m"]

    def _pull(self, data: mujoco.MjData) -> None:
        entry, place_m = self._entry, data.xpos[self._mobile]
        rate = 2 * np.pi * entry.frequency_hz
        spring_n = self._mass_kg * rate**2 * (self._home_m - place_m)
        damper_n = -2 * entry.damping_ratio * self._mass_kg * rate * data.qvel[self._velocity]
        along_m = data.xpos[self._foot] - place_m
        length_m = float(np.linalg.norm(along_m))
        ribbon_n = entry.ribbon_n_per_m * max(length_m - self._ribbon_m, 0.0) * along_m / max(length_m, 1e-9)
        data.xfrc_applied[self._mobile, :3] = self._weight_n + spring_n + damper_n + ribbon_n
        data.xfrc_applied[self._foot, :3] = -ribbon_n


def bind(entry: KickEntry, model: mujoco.MjModel, bundle: Bundle) -> Kick:
    """Find what *entry* names in *model*."""
    return Kick(entry, model, ms_to_s(bundle.manifest.step_ms))
