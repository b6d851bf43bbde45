"""Preferential looking: which gratings infants prefer to grey, by frequency and contrast, through their own eyes."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from statistics import NormalDist
from types import TracebackType
from typing import Any, Self, cast

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.quantities import Quantity
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_posed, mjcf_of, prepare
from mimoc.bundle.variants import Variant
from mimoc.compiler import building
from mimoc.components.senses.vision.build import acuity_at
from mimoc.components.senses.vision.filters import BLUE, GREEN, RED
from mimoc.components.senses.vision.run import Vision
from mimoc.components.senses.vision.thresholds import sensitivity_at
from mimoc.render.plots import Dots, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.studies.experiment import Experiment, Results, Table, child, grid
from mimoc.studies.notebook import PAGES, markdown_table, months_text

PATCH_M, ASIDE_M = 0.125, 0.12
"""Side of a square grating, as on the Teller Acuity Cards, and where its middle is, left or right of the card's."""
BOARD_M = (1.2, 1.2)
"""Width and height of the card: all that is seen, so that contrast to it is contrast to the mean of a picture."""
THICK_M, AHEAD_M = 0.001, 0.0005  # Half the thickness of card and grating, and how far the grating stands out.
TEXTURE_PX = 2048
GREY, AMPLITUDE = 128, 127  # Mean and amplitude of the texture, of 255 levels.
EMISSION = 0.35  # Light of the card's own, with which its mean is about half of the brightest that a picture can hold.
MARGIN = 0.8  # Part of a patch, from its middle, that is looked at: what is around it is no part of the grating.
WEIGHTS = np.array([RED, GREEN, BLUE])


@dataclass(frozen=True, slots=True)
class Eyes:
    """What an infant sees with, and at which distance a card is held."""

    age_months: float
    distance_m: float
    size_px: int
    fovy_deg: float
    keys: tuple[tuple[str, Any], ...] = ()  # Further keys of its sense of vision, with their values.


@dataclass(frozen=True, slots=True)
class Seen:
    """Contrast at the frequency of the grating on both sides of a card, left and right: amplitude over mean."""

    drawn: FloatArray  # As MuJoCo draws it, without an infant's eye in between: what a photometer says.
    observed: FloatArray  # As the infant observes it.


@cache
def looking_infant(eyes: Eyes) -> Bundle:
    """Return an average child that sits, held by hip, chest and head, and looks straight ahead."""
    size = {"width_px": eyes.size_px, "height_px": eyes.size_px, "fovy_deg": eyes.fovy_deg}
    senses = {"vision": {**size, **dict(eyes.keys)}}
    actuation = {"locked": ["eyes", "neck"]}
    scene = {"kind": "empty", "pose": "sitting", "held": ["hip", "chest", "head"]}
    spec = child("looking", eyes.age_months, senses=senses, actuation=actuation, scene=scene)
    return building.builder(spec)(0, check=False)


