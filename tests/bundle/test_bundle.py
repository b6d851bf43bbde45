"""A bundle that is read is intact, or it is refused; a bundle is written all or nothing."""

import dataclasses
import io
import json
import os
import zipfile
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra import numpy as arrays
from support.bundles import ONE, TWO, contents

import mimoc
from mimoc.base.arrays import rounded_array
from mimoc.base.errors import BundleError
from mimoc.base.rounding import rounded
from mimoc.bundle.io import (
    ARRAYS,
    LOCK,
    MANIFEST,
    MAX_LOCK_BYTES,
    digests,
    lock_files,
    pack_arrays,
    read_bundle,
    unpack_arrays,
    write_bundle,
)


def test_what_is_written_is_what_is_read(out):
    assert write_bundle(ONE, out) == out
    read = read_bundle(out)
    assert (read.files, read.manifest, read.path) == (ONE.files, ONE.manifest, out)
    assert contents(out) == dict(ONE.files)
    assert os.listdir(out.parent) == [out.name]


PARTS = st.text(st.characters(categories=["Ll", "Nd", "Lo"], include_characters=" -_.$*[]"), min_size=1, max_size=9)
FOLDERS = st.lists(PARTS.map(lambda part: f"d{part}"), max_size=3)
FILE_NAMES = st.builds(lambda above, name: "/".join([*above, f"f{name}"]), FOLDERS, PARTS)


@given(files=st.dictionaries(FILE_NAMES, st.binary(max_size=99), max_size=8))
def test_any_tree_of_files_survives_the_round_trip(files, tmp_path_factory):
    whole = lock_files({**files, MANIFEST: ONE.files[MANIFEST]}, {}, {})
    folder = write_bundle(whole, tmp_path_factory.mktemp("tree") / "out")
    assert read_bundle(folder).files == whole.files
    assert contents(folder) == dict(whole.files)


def test_the_lock_has_the_digest_of_every_file_and_input():
    lock = json.loads(ONE.files[LOCK])
    assert lock["files"] == digests({name: content for name, content in ONE.files.items() if name != LOCK})
    assert lock["inputs"] == digests({"who.csv": b"1,2"})
    assert lock["versions"] == {"mimoc": "1"}
    assert digests({"a": b""}) == {"a": "sha256:e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"}


def test_the_same_files_in_another_order_are_the_same_bundle():
    files = {name: content for name, content in ONE.files.items() if name != LOCK}
    again = lock_files(dict(reversed(files.items())), {"mimoc": "1"}, {"who.csv": b"1,2"})
    assert list(again.files.items()) == list(ONE.files.items())


def test_a_bundle_in_memory_cannot_be_changed():
    with pytest.raises(TypeError):
        ONE.files["infant.xml"] = b""  # pyright: ignore[reportIndexIssue]


def test_every_file_that_is_wrong_is_named(out):
    write_bundle(ONE, out)
    (out / "infant.xml").write_bytes(b"")
    (out / "assets/3.png").write_bytes(b"x")
    (out / "assets/5.png").unlink()
    (out / MANIFEST).unlink()
    with pytest.raises(
        BundleError,
        match=r"assets/5.png is missing, manifest.json is missing, assets/3.png was changed, infant.xml was changed",
    ):
        read_bundle(out)


@pytest.mark.parametrize("name", sorted(ONE.files.keys() - {LOCK}))
def test_a_change_of_any_file_is_found(out, name):
    write_bundle(ONE, out)
    (out / name).write_bytes(ONE.files[name] + b" ")
    with pytest.raises(BundleError) as error:
        read_bundle(out)
    assert str(error.value) == f"{out}: {name} was changed; build it again with 'mimoc build --force'"


@pytest.mark.parametrize(
    ("replace", "said"),
    [
        (os.mkdir, "is missing"),
        (os.mkfifo, "is not a regular file"),
        (lambda path: os.symlink(path, path), "is a link, which mimoc never writes"),
        (lambda path: os.symlink("/etc/hostname", path), "is a link, which mimoc never writes"),
    ],
)
def test_a_path_that_is_no_longer_a_file_is_named(out, replace, said):
    write_bundle(ONE, out)
    (out / "infant.xml").unlink()
    replace(out / "infant.xml")
    with pytest.raises(BundleError, match=f"infant.xml {said}"):
        read_bundle(out)


def test_a_folder_of_a_bundle_that_is_a_link_is_not_followed(out):
    write_bundle(ONE, out)
    os.rename(out / "assets", out.parent / "elsewhere")
    os.symlink(out.parent / "elsewhere", out / "assets")
    with pytest.raises(BundleError, match=r"assets/0.png is a link, which mimoc never writes"):
        read_bundle(out)


