"""Arousal on a device: how much of its muscle tone the infant in each world has."""

from collections.abc import Sequence

import mujoco_warp as mjw
import torch
import warp as wp

from mimoc.runtime.arousal import FIELDS, MOST, ToneInModels, tone_of
from mimoc.runtime.device.arrays import put
from mimoc.runtime.env import InfantEnv


class DeviceArousal:
    """The arousal of all infants; as built, until it is set."""

    def __init__(self, infants: Sequence[InfantEnv], body: torch.Tensor, model: mjw.Model):
        tones = [tone_of(infant.manifest.actuation, infant.model) for infant in infants]
        fields = [wp.to_torch(getattr(model, name)) for name in FIELDS]
        which = body.tolist()
        self._tone = ToneInModels([tones[index] for index in which], fields, infants[0].model.jnt_qposadr, put)
        self.as_built = put([float(infants[index].manifest.actuation.arousal) for index in which])
        self.level = self.as_built.clone()
        """Arousal in each world now, shape (worlds,)."""
        self._is_set = False

    def set(self, level: torch.Tensor) -> None:
        """Change the arousal of all worlds, shape (worlds,); what is beyond 0 and 2 is clipped."""
        self.level, self._is_set = level.clamp(0, MOST), True
        self._tone.write(self.level - self.as_built)

    def begin(self, begins: torch.Tensor) -> None:
        """Let infants that begin an episode have the arousal that they are built for; a mask of shape (worlds,)."""
        if self._is_set:
            self.set(torch.where(begins, self.as_built, self.level))
