"""`mimoc.view`: whatever can be shown is the page that the command writes."""

import re
import subprocess
import sys
import webbrowser
from collections.abc import Iterator
from html import unescape

import numpy as np
import pytest
from support.full import full_but
from support.pages import few_ages, read_page
from support.worlds import placed

import mimoc
from mimoc.base.errors import MimocError, OutputError
from mimoc.runtime.opening import shared_world
from mimoc.runtime.world_env import WorldEnv
from mimoc.viewer.growth import own_parts

SPEC = {"mimoc": 1, "name": "shown", "age_months": 9, "scene": {"pose": "supine"}, "body": {"skin": False}}


@pytest.fixture(scope="module", autouse=True)
def pages_of_few_ages() -> Iterator[None]:
    with few_ages():
        yield


@pytest.fixture(scope="module")
def spec() -> mimoc.InfantSpec:
    return mimoc.InfantSpec.model_validate(SPEC)


@pytest.fixture(scope="module")
def shown(spec) -> mimoc.View:
    return mimoc.view(spec)


def test_an_environment_is_shown_as_it_is_now(spec):
    env = mimoc.make(spec)
    env.reset(seed=0)
    for _ in range(20):
        env.step(env.action_space.sample())
    known = read_page(mimoc.view(env).html)
    at_nine = known["ages_months"].index(9)
    inner = env.unwrapped
    now = inner.data.qpos[own_parts(inner.model, inner.manifest).qpos]
    assert known["pose"] == "now"
    assert known["poses"]["now"][at_nine] == pytest.approx(now, abs=1e-6)
    heights_m = known["poses"]["now"][:, 2]
    assert (np.diff(heights_m) * np.sign(now[2]) > 0).all()


def test_a_world_is_shown_by_infant_with_the_others_around_as_they_are():
    """Each is where it is alone, so that its poses suit; from there the others are as far as in the world."""
    near, skinned = {**SPEC, "name": "near"}, {**SPEC, "name": "skinned", "age_months": 0, "body": {"skin": True}}
    world = placed({"anna": near, "ben": skinned}, {"y_cm": 20, "yaw_deg": 90}, {"y_cm": -50})
    env = WorldEnv(world)
    env.reset(seed=0)
    for _ in range(5):
        env.step({name: env.action_space(name).sample() for name in env.agents})
    for view, pose, state in (
        (mimoc.view(world), "supine", WorldEnv(world).data),
        (mimoc.view(env), "now", env.data),
    ):
        infants = read_page(view.html)["infants"]
        assert [(one["name"], one["age_months"], one["pose"]) for one in infants.values()] == [
            ("anna", 9, pose),
            ("ben", 0, pose),
        ]
        anna, ben = infants.values()
        bodies = ben["surroundings"]["bodies"]
        head_m = bodies["pos"][bodies["names"].index("anna_head")]
        hip_m = ben["poses"][pose][ben["ages_months"].index(0)][:3]
        in_world_m = state.body("anna_head").xpos - state.body("ben_hip").xpos
        assert np.linalg.norm(head_m - hip_m) == pytest.approx(np.linalg.norm(in_world_m), abs=1e-5)
        assert (head_m - hip_m)[2] == pytest.approx(in_world_m[2], abs=1e-5)
        meshes = [mesh["verts"].reshape(-1, 3) for mesh in anna["surroundings"]["meshes"]]
        assert np.ptp(np.concatenate(meshes), axis=0).max() > 0.4, "Ben with his skin"
        assert not any("ben" in name for name in ben["surroundings"]["bodies"]["names"])
        materials = len(anna["materials"])
        assert anna["surroundings"]["geoms"]["material"].max() < materials
    with pytest.raises(MimocError, match="physics on a page is that of a single infant"):
        mimoc.view(world, physics=True)


