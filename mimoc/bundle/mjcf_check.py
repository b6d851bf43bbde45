"""Whether MJCF and its pictures, meshes and skins are what mimoc writes, before MuJoCo reads any of them.

MJCF has only the elements and attributes that mimoc writes, and not too many of them. Other files are as large as they
say, and no larger than infants need.
"""

import re
import struct
import zlib
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NoReturn
from xml.parsers import expat

import numpy as np

from mimoc.base.errors import BundleError
from mimoc.bundle.regular_files import UnusableFileError

Values = Callable[[Sequence[str]], bool]
"""Whether all of some values are what an attribute may be; looking at those of a file together takes a tenth of the
time."""


def _words(words: str) -> Values:
    return frozenset(words.split()).issuperset


def _numbers(lowest: int, highest: int) -> Values:
    return frozenset(map(str, range(lowest, highest + 1))).issuperset


def _shaped(shape: str) -> Values:
    pattern = re.compile(shape, re.ASCII)
    return lambda values: all(map(pattern.fullmatch, values))


def _file(suffix: str) -> Values:
    """Among the assets, without `..`, blanks or anything else that two programs could read in two ways."""
    return _shaped(rf"assets/(?:[\w-][\w.+-]*/){{0,4}}[\w-][\w.+-]{{0,200}}\.{suffix}")


def _are_short(values: Sequence[str], joined: str, longest: int) -> bool:
    return len(joined) <= longest or max(map(len, values)) <= longest


DIGITS = frozenset("0123456789-+.e ")
LARGE = re.compile(r"e(?:\+?0*[1-9][0-9]|-[0-9]{4})")  # Exponents above 9.


def _are_numbers(values: Sequence[str]) -> bool:
    text = " ".join(values)
    return DIGITS.issuperset(text) and not LARGE.search(text) and _are_short(values, text, 100_000)


def _are_names(values: Sequence[str]) -> bool:
    text = " ".join(values)
    return text.isprintable() and _are_short(values, text, 200)


VALUES: Mapping[Values, str] = {
    _are_names: "model name joint joint1 site objname body1 body2 geom1 geom2 target texture mesh material",
    _words("true false auto enable disable 0 1"): "limited active actearly actlimited ctrllimited forcelimited "
    "castshadow directional mocap texuniform energy eulerdamp island multiccd nativeccd sensor",
    _numbers(0, 99): "contype conaffinity condim priority group numslices numstacks offsamples nuser_actuator",
    _numbers(1, 100): "iterations ls_iterations",
    _numbers(1, 4096): "width height offwidth offheight shadowsize",
    _shaped("[a-zA-Z0-9]{1,20}"): "integrator cone jacobian solver mode objtype builtin dyntype gaintype biastype",
    _shaped("(?:[a-z][a-z0-9_]{0,20}_)?infant"): "class childclass",
    _words("."): "texturedir meshdir",
    _words("radian"): "angle",
    _words("xyz"): "eulerseq",
    _words("false"): "autolimits",
    _words("shell convex exact legacy"): "inertia",
    _shaped("[1-6] [1-6]"): "gridsize",
    _shaped("[.RLUDFB]{1,12}"): "gridlayout",
}
"""What attributes of these names may be in any element; all others are numbers."""
BY_ELEMENT: Mapping[tuple[str, str], Values] = {
    ("include", "file"): _words("infant.xml"),
    ("texture", "file"): _file("png"),
    ("mesh", "file"): _file("obj"),
    ("skin", "file"): _file("skn"),
    ("texture", "type"): _shaped("[a-zA-Z0-9]{1,20}"),
    ("joint", "type"): _words("hinge ball slide"),
    ("geom", "type"): _words("plane sphere capsule ellipsoid cylinder box mesh"),
    ("spatial", "width"): _are_numbers,
    ("site", "type"): _words("sphere capsule ellipsoid cylinder box"),
}
"""What attributes may be whose name means something else in each element."""
_SOFT = "solref solimp solreflimit solimplimit solreffriction solimpfriction margin gap solmix"
ATTRIBUTES: Mapping[str, str] = {
    "mujoco": "model",
    "include": "file",
    "compiler": "angle eulerseq autolimits texturedir meshdir boundinertia",
    "option": "timestep integrator cone jacobian solver iterations ls_iterations tolerance ls_tolerance gravity",
    "flag": "multiccd nativeccd eulerdamp island energy sensor",
    "size": "nuser_actuator",
    "statistic": "center extent",
    "visual asset worldbody deformable contact tendon actuator sensor equality keyframe": "",
    "global": "offwidth offheight azimuth elevation fovy",
    "headlight": "active ambient diffuse specular",
    "quality": "shadowsize numslices numstacks offsamples",
    "map": "znear zfar shadowclip",
    "rgba": "haze fog",
    "default": "class",
    "texture": "name type builtin rgb1 rgb2 width height file gridsize gridlayout",
    "material": "name rgba texture texrepeat texuniform specular shininess reflectance emission",
    "mesh": "name file inertia",
    "light": "name directional pos dir diffuse specular ambient attenuation cutoff exponent castshadow",
    "body": "name pos euler quat childclass mocap",
    "freejoint": "name",
    "joint": "name joint joint1 type limited active axis pos range stiffness damping frictionloss armature springref "
    f"coef polycoef {_SOFT}",
    "geom": "name type mesh size pos euler quat mass rgba material contype conaffinity condim priority friction group "
    f"{_SOFT}",
    "site": "name site type pos size euler quat zaxis fromto rgba group material",
    "camera": "name pos euler quat fovy mode target",
    "skin": "name file material group",
    "exclude": "name body1 body2",
    "pair": f"name geom1 geom2 condim friction {_SOFT}",
    "spatial": "name limited range stiffness damping width rgba",
    "fixed": f"name limited range stiffness damping frictionloss {_SOFT}",
    "general": "name class joint ctrllimited forcelimited actlimited actearly gear ctrlrange forcerange actrange "
    "lengthrange dyntype gaintype biastype dynprm gainprm biasprm user group",
    "torque gyro accelerometer force touch velocimeter magnetometer rangefinder framepos framequat framelinvel": (
        "name site objname objtype"
    ),
    "weld": f"name body1 body2 active anchor relpose torquescale {_SOFT}",
    "key": "name qpos qvel act ctrl mpos mquat time",
}
"""The attributes of elements. A sense, a task or a scene of a plug-in prints by the same templates, so that it is
within them as well."""
_BY_NAME = {name: values for values, names in VALUES.items() for name in names.split()}
ELEMENTS: Mapping[str, Mapping[str, Values]] = {
    element: {name: BY_ELEMENT.get((element, name)) or _BY_NAME.get(name, _are_numbers) for name in names.split()}
    for elements, names in ATTRIBUTES.items()
    for element in elements.split()
}
"""What the values of each attribute of each element may be."""

