"""Whether MJCF is what mimoc writes, before MuJoCo reads any of it: which elements and attributes, and how many."""

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NoReturn
from xml.parsers import expat

from mimoc.base.errors import BundleError


@dataclass(frozen=True, slots=True, eq=False)
class Words:
    """Some words, and no others."""

    words: frozenset[str]

    def allow(self, values: Iterable[str]) -> bool:
        """Return whether all of some values are among the words."""
        return self.words.issuperset(values)


@dataclass(frozen=True, slots=True, eq=False)
class Text:
    """Text of some characters; all values of a file are looked at together, which takes a tenth of the time."""

    characters: frozenset[str] | None
    """The characters it consists of; None for all that can be seen, and blanks."""
    forbidden: re.Pattern[str] | None
    """Matches what it may not contain."""
    longest: int
    """Characters of the longest value."""

    def allow(self, values: Iterable[str]) -> bool:
        """Return whether all of some values are such texts."""
        text = " ".join(values)
        if self.forbidden and self.forbidden.search(text):
            return False
        if not (text.isprintable() if self.characters is None else self.characters.issuperset(text)):
            return False
        return len(text) <= self.longest or max(map(len, values)) <= self.longest


@dataclass(frozen=True, slots=True, eq=False)
class Shaped:
    """Text of some shape, in few attributes."""

    shape: re.Pattern[str]

    def allow(self, values: Iterable[str]) -> bool:
        """Return whether all of some values have the shape."""
        return all(map(self.shape.fullmatch, values))


Values = Words | Text | Shaped
"""What the values of an attribute may be."""


def _words(words: str) -> Words:
    return Words(frozenset(words.split()))


def _file(suffix: str) -> Shaped:
    """Among the assets, without `..`, blanks or anything else that two programs could read in two ways."""
    return Shaped(re.compile(rf"assets/(?:[\w-][\w.+-]*/){{0,4}}[\w-][\w.+-]{{0,200}}\.{suffix}", re.ASCII))


NUMBERS = Text(frozenset("0123456789-+.e "), re.compile(r"e(?:\+?0*[1-9][0-9]|-[0-9]{4})"), 100_000)
"""One number or several, without exponents above 9. MuJoCo knows how many there must be."""
NAME = Text(None, None, 200)
FLAG = _words("true false auto enable disable 0 1")
COUNT = Words(frozenset(map(str, range(100))))
ITERATIONS = Words(frozenset(map(str, range(1, 101))))
PIXELS = Words(frozenset(map(str, range(1, 4097))))
WORD = Shaped(re.compile("[a-zA-Z0-9]{1,20}"))
CLASS = _words("infant")
HERE = _words(".")


def _of(names: str, values: Values) -> dict[str, Values]:
    return dict.fromkeys(names.split(), values)


_SOFT = _of("solref solimp solreflimit solimplimit solreffriction solimpfriction margin gap solmix", NUMBERS)
_MASKS = _of("contype conaffinity condim priority", COUNT)
_SENSORS = "torque gyro accelerometer force touch velocimeter magnetometer rangefinder framepos framequat framelinvel"

