"""Infants that sit with their trunk held, as in the arms of somebody who is not there."""

import dataclasses
from collections.abc import Callable
from types import MappingProxyType
from typing import Any

import mujoco
import pytest

import mimoc
from mimoc.bundle.model import load_model

SPINE = tuple(f"robot:hip_{way}{part}" for way in ("lean", "rot", "bend") for part in (1, 2))


def held(bundle: mimoc.Bundle) -> mimoc.Bundle:
    """Return an infant whose hip is welded to the world as it sits, and whose spine is locked."""
    model = load_model(bundle)
    sitting = model.key("sitting").qpos
    place = " ".join(map(repr, sitting[:7].tolist()))
    locks = "".join(
        f'<joint name="lock {name}" joint1="{name}" polycoef="{sitting[model.joint(name).qposadr[0]]} 0 0 0 0"/>'
        for name in SPINE
    )
    equality = f'<equality><weld name="held" body1="world" body2="hip" relpose="{place}"/>{locks}</equality>'
    scene = bundle.files["scene.xml"].decode().replace("<keyframe>", f"{equality}<keyframe>")
    return dataclasses.replace(bundle, files=MappingProxyType({**bundle.files, "scene.xml": scene.encode()}))


@pytest.fixture(scope="session")
def held_infant(built) -> Callable[..., mimoc.InfantEnv]:
    """Return what gives the environment of a held infant, which all tests share; reset it first."""
    found: dict[tuple[Any, ...], mimoc.InfantEnv] = {}

    def give(
        age_months: float = 18, hands: str = "mitten", model: str = "torque", development: str = "maturing"
    ) -> mimoc.InfantEnv:
        key = age_months, hands, model, development
        if key not in found:
            keys = {"body": {"hands": hands}, "actuation": {"model": model}, "development": development}
            bundle = built(age_months=age_months, scene={"kind": "flat", "pose": "sitting"}, **keys)
            found[key] = mimoc.InfantEnv(held(bundle))
        return found[key]

    return give


@pytest.fixture
def floating(open_env) -> mimoc.InfantEnv:
    """Return an infant of 18 months without gravity, and without anything that touches, rubs, limits or couples.

    Its motors act at once (`published`), so that what they are commanded is what happens.
    """
    env = open_env(age_months=18, development="published", scene={"kind": "empty"})
    env.reset(seed=0)
    env.model.opt.gravity[:] = 0.0
    env.model.dof_frictionloss[:] = 0.0
    env.model.jnt_limited[:] = 0
    env.model.tendon_limited[:] = 0
    env.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    return env