REFERRING = {"texture", "mesh", "skin"}  # Elements that refer to files, besides the one `include`.

MAX_COUNTS: Mapping[str, int] = {
    "include": 1,
    "body": 512,
    "joint": 1024,
    "freejoint": 64,
    "geom": 2048,
    "mesh": 1024,
    "texture": 256,
    "skin": 16,
    "light": 64,
    "camera": 64,
    "general": 512,
    "key": 32,
    "pair": 8192,
    "weld": 64,
}
"""How many there may be of some elements; a room with fifty toys and an infant with ten fingers have half as many at
most."""
MAX_ELEMENTS = 20_000
MAX_BYTES = 2**23  # Largest size of one file, for each infant in it; those of that room have 0.6 MB.
MAX_DEPTH = 64  # Elements within each other; in an infant with ten fingers 14.


_BEYOND_ELEMENTS = re.compile(rb"<[!?]|&#|>\s*+[^<\s]")
"""Where comments, declarations, numbered characters and text between elements begin: mimoc writes none, and parsers
differ in them."""
_MAX_SHOWN = 60


def read_mjcf(file: str, content: bytes, infants: int = 1) -> tuple[Counter[str], dict[str, str]]:
    """Return the numbers of elements of MJCF, and those that refer to files, by path, or raise a BundleError."""
    if len(content) > (most := MAX_BYTES * infants):
        raise BundleError(f"{file}: it has more than {most >> 20} MB, which no infant needs")
    if beyond := _BEYOND_ELEMENTS.search(content):
        line = content.count(b"\n", 0, beyond.start()) + 1
        raise BundleError(f"{file}:{line}: mimoc writes nothing but elements")
    reader = _Reader(file)
    reader.read(content)
    if not all(values(given) for values, given in reader.given.items()):
        _Reader(file, at_once=True).read(content)
    for name, most in MAX_COUNTS.items():
        if (number := reader.counts[name]) > most * infants:
            raise BundleError(f"{file}: {number:,} times <{name}>, where at most {most * infants:,} may be")
    if (number := reader.counts.total()) > (most := MAX_ELEMENTS * infants):
        raise BundleError(f"{file}: {number:,} elements, where at most {most:,} may be")
    return reader.counts, reader.references