def test_the_first_infants_of_a_vector_environment_are_shown_as_they_are_now(spec):
    envs = mimoc.make_vec(spec, num_envs=9)
    envs.reset(seed=0)
    envs.step(envs.action_space.sample())
    infants = read_page(mimoc.view(envs).html)["infants"]
    assert [*infants] == [str(row) for row in range(8)]
    inner = envs.infants[3]
    at_nine = infants["3"]["ages_months"].index(9)
    now = inner.data.qpos[own_parts(inner.model, inner.manifest).qpos]
    assert infants["3"]["poses"]["now"][at_nine] == pytest.approx(now, abs=1e-6)
    envs.close()


def test_a_recording_of_a_world_is_replayed_with_the_others_around(tmp_path):
    spec = mimoc.InfantSpec.model_validate(SPEC)
    env = mimoc.Recorder(shared_world({"anna": spec, "ben": spec}), tmp_path / "recording")
    env.reset(seed=0)
    for _ in range(3):
        env.step({name: np.full(env.action_space(name).shape, 0.5, np.float32) for name in env.agents})
    in_world_m = env.unwrapped.data.body("anna_head").xpos - env.unwrapped.data.body("ben_hip").xpos
    env.close()
    view = mimoc.view(tmp_path / "recording", infant=1)
    page = read_page(view.html)
    bodies, recording = page["surroundings"]["bodies"], page["recording"]
    assert (view.difference, page["name"], len(recording["qpos"])) == (None, "ben", 4)
    head_m = recording["around"][-1][bodies["names"].index("anna_head"), :3]
    assert head_m - recording["qpos"][-1][:3] == pytest.approx(in_world_m, abs=2e-4)
    assert page["surroundings"]["geoms"]["material"].max() < len(page["materials"])
    with pytest.raises(MimocError, match="physics on a page is that of a single infant"):
        mimoc.view(tmp_path / "recording", infant=1, physics=True)


@pytest.mark.parametrize(
    "keys",
    full_but(
        [
            {"task": {"kind": "standup"}, "scene": {}},
            {"scene": {"kind": "room", "toys": {"count": [3, 3], "size_cm": [85, 90]}}},
        ],
        [
            {"scene": {"kind": "flat", "toys": {"size_cm": [36.891, 68.044]}}},
            {"senses": {"vision": {"body": "skin", "width_px": 8, "height_px": 8}}, "body": {"skin": True}},
        ],
    ),
    ids=[
        "a task that it is too young for at other ages",
        "toys with which it has no room when older",
        "toys on a floor with which it has no room when younger",
        "eyes that see its skin",
    ],
)
def test_whatever_an_infant_does_and_sees_it_is_shown_at_all_ages(keys):
    infant = mimoc.InfantSpec.model_validate({**SPEC, "age_months": 12, **keys})
    known = read_page(mimoc.view(infant).html)
    assert known["ages_months"][0] == 0
    assert known["poses"]


def test_a_notebook_shows_the_page_in_a_frame_of_its_own(shown):
    (inside,) = re.findall(r'sandbox="allow-scripts" .*srcdoc="([^"]*)"', shown._repr_html_(), re.DOTALL)
    assert unescape(inside) == shown.html


def test_it_is_saved_and_opened_where_it_was_saved(shown, tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", lambda address: opened.append(address) or True)
    assert shown.save(tmp_path / "infant.html").read_text(encoding="utf-8") == shown.html
    assert shown.open()
    assert opened == [(tmp_path / "infant.html").as_uri()]


def test_what_cannot_be_shown_or_written_is_refused_before_anything_is_built(spec, tmp_path):
    with pytest.raises(OutputError, match=r"end it in \.html"):
        mimoc.view(spec, tmp_path / "page.png")
    with pytest.raises(
        MimocError, match="a set cannot be shown; give a bundle, a spec, a world, a recording or an env"
    ):
        mimoc.view({1})
    with pytest.raises(MimocError, match="'infant' and 'episode' choose from a recording"):
        mimoc.view(spec, episode=2)


def test_the_page_of_an_infant_needs_no_extra():
    """What reads recordings is imported for a recording only."""
    program = "import sys; sys.modules['pyarrow'] = None; import mimoc.cli.pages, mimoc.viewer.viewing"
    subprocess.run([sys.executable, "-c", program], check=True)