ELEMENTS: Mapping[str, Mapping[str, Values]] = {
    "mujoco": {"model": NAME},
    "include": {"file": _words("infant.xml")},
    "compiler": {
        "angle": _words("radian"),
        "eulerseq": _words("xyz"),
        "autolimits": _words("false"),
        **_of("texturedir meshdir", HERE),
        "boundinertia": NUMBERS,
    },
    "option": {
        "timestep": NUMBERS,
        **_of("integrator cone jacobian solver", WORD),
        **_of("iterations ls_iterations", ITERATIONS),
        **_of("tolerance ls_tolerance gravity", NUMBERS),
    },
    "flag": _of("multiccd nativeccd eulerdamp island energy sensor", FLAG),
    "size": {"nuser_actuator": COUNT},
    "statistic": _of("center extent", NUMBERS),
    "visual": {},
    "global": {**_of("offwidth offheight", PIXELS), **_of("azimuth elevation fovy", NUMBERS)},
    "headlight": {"active": FLAG, **_of("ambient diffuse specular", NUMBERS)},
    "quality": {"shadowsize": PIXELS, **_of("numslices numstacks offsamples", COUNT)},
    "map": _of("znear zfar shadowclip", NUMBERS),
    "rgba": _of("haze fog", NUMBERS),
    "default": {"class": CLASS},
    "asset": {},
    "texture": {
        "name": NAME,
        **_of("type builtin", WORD),
        **_of("rgb1 rgb2", NUMBERS),
        **_of("width height", PIXELS),
        "file": _file("png"),
        "gridsize": Shaped(re.compile("[1-6] [1-6]")),
        "gridlayout": Shaped(re.compile("[.RLUDFB]{1,12}")),
    },
    "material": {
        "name": NAME,
        "rgba": NUMBERS,
        "texture": NAME,
        "texrepeat": NUMBERS,
        "texuniform": FLAG,
        **_of("specular shininess reflectance emission", NUMBERS),
    },
    "mesh": {"name": NAME, "file": _file("obj"), "inertia": _words("shell convex exact legacy")},
    "worldbody": {},
    "light": {
        "name": NAME,
        "directional": FLAG,
        **_of("pos dir diffuse specular ambient attenuation cutoff exponent", NUMBERS),
        "castshadow": FLAG,
    },
    "body": {"name": NAME, **_of("pos euler quat", NUMBERS), "childclass": CLASS, "mocap": FLAG},
    "freejoint": {"name": NAME},
    "joint": {
        **_of("name joint joint1", NAME),
        "type": _words("hinge"),
        **_of("limited active", FLAG),
        **_of("axis pos range stiffness damping frictionloss armature springref coef polycoef", NUMBERS),
        **_SOFT,
    },
    "geom": {
        "name": NAME,
        "type": _words("plane sphere capsule ellipsoid cylinder box mesh"),
        "mesh": NAME,
        **_of("size pos euler quat mass rgba", NUMBERS),
        "material": NAME,
        **_MASKS,
        "friction": NUMBERS,
        **_SOFT,
        "group": COUNT,
    },
    "site": {
        "name": NAME,
        "type": _words("sphere capsule ellipsoid cylinder box"),
        **_of("pos size euler quat zaxis fromto rgba", NUMBERS),
        "group": COUNT,
        "material": NAME,
    },
    "camera": {"name": NAME, **_of("pos euler quat fovy", NUMBERS), "mode": WORD, "target": NAME},
    "deformable": {},
    "skin": {"name": NAME, "file": _file("skn"), "material": NAME, "group": COUNT},
    "contact": {},
    "exclude": _of("name body1 body2", NAME),
    "pair": {**_of("name geom1 geom2", NAME), "condim": COUNT, "friction": NUMBERS, **_SOFT},
    "tendon": {},
    "fixed": {"name": NAME, "limited": FLAG, **_of("range stiffness damping frictionloss", NUMBERS), **_SOFT},
    "actuator": {},
    "general": {
        "name": NAME,
        "class": CLASS,
        "joint": NAME,
        **_of("ctrllimited forcelimited actlimited actearly", FLAG),
        **_of("gear ctrlrange forcerange actrange lengthrange", NUMBERS),
        **_of("dyntype gaintype biastype", WORD),
        **_of("dynprm gainprm biasprm user", NUMBERS),
        "group": COUNT,
    },
    "sensor": {},
    **{kind: {**_of("name site objname", NAME), "objtype": WORD} for kind in _SENSORS.split()},
    "equality": {},
    "weld": {**_of("name body1 body2", NAME), "active": FLAG, **_of("anchor relpose torquescale", NUMBERS), **_SOFT},
    "keyframe": {},
    "key": {"name": NAME, **_of("qpos qvel act ctrl mpos mquat time", NUMBERS)},
}
"""What the values of each attribute of each element may be. A sense, a task or a scene of a plug-in prints by the same
templates, so that it is within them as well."""

REFERRING = {"texture", "mesh", "skin"}
"""Elements that refer to files, besides the one `include`."""

