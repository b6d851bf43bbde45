"""The bundle, with its large arrays: read from a folder with its digests checked, and written to one all or nothing."""

import errno
import io
import json
import math
import os
import shutil
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from pathlib import Path, PurePosixPath
from types import MappingProxyType
from typing import Any, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import BundleError
from mimoc.bundle.files import SharedFiles, remove_leftovers, swap_folders, unfinished_name
from mimoc.bundle.manifest import Manifest, read_manifest
from mimoc.bundle.regular_files import (
    MAX_FILES,
    MAX_NESTED,
    RegularFiles,
    UnusableFileError,
    read_regular_file,
    regular_files,
)

ARRAYS = "arrays.npz"  # Path in the bundle; a bundle without arrays has no such file.
SUFFIX = ".npy"
FIRST_DATE = (1980, 1, 1, 0, 0, 0)  # The earliest that a ZIP archive can hold: a build has no date.
UNIX = 3
READABLE = 0o644 << 16  # System and permissions in the archive, which Python would take from where it runs.
NUMBERS = "biuf"  # Kinds of `numpy.dtype` that arrays may have: no objects, no text.

Array = npt.NDArray[Any]


class LazyArrays(Mapping[str, Array]):
    """Arrays by name, of which some are made when one of them is first asked for; all are read-only."""

    def __init__(self, ready: Mapping[str, Array], names: Sequence[str], make: Callable[[], Mapping[str, Array]]):
        self._ready, self._names, self._make = ready, tuple(names), make

    @cached_property
    def _made(self) -> Mapping[str, Array]:
        return self._make()

    def __getitem__(self, name: str) -> Array:
        return self._made[name] if name in self._names else self._ready[name]

    def __iter__(self) -> Iterator[str]:
        return iter((*self._ready, *self._names))

    def __len__(self) -> int:
        return len(self._ready) + len(self._names)


def pack_arrays(arrays: Mapping[str, Array]) -> bytes:
    """Return an archive that `numpy.load` reads: not compressed, sorted by name."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name in sorted(arrays):
            info = zipfile.ZipInfo(name + SUFFIX, FIRST_DATE)
            info.create_system, info.external_attr = UNIX, READABLE
            array = arrays[name]
            file = io.BytesIO()
            little_endian = np.asarray(array, array.dtype.newbyteorder("<"), order="C")
            np.lib.format.write_array(file, little_endian, version=(1, 0), allow_pickle=False)
            archive.writestr(info, file.getvalue())
    return packed.getvalue()


def unpack_arrays(content: bytes) -> dict[str, Array]:
    """Return the arrays that `pack_arrays` wrote, read-only views of the archive, or raise a BundleError."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = archive.infolist()
            is_plain = all(member.compress_type == zipfile.ZIP_STORED for member in members)
            if not is_plain or sum(member.file_size for member in members) > len(content):
                raise ValueError("it is compressed")
            return {member.filename.removesuffix(SUFFIX): _unpacked(archive.read(member)) for member in members}
    except Exception:  # Whatever a stranger's archive makes the readers of ZIP and NPY raise.
        raise BundleError(f"{ARRAYS} is damaged; build the bundle again") from None


def _unpacked(content: bytes) -> Array:
    file = io.BytesIO(content)
    if np.lib.format.read_magic(file) != (1, 0):
        raise ValueError("it is of another version")
    shape, is_fortran, kind = np.lib.format.read_array_header_1_0(file)
    if kind.kind not in NUMBERS or is_fortran or math.prod(shape) * kind.itemsize != len(content) - file.tell():
        raise ValueError("its size is not what it says")
    return np.frombuffer(content, kind, offset=file.tell()).reshape(shape)


@dataclass(frozen=True, eq=False, repr=False)
class LazyFiles(Mapping[str, bytes]):
    """Content by path, made when it is first asked for."""

    arrays: Mapping[str, Array]  # What the file of the large arrays holds, read-only, rounded as it is in the file.
    make: Callable[[], Mapping[str, bytes]]

    def __getitem__(self, path: str) -> bytes:
        return self._all[path]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    @cached_property
    def _all(self) -> Mapping[str, bytes]:
        return self.make()


