"""An infant that reaches in episodes of a third of a second, and trainings that take a second."""

import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from support import store

import mimoc
from mimoc.bundle.io import unpack_arrays
from mimoc.render.plots import Sheet, encode

TINY = {
    "ppo": {"n_steps": 32, "batch_size": 64, "n_epochs": 1, "width": 8, "layers": 1},
    "sac": {"learning_starts": 20, "batch_size": 16, "buffer_size": 100, "width": 8, "layers": 1},
}
EVERY = 128  # Steps between checkpoints.


def build(**keys: Any) -> mimoc.Bundle:
    spec = {
        "mimoc": 1,
        "name": "reaching",
        "age_months": 18,
        "senses": {"proprioception": {}},
        "task": {"kind": "reach", "steps": 30},
    }
    return store.built({**spec, **keys})


@pytest.fixture(scope="session", autouse=True)
def _curves_of_one_length_are_drawn_once() -> Iterator[None]:
    """Draw a learning curve only if there was none as long before: it takes longer than a short training."""
    try:
        from mimoc.training import trainer
    except ModuleNotFoundError:  # Then nothing trains.
        yield
        return
    pictures: dict[tuple[int, ...], bytes] = {}

    def draw(sheet: Sheet) -> bytes:
        lengths = tuple(len(line.x) for plot in sheet.plots for line in plot.lines)
        pictures[lengths] = pictures.get(lengths) or encode(sheet)
        return pictures[lengths]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(trainer, "encode", draw)
        yield


@pytest.fixture(scope="session")
def built() -> Callable[..., mimoc.Bundle]:
    return build


@pytest.fixture(scope="session")
def bundle() -> mimoc.Bundle:
    return build()


@pytest.fixture
def learn(bundle, tmp_path) -> Callable[..., Any]:
    def train(name: str = "run", steps: int = 2 * EVERY, algo: str = "ppo", **options: Any) -> Any:
        source = options.pop("source", bundle)
        options = {"envs": 2, "checkpoint_every": EVERY, "hyper": TINY[algo]} | options
        return mimoc.train(source, tmp_path / name, steps=steps, algo=algo, **options)

    return train


@pytest.fixture(scope="session")
def trained(bundle, tmp_path_factory) -> Path:
    """Return the folder of a training, which is only to be read."""
    folder = tmp_path_factory.mktemp("runs") / "trained"
    mimoc.train(bundle, folder, steps=EVERY, envs=2, checkpoint_every=EVERY, hyper=TINY["ppo"])
    return folder


@pytest.fixture(scope="session")
def learned() -> Callable[[Path], Any]:
    import torch

    def read(policy: Path) -> Any:
        with zipfile.ZipFile(policy) as archive:
            weights = unpack_arrays(archive.read("weights.npz"))
            tensors = {name: torch.from_numpy(array.copy()) for name, array in weights.items()}
            return tensors, archive.read("scale.npz")

    return read


@pytest.fixture(scope="session")
def same() -> Callable[[Any, Any], bool]:
    """Return what says whether two nests of dictionaries, lists and tensors are the same to the bit."""
    return is_same


def is_same(ours: Any, theirs: Any) -> bool:
    import torch

    if isinstance(ours, torch.Tensor):
        return torch.equal(ours, theirs)
    if isinstance(ours, dict):
        return ours.keys() == theirs.keys() and all(is_same(ours[key], theirs[key]) for key in ours)
    if isinstance(ours, (list, tuple)):
        return len(ours) == len(theirs) and all(map(is_same, ours, theirs))
    return bool(ours == theirs)
