"""A sense is one folder and one line: here a tiny one is registered as others would, and used like mimoc's own."""

from dataclasses import dataclass
from typing import Annotated, Literal

import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from pydantic import Field

import mimoc
from mimoc.base.errors import SpecError
from mimoc.body.tree import BodyTree
from mimoc.bundle.io import Bundle
from mimoc.compiler.explain import entries_of, explain
from mimoc.compiler.mjcf.elements import Sensor, Site
from mimoc.compiler.mjcf.scene import Placed
from mimoc.runtime.noise import Noise
from mimoc.runtime.sense import Sample, Vector
from mimoc.schema.base import Model
from mimoc.schema.kinds import AgeTable, NoiseOption, SenseKind
from mimoc.schema.quantities import Real


class HeightSpec(Model):
    """Height of the head above the floor."""

    max_m: Annotated[Real, Field(gt=0, le=10)] = 2.0
    """Largest height that is observed."""


class HeightEntry(Model):
    """Height of the head above the floor."""

    kind: Literal["height"] = "height"
    """Which sense this is."""
    site: str
    """Site in the middle of the head."""
    max_m: float
    """Largest height that is observed."""


def build(spec: HeightSpec, body: BodyTree) -> Placed:
    site = Site("height_site", body.geoms["head"].pos_m, 0.01)
    origin = {"value": spec.max_m, "unit": "m", "rule": "given by the spec", "from": ["spec.senses.height.max_m"]}
    return Placed(
        HeightEntry(site=site.name, max_m=spec.max_m),
        sites={"head": (site,)},
        sensors=(Sensor("velocimeter", "height_velocity", site.name),),
        arrays={"marks_m": np.linspace(0, spec.max_m, 3)},
        origins={"height.max_m": origin},
    )


class Height(Vector):
    """Height of the head, shape (1,), [m]."""

    def __init__(self, site: int, max_m: float):
        super().__init__("height", layout=("head [m]",), low=0.0, high=max_m)
        self._site = site

    def __call__(self, data: mujoco.MjData) -> Sample:
        return data.site_xpos[self._site, 2:].copy()


def bind(entry: HeightEntry, model: mujoco.MjModel, bundle: Bundle) -> Height:
    assert bundle.arrays["height/marks_m"].tolist() == [0, entry.max_m / 2, entry.max_m]
    assert model.sensor("height_velocity").objid[0] == model.site(entry.site).id
    return Height(model.site(entry.site).id, entry.max_m)


@dataclass(frozen=True)
class Blur(Noise):
    """As much too high or too low as drawn."""

    deviation_m: np.ndarray

    def __call__(self, draw, sample, state):
        return sample + self.deviation_m * draw.xp.sign(draw.normals(sample.shape)), None


def bind_blur(deviation_m: float, sense: Height, low_pass_s: float) -> Blur:
    assert (sense.name, low_pass_s) == ("height", 0.06)
    return Blur(np.array([deviation_m]))


KIND = SenseKind(
    name="height",
    spec=HeightSpec,
    entry=HeightEntry,
    build=build,
    run=bind,
    physiological_delay=AgeTable((0.0, 24.0), ms=(60.0, 20.0), legs_ms=(80.0, 40.0)),
    noise=NoiseOption("m", "Error of the height, either way.", most=1.0, run=bind_blur),
)


@pytest.fixture(autouse=True)
def _registered(registered):
    with registered(KIND):
        yield


def spec(**keys) -> mimoc.InfantSpec:
    usual = {"mimoc": 1, "name": "tall", "age_months": 12, "senses": {"height": {"max_m": 1.5}}}
    return mimoc.InfantSpec.model_validate({**usual, **keys})


def heights(env: mimoc.InfantEnv, count: int, command: float = 0.0) -> list[float]:
    env.reset(seed=0)
    action = np.full(env.action_space.shape, command, np.float32)
    return [float(env.step(action)[0]["height"][0]) for _ in range(count)]


def test_it_is_observed_in_its_unit_and_within_its_bounds():
    env = mimoc.InfantEnv(mimoc.build(spec()))
    check_env(env, skip_render_check=True)
    observation, _ = env.reset(seed=0)
    assert observation["height"] == pytest.approx(env.data.geom("head").xpos[2])
    assert env.layout("height") == ("head [m]",)
    assert env.observation_space["height"].high == [1.5]


def test_it_is_late_by_its_own_delay_in_whole_physics_steps():
    prompt, late = (heights(mimoc.InfantEnv(mimoc.build(spec(delays={"height_ms": ms}))), 12, 1.0) for ms in (0, 40))
    assert late[4:] == prompt[:-4]
    assert len(set(prompt)) == len(prompt)


def test_a_preset_knows_its_delay_at_an_age():
    """The delay of the legs does not matter to a sense that does not say in which bodies it measures."""
    bundle = mimoc.build(spec(delays={"preset": "physiological"}))
    assert (bundle.manifest.delays.height.ms, bundle.manifest.delays.height.legs_ms) == (40, 60)
    assert heights(mimoc.InfantEnv(bundle), 12)[4:] == heights(mimoc.InfantEnv(mimoc.build(spec())), 12)[:-4]


def test_it_has_the_noise_of_its_record_and_the_jitter_of_all():
    silent = heights(mimoc.InfantEnv(mimoc.build(spec())), 12)
    noisy = mimoc.build(spec(noise={"height_m": 0.0625}))
    assert noisy.manifest.noise.height_m == 0.0625
    assert explain(noisy, "noise.height_m").lines[0].endswith("0.0625 m")
    errors = np.subtract(heights(mimoc.InfantEnv(noisy), 12), silent)
    assert set(np.round(errors, 6)) == {-0.0625, 0.0625}
    late = heights(mimoc.InfantEnv(mimoc.build(spec(delays={"height_ms": 20}, noise={"delay_jitter_ms": 20}))), 40)
    assert late != heights(mimoc.InfantEnv(mimoc.build(spec(delays={"height_ms": 20}))), 40)
    with pytest.raises(SpecError, match=r"noise\.height_m: 2 is too large; give 0 to 1 m"):
        spec().with_(noise={"height_m": 2})


def test_its_numbers_are_explained():
    bundle = mimoc.build(spec(delays={"height_ms": 40}))
    explained = explain(bundle, "height.max_m")
    assert explained.lines[0].endswith("1.5 m")
    assert [source.key for source in explained.sources] == ["spec.senses.height.max_m"]
    assert entries_of(bundle)["delays.height.ms"]["from"] == ["spec.delays.height_ms"]


@pytest.mark.full
def test_bad_input_is_told_like_any_other(tmp_path):
    (tmp_path / "spec.yaml").write_text(
        "mimoc: 1\nname: x\nage_months: 9\nsenses: {height: {max_m: -1, min_m: 0}}\ndelays: {height_ms: 3}\n"
    )
    with pytest.raises(SpecError) as error:
        mimoc.build(tmp_path / "spec.yaml")
    keys = [problem.key for problem in error.value.problems]
    assert keys == ["senses.height.max_m", "senses.height.min_m", "delays.height_ms"]


def test_a_bundle_of_an_infant_without_it_can_be_read_where_it_is_unknown():
    spec = mimoc.InfantSpec(mimoc=1, name="kim", age_months=9)
    content = mimoc.build(spec).files["manifest.json"]
    assert b"vestibular" in content
    assert b"sound" not in content