class CardTrial:
    """An infant before a card with a grating of vertical bars on its right side, as the infant sees it.

    Cycles per degree are those in the middle of the picture, where degrees are largest.
    """

    def __init__(self, eyes: Eyes, frequency_cpd: float):
        bundle = looking_infant(eyes)
        patch_deg = math.degrees(PATCH_M / eyes.distance_m)
        cycles = max(1, round(frequency_cpd * patch_deg))
        self.frequency_cpd = cycles / patch_deg
        """Frequency of the grating: the next with whole cycles, whose mean is the grey of the card."""
        self._env = InfantEnv(Variant(bundle, _with_card(bundle, eyes.distance_m, cycles)))
        self._whole_cycles, self._cycles = cycles, cycles * MARGIN
        self._windows = [self._window(eye.camera) for eye in bundle.manifest.anatomy.eyes]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._env.close()

    def look(self, contrast: float = 1.0) -> Seen:
        """Return what is drawn and observed of a grating that is printed with a contrast."""
        env, vision = self._env, cast(Vision, self._env.senses["vision"])
        texture = env.model.texture("bars")
        start = texture.adr[0]
        bars = _bars(self._whole_cycles, contrast)
        env.model.tex_data[start : start + bars.size] = bars.ravel()
        vision.eyes.use_model(env.model)
        observation, _ = env.reset(seed=0)  # Without a step, in which slow eyes would still see what was before.
        drawn = vision.eyes(env.data)
        observed = [observation[name] for name in vision.spaces]
        return Seen(self._contrasts(drawn), self._contrasts(observed))

    def _contrasts(self, pictures: Any) -> FloatArray:
        of_eyes = list[list[float]]()
        for picture, windows in zip(pictures, self._windows, strict=True):
            height = len(picture)
            cut = [np.rint(height * window).astype(int) for window in windows]
            sides = [picture[top:bottom, left:right] @ WEIGHTS for top, bottom, left, right in cut]
            of_eyes.append([_contrast(side.mean(axis=0), self._cycles) for side in sides])
        return np.mean(of_eyes, axis=0)

    def _window(self, camera: str) -> list[FloatArray]:
        """Return where an eye sees both sides: top, bottom, left, right, as shares of the picture's height."""
        model, data = self._env.model, self._env.data
        eye = data.camera(camera)
        scale = 2 * math.tan(math.radians(model.camera(camera).fovy[0]) / 2)
        windows = []
        for side in ("plain", "grating"):
            right_m, up_m, back_m = eye.xmat.reshape(3, 3).T @ (data.geom(side).xpos - eye.xpos)
            middle = np.array([right_m, -up_m]) / -back_m / scale + 0.5
            half = MARGIN * PATCH_M / 2 / -back_m / scale
            windows.append(np.array([middle[1] - half, middle[1] + half, middle[0] - half, middle[0] + half]))
        return windows


def _bars(cycles: int, contrast: float) -> npt.NDArray[np.uint8]:
    """Return a texture of vertical bars, shape (4, columns, 3)."""
    wave = np.sin(2 * np.pi * cycles * (np.arange(TEXTURE_PX) + 0.5) / TEXTURE_PX)
    levels = np.rint(GREY + AMPLITUDE * contrast * wave).astype(np.uint8)
    return np.broadcast_to(levels[None, :, None], (4, TEXTURE_PX, 3))


def _contrast(columns: FloatArray, cycles: float) -> float:
    """Return the contrast of bars of some cycles in the mean luminance of columns, by least squares."""
    angles = 2 * np.pi * cycles * (np.arange(len(columns)) + 0.5) / len(columns)
    waves = np.stack([np.cos(angles), np.sin(angles), np.ones(len(columns))], axis=1)
    cosine, sine, mean = np.linalg.lstsq(waves, columns, rcond=None)[0]
    return math.hypot(cosine, sine) / max(mean, 1.0)


def _with_card(bundle: Bundle, distance_m: float, cycles: int) -> mujoco.MjModel:
    """Return an infant's model with a card straight before its eyes."""
    _, data = load_posed(bundle)
    cameras = [data.camera(name) for name in (eye.camera for eye in bundle.manifest.anatomy.eyes)]
    frame = cameras[0].xmat.reshape(3, 3)
    middle_m = np.mean([camera.xpos for camera in cameras], axis=0) - distance_m * frame[:, 2]
    scene, assets = mjcf_of(bundle.files, bundle.manifest.scene)
    spec = mujoco.MjSpec.from_string(scene, assets=assets)
    for name, rows in (("bars", _bars(cycles, 1.0)), ("grey", _bars(1, 0.0))):
        texture = spec.add_texture(
            name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, height=rows.shape[0], width=rows.shape[1], nchannel=3
        )
        texture.data = rows.tobytes()
        material = spec.add_material(name=name, specular=0.0, shininess=0.0, emission=EMISSION)
        material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
    quat = np.empty(4)
    mujoco.mju_mat2Quat(quat, frame.ravel())
    for name, aside_m, ahead_m, size_m, material in (
        ("card", 0.0, 0.0, BOARD_M, "grey"),
        ("plain", -ASIDE_M, AHEAD_M, (PATCH_M, PATCH_M), "grey"),
        ("grating", ASIDE_M, AHEAD_M, (PATCH_M, PATCH_M), "bars"),
    ):
        spec.worldbody.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[size_m[0] / 2, size_m[1] / 2, THICK_M],
            pos=middle_m + aside_m * frame[:, 0] + ahead_m * frame[:, 2],
            quat=quat,
            material=material,
            contype=0,
            conaffinity=0,
        )
    model = spec.compile()
    prepare(model)
    return model