class _Reader:
    """Reads MJCF element by element, and refuses what mimoc does not write."""

    def __init__(self, file: str, *, at_once: bool = False):
        """Begin a file; to check each value *at once*, where it is, takes longer than all together in the end."""
        self.counts, self.references = Counter[str](), dict[str, str]()
        self.given: defaultdict[Values, list[str]] = defaultdict(list)
        """The values of all attributes, by what they may be."""
        self._sinks: dict[str, dict[str, Callable[[str], None]]] = {}
        """What takes the values of each attribute, by element."""
        self._file, self._at_once, self._depth, self._muscles = file, at_once, 0, False
        self._unmeasured: list[tuple[int, bool]] = []
        """Lines of actuators without a lengthrange, and whether they are muscles by types of their own."""
        self._parser: Any = expat.ParserCreate("utf-8")
        self._parser.StartElementHandler, self._parser.EndElementHandler = self._begin, self._end

    def read(self, content: bytes) -> None:
        """Read the whole file."""
        try:
            self._parser.Parse(content, True)
        except (expat.ExpatError, UnicodeDecodeError) as error:
            raise BundleError(f"{self._file}: it is not XML ({error})") from None
        for line, is_muscle in self._unmeasured:
            if is_muscle or self._muscles:
                raise BundleError(f"{self._file}:{line}: a muscle without a lengthrange")

    def _begin(self, element: str, attributes: dict[str, str]) -> None:
        sinks = self._sinks.get(element) or self._sinks_of(element)
        self.counts[element] += 1
        self._depth += 1
        if self._depth > MAX_DEPTH:
            self._refuse(f"more than {MAX_DEPTH} elements within each other")
        for name, value in attributes.items():
            if name not in sinks:
                self._refuse(f"{name[:_MAX_SHOWN]!r} is not an attribute that mimoc gives <{element}>")
            sinks[name](value)
            if self._at_once and not ELEMENTS[element][name]([value]):
                self._refuse(f"{name}={value[:_MAX_SHOWN]!r} is not what mimoc writes there")
        if element in REFERRING and "file" in attributes:
            self.references[attributes["file"]] = element
        elif element == "general":
            self._check_muscle(attributes)

    def _sinks_of(self, element: str) -> dict[str, Callable[[str], None]]:
        if element not in ELEMENTS:
            self._refuse(f"<{element[:_MAX_SHOWN]}> is not an element that mimoc writes")
        self._sinks[element] = {name: self.given[values].append for name, values in ELEMENTS[element].items()}
        return self._sinks[element]

    def _check_muscle(self, attributes: dict[str, str]) -> None:
        """MuJoCo finds the lengths of a muscle that does not give them by simulating it, which takes long.

        An actuator is a muscle by its own types, or by those of the defaults, which may stand after it.
        """
        types = attributes.get("gaintype"), attributes.get("biastype")
        if "joint" not in attributes:
            self._muscles |= "muscle" in types
        elif ("muscle" in types or None in types) and not _is_range(attributes.get("lengthrange", "")):
            self._unmeasured.append((self._parser.CurrentLineNumber, "muscle" in types))

    def _end(self, element: str) -> None:
        self._depth -= 1

    def _refuse(self, reason: str) -> NoReturn:
        raise BundleError(f"{self._file}:{self._parser.CurrentLineNumber}: {reason}")


def _is_range(numbers: str) -> bool:
    try:
        lowest, highest = map(float, numbers.split())
        return lowest < highest
    except ValueError:
        return False


MAX_SIDE_PX = 4096  # Pixels along a side of a picture; those of infants have 512 at most.
MAX_PIXELS = 2**26  # Pixels of all pictures of a bundle, which take three bytes each once they are decoded.
MAX_FACES = 20_000  # Triangles of a mesh; toys have at most 5,000.
MAX_MESH_BYTES = 10 * 2**20  # Bytes of all meshes of a bundle; fifty toys of 5,000 triangles each have 8 MB.
MAX_VERTICES = 200_000  # Vertices of all skins of a bundle; an infant has 7,500.
SURELY_SMALL = 2**16
"""Bytes of a picture that need not be tried: Deflate's ratio is at most 1032, so that they unpack to 64 MB at most, and
MuJoCo refuses the first one that is larger than it says."""

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_CHUNKS = (b"IHDR", b"PLTE", b"tRNS", b"IDAT", b"IEND")
"""Chunks that mimoc writes; others can have compressed texts inside."""
_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}  # Numbers of a pixel by colour type (PNG specification, table 11.1).
_NAME_BYTES = 40  # The name of a bone in MuJoCo's files of skins.