class HasFiles(Protocol):
    """Something that can be written as a folder."""

    @property
    def files(self) -> Mapping[str, bytes]:
        """Content of each file by its path within the folder."""
        ...


Read = TypeVar("Read")
MANIFEST, LOCK = "manifest.json", "lock.json"
SHARED = "assets/"  # Where the files of a bundle are that other infants have as well: pictures and meshes.
MAX_LOCK_BYTES = 2**22  # Upper bound of a lock's size; real ones are far smaller.


@dataclass(frozen=True, slots=True, repr=False)
class Bundle:
    """The files of a compiled infant.

    Example:
        >>> import mimoc
        >>> bundle = mimoc.read_bundle("out/nine_months")
        >>> sorted(bundle.files)[-3:]
        ['resolved.yaml', 'scene.xml', 'spec.yaml']
        >>> bundle.manifest.root_body, len(bundle.manifest.actuation.actuators)
        ('hip', 44)
    """

    files: Mapping[str, bytes]  # Content of each file by its path within the bundle, sorted; read-only.
    manifest: Manifest  # Everything the runtime knows about the infant.
    path: Path | None  # Folder it was read from; None if it exists only in memory.

    @property
    def arrays(self) -> Mapping[str, Array]:
        """Its large arrays by name, such as `touch/points_m`, read-only; empty if it has none.

        Raises:
            BundleError: If the archive that holds them is damaged.
        """
        if isinstance(self.files, LazyFiles):
            return self.files.arrays
        return MappingProxyType(unpack_arrays(self.files[ARRAYS]) if ARRAYS in self.files else {})

    @property
    def versions(self) -> Mapping[str, str]:
        """Versions of the software that made it, by name."""
        return versions_in(self.files)

    def __repr__(self) -> str:
        size_kb = sum(map(len, self.files.values())) / 1000
        at = f", read from {str(self.path)!r}" if self.path else ""
        who = f"{self.manifest.name!r}, {self.manifest.child.age_months:g} months"
        return f"Bundle({who}, {len(self.files)} files, {size_kb:.0f} kB{at})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _bundle, (dict(self.files), self.manifest, self.path)


def lock_files(
    files: Mapping[str, bytes],
    versions: Mapping[str, str],
    inputs: Mapping[str, bytes],
    manifest: Manifest | None = None,
) -> Bundle:
    """Return a bundle of files, which include the manifest, and a lock with the digests of these and all inputs."""
    return _bundle(with_lock(files, versions, inputs), manifest or read_manifest(files[MANIFEST]), None)


def versions_in(files: Mapping[str, bytes]) -> dict[str, str]:
    """Return the versions of the software that made the files of a bundle, by name, as its lock says."""
    listed = json.loads(files[LOCK]).get("versions")
    return {str(name): str(version) for name, version in listed.items()} if isinstance(listed, dict) else {}