AGES_MONTHS: Sequence[float] = (1, 3, 6, 12)
FAR_FROM_MONTHS = 6
NEAR_M, FAR_M = 0.38, 0.84
"""Distance of the card before that age, and from it on; both are used with the Teller Acuity Cards."""
HALF_WIDTH_M = 0.21  # What is seen to each side of the middle of the card.
SIZE_PX = 512
NOISE = 0.003  # Standard deviation of the noise of the decision, on each side, as a contrast.
RIGHT = 0.75  # Share of right choices at the threshold, as is usual with two sides.
MATURING = tuple((key, "age") for key in ("contrast", "colour", "field", "focus", "flicker"))
PLAIN, MATURE_KEYS, USUAL, CONTRAST = KINDS = "acuity alone", "all that matures", "64 x 64 pixels", "contrast"
ACUITY_SHARES: Sequence[float] = (0.5, 0.65, 0.8, 0.88, 0.94, 0.98, 1.02, 1.06, 1.15)
USUAL_CPD: Sequence[float] = (0.2, 0.3, 0.4, 0.44, 0.48, 0.52)
"""Frequencies for eyes of 64 x 64 pixels over 60 degrees, which hold up to .48 cycles per degree."""
CONTRAST_CPD: Sequence[float] = (0.25, 0.5, 1.0, 2.0, 4.0)
THRESHOLD_SHARES: Sequence[float] = np.geomspace(0.7, 1.6, 14).tolist()
"""Contrasts of gratings, relative to the entered threshold."""
MAX_CONTRAST, PROBE = 0.85, 0.5
"""Largest contrast of a card, and that of the one by which it is found out how much contrast pictures of it have."""
CUT_OFFS_CPD = {1.0: 2.4, 3.0: 4.0}
"""Cut-offs of Banks & Salapatek 1978, Invest Ophthalmol Vis Sci 17: 361, by preferential looking."""


@dataclass(frozen=True, slots=True)
class Threshold:
    """Where an infant chooses the grating in three of four trials."""

    age_months: float
    entered: float  # What its eyes are built with.
    measured: float  # NaN if no grating was preferred.

    @property
    def ratio(self) -> float:
        """The measured over the entered one."""
        return self.measured / self.entered


@dataclass(frozen=True, slots=True)
class Case:
    """An infant of an age, and with which eyes it looks."""

    age_months: float
    eyes: str  # One of the above, or `CONTRAST` for thresholds of contrast with all that matures.


def look(case: Case, seed: int) -> Any:
    """Return the finest grating that an infant prefers, or its thresholds of contrast by frequency."""
    age_months = case.age_months
    if case.eyes == CONTRAST:
        return dict(contrast_thresholds(age_months))
    if case.eyes == USUAL:
        return acuity(age_months, Eyes(age_months, NEAR_M, 64, 60.0), USUAL_CPD)
    return acuity(age_months, eyes_of(age_months, MATURING if case.eyes == MATURE_KEYS else ()))


def _thresholds(results: Results, eyes: str) -> list[Threshold]:
    return [found for case, (found,) in results.by_case.items() if case.eyes == eyes]


