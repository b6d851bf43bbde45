"""The state of a simulation as one array: all that MuJoCo's next steps depend on."""

import mujoco
import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

STATE = mujoco.mjtState.mjSTATE_INTEGRATION
"""What of a simulation it contains."""


def physics_of(model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
    """Return the state of a simulation, shape (n,)."""
    physics = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, physics, STATE)
    return physics


def time_of(physics: FloatArray) -> float:
    """Return the time of a state [s], which MuJoCo writes first."""
    return float(physics[0])


def check_physics(physics: FloatArray, model: mujoco.MjModel) -> None:
    """Check that a state has the size of those of a model; raise a ValueError if it has not."""
    if np.shape(physics) != (mujoco.mj_stateSize(model, STATE),):
        raise ValueError("state does not fit this infant: the size of its model's state is different")


def set_physics(model: mujoco.MjModel, data: mujoco.MjData, physics: FloatArray) -> None:
    """Restore a state, with all that is derived from it."""
    mujoco.mj_resetData(model, data)
    mujoco.mj_setState(model, data, physics, STATE)
    mujoco.mj_forward(model, data)
    mujoco.mj_setState(model, data, physics, STATE)  # The solver's warm start, as it was.