MOST: Mapping[str, int] = {
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
MOST_ELEMENTS = 20_000
MOST_BYTES = 2**23
"""Of one file; those of that room have 0.6 MB."""
MOST_DEPTH = 64
"""Elements within each other; in an infant with ten fingers 14."""


_BEYOND_ELEMENTS = re.compile(rb"<[!?]|&#|>\s*+[^<\s]")
"""Where comments, declarations, numbered characters and text between elements begin: mimoc writes none, and parsers
differ in them."""
_SHOWN = 60


def read_mjcf(file: str, content: bytes) -> tuple[Counter[str], dict[str, str]]:
    """Check that a file of MJCF is one that mimoc could have written.

    Args:
        file: Its name, for errors.
        content: The file.

    Returns:
        How many there are of each element, and the element that refers to each other file, by the path of that.

    Raises:
        BundleError: If mimoc writes no such thing; the message says where it is.
    """
    if len(content) > MOST_BYTES:
        raise BundleError(f"{file}: it has more than {MOST_BYTES >> 20} MB, which no infant needs")
    if beyond := _BEYOND_ELEMENTS.search(content):
        line = content.count(b"\n", 0, beyond.start()) + 1
        raise BundleError(f"{file}:{line}: mimoc writes nothing but elements")
    reader = _Reader(file)
    reader.read(content)
    if not all(values.allow(given) for values, given in reader.given.items()):
        _Reader(file, at_once=True).read(content)
    for name, most in MOST.items():
        if (number := reader.counts[name]) > most:
            raise BundleError(f"{file}: {number:,} times <{name}>, where at most {most:,} may be")
    if (number := reader.counts.total()) > MOST_ELEMENTS:
        raise BundleError(f"{file}: {number:,} elements, where at most {MOST_ELEMENTS:,} may be")
    return reader.counts, reader.references


class _Reader:
    """Reads MJCF element by element, and refuses what mimoc does not write."""

    def __init__(self, file: str, *, at_once: bool = False):
        """Begin a file.

        Args:
            file: Its name.
            at_once: Whether to check each value where it is; it takes less time to check them together in the end.
        """
        self.counts, self.references = Counter[str](), dict[str, str]()
        self.given: defaultdict[Values, list[str]] = defaultdict(list)
        """The values of all attributes, by what they may be."""
        self._sinks: dict[str, dict[str, Callable[[str], None]]] = {}
        """What takes the values of each attribute, by element."""
        self._file, self._at_once, self._depth, self._muscles = file, at_once, 0, False
        self._parser: Any = expat.ParserCreate("utf-8")
        self._parser.StartElementHandler, self._parser.EndElementHandler = self._begin, self._end

    def read(self, content: bytes) -> None:
        """Read the whole file."""
        try:
            self._parser.Parse(content, True)
        except (expat.ExpatError, UnicodeDecodeError) as error:
            raise BundleError(f"{self._file}: it is not XML ({error})") from None

    def _begin(self, element: str, attributes: dict[str, str]) -> None:
        sinks = self._sinks.get(element) or self._sinks_of(element)
        self.counts[element] += 1
        self._depth += 1
        if self._depth > MOST_DEPTH:
            self._refuse(f"more than {MOST_DEPTH} elements within each other")
        for name, value in attributes.items():
            if name not in sinks:
                self._refuse(f"{name[:_SHOWN]!r} is not an attribute that mimoc gives <{element}>")
            sinks[name](value)
            if self._at_once and not ELEMENTS[element][name].allow([value]):
                self._refuse(f"{name}={value[:_SHOWN]!r} is not what mimoc writes there")
        if element in REFERRING and "file" in attributes:
            self.references[attributes["file"]] = element
        elif element == "general":
            self._check_muscle(attributes)

    def _sinks_of(self, element: str) -> dict[str, Callable[[str], None]]:
        if element not in ELEMENTS:
            self._refuse(f"<{element[:_SHOWN]}> is not an element that mimoc writes")
        self._sinks[element] = {name: self.given[values].append for name, values in ELEMENTS[element].items()}
        return self._sinks[element]

    def _check_muscle(self, attributes: dict[str, str]) -> None:
        """MuJoCo finds the lengths of a muscle that does not give them by simulating it, which takes long."""
        self._muscles |= "muscle" in (attributes.get("gaintype"), attributes.get("biastype"))
        if self._muscles and "joint" in attributes:
            lengths = attributes.get("lengthrange", "").split()
            if len(lengths) != 2 or not _is_rising(lengths):
                self._refuse("a muscle without a lengthrange")

    def _end(self, element: str) -> None:
        self._depth -= 1

    def _refuse(self, reason: str) -> NoReturn:
        raise BundleError(f"{self._file}:{self._parser.CurrentLineNumber}: {reason}")


def _is_rising(numbers: list[str]) -> bool:
    try:
        return float(numbers[0]) < float(numbers[1])
    except ValueError:
        return False
