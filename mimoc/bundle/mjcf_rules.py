"""What the MJCF of a bundle may consist of: the elements and attributes that mimoc writes, and how large they get."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol


class Values(Protocol):
    """What the values of an attribute may be."""

    def allow(self, values: Iterable[str]) -> bool:
        """Return whether all of some values are allowed."""
        ...


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
