"""Infants on MuJoCo Warp, by default on its CPU device, see what they do on the CPU, without OpenGL."""

import numpy as np
import pytest
import warp as wp
from support.devices import DEVICE, break_down, infant, random_actions, still

import mimoc
from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.device import Filters, NoVision, flat_picture
from mimoc.components.senses.vision.filters import Persistence
from mimoc.components.senses.vision.run import filters, perceive
from mimoc.runtime.device.signals import DeviceError
from mimoc.runtime.gymnasium_forms import BatchMismatchError
from mimoc.runtime.term import stack_terms
from mimoc.runtime.worlds import NUMPY

EYES = ("eye_left", "eye_right")
WIDTH, HEIGHT = 40, 32
SIZE = {"width_px": WIDTH, "height_px": HEIGHT}
BRIGHTNESS = 6.0
"""Mean difference, of 255: OpenGL computes highlights at corners only, the ray caster in each pixel."""
PLACE_PX = 0.6
ROUNDING = 0.01


def build(age_months: float, **vision: object) -> mimoc.Bundle:
    """Return an infant that reaches; with the same senses as others in these tests, so that few kernels are needed."""
    senses = {"proprioception": {}, "vestibular": {}, "vision": {**SIZE, "body": "solids", **vision}}
    return infant(
        age_months, senses=senses, task={"kind": "reach"}, delays={"vision_ms": 30 if age_months > 12 else 15}
    )


@pytest.fixture(scope="module")
def pair():
    """Return infants of two ages on MuJoCo Warp and on the CPU."""
    bundles = [build(12, foveation=3, acuity={"cpd": 0.5}), build(18, acuity="off")]
    ours = mimoc.make_vec(bundles, device=DEVICE, starts=2, autoreset_mode="SameStep", max_episode_steps=8)
    theirs = mimoc.make_vec(bundles, threads=1)
    yield ours, theirs
    ours.close(), theirs.close()


def assert_alike(seen, expected):
    """Compare pictures: all in all, and where the red ball is."""
    for eye in EYES:
        assert seen[eye].dtype == np.uint8
        assert seen[eye].shape == expected[eye].shape == (2, HEIGHT, WIDTH, 3)
        for ours, theirs in zip(seen[eye], expected[eye], strict=True):
            assert np.abs(ours.astype(int) - theirs).mean() < BRIGHTNESS
            assert ball(ours) == pytest.approx(ball(theirs), abs=PLACE_PX)


def ball(picture: np.ndarray) -> np.ndarray:
    """Return row and column of the centre of what is red, and the root of its size, in pixels."""
    redness = np.clip(picture[..., 0].astype(float) - picture[..., 1:].max(axis=-1) - 60, 0, None)
    rows, columns = np.indices(redness.shape)
    assert redness.sum() > 0
    size = np.sqrt((redness > 20).sum())
    return np.array([(rows * redness).sum() / redness.sum(), (columns * redness).sum() / redness.sum(), size])


def test_infants_of_two_ages_see_the_ball_as_on_the_cpu_with_delays_acuity_and_foveation(pair):
    ours, theirs = pair
    assert ours.single_observation_space == theirs.single_observation_space
    (seen, _), (expected, _) = ours.reset(seed=0), theirs.reset(seed=0)
    assert_alike(seen, expected)
    first = seen
    generator = np.random.default_rng(0)
    for step in range(7):
        command = random_actions(theirs, generator)
        seen, expected = ours.step(command)[0], theirs.step(command)[0]
        if step < 2:  # Of the older infant, nothing has arrived yet.
            assert (
                seen["eye_left"][1]
                == ours.worlds.default_starts.samples["vision"].cpu().numpy()[3][:SEEN].reshape(HEIGHT, WIDTH, 3)
            ).all()
        assert_alike(seen, expected)
    assert ours.observation_space.contains(seen)
    assert all((seen[eye] != first[eye]).any(axis=(1, 2, 3)).all() for eye in EYES)


SEEN = HEIGHT * WIDTH * 3


def test_an_episode_begins_with_what_is_seen_at_its_start(pair):
    ours, _ = pair
    ours.reset(seed=[0, 1])
    command = np.ones(ours.action_space.shape, np.float32)
    for _ in range(8):
        seen, _, terminated, truncated, info = ours.step(command)
        if (terminated | truncated).any():
            break
    ended = int(np.flatnonzero(terminated | truncated)[0])
    starts = ours.worlds.default_starts.samples["vision"].cpu().numpy()[2 * ended : 2 * ended + 2, :SEEN]
    begun = seen["eye_left"][ended].ravel()
    assert any((begun == start).all() for start in starts)
    assert (info["final_obs"]["eye_left"][ended].ravel() != begun).any()
    assert isinstance(ours.infants[0].senses["vision"], NoVision)


def test_an_infant_whose_simulation_breaks_down_is_not_in_the_way_of_what_others_see(pair):
    ours, _ = pair
    ours.reset(seed=0)
    break_down(ours)
    seen, _, terminated, _, info = ours.step(still(ours))
    assert info["unstable"].tolist() == terminated.tolist() == [True, False]
    assert np.ptp(seen["eye_left"], axis=(1, 2, 3)).min() > 100


IMMATURE = (0.9, 2.0, "corner")


