"""Large arrays of a bundle: the same bytes for the same numbers, and nothing that a stranger's archive could do."""

import dataclasses
import io
import zipfile
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra import numpy as arrays

import mimoc
from mimoc.base.errors import BundleError
from mimoc.base.rounding import rounded, rounded_array
from mimoc.bundle.arrays import ARRAYS, pack_arrays, unpack_arrays

names = st.from_regex(r"[a-z]{1,8}/[a-z_]{1,8}", fullmatch=True)
values = arrays.arrays(
    st.sampled_from(["<f8", ">f8", "<f4", "<i8", "|u1", "|b1"]), arrays.array_shapes(min_dims=0, min_side=0)
)


@pytest.mark.full
@given(st.dictionaries(names, values, max_size=4))
def test_what_is_unpacked_is_what_was_packed(packed):
    found = unpack_arrays(pack_arrays(packed))
    assert list(found) == sorted(packed)
    for name, array in packed.items():
        assert found[name].shape == array.shape
        assert found[name].dtype == array.dtype.newbyteorder("<")
        assert np.array_equal(found[name], array, equal_nan=array.dtype.kind == "f")
        assert not found[name].flags.writeable


def test_the_bytes_do_not_depend_on_order_layout_or_the_clock():
    points = np.arange(6.0).reshape(2, 3)
    same = [{"a": points, "b": points[0]}, {"b": points[0].astype(">f8"), "a": np.asfortranarray(points)}]
    first, second = map(pack_arrays, same)
    assert first == second
    with zipfile.ZipFile(io.BytesIO(first)) as archive:
        assert {(info.date_time, info.create_system, info.compress_type) for info in archive.infolist()} == {
            ((1980, 1, 1, 0, 0, 0), 3, zipfile.ZIP_STORED)
        }


def test_numpy_reads_it():
    with np.load(io.BytesIO(pack_arrays({"touch/points_m": np.eye(3)})), allow_pickle=False) as archive:
        assert np.array_equal(archive["touch/points_m"], np.eye(3))


def archive(*members: tuple[str, bytes], compression: int = zipfile.ZIP_STORED) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", compression) as file:
        for name, member in members:
            file.writestr(name, member)
    return content.getvalue()


def npy(header: str, body: bytes = b"") -> bytes:
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode("latin1") + body


def pickled() -> bytes:
    content = io.BytesIO()
    np.save(content, np.array([{}, None], dtype=object), allow_pickle=True)
    return content.getvalue()


WHOLE = pack_arrays({"a": np.arange(100.0)})
HUGE = "{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,), }\n"
SHORT = "{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }\n"
DAMAGED = {
    "no archive": b"not an archive",
    "empty": b"",
    "cut off": WHOLE[:-30],
    "one byte changed": WHOLE[:200] + bytes([WHOLE[200] ^ 1]) + WHOLE[201:],
    "compressed": archive(("a.npy", bytes(10**6)), compression=zipfile.ZIP_DEFLATED),
    "no array": archive(("a.npy", b"text")),
    "objects": archive(("a.npy", pickled())),
    "a shape without numbers": archive(("a.npy", npy(HUGE))),
    "too few numbers": archive(("a.npy", npy(SHORT, bytes(16)))),
    "too many numbers": archive(("a.npy", npy(SHORT, bytes(32)))),
    "a header of nonsense": archive(("a.npy", npy("(" * 5000 + "\n"))),
}


@pytest.mark.parametrize("content", DAMAGED.values(), ids=DAMAGED)
def test_a_damaged_archive_is_one_clear_error(content):
    with pytest.raises(BundleError, match=r"^arrays\.npz is damaged; build the bundle again$"):
        unpack_arrays(content)


@given(arrays.arrays(np.float64, 20, elements=st.floats(-1e6, 1e6)))
def test_floats_are_rounded_like_all_floats_in_files(array):
    assert rounded_array(array).tolist() == rounded(array.tolist())


def test_whole_numbers_are_not_rounded():
    assert rounded_array(np.array([2**53 + 1]))[0] == 2**53 + 1


@pytest.fixture(scope="module")
def touching(built) -> mimoc.Bundle:
    return built(senses={"touch": {"density": 0.1}})


def test_a_bundle_without_arrays_has_no_such_file(built):
    bundle = built(body={"skin": False})
    assert ARRAYS not in bundle.files
    assert bundle.arrays == {}


def test_a_bundle_that_was_written_has_the_same_arrays(touching, tmp_path):
    read = mimoc.read_bundle(mimoc.write_bundle(touching, tmp_path / "out"))
    assert read.files[ARRAYS] == touching.files[ARRAYS]
    assert np.array_equal(read.arrays["touch/points_m"], touching.arrays["touch/points_m"])


@pytest.mark.parametrize(
    "content", [None, pack_arrays({}), pack_arrays({"touch/points_m": np.zeros((3, 3))}), b"nonsense"], ids=repr
)
def test_skin_points_that_are_not_those_of_the_manifest_are_refused(touching, content):
    files = {**touching.files, ARRAYS: content}
    kept = MappingProxyType({name: file for name, file in files.items() if file is not None})
    with pytest.raises(BundleError, match="damaged; build the bundle again"):
        mimoc.InfantEnv(dataclasses.replace(touching, files=kept))
