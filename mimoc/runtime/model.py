"""From a bundle to a compiled MuJoCo model."""

import warnings

import mujoco

from mimoc.bundle import Bundle
from mimoc.errors import ModelError

FAULTY_SPARSE_SOLVER = "4.0.0"
"""MuJoCo release whose Newton solver is wrong in rare states when the Jacobian is sparse (design.md, section 6)."""


def load_model(bundle: Bundle) -> mujoco.MjModel:
    """Return the compiled scene of a bundle.

    Raises:
        ModelError: If MuJoCo refuses it.
    """
    try:
        model = mujoco.MjModel.from_xml_string(bundle.files[bundle.manifest.scene].decode(), assets=dict(bundle.files))
    except ValueError as error:
        raise ModelError(f"MuJoCo {mujoco.__version__} refuses the bundle: {' '.join(str(error).split())}") from None
    if mujoco.__version__ == FAULTY_SPARSE_SOLVER:
        warnings.warn(
            f"MuJoCo {FAULTY_SPARSE_SOLVER} solves sparse contact problems wrongly now and then; mimoc uses its slower "
            "dense solver instead. Any other release from 3.5 on is right: pip install 'mujoco!=4.0.0'",
            stacklevel=2,
        )
        model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    return model


def simulation_warnings(data: mujoco.MjData) -> tuple[str, ...]:
    """Return the kinds of warning that MuJoCo has raised in a simulation."""
    return tuple(
        mujoco.mjtWarning(kind).name.removeprefix("mjWARN_")
        for kind in range(mujoco.mjtWarning.mjNWARNING)
        if data.warning[kind].number
    )