def test_a_bundle_is_found_by_a_link_to_its_folder(out):
    write_bundle(ONE, out)
    os.symlink(out, out.parent / "latest")
    assert read_bundle(out.parent / "latest").files == ONE.files


def test_files_outside_the_lock_are_ignored_but_do_not_survive_force(out):
    write_bundle(ONE, out)
    (out / "notes.txt").write_text("mine")
    assert read_bundle(out).files == ONE.files
    write_bundle(TWO, out, force=True)
    assert contents(out) == dict(TWO.files)


def test_the_error_for_a_missing_folder_says_how_to_build_a_bundle(tmp_path):
    with pytest.raises(BundleError, match=r"nothing: there is no such folder; build one there with 'mimoc build SPEC"):
        read_bundle(tmp_path / "nothing")


def test_a_file_or_another_folder_is_not_a_bundle(tmp_path):
    (tmp_path / "infant.xml").write_text("<mujoco/>")
    with pytest.raises(BundleError, match="there is no such folder"):
        read_bundle(tmp_path / "infant.xml")
    with pytest.raises(BundleError, match=r"this is not a bundle, it has no lock.json"):
        read_bundle(tmp_path)


NO_LOCKS = {
    "empty": b"",
    "no JSON": b"<mujoco/>",
    "no text": b"\xff\xfe\x00",
    "a list": b"[]",
    "a number": b"1e999",
    "no files": b"{}",
    "files in a list": b'{"files": ["manifest.json"]}',
    "no manifest": b'{"files": {"infant.xml": "sha256:0"}}',
    "a bomb": b"[" * 200_000,
    "cut off": ONE.files[LOCK][:-20],
    "huge": ONE.files[LOCK] + b" " * MAX_LOCK_BYTES + b"!",
    "above": b'{"files": {"manifest.json": "", "../secret": ""}}',
    "above, inside": b'{"files": {"manifest.json": "", "assets/../../secret": ""}}',
    "absolute": b'{"files": {"manifest.json": "", "/etc/passwd": ""}}',
    "backslash": rb'{"files": {"manifest.json": "", "..\\secret": ""}}',
    "NUL": rb'{"files": {"manifest.json": "", "a\u0000b": ""}}',
    "half a character": rb'{"files": {"manifest.json": "", "\ud800": ""}}',
    "a new line": rb'{"files": {"manifest.json": "", "a\nb": ""}}',
}


@pytest.mark.parametrize("lock", NO_LOCKS.values(), ids=NO_LOCKS.keys())
def test_a_folder_with_a_damaged_lock_is_neither_read_nor_replaced(out, lock):
    write_bundle(ONE, out)
    (out / LOCK).write_bytes(lock)
    before = contents(out)
    with pytest.raises(BundleError, match=r"lock.json is damaged; remove the folder and build it again$"):
        read_bundle(out)
    with pytest.raises(BundleError, match="is not a bundle and is never replaced"):
        write_bundle(TWO, out, force=True)
    assert contents(out) == before


@pytest.mark.parametrize("digest", ["", "sha256:", None, 7, ["sha256:0"]])
def test_a_lock_with_an_invalid_digest_matches_no_file(out, digest):
    write_bundle(ONE, out)
    lock = json.loads(ONE.files[LOCK])
    lock["files"]["infant.xml"] = digest
    (out / LOCK).write_text(json.dumps(lock))
    with pytest.raises(BundleError, match=r"infant.xml was changed"):
        read_bundle(out)


OTHER_MANIFESTS = {
    b'{"manifest": 1}': "this version of mimoc reads manifests of version 2 only; build it again",
    b'{"manifest": 3}': "this version of mimoc reads manifests of version 2 only; build it again",
    b"[]": "this version of mimoc reads manifests of version 2 only; build it again",
    b"{}": "manifest.json: name: Field required; child: Field required; .* and 7 more; build it again",
    b"\xff": "manifest.json: it is damaged; build it again",
    b"": "manifest.json: it is damaged; build it again",
    b"[" * 200_000: "manifest.json: it is damaged; build it again",
    b" " * 2**22 + b"{}": "manifest.json: it has more than 4 MB, which no infant needs",
}


@pytest.mark.parametrize("manifest", OTHER_MANIFESTS, ids=lambda manifest: manifest[:9])
def test_a_manifest_of_another_kind_is_refused_with_a_clear_error(out, manifest):
    files = {"infant.xml": b"", MANIFEST: manifest}
    (out / "assets").mkdir(parents=True)
    for name, content in {**files, LOCK: json.dumps({"files": digests(files)}).encode()}.items():
        (out / name).write_bytes(content)
    with pytest.raises(BundleError, match=OTHER_MANIFESTS[manifest]):
        read_bundle(out)
    assert read_bundle(write_bundle(ONE, out, force=True)).files == ONE.files