def check_assets(files: Mapping[str, bytes], references: Mapping[str, str]) -> None:
    """Raise a BundleError if a file that the MJCF refers to, by element and path, is missing, damaged or too large."""
    sizes = dict.fromkeys(_CHECKS, 0)
    for path, element in references.items():
        if path not in files:
            raise BundleError(f"{path}: <{element}> refers to it, but it is not among the files of the bundle")
        try:
            sizes[element] += _CHECKS[element](files[path])
        except UnusableFileError as error:
            raise BundleError(f"{path}: {error}") from None
        if sizes[element] > _MAX_SIZES[element]:
            raise BundleError(f"{path}: with this one, every <{element}> together is larger than any infant needs")


def pixels_of(content: bytes, *, is_ours: bool = True) -> int:
    """Return the number of pixels of a PNG; UnusableFileError if it is none, too large, or unpacks to more.

    If it *is_ours* it may only contain what mimoc writes; other programs also write 16 bits, texts and profiles.
    """
    data = b"".join(_chunks(content, is_ours))
    width, height, depth, colour = struct.unpack_from(">IIBB", content, 16)
    if not 0 < width <= MAX_SIDE_PX or not 0 < height <= MAX_SIDE_PX:
        raise UnusableFileError(
            f"it says that it has {width:,} x {height:,} pixels; at most {MAX_SIDE_PX:,} a side may be"
        )
    if depth > (8 if is_ours else 16) or colour not in _CHANNELS:
        raise UnusableFileError("its colours are of a kind that mimoc never writes")
    if len(data) > SURELY_SMALL:
        bytes_of_all = (1 + (width * _CHANNELS[colour] * depth + 7) // 8) * height
        most = bytes_of_all if is_ours else 2 * bytes_of_all  # Interlaced ones have more rows, each with a byte more.
        unpacked = zlib.decompressobj()
        try:
            size = len(unpacked.decompress(data, most + 1))
        except zlib.error:
            size = 0
        if not bytes_of_all <= size <= most:
            raise UnusableFileError("it has not as many pixels as it says")
    return width * height


def _chunks(content: bytes, is_ours: bool) -> list[bytes]:
    """Return the compressed data of a PNG, checked chunk by chunk."""
    if content[:8] != _SIGNATURE or content[12:16] != b"IHDR" or len(content) < 45:
        raise UnusableFileError("it is not a PNG")
    place, compressed = 8, []
    while place + 12 <= len(content):
        size, kind = struct.unpack_from(">I4s", content, place)
        if (is_ours and kind not in _CHUNKS) or place + 12 + size > len(content):
            raise UnusableFileError("it is damaged, or not a PNG as mimoc writes it")
        if kind == b"IDAT":
            compressed.append(content[place + 8 : place + 8 + size])
        place += 12 + size
    return compressed


def _mesh_bytes(content: bytes) -> int:
    if content.translate(None, b"0123456789-+.e \nvf") or content[:2] != b"v ":
        raise UnusableFileError("it is not an OBJ of vertices and triangles alone")
    if content.count(b"f") > MAX_FACES or content.count(b"v") > MAX_FACES:
        raise UnusableFileError(f"it has more than {MAX_FACES:,} triangles")
    return len(content)


def _vertices(content: bytes) -> int:
    if len(content) < 16:
        raise UnusableFileError("it is not a skin")
    verts, texcoords, faces, bones = np.frombuffer(content, "<i4", 4).tolist()
    if min(verts, faces, bones) < 1 or texcoords not in (0, verts) or verts > MAX_VERTICES:
        raise UnusableFileError("its sizes are not those of a skin")
    place = 16 + 12 * verts + 8 * texcoords
    indices = _indices(content, place, 3 * faces, verts)
    place += indices
    for _ in range(bones):
        head = place + _NAME_BYTES + 28
        count = int(_integers(content, head, 1)[0])
        place = head + 4 + 2 * _indices(content, head + 4, count, verts)
    if place != len(content):
        raise UnusableFileError("it is longer or shorter than it says")
    return verts


def _indices(content: bytes, place: int, count: int, verts: int) -> int:
    vertices = _integers(content, place, count)
    if len(vertices) and (vertices.min() < 0 or vertices.max() >= verts):
        raise UnusableFileError("it refers to vertices that it does not have")
    return 4 * count


def _integers(content: bytes, place: int, count: int) -> "np.ndarray":
    if count < 0 or place + 4 * count > len(content):
        raise UnusableFileError("it is longer or shorter than it says")
    return np.frombuffer(content, "<i4", count, place)


_CHECKS: Mapping[str, Callable[[bytes], int]] = {"texture": pixels_of, "mesh": _mesh_bytes, "skin": _vertices}
_MAX_SIZES = {"texture": MAX_PIXELS, "mesh": MAX_MESH_BYTES, "skin": MAX_VERTICES}
