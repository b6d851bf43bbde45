"""Where an infant's keypoints are."""

from collections.abc import Sequence

import mujoco
import numpy as np
import numpy.typing as npt


class Keypoints:
    """The keypoints of an infant, in the order in which the manifest has them."""

    def __init__(self, names: Sequence[str], model: mujoco.MjModel):
        """Find the sites of these names; those of missing limbs are not there."""
        self._sites = np.array([mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name) for name in names], int)

    def __call__(self, data: mujoco.MjData) -> npt.NDArray[np.float64]:
        """Return their places in the world frame, shape (n, 3), [m]; those of missing limbs are NaN."""
        places = np.full((len(self._sites), 3), np.nan)
        present = self._sites >= 0
        places[present] = data.site_xpos[self._sites[present]]
        return places