@pytest.mark.parametrize("force", [False, True])
def test_a_folder_that_is_not_a_bundle_is_never_replaced(out, force):
    out.mkdir()
    (out / "thesis.tex").write_text("months of work")
    with pytest.raises(BundleError, match="this folder is not a bundle and is never replaced; name a new folder"):
        write_bundle(ONE, out, force=force)
    assert contents(out.parent) == {"infant/thesis.tex": b"months of work"}


@pytest.mark.parametrize("force", [False, True])
def test_a_file_is_never_replaced(out, force):
    out.write_text("work")
    with pytest.raises(BundleError, match="this is a file; name a new folder"):
        write_bundle(ONE, out, force=force)
    assert contents(out.parent) == {"infant": b"work"}


def test_a_bundle_is_replaced_only_with_force(out):
    write_bundle(ONE, out)
    with pytest.raises(BundleError) as error:
        write_bundle(TWO, out)
    assert str(error.value) == f"{out}: a bundle already exists here; replace it with --force, or name a new folder"
    assert read_bundle(out).files == ONE.files
    write_bundle(TWO, out, force=True)
    assert read_bundle(out).files == TWO.files
    assert os.listdir(out.parent) == [out.name]


def test_a_damaged_bundle_can_be_built_again(out):
    write_bundle(ONE, out)
    (out / "infant.xml").unlink()
    write_bundle(ONE, out, force=True)
    assert read_bundle(out).files == ONE.files


def test_an_empty_folder_can_be_written_to(out):
    out.mkdir()
    write_bundle(ONE, out)
    assert read_bundle(out).files == ONE.files


def test_a_link_is_followed_and_stays_a_link(out, tmp_path):
    link = tmp_path / "link"
    link.symlink_to(out)
    for whole, force in ((ONE, False), (TWO, True)):
        assert write_bundle(whole, link, force=force) == link
        assert link.is_symlink()
        assert read_bundle(link).files == read_bundle(out).files == whole.files
    assert set(os.listdir(tmp_path)) == {"builds", "link"}
    assert os.listdir(out.parent) == [out.name]


@pytest.mark.parametrize(
    "name",
    [
        *("with blank", "run[1]", "run*", "häschen", "-o", ".hidden", "~/infant", "a" * 100),
        *("builds/infant", "builds/infant/", "./builds/../builds/infant", "a/b/c"),
    ],
)
def test_unusual_home_relative_and_missing_folders_are_accepted(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    write_bundle(ONE, name)
    write_bundle(TWO, name, force=True)
    assert read_bundle(name).files == TWO.files
    assert len(list(tmp_path.rglob(LOCK))) == 1


def test_the_working_directory_is_never_replaced(out, monkeypatch):
    """A shell in it would be left in a deleted folder."""
    out.mkdir()
    monkeypatch.chdir(out)
    with pytest.raises(BundleError, match="the folder you are in"):
        write_bundle(ONE, ".")
    assert write_bundle(ONE, "inside").exists()


def test_nothing_is_written_outside_the_folder(out):
    stray = replace(ONE, files={**ONE.files, "../stray": b""})
    with pytest.raises(BundleError, match=r"'../stray' is outside the bundle's folder"):
        write_bundle(stray, out)
    assert not out.exists()
    assert os.listdir(out.parent) == []


def test_impossible_names_are_refused(tmp_path):
    with pytest.raises(BundleError, match="cannot have this name"):
        write_bundle(ONE, tmp_path / "no\0name")


@pytest.mark.parametrize(
    ("name", "reason"), [("file/out", "File exists|Not a directory"), ("a" * 300, "File name too long")]
)
def test_a_path_that_cannot_be_a_folder_is_named_in_the_error(tmp_path, name, reason):
    (tmp_path / "file").write_text("work")
    with pytest.raises(BundleError, match=rf"cannot be written \(({reason})\); choose another folder"):
        write_bundle(ONE, tmp_path / name)
    assert contents(tmp_path) == {"file": b"work"}


def test_the_home_of_an_unknown_user_is_an_ordinary_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_bundle(ONE, "~nobody_of_that_name/out")
    assert read_bundle("~nobody_of_that_name/out").files == ONE.files


def test_permissions_are_those_of_the_users_mask(out):
    kept = os.umask(0o027)
    try:
        write_bundle(ONE, out)
    finally:
        os.umask(kept)
    assert {oct(path.stat().st_mode & 0o777) for path in (out, out / "assets")} == {"0o750"}
    assert {oct((out / name).stat().st_mode & 0o777) for name in ONE.files} == {"0o640"}


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
