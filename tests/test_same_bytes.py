"""The same spec gives the same bytes whatever the processor and the locale are; `make matrix` tries many more."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from support import store
from support.full import full_but

CONFIGS = Path(__file__).parents[1] / "configs"
NAMES = ("individual", "reach")
PUBLISHED = "mimoc: 1\nname: x\nage_months: 3.3\ndevelopment: published\nbody: {hands: five_finger}\n"
BUILD = """
import json, locale, sys, mimoc
try:
    locale.setlocale(locale.LC_ALL, "")
except locale.Error:
    pass  # This machine has no such locale.
print(json.dumps([mimoc.build(path).files["lock.json"].decode() for path in sys.argv[1:]]))
"""
MACHINES = {  # Names of kernels of OpenBLAS; where NumPy has another library, they change nothing.
    "an old processor": {"OPENBLAS_CORETYPE": "Prescott", "LC_ALL": "C"},
    "a newer one, in Turkey": {"OPENBLAS_CORETYPE": "Haswell", "LC_ALL": "tr_TR.UTF-8"},
}


@pytest.mark.full
@pytest.mark.matrix
@pytest.mark.parametrize("machine", full_but(list(MACHINES)[:1], MACHINES))
def test_bundles_are_the_same_to_the_byte_on(machine, tmp_path):
    published = tmp_path / "published.yaml"
    published.write_text(PUBLISHED, encoding="utf-8")
    paths = [*(CONFIGS / f"{name}.yaml" for name in NAMES), published]
    command = [sys.executable, "-W", "ignore", "-c", BUILD, *map(str, paths)]
    environment = {**os.environ, **MACHINES[machine]}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) == [store.built(path).files["lock.json"].decode() for path in paths]