def _contrasts(results: Results) -> list[tuple[float, float, Threshold]]:
    """Return age, frequency and threshold of all gratings whose contrast was varied."""
    found = {case.age_months: it for case, (it,) in results.by_case.items() if case.eyes == CONTRAST}
    return [(age, frequency_cpd, it) for age, items in found.items() for frequency_cpd, it in items.items()]


def _numbers(results: Results) -> dict[str, object]:
    contrasts = _contrasts(results)
    headings = ("months", "cycles/degree", "entered threshold [%]", "measured [%]", "measured / entered")
    rows = (
        [f"{age:g}", f"{at:.2f}", f"{100 * item.entered:.1f}", f"{100 * item.measured:.1f}", f"{item.ratio:.2f}"]
        for age, at, item in contrasts
    )
    return {
        "size": SIZE_PX,
        "near": 100 * NEAR_M,
        "far": 100 * FAR_M,
        "far_from": FAR_FROM_MONTHS,
        "noise": 100 * NOISE,
        "acuities": _acuity_table(*(_thresholds(results, eyes) for eyes in (PLAIN, MATURE_KEYS, USUAL))),
        "contrasts": markdown_table(headings, rows),
        "plain_error": max(abs(item.ratio - 1) for item in _thresholds(results, PLAIN)) * 100,
        "contrast_error": max(abs(item.ratio - 1) for *_, item in contrasts) * 100,
        "contrast_count": len(contrasts),
    }


def eyes_of(age_months: float, keys: tuple[tuple[str, str], ...] = ()) -> Eyes:
    """Return eyes with as fine a picture of the card as its gratings need."""
    distance_m = FAR_M if age_months >= FAR_FROM_MONTHS else NEAR_M
    return Eyes(age_months, distance_m, SIZE_PX, 2 * math.degrees(math.atan(HALF_WIDTH_M / distance_m)), keys)


def right_choices(contrasts: FloatArray) -> float:
    """Return Φ(d / (s √2)), the share of right choices with the difference d of contrasts and noise s on each side."""
    plain, grating = contrasts
    return NormalDist(0, NOISE * math.sqrt(2)).cdf(float(grating - plain))


def acuity(age_months: float, eyes: Eyes, frequencies_cpd: Sequence[float] = ()) -> Threshold:
    """Return the finest grating that is preferred."""
    entered_cpd = acuity_at(age_months, "tac2")
    tried_cpd, shares = list[float](), list[float]()
    for frequency_cpd in frequencies_cpd or [share * entered_cpd for share in ACUITY_SHARES]:
        with CardTrial(eyes, frequency_cpd) as trial:
            tried_cpd.append(trial.frequency_cpd)
            shares.append(right_choices(trial.look().observed))
    return Threshold(age_months, entered_cpd, crossing(tried_cpd[::-1], shares[::-1]))


def contrast_thresholds(age_months: float) -> Iterator[tuple[float, Threshold]]:
    """Yield the frequencies at which an infant's contrast threshold can be measured, with it."""
    eyes = eyes_of(age_months, MATURING)
    entry = looking_infant(eyes).manifest.senses.vision
    assert entry is not None, "it sees"
    peak, peak_cpd = entry.sensitivity or math.nan, entry.sensitivity_peak_cpd or math.nan
    for wanted_cpd in CONTRAST_CPD:
        with CardTrial(eyes, wanted_cpd) as trial:
            frequency_cpd = trial.frequency_cpd
            entered = 1 / float(sensitivity_at(np.array(frequency_cpd), peak, peak_cpd))
            if entered * THRESHOLD_SHARES[-1] > MAX_CONTRAST:
                continue
            drawn_share = float(trial.look(PROBE).drawn[1]) / PROBE  # Textures are smoothed where they are drawn small.
            printed = [min(entered * share / drawn_share, 1.0) for share in THRESHOLD_SHARES]
            seen = [trial.look(contrast) for contrast in printed]
            shares = [right_choices(item.observed) for item in seen]
        drawn = [float(item.drawn[1]) for item in seen]
        yield frequency_cpd, Threshold(age_months, entered, crossing(drawn, shares))


