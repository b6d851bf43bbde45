"""Everything that can be done with one kind of environments can be done with all, or refused in one line."""

from pathlib import Path

import pytest
from contracts.capabilities import PAGE, PARTS, Capability, all_capabilities, names_of, page_with, table
from contracts.kinds import KINDS, MANY, ON_DEVICE, ONE, WORLD, WORLDS, Kind

import mimoc
from mimoc.runtime.batch_env import BatchEnv
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.world_env import WorldEnv

QUICK = [capability for capability in all_capabilities() if not capability.extras]
EXTRAS = [capability for capability in all_capabilities() if capability.extras]


def assert_done_or_refused(capability: Capability, kind: Kind, folder: Path) -> None:
    if capability.has(kind):
        capability.fact(kind, folder)
        return
    with pytest.raises((mimoc.MimocError, TypeError)) as refusal:
        capability.fact(kind, folder)
    assert capability.refusals[kind.name] in str(refusal.value)
    assert "\n" not in str(refusal.value)


def each(capabilities: list[Capability]) -> pytest.MarkDecorator:
    slow = [pytest.mark.slow, pytest.mark.full]
    cases = [
        pytest.param(capability, id=capability.fact.__name__, marks=slow if capability.is_slow else [])
        for capability in capabilities
    ]
    return pytest.mark.parametrize("capability", cases)


@each(QUICK)
def test_one_infant(capability, tmp_path):
    assert_done_or_refused(capability, ONE, tmp_path)


@each(QUICK)
def test_infants_that_share_a_world(capability, tmp_path):
    assert_done_or_refused(capability, WORLD, tmp_path)


@each(QUICK)
def test_many_infants(capability, tmp_path):
    assert_done_or_refused(capability, MANY, tmp_path)


@each(QUICK)
def test_infants_of_many_worlds(capability, tmp_path):
    assert_done_or_refused(capability, WORLDS, tmp_path)


@pytest.mark.extras
@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
@each(EXTRAS)
def test_infants_learn(capability, kind, tmp_path):
    assert_done_or_refused(capability, kind, tmp_path)


@pytest.mark.extras
@pytest.mark.slow
@each(all_capabilities())
def test_many_infants_on_a_device(capability, tmp_path, kernels_compiled_quickly):
    assert_done_or_refused(capability, ON_DEVICE, tmp_path)


def public_names(environment: type) -> set[str]:
    own = [cls for cls in environment.__mro__ if cls.__module__.startswith("mimoc")]
    return {name for cls in own for name in vars(cls) if not name.startswith("_")}


@pytest.mark.parametrize(("kind", "environment"), [(ONE, InfantEnv), (WORLD, WorldEnv), (MANY, BatchEnv)])
def test_no_method_is_forgotten(kind, environment):
    parts = {name for names in PARTS for name in names.split()}
    assert public_names(environment) - parts - names_of(kind) == set()


@pytest.mark.extras
def test_no_method_on_a_device_is_forgotten():
    from mimoc.runtime.device.vector_env import DeviceEnv

    parts = {name for names in PARTS for name in names.split()}
    assert public_names(DeviceEnv) - parts - names_of(ON_DEVICE) == set()


def test_the_page_has_the_table():
    """Renew it with `PYTHONPATH=tests python -m contracts.capabilities`."""
    assert PAGE.read_text(encoding="utf-8") == page_with(table())
