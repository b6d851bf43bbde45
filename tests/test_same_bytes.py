"""The same spec gives the same bytes whatever the processor and the locale are; `make matrix` tries many more."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st
from support import store
from support.full import full_but

from mimoc.base.random_streams import between, pick, shuffled, stream, whole_between

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


SEEDS = st.integers(0, 2**53)
RECORDED = [0.112136260583, 0.996863055949, 0.205098491323]  # Three numbers of seed 7.


@given(SEEDS, st.text(max_size=20))
def test_the_same_seed_and_aspect_give_the_same_numbers(seed, aspect):
    assert np.array_equal(stream(seed, aspect).random(5), stream(seed, aspect).random(5))


def test_a_new_process_draws_the_same_numbers():
    code = "from mimoc.base.random_streams import stream; print(stream(7, 'room.size').random(3).tolist())"
    command, told = [sys.executable, "-c", code], {"capture_output": True, "text": True, "check": True}
    runs = [
        subprocess.run(command, env={**os.environ, "PYTHONHASHSEED": seed}, **told).stdout for seed in ("1", "4242")
    ]
    assert runs[0] == runs[1] == f"{stream(7, 'room.size').random(3).tolist()}\n"


def test_the_numbers_are_those_of_every_release():
    """Else a scene would change under its users; NumPy promises these bits."""
    assert [round(number, 12) for number in stream(7, "room.size").random(3)] == RECORDED


def test_no_two_seeds_or_aspects_share_a_stream():
    firsts = {stream(seed, aspect).random() for seed in range(500) for aspect in ("room.size", "room.floor", "toys")}
    assert len(firsts) == 1500


def test_streams_of_neighbouring_seeds_are_not_alike():
    numbers = np.array([[stream(seed, aspect).random() for aspect in ("a", "b")] for seed in range(2000)])
    assert abs(np.corrcoef(numbers.T)[0, 1]) < 0.07
    assert abs(np.corrcoef(numbers[1:, 0], numbers[:-1, 0])[0, 1]) < 0.07


@given(SEEDS, st.floats(-10, 10), st.floats(0, 10))
def test_between_stays_between(seed, low, width):
    assert low <= between(stream(seed, "x"), low, low + width) <= low + width


def test_every_whole_number_is_alike_likely():
    generator = stream(0, "x")
    counts = np.bincount([whole_between(generator, 2, 5) for _ in range(4000)])
    assert list(counts[:2]) == [0, 0]
    assert counts[2:].min() > 900


def test_picking_finds_every_item():
    generator = stream(1, "x")
    assert {pick(generator, "abc") for _ in range(100)} == set("abc")


@given(SEEDS, st.lists(st.integers(), max_size=8))
def test_shuffling_keeps_every_item(seed, items):
    assert sorted(shuffled(stream(seed, "x"), items)) == sorted(items)