def crossing(values: Sequence[float], shares: Sequence[float]) -> float:
    """Return from which value on the share of right choices is at the threshold, by logarithms of values; or NaN."""
    missed = [index for index, share in enumerate(shares) if share < RIGHT]
    if not missed or missed[-1] + 1 == len(shares):
        return math.nan if missed else float(values[0])
    before, after = missed[-1], missed[-1] + 1
    part = (RIGHT - shares[before]) / (shares[after] - shares[before])
    return float(values[before] * (values[after] / values[before]) ** part)


def _acuity_table(plain: Sequence[Threshold], mature: Sequence[Threshold], usual: Sequence[Threshold]) -> str:
    headings = (
        *("months", "entered [cycles/degree]", PLAIN, MATURE_KEYS, USUAL),
        *("Mayer et al. 1995", "Banks & Salapatek 1978"),
    )
    rows = (
        [
            f"{item.age_months:g}",
            *(f"{value:.2f}" for value in (item.entered, item.measured, full.measured, coarse.measured)),
            f"{acuity_at(item.age_months, 'mayer1995'):.2f}",
            f"{CUT_OFFS_CPD[item.age_months]:g}" if item.age_months in CUT_OFFS_CPD else "",
        ]
        for item, full, coarse in zip(plain, mature, usual, strict=True)
    )
    return markdown_table(headings, rows)


def _plots(results: Results) -> list[Plot]:
    x = Quantity("age_months", "Age", "months")
    y = Quantity("acuity_cpd", "Finest grating preferred", "cycles/degree")
    measured = {eyes: _thresholds(results, eyes) for eyes in (PLAIN, MATURE_KEYS)}
    ages = [item.age_months for item in measured[PLAIN]]
    profiles = {"tac2": "entered", "mayer1995": "Mayer et al. 1995"}
    lines = tuple(Line(ages, [acuity_at(age, name) for age in ages], label) for name, label in profiles.items())
    dots = tuple(Dots(ages, [item.measured for item in items], label) for label, items in measured.items())
    return [Plot(x, y, lines, dots=dots, title="Acuity"), _contrast_plot(results, ages)]


def _contrast_plot(results: Results, ages: Sequence[float]) -> Plot:
    lines, dots = [], []
    for age in ages:
        items = [(at, item) for months, at, item in _contrasts(results) if months == age]
        label = months_text(age)
        at = np.log2([frequency for frequency, _ in items])
        lines.append(Line(at, np.log10([1 / item.entered for _, item in items]), label))
        dots.append(Dots(at, np.log10([1 / item.measured for _, item in items]), label))
    x = Quantity("frequency", "Spatial frequency", "log2 of cycles/degree")
    y = Quantity("sensitivity", "Contrast sensitivity", "log10")
    return Plot(x, y, tuple(lines), dots=tuple(dots), title="Contrast sensitivity")


def _acuities(results: Results) -> Table:
    return "age_months,eyes,entered_cpd,measured_cpd", (
        (item.age_months, eyes, item.entered, item.measured)
        for eyes in (PLAIN, MATURE_KEYS, USUAL)
        for item in _thresholds(results, eyes)
    )


EXPERIMENT = Experiment(
    name="looking",
    trial=look,
    cases=grid(Case, eyes=KINDS, age_months=AGES_MONTHS),
    quick={"cases": grid(Case, eyes=KINDS, age_months=(1, 6))},
    kept=False,
    files={
        "acuity.csv": _acuities,
        "contrast.csv": lambda results: (
            "age_months,frequency_cpd,entered,measured",
            ((age, at, item.entered, item.measured) for age, at, item in _contrasts(results)),
        ),
        "looking.png": _plots,
    },
    page=PAGES / "looking.md",
    numbers=_numbers,
    infants=lambda law: (looking_infant(eyes_of(age)) for age in AGES_MONTHS),
)