def with_lock(files: Mapping[str, bytes], versions: Mapping[str, str], inputs: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return files with a lock, which has the digests of these and of all inputs."""
    return _with_lock(files, {"lock": 1, "versions": dict(versions), "inputs": digests(inputs)})


def digests(files: Mapping[str, bytes]) -> dict[str, str]:
    """Return the digest of each file, sorted by name."""
    return {name: f"sha256:{sha256(files[name]).hexdigest()}" for name in sorted(files)}


@takes("the folder of a bundle", *PATH)
def read_bundle(path: str | Path) -> Bundle:
    """Read the bundle in a folder; files that are not listed in its lock are ignored.

    Raises:
        BundleError: If the folder is not a bundle, or files are missing or changed; the error names each of them.

    Example:
        >>> import mimoc
        >>> mimoc.read_bundle("out/nine_months").manifest.name
        'nine_months'
    """
    return read_locked(path, lambda files, folder: _bundle(files, read_manifest(files[MANIFEST]), folder))


def read_locked(path: str | Path, parse: Callable[[Mapping[str, bytes], Path], Read]) -> Read:
    """Return what *parse* makes of the files that a folder's lock lists; BundleError if one is missing or changed."""
    folder = Path(os.path.expanduser(path))
    try:
        os.stat(folder)
    except FileNotFoundError:
        pass
    except (OSError, ValueError) as error:  # A name that is too long, or has a null byte.
        raise BundleError(f"{str(folder)[:100]}: the folder cannot be read ({error})") from None
    while True:
        with _watch_for_replacement(folder) as replaced:
            try:
                return _read_folder(folder, parse)
            except BundleError:
                if not replaced():
                    raise


def without(bundle: Bundle, name: str) -> Bundle:
    """Return a bundle without one of its files, which its lock no longer lists."""
    files = {other: content for other, content in bundle.files.items() if other not in (name, LOCK)}
    return _bundle(_with_lock(files, json.loads(bundle.files[LOCK])), bundle.manifest, None)


@takes("a bundle", "Bundle", "WorldBundle")
def write_bundle(bundle: HasFiles, out: str | Path, *, force: bool = False, shared: SharedFiles | None = None) -> Path:
    """Write a bundle into a folder atomically: a reader sees either the old folder or the new one.

    Args:
        bundle: The bundle.
        out: A new or empty folder or, with *force*, an existing bundle.
        force: Replace an existing bundle, together with any other files in its folder.
        shared: Where pictures and meshes are kept that this bundle shares with others; its files are links to them.

    Raises:
        BundleError: If the folder holds something that must not be replaced, or cannot be written.

    Example:
        >>> import mimoc
        >>> bundle = mimoc.build("nine_months.yaml")
        >>> sorted(path.name for path in mimoc.write_bundle(bundle, "out/written").iterdir())[-3:]
        ['resolved.yaml', 'scene.xml', 'spec.yaml']
    """
    target = Path(os.path.expanduser(out))
    try:
        place = Path(os.path.realpath(target))
        _check_replaceable(place, target, force)
        place.parent.mkdir(parents=True, exist_ok=True)
        remove_leftovers(place.parent, _staging_prefix(place))
        staging = place.parent / unfinished_name(_staging_prefix(place))
        staging.mkdir()
        try:
            if outside := [name for name in bundle.files if not _is_inside(name)]:
                raise BundleError(f"'{outside[0]}' is outside the bundle's folder, where nothing is written")
            for name, content in bundle.files.items():
                path = staging / name
                path.parent.mkdir(parents=True, exist_ok=True)
                if shared and name.startswith(SHARED):
                    shared.put(path, content)
                else:
                    path.write_bytes(content)
            _move_into_place(staging, place, target, force)
        finally:
            shutil.rmtree(staging, ignore_errors=True)
    except OSError as error:
        raise BundleError(f"{target}: cannot be written ({error.strerror}); choose another folder") from None
    except ValueError:
        raise BundleError(f"{str(target)!r}: a folder cannot have this name; choose another folder") from None
    return target


def _bundle(files: Mapping[str, bytes], manifest: Manifest, path: Path | None) -> Bundle:
    return Bundle(in_order(files), manifest, path)


def in_order(files: Mapping[str, bytes]) -> Mapping[str, bytes]:
    """Return files sorted by path, read-only."""
    return MappingProxyType(dict(sorted(files.items())))


def _with_lock(files: Mapping[str, bytes], lock: Mapping[str, Any]) -> dict[str, bytes]:
    text = json.dumps({**lock, "files": digests(files)}, indent=1, sort_keys=True) + "\n"
    return {**files, LOCK: text.encode()}


@contextmanager
def _watch_for_replacement(folder: Path) -> Iterator[Callable[[], bool]]:
    """Yield a function that says whether another build has replaced a folder since.

    The folder is kept open meanwhile, so that no new folder can be given its inode.
    """
    try:
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    except OSError:
        yield lambda: False
        return
    try:
        yield lambda: folder.exists() and not os.path.samestat(os.fstat(handle), os.stat(folder))
    finally:
        os.close(handle)


def _read_folder(folder: Path, parse: Callable[[Mapping[str, bytes], Path], Read]) -> Read:
    try:
        with regular_files(folder) as opened:
            lock, files = _read_files(folder, opened)
    except OSError:
        if os.path.isfile(folder):  # Unlike a path's own method, also for paths that no file can have.
            raise BundleError(f"{folder}: there is no such folder, as this is a file; {_ADVICE_FOR_FILES}") from None
        raise BundleError(f"{folder}: there is no such folder; {_ADVICE}") from None
    try:
        return parse({**files, LOCK: lock}, folder)
    except BundleError as error:
        raise BundleError(f"{folder}: {error}") from None


_ADVICE = "build one there with 'mimoc build SPEC -o OUT'"
_ADVICE_FOR_FILES = "name the folder of a bundle, or a spec that ends in .yaml or .yml"


def _read_files(folder: Path, opened: RegularFiles) -> tuple[bytes, dict[str, bytes]]:
    """Return a lock and the files that it lists, all of which must be there and have the digests that it says."""
    try:
        lock = opened.read(LOCK, MAX_LOCK_BYTES)
    except UnusableFileError:
        lock = b""
    if lock is None:
        raise BundleError(f"{folder}: this is not a bundle, it has no {LOCK}; {_ADVICE}")
    if (locked := _locked_files(lock)) is None:
        raise BundleError(f"{folder}: {LOCK} is damaged; remove the folder and build it again")
    files, problems = dict[str, bytes](), list[str]()
    for name in sorted(locked):
        try:
            content = opened.read(name)
        except UnusableFileError as error:
            problems.append(f"{name} {error}")
            continue
        if content is None:
            problems.append(f"{name} is missing")
        else:
            files[name] = content
    problems += [f"{name} was changed" for name, digest in digests(files).items() if digest != locked[name]]
    if problems:
        raise BundleError(f"{folder}: {', '.join(problems)}; build it again with 'mimoc build --force'")
    return lock, files


def _locked_files(content: bytes) -> dict[str, str] | None:
    try:
        lock: Any = json.loads(content)
        files = lock["files"]
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
    if not isinstance(files, dict) or MANIFEST not in files or len(files) > MAX_FILES:
        return None
    return files if all(map(_is_inside, files)) and len(content) <= MAX_LOCK_BYTES else None


def _is_inside(name: str) -> bool:
    path = PurePosixPath(name)
    if not name.isprintable() or "\\" in name or len(path.parts) > MAX_NESTED:
        return False
    return bool(path.parts) and not path.is_absolute() and ".." not in path.parts


def _check_replaceable(place: Path, target: Path, force: bool) -> None:
    """Raise a BundleError if writing to *place* would overwrite anything but an empty folder or, by force, a bundle."""
    if not os.path.lexists(place):
        return
    if not place.is_dir():
        raise BundleError(f"{target}: this is a file; name a new folder")
    if Path.cwd().is_relative_to(place) or os.path.ismount(place):
        reason = "a mounted folder" if os.path.ismount(place) else "the folder you are in"
        raise BundleError(f"{target}: {reason} cannot be replaced; name a new folder inside it")
    if not any(place.iterdir()):
        return
    if not _is_bundle(place):
        raise BundleError(f"{target}: this folder is not a bundle and is never replaced; name a new folder")
    if not force:
        raise BundleError(f"{target}: a bundle already exists here; replace it with --force, or name a new folder")


def _is_bundle(folder: Path) -> bool:
    try:
        return _locked_files(read_regular_file(folder / LOCK, MAX_LOCK_BYTES) or b"") is not None
    except UnusableFileError:
        return False


def _move_into_place(staging: Path, place: Path, target: Path, force: bool) -> None:
    """Rename the finished folder to its final path; anything it replaces is left in *staging*."""
    try:
        os.rename(staging, place)
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise
        _check_replaceable(place, target, force)  # Another process may have written there meanwhile.
        swap_folders(staging, place)


def _staging_prefix(place: Path) -> str:
    return f".{place.name}.mimoc-"
