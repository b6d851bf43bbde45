"""A few tries of each fuzzer, of which `.ci/task fuzz` makes thousands; a little of `.ci/task soak`."""

import os
from collections.abc import Iterator
from multiprocessing import get_context

import numpy as np
import pytest
from fuzz import meshes, pictures
from fuzz.fuzzing import FUZZERS, Canaries, fuzzer, is_clear, run_try
from fuzz.honest_specs import Case, cases, sections, use_drawn
from fuzz.honest_uses import DEAR
from fuzz.soak import growth, looked_at, scenes, steps
from fuzz.strange_infants import CANARIES
from support.full import FULL, full_but
from support.mesh_kinds import glb_of

from mimoc.base.errors import TextureError, ToyError
from mimoc.compiler.looks.wallpaper import read_textures
from mimoc.components.toys.toys4k.build import load_toy
from mimoc.components.toys.toys4k.dataset import find_toys

SEED = 2026
LATER = {
    **dict.fromkeys(("honest_cohorts", "honest_specs"), FULL),
    **dict.fromkeys(("policies", "cohorts", "trainings"), pytest.mark.extras),
}
"""What takes long, and what trains."""


@pytest.mark.parametrize("name", [pytest.param(name, marks=LATER.get(name, ())) for name in FUZZERS])
@pytest.mark.filterwarnings("ignore:the task of .* does not limit its episodes")
def test_nothing_that_strangers_change_breaks_mimoc(name, tmp_path):
    """It is used, or refused in clear lines, and no file outside of it is opened."""
    made, watch = fuzzer(name), Canaries(tmp_path / "outside", CANARIES)
    (tmp_path / "prepared").mkdir()
    prepared = made.prepare(tmp_path / "prepared")
    outcomes = []
    for number in range(made.short):
        (tmp_path / f"{number}").mkdir()
        outcomes.append(run_try(made, prepared, SEED, number, tmp_path / f"{number}", watch))
    watch.close()
    assert [outcome for outcome in outcomes if outcome.is_fault] == []
    assert {outcome.result for outcome in outcomes} >= ({"used"} if made.honest else {"used", "refused"})


@pytest.mark.full
@pytest.mark.parametrize("part", full_but([steps], [scenes]))
def test_memory_and_file_handles_stay_flat(part):
    first, *_, last = looked_at(part(3), 3)
    assert last.rounds == 3
    assert growth(first, last) == ""


def leaking(rounds: int, mb: int, handles: int) -> Iterator[None]:
    """Keep memory and file handles in every round, and let go of them at the end."""
    kept, opened = [], []
    for _ in range(rounds):
        kept.append(np.ones(mb * 2**17))
        opened += [os.open(os.devnull, os.O_RDONLY) for _ in range(handles)]
        yield
    for handle in opened:
        os.close(handle)


def growth_while_leaking(mb: int, handles: int) -> str:
    first, last = looked_at(leaking(2, mb, handles), 2)
    return growth(first, last)


@pytest.mark.full
@pytest.mark.parametrize(("mb", "handles"), [(64, 0), (0, 1), (64, 1)])
def test_what_leaks_is_found_and_named(mb, handles):
    """Twice as much as may grow in memory, or one handle, is enough in a process that frees nothing else meanwhile."""
    with get_context("spawn").Pool(1) as pool:
        found = pool.apply(growth_while_leaking, (mb, handles))
    assert ("file handles" in found) == (handles > 0)
    assert ("MB (at most 32)" in found) == (mb > 0)


PNG, *_, TIFF = pictures.prepare(None)
PICTURES = {
    "2^62_pixels": pictures.resized(PNG, 2**31 - 1, 2**31 - 1),
    "a_line_of_2^31_pixels": pictures.resized(PNG, 2**31 - 1, 1),
    "25_megapixels": pictures.resized(PNG, 5000, 5000),
    "no_pixels": pictures.resized(PNG, 0, 16),
    "cut_off": PNG[: len(PNG) // 2],
    "header_only": PNG[:33],
    "another_format": TIFF,
    "empty": b"",
}
FAR = 2**40
MESHES = {
    "obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999\n",
    "stl": bytes(80) + (2**32 - 1).to_bytes(4, "little"),
    "ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n",
    "glb": glb_of(
        {
            "asset": {"version": "2.0"},
            "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": FAR}],
            "bufferViews": [{"buffer": 0, "byteLength": FAR, "byteOffset": FAR}],
            "buffers": [{"byteLength": FAR, "uri": "../../etc/passwd"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "nodes": [{"mesh": 0, "children": [0]}],
            "scenes": [{"nodes": [0]}],
        }
    ),
}


@pytest.mark.parametrize("name", PICTURES)
def test_a_crafted_picture_is_refused_in_one_line(name, tmp_path):
    (tmp_path / "picture.png").write_bytes(PICTURES[name])
    with pytest.raises(TextureError) as error:
        read_textures(tmp_path / "picture.png")
    assert is_clear(error.value)


def test_a_picture_that_is_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "picture.png")
    with pytest.raises(TextureError, match="is not a file"):
        read_textures(tmp_path)


@pytest.mark.parametrize("kind", MESHES)
def test_a_crafted_mesh_is_refused_in_one_line(kind, tmp_path, monkeypatch):
    monkeypatch.setattr(meshes.processing, "run_worker", meshes.read_here)
    (tmp_path / f"toy.{kind}").write_bytes(MESHES[kind])
    with pytest.raises(ToyError, match=r"^'toy' ") as error:
        load_toy(find_toys(tmp_path), "toy")
    assert is_clear(error.value)


def test_a_mesh_that_is_a_pipe_is_no_toy(tmp_path):
    os.mkfifo(tmp_path / "toy.obj")
    with pytest.raises(ToyError, match="contains no meshes"):
        find_toys(tmp_path)


COUNT = 300
CASES = cases(SEED, COUNT)
CHUNKS = 15
QUICK = ("run", "check", "grow", "batch")  # Dear uses that take less than a second.


def refused(chosen: list[Case], folder) -> int:
    """Use what is drawn of some cases; return of how many something was refused."""
    count = 0
    for number, case in enumerate(chosen):
        (folder / f"{number}").mkdir()
        count += use_drawn(case, folder / f"{number}") > 0
    return count


def test_a_few_honest_specs_are_used_in_some_ways(tmp_path):
    quick = [case for case in CASES if set(case.dear) <= {*QUICK}]
    assert refused(quick[::24], tmp_path) < len(quick[::24])


@pytest.mark.slow
@pytest.mark.parametrize("chunk", [pytest.param(chunk, marks=FULL) for chunk in range(CHUNKS)])
def test_honest_specs_are_used_in_every_way_and_most_are_refused_nothing(chunk, tmp_path):
    chosen = CASES[chunk::CHUNKS]
    assert refused(chosen, tmp_path) < len(chosen) / 2


def test_each_section_is_put_to_each_dear_use_and_beside_each_other():
    met = {(section, use) for case in CASES for section in case.sections for use in case.dear}
    assert met == {(section, use) for section in sections() for use in DEAR}
    pairs = {frozenset(case.sections) for case in CASES if len(case.sections) == 2}
    assert len(pairs) == len(sections()) * (len(sections()) - 1) / 2