@pytest.mark.parametrize("supersample", [1, 2])
def test_acuity_and_foveation_of_each_age_are_those_of_the_cpu_on_the_same_picture(supersample):
    """Of 256 levels each is the nearest, but for rounding of numbers midway between two."""
    kinds = [(None, 0.0, "corner"), (1.2, 3.0, "corner"), (0.3, 0.0, "border"), (None, 5.0, "edge"), *[IMMATURE] * 3]
    entries = [
        VisionEntry(
            cameras=EYES,
            **SIZE,
            supersample=supersample,
            acuity_cpd=acuity_cpd,
            foveation=foveation,
            foveation_radius=radius,
            unseen=(),
        )
        for acuity_cpd, foveation, radius in kinds
    ]
    entries[1] = entries[1].model_copy(update={"acuity_shares": (0.3, 1.0), "field_deg": {"right": 5.0}})
    threshold = {"contrast": "threshold", "sensitivity": 8.0, "sensitivity_peak_cpd": 0.2}
    entries[4:] = [
        entries[4].model_copy(update=threshold),
        entries[5].model_copy(update={**threshold, "acuity_shares": (0.5, 1.0), "noticed_deg": 20.0}),
        entries[6].model_copy(update={"purity_threshold": 0.2, "chroma_gain": 0.5}),
    ]
    fovy_deg, drawn = (60.0, 40.0, 60.0, 90.0, 60.0, 60.0, 50.0), (HEIGHT * supersample, WIDTH * supersample)
    pictures = np.random.default_rng(0).integers(0, 256, (len(kinds), len(EYES), *drawn, 3), dtype=np.uint8)
    packed = (pictures.astype(np.uint32) << np.array([16, 8, 0], np.uint32)).sum(axis=-1, dtype=np.uint32)
    perceive_all = Filters(entries, fovy_deg, np.arange(len(kinds)))
    perceived = perceive_all(wp.array(packed.reshape(len(kinds), -1), dtype=wp.uint32))
    found = perceived.cpu().numpy().reshape(len(kinds), len(EYES), HEIGHT, WIDTH, 3)
    for ours, entry, fovy, picture in zip(found, entries, fovy_deg, pictures, strict=True):
        assert np.ptp(perceive(picture, filters(entry, fovy))) > 0
        theirs = picture.astype(np.float32)
        for apply in filters(entry, fovy):
            theirs = apply(theirs)
        assert np.abs(ours - theirs.clip(0, 255)).max() < 0.5 + ROUNDING


def test_a_cubes_texture_becomes_a_picture_by_longitude_and_latitude():
    """Painted by direction, x red, y green and z blue, the faces stacked as OpenGL has them."""
    size_px = 32
    along, down = np.meshgrid(*[(np.arange(size_px) + 0.5) / size_px * 2 - 1] * 2)
    one = np.ones_like(along)
    faces = [
        (one, -down, -along),
        (-one, -down, along),
        (along, one, down),
        (along, -one, -down),
        (along, -down, one),
        (-along, -down, -one),
    ]
    cube = np.concatenate([np.stack(face, axis=-1) for face in faces])
    cube = 127.5 + 127.5 * cube / np.linalg.norm(cube, axis=-1, keepdims=True)
    picture = flat_picture(cube.astype(np.uint8), on_limbs=False)
    rows, columns = picture.shape[:2]
    longitude = (np.arange(columns) + 0.5) / columns * 2 * np.pi
    latitude = (0.5 - (np.arange(rows)[:, None] + 0.5) / rows) * np.pi
    found = picture / 127.5 - 1
    assert found[..., 0] == pytest.approx(np.cos(latitude) * np.cos(longitude), abs=0.06)
    assert found[..., 1] == pytest.approx(np.cos(latitude) * np.sin(longitude), abs=0.06)
    assert found[..., 2] == pytest.approx(np.sin(latitude) * np.ones(columns), abs=0.06)
    around = flat_picture(cube.astype(np.uint8), on_limbs=True)
    assert (around == around[0]).all()


@pytest.mark.parametrize(
    ("eyes", "error", "text"),
    [
        ([{}, {"supersample": 2}], BatchMismatchError, r"vision.supersample \(1, 2\)"),
        (
            [{"focus": "age"}],
            DeviceError,
            r"infant 0: eyes that are out of focus \('senses.vision.focus'\) do not run on",
        ),
        ([{"body": "skin"}], DeviceError, r"infant 0: MuJoCo Warp draws no skins, so eyes see solids on a device"),
    ],
)
def test_eyes_that_a_device_cannot_have_are_refused_in_one_line(make, eyes, error, text):
    with pytest.raises(error, match=text):
        make([build(12 if len(eyes) > 1 else 1, **keys) for keys in eyes])


@pytest.mark.slow
def test_pictures_of_a_newborn_lag_behind_by_the_filter_of_the_cpu(make):
    """What flickers is seen as by the CPU's filter of what an infant sees that has none."""
    slow, fast = (make([build(1, acuity="off", **keys)]) for keys in ({"flicker": 1}, {}))
    slow.reset(seed=0), fast.reset(seed=0)
    persist, state = stack_terms([Persistence(np.array([2.0]))]), None
    command = np.ones(slow.action_space.shape, np.float32)
    for step in range(6):
        lagging, sharp = slow.step(command)[0]["eye_left"], fast.step(command)[0]["eye_left"]
        seen, state = persist(NUMPY, slow.infants[0].manifest.step_ms / 1000 if step else np.inf, sharp, state)
    apart = [np.abs(lagging.astype(int) - other).mean() for other in (seen, sharp)]
    assert apart[0] < 0.3 * apart[1]
