"""A grey card with a grating on one side, held before the eyes of an infant, and what the infant observes of it."""

import math
from dataclasses import dataclass
from functools import cache
from types import TracebackType
from typing import Any, Self, cast

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_posed, mjcf_of, prepare
from mimoc.bundle.variants import Variant
from mimoc.compiler import building
from mimoc.components.senses.vision.colours import BLUE, GREEN, RED
from mimoc.components.senses.vision.run import Vision
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.studies.experiments.notebook import child

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
    senses, actuation = {"vision": {**size, **dict(eyes.keys)}}, {"locked": ["eyes", "neck"]}
    scene = {"kind": "empty", "pose": "sitting", "held": ["hip", "chest", "head"]}
    spec = child("looking", eyes.age_months, senses=senses, actuation=actuation, scene=scene)
    return building.builder(spec)(0, check=False)


class CardTrial:
    """An infant before a card with a grating of vertical bars on its right side, as the infant sees it.

    Cycles per degree are those in the middle of the picture, where degrees are largest.
    """

    def __init__(self, eyes: Eyes, frequency_cpd: float):
        bundle, patch_deg = looking_infant(eyes), math.degrees(PATCH_M / eyes.distance_m)
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
        eye, scale = data.camera(camera), 2 * math.tan(math.radians(model.camera(camera).fovy[0]) / 2)
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
