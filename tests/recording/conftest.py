"""A short way to an infant that can be filmed, and to what a film shows."""

from collections.abc import Callable, Iterator
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image, ImageSequence

import mimoc


@pytest.fixture(scope="session")
def bundle() -> mimoc.Bundle:
    spec = {"mimoc": 1, "name": "infant", "age_months": 9, "scene": {"pose": "sitting"}}
    return mimoc.build(
        mimoc.InfantSpec.model_validate(spec | {"senses": {"vision": {"width_px": 16, "height_px": 16}}})
    )


@pytest.fixture
def env(bundle) -> Iterator[mimoc.InfantEnv]:
    """Return its environment, without shadows, which take time to draw."""
    env = mimoc.InfantEnv(bundle)
    env.model.vis.quality.shadowsize = 0
    yield env
    env.close()


@pytest.fixture(scope="session")
def watch() -> Callable[[Path], tuple[np.ndarray, list[float]]]:
    """Return what decodes a film: its pictures, shape (n, height, width, 3), and when each one ends, in s."""

    def decode(file: Path) -> tuple[np.ndarray, list[float]]:
        if file.suffix == ".gif":
            with Image.open(file) as image:
                shown = ImageSequence.Iterator(image)
                frames = [(np.asarray(frame.convert("RGB")), frame.info["duration"]) for frame in shown]
            return np.stack([picture for picture, _ in frames]), list(np.cumsum([ms for _, ms in frames]) / 1000)
        with av.open(file) as container:
            frames = [(frame.to_ndarray(format="rgb24"), frame.time) for frame in container.decode(video=0)]
            length_s = container.duration / av.time_base
        return np.stack([picture for picture, _ in frames]), [*(time_s for _, time_s in frames[1:]), length_s]

    return decode
