"""Everything that can be done with an environment: one list, which is tested and printed for each of its kinds.

A capability states a fact about each kind of environments that has it, and gives the line by which the others refuse
it. `PYTHONPATH=tests python -m contracts.capabilities` writes the table of docs/environments.md anew.
"""

import copy
import pickle
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from contracts.kinds import KIM, MANY, NAMES, ON_DEVICE, ONE, WORLD, WORLDS, Driven, Kind
from PIL import Image
from support.same import assert_same

import mimoc
from mimoc.movement.simulated import film_recording
from mimoc.runtime.expression import expression_of
from mimoc.runtime.infants import infants_of

PAGE = Path(__file__).resolve().parents[2] / "docs" / "environments.md"
Fact = Callable[[Kind, Path], None]
"""States what is true of a kind of environments; it may write into a folder."""


def row_by_row(kind: Kind, ours: Any, theirs: Any) -> None:
    """Compare what an infant observes here with what it observes alone."""
    assert ours.keys() == theirs.keys()
    for name, readings in theirs.items():
        if kind.tolerance == 0.0:
            assert np.asarray(ours[name]).tobytes() == np.asarray(readings).tobytes(), name
        else:
            assert ours[name] == pytest.approx(readings, rel=kind.tolerance, abs=kind.tolerance), name


def as_alone(kind: Kind, spec: Mapping[str, Any] = KIM, steps: int = 3, **given: Any) -> None:
    """Assert that infants observe and earn what each does alone, after a reset with options."""
    do: Callable[[Driven], None] = given.pop("do", lambda driven: None)
    with ExitStack() as opened:
        here = opened.enter_context(kind.open(spec))
        alone = [opened.enter_context(ONE.open(spec)) for _ in range(here.count)]
        for number, started in enumerate(here.reset(seed=3, **copy.deepcopy(given))):
            row_by_row(kind, started, alone[number].reset(seed=3 + number, **copy.deepcopy(given))[0])
        for driven in (here, *alone):
            do(driven)
        generator, low, high = np.random.default_rng(7), here.action_space.low, here.action_space.high
        for _ in range(steps):
            actions = generator.uniform(low, high, (here.count, len(low))).astype(np.float32) * 0.3
            for number, observed in enumerate(here.step(actions)):
                row_by_row(kind, observed, alone[number].step(actions[number : number + 1])[0])
                assert here.rewards[number] == pytest.approx(alone[number].rewards[0], abs=kind.tolerance)
                assert here.infos[number]["age_months"] == pytest.approx(alone[number].infos[0]["age_months"])


# Episodes.


def runs(kind: Kind, folder: Path) -> None:
    """With delays, jitter and noise, each infant observes what it does alone."""
    late = {"delays": {"sensory_ms": 20, "motor_ms": 10}}
    chance = {"noise": {"proprioception_deg": 2, "motor": 0.1, "delay_jitter_ms": 5}}
    as_alone(kind, {**KIM, **late, **({} if kind is ON_DEVICE else chance)}, steps=6)


def starts_in_a_pose(kind: Kind, folder: Path) -> None:
    as_alone(kind, pose="prone")
    with kind.open() as here:
        lying, prone = here.reset(seed=0), here.reset(seed=0, pose="prone")
        assert all((one["vestibular"] != other["vestibular"]).any() for one, other in zip(lying, prone, strict=True))


def starts_with_arousal(kind: Kind, folder: Path) -> None:
    as_alone(kind, arousal=0.3)


def starts_at_an_age(kind: Kind, folder: Path) -> None:
    as_alone(kind, age_months=10)
    with kind.open() as here:
        here.reset(seed=0, age_months=10)
        assert [info["age_months"] for info in here.infos] == [10] * here.count


ROOM = {"kind": "room", "toys": {"count": [2, 2]}}


def starts_in_another_scene(kind: Kind, folder: Path) -> None:
    with kind.open(scene=ROOM, is_of_spec=True) as here:
        here.reset(seed=0)
        first = [toys_of(infant) for infant in here.infants]
        here.reset(seed=0, scene_seed=7)
        assert {infant.manifest.seed for infant in here.infants} == {7}
        assert all(toys_of(infant) != before for infant, before in zip(here.infants, first, strict=True))


def toys_of(infant: Any) -> list[Any]:
    """Return the toys around an infant, and where they are."""
    return [toy.body for toy in infant.manifest.toys]


BALL = {"name": "ball", "radius_cm": 3, "at": {"x_cm": 100, "y_cm": 0}}


def starts_with_objects_elsewhere(kind: Kind, folder: Path) -> None:
    with kind.open(scene={"objects": [BALL]}) as here:
        here.reset(seed=0, objects={"ball": {"x_cm": 70, "y_cm": 5}})
        for infant in here.infants:
            assert places_of(here, infant, "object_ball")[:2] == pytest.approx((0.7, 0.05), abs=2e-3)


def places_of(here: Driven, infant: Any, body: str) -> Any:
    """Return where a body is in the world of an infant, of the first one on a device."""
    if here.env.unwrapped.__class__.__name__ == "DeviceEnv":
        return here.env.unwrapped.worlds.data.xpos.numpy()[0, infant.model.body(body).id]
    return infant.data.body(body).xpos


def grows(kind: Kind, folder: Path) -> None:
    with kind.open() as here:
        here.reset(seed=0)
        here.flail(2)
        for row in here.grow(10):
            assert all(np.isfinite(readings).all() for readings in row.values())
        here.flail(1)
        assert [info["age_months"] for info in here.infos] == [10] * here.count
    as_alone(kind, do=lambda driven: driven.grow(10))


def grows_by_a_schedule(kind: Kind, folder: Path) -> None:
    schedule = mimoc.growth_schedule("grown", (9, 10), steps=5)
    with kind.open() as here:
        grown = here
        if kind is WORLD:
            here.env.grow_by(dict.fromkeys(NAMES, schedule))
        elif kind in (MANY, WORLDS):
            here.env.grow_by(schedule)
        else:
            grown = type(here)(mimoc.GrowthWrapper(here.env, schedule))
        grown.reset(seed=0)
        ages = []
        for _ in range(6):
            grown.flail(1)
            ages.append({info["age_months"] for info in grown.infos})
    assert ages == [{schedule(step)} for step in range(6)]


# What can be done to an infant.


def has_expressions(kind: Kind, folder: Path) -> None:
    with kind.open() as here:
        here.reset(seed=0)
        for infant in here.infants:
            infant.set_expression("happy")
        assert {expression_of(infant.manifest, infant.model) for infant in here.infants} == {"happy"}


def is_aroused(kind: Kind, folder: Path) -> None:
    def arouse(driven: Driven) -> None:
        if hasattr(driven.env.unwrapped, "set_arousal"):
            driven.env.unwrapped.set_arousal(0.3)
        else:
            for infant in driven.infants:
                infant.set_arousal(0.3)

    as_alone(kind, do=arouse)


def tells_of_itself(kind: Kind, folder: Path) -> None:
    """Keypoints, effort, skin, layouts and spaces of each infant."""
    with kind.open({**KIM, "senses": {"proprioception": {}, "touch": {"density": 0.2}}}) as here:
        here.reset(seed=0)
        here.flail(1)
        for infant in here.infants:
            assert np.isfinite(infant.keypoints()).all()
            assert infant.effort() > 0
            assert len(infant.layout("proprioception")) == infant.observation_space["proprioception"].shape[0]
            assert infant.observation_space.contains(infant.observe())
            assert infant.action_space.contains(infant.rest)
            assert infant.skin.positions.shape[1] == 3
            assert infant.model.body(infant.manifest.root_body).id >= 1
            assert (infant.max_steps, infant.steps, infant.age_months, infant.arousal) == (None, 1, 9.0, 1.0)


# States and copies.


def keeps_states(kind: Kind, folder: Path) -> None:
    late = {**KIM, "delays": {"sensory_ms": 20}}
    with kind.open(late) as here:
        here.reset(seed=0)
        here.flail(2)
        state = pickle.loads(pickle.dumps(here.env.unwrapped.get_state()))
        after = here.flail(2)
        here.restore(state)
        assert_same(here.flail(2), after)


def copied(kind: Kind, copy_of: Callable[[Any], Any]) -> None:
    with kind.open({**KIM, "delays": {"sensory_ms": 20}}) as here:
        here.reset(seed=0)
        here.flail(2)
        again = type(here)(copy_of(here.env))
        after = here.flail(2)
        assert_same(again.flail(2), after)
        again.env.close()


def is_copied(kind: Kind, folder: Path) -> None:
    copied(kind, copy.deepcopy)


def is_pickled(kind: Kind, folder: Path) -> None:
    copied(kind, lambda env: pickle.loads(pickle.dumps(env)))


# Objects of a script.


@dataclass(frozen=True)
class High(mimoc.Term):
    """The height of a body is the reward."""

    body: int

    def __call__(self, worlds: Any, action: Any, memory: Any) -> mimoc.Judgement:
        return mimoc.Judgement({"height": worlds.xpos[:, self.body, 2]})


class HeadUp(mimoc.Task):
    def bind(self, model: Any, bundle: Any) -> None:
        self.term = High(model.body(bundle.manifest.anatomy.head).id)


@dataclass(frozen=True)
class Heights(mimoc.Term):
    """The heights of some bodies."""

    bodies: np.ndarray

    def __call__(self, worlds: Any, *rest: Any) -> Any:
        return worlds.xp.take(worlds.xpos, self.bodies, axis=1)[..., 2]


class Height:
    space = gymnasium.spaces.Box(-10.0, 10.0, (1,), np.float32)

    def bind(self, model: Any, bundle: Any) -> None:
        self.term = Heights(np.array([model.body(bundle.manifest.anatomy.head).id]))


class Lift(mimoc.Companion):
    """Pulls the infant up with twice its weight."""

    def bind(self, model: Any, bundle: Any, generator: np.random.Generator) -> None:
        self.root = model.body(bundle.manifest.root_body).id
        self.force_n = 2 * 9.81 * float(model.body_subtreemass[self.root])

    def before_step(self, data: Any) -> None:
        data.xfrc_applied[self.root, 2] = self.force_n


def has_a_task_of_a_script(kind: Kind, folder: Path) -> None:
    with kind.open(task=HeadUp(steps=50)) as here:
        here.reset(seed=0)
        here.rest(2)
        assert all(0.01 < reward < 0.2 for reward in here.rewards)
        assert {infant.max_steps for infant in here.infants} == {50}


def has_a_sense_of_a_script(kind: Kind, folder: Path) -> None:
    with kind.open(senses={"height": Height()}) as here:
        here.reset(seed=0)
        assert all(0.01 < row["height"][0] < 0.2 for row in here.rest(2))


def has_a_companion_of_a_script(kind: Kind, folder: Path) -> None:
    with kind.open(companions={"lift": Lift()}) as here:
        here.reset(seed=0)
        hips_m = [infant.data.body(infant.manifest.root_body).xpos[2] for infant in here.infants]
        here.rest(20)
        for infant, before_m in zip(here.infants, hips_m, strict=True):
            assert infant.data.body(infant.manifest.root_body).xpos[2] > before_m + 0.05


# What is around an infant.


def has_a_caregiver(kind: Kind, folder: Path) -> None:
    with kind.open({**KIM, "age_months": 4}, scene={"caregiver": {}}) as here:
        here.reset(seed=0)
        for infant in here.infants:
            infant.caregiver.do("show_face", "happy")
        here.rest(2)
        assert all(act[1:3] == ("show_face", "happy") for infant in here.infants for act in infant.caregiver.acts)
        assert all(infant.caregiver.acts for infant in here.infants)


MOBILE = {
    "kind": "mobile",
    "name": "mobile",
    "at": {"frame": "infant", "x_cm": 60, "y_cm": 0, "z_cm": 30},
    "tied_to": "left_foot",
}


def has_a_ribbon(kind: Kind, folder: Path) -> None:
    with kind.open(scene={"objects": [MOBILE]}) as here:
        here.reset(seed=0)
        (first, *_) = here.infants
        assert first.manifest.objects[0].tied_to.endswith("left_foot")
        before = mobile_of(here)
        names = [first.model.actuator(int(index)).name for index in first.actuation.actuators]
        legs = np.array([name.endswith(("_hip_flex", "_knee")) for name in names], np.float32)
        for sign in (-1.0, 1.0):
            for _ in range(25):
                here.step(np.tile(sign * legs, (here.count, 1)).astype(np.float32))
        assert np.abs(mobile_of(here) - before).max() > 0.02


def mobile_of(here: Driven) -> np.ndarray:
    """Return how the cord of the mobile hangs in the first world."""
    if here.env.unwrapped.__class__.__name__ == "DeviceEnv":
        address = here.infants[0].model.joint("object_mobile_cord").qposadr[0]
        return here.env.unwrapped.worlds.data.qpos.numpy()[0, address : address + 4].copy()
    return here.infants[0].data.joint("object_mobile_cord").qpos.copy()


BATH = {
    "name": "bath",
    "kind": "water",
    "depth_cm": 200,
    "sides_cm": [300, 300],
    "infant_kg_m3": 800,
    "at": {"x_cm": 0},
}


def is_in_water(kind: Kind, folder: Path) -> None:
    with kind.open(scene={"objects": [BATH]}) as here:
        here.reset(seed=0)
        (first, *_) = here.infants
        before_m = first.data.body(first.manifest.root_body).xpos[2]
        here.rest(30)
        assert first.data.body(first.manifest.root_body).xpos[2] > before_m + 0.02


def starts_at_furniture(kind: Kind, folder: Path) -> None:
    sitting = {**KIM, "scene": {"pose": "sitting"}}
    with kind.open(sitting, scene={"objects": [{"kind": "seat", "name": "seat"}]}, start_at="seat") as here:
        here.reset(seed=0)
        (first, *_) = here.infants
        hip_m, seat_m = (places_of(here, first, body)[:2] for body in (first.manifest.root_body, "object_seat"))
        assert np.linalg.norm(hip_m - seat_m) < 0.2


def speaks_and_hears(kind: Kind, folder: Path) -> None:
    spec = {**KIM, "actuation": {"voice": True}, "senses": {"hearing": {"output": "levels", "thresholds": "off"}}}
    with kind.open(spec) as here:
        here.reset(seed=0)
        silence = here.rest(12)
        actions = np.zeros((here.count, *here.action_space.shape), np.float32)
        actions[:, -2:] = 0.3, 1.0
        for _ in range(12):
            loud = here.step(actions)
        pairs = zip(silence, loud, strict=True)
        assert all((sound["hearing"] > before["hearing"] + 10).all() for before, sound in pairs)


def sees(kind: Kind, folder: Path) -> None:
    eyes = {"vision": {"width_px": 12, "height_px": 12}}
    with kind.open({**KIM, "senses": eyes}, scene={"kind": "room"}) as here:
        for row in here.reset(seed=0):
            assert all(view.shape == (12, 12, 3) and view.std() > 0 for view in row.values())
            assert len(row) == 2


def is_rendered(kind: Kind, folder: Path) -> None:
    with kind.open(render_mode="rgb_array", width=48, height=32) as here:
        here.reset(seed=0)
        picture = here.env.render()
        assert picture.dtype == np.uint8
        assert picture.std() > 5
        assert picture.shape[0] >= 32


# Policies, and what runs them.


def acts_by_policies(kind: Kind, folder: Path) -> None:
    """Each infant is commanded what it is alone."""
    with ExitStack() as opened:
        here = opened.enter_context(kind.open())
        act = mimoc.policy_vec("general_movements+reflexes", here.env)
        generators = [np.random.default_rng(row) for row in range(here.count)]
        observed = here.reset(seed=0)
        actions = here.rows(act(here.joined(generators), here.joined(observed)))
        for row, action in enumerate(actions):
            alone = opened.enter_context(ONE.open())
            policy = mimoc.policy_vec("general_movements+reflexes", alone.env)
            assert action == pytest.approx(policy(np.random.default_rng(row), alone.reset(seed=row)[0]), abs=1e-5)


def has_policies_by_infant(kind: Kind, folder: Path) -> None:
    with kind.open() as here:
        *_, last = infants_of("test", here.env)
        act = mimoc.policy_vec({last: "random"}, here.env)
        generators = [np.random.default_rng(row) for row in range(here.count)]
        actions = here.rows(act(here.joined(generators), here.joined(here.reset(seed=0))))
        assert [bool(action.any()) for action in actions] == [False] * (here.count - 1) + [True]


def is_evaluated(kind: Kind, folder: Path) -> None:
    """Each infant earns what it earns alone."""
    options: dict[str, Any] = {"episodes": 2, "seed": 4, "steps_per_episode": 3}
    with kind.open(task=HeadUp(steps=3)) as here, ONE.open(task=HeadUp(steps=3)) as alone:
        outcomes = mimoc.evaluate(here.env, "random", **options)
        wanted = mimoc.evaluate(alone.env, "random", **options)
        if kind is WORLD:
            assert outcomes.keys() == set(NAMES)
            outcomes = outcomes[NAMES[0]]
        assert [episode.steps for episode in outcomes] == [3, 3]
        if kind is not WORLDS:
            returns = [episode.total_reward for episode in wanted]
            assert [episode.total_reward for episode in outcomes] == pytest.approx(returns, rel=10 * kind.tolerance)


def recorded(kind: Kind, folder: Path, steps: int = 3, **options: Any) -> Path:
    """Return the folder of a recording of some control steps of each infant."""
    with kind.open(**options) as here:
        recorder = type(here)(mimoc.Recorder(here.env, folder / "recording"))
        recorder.reset(seed=1)
        recorder.flail(steps)
        recorder.env.close()
    return folder / "recording"


def is_recorded(kind: Kind, folder: Path) -> None:
    """A recording has what all infants did and observed."""
    with kind.open() as here:
        recorder = type(here)(mimoc.Recorder(here.env, folder / "recording"))
        started, ended = recorder.reset(seed=1), recorder.flail(3)
        recorder.env.close()
    recording = mimoc.read_recording(folder / "recording")
    assert len(recording) == recording.infants == len(started)
    for number, (first, last) in enumerate(zip(started, ended, strict=True)):
        (episode,) = recording.of_infant(number)
        assert episode.actions.shape[0] == 3
        for name, readings in episode.observations.items():
            assert np.array_equal(readings[0], first[name])
            assert np.array_equal(readings[-1], last[name])


def is_replayed(kind: Kind, folder: Path) -> None:
    """Everything comes out again, with growth and restored states in between."""
    with kind.open() as here:
        recorder = type(here)(mimoc.Recorder(here.env, folder / "recording"))
        recorder.reset(seed=1)
        recorder.flail(2)
        if kind is not ON_DEVICE:
            here.restore(here.env.unwrapped.get_state())
            here.grow(9.5)
        recorder.flail(2)
        recorder.reset(seed=2, age_months=10)
        recorder.flail(2)
        recorder.env.close()
    replayed = list(mimoc.replay_recording(folder / "recording"))
    assert [one.difference for one in replayed] == [None] * len(mimoc.read_recording(folder / "recording"))


def is_measured(kind: Kind, folder: Path) -> None:
    table = mimoc.measure_recordings(recorded(kind, folder), ["right_hand_path_m"])
    assert len(table["right_hand_path_m"]) == mimoc.read_recording(folder / "recording").infants
    assert all(0 < path_m < 1 for path_m in table["right_hand_path_m"])


def has_its_movement_measured(kind: Kind, folder: Path) -> None:
    """From points of the body in a recording that is simulated again."""
    path = recorded(kind, folder, steps=330)
    films = list(film_recording(path))
    assert len(films) == mimoc.read_recording(path).infants
    assert all(mimoc.measure_movement(film.seen)["kicks_per_min"] >= 0 for film in films)


def is_exported(kind: Kind, folder: Path) -> None:
    path = recorded(kind, folder)
    mimoc.export_recording(path, "csv", folder / "tables")
    files = [*(folder / "tables").rglob("*.csv")]
    assert len(files) >= mimoc.read_recording(path).infants


def is_filmed(kind: Kind, folder: Path) -> None:
    with kind.open() as here:
        mimoc.record(here.env, "random", folder / "film.gif", steps=8, height_px=64)
    with Image.open(folder / "film.gif") as film:
        assert film.n_frames >= 2


def has_a_page(kind: Kind, folder: Path) -> None:
    with kind.open() as here:
        here.reset(seed=0)
        page = mimoc.view(here.env)
    assert "<html" in page.html


def has_a_report(kind: Kind, folder: Path) -> None:
    with kind.open() as here:
        bundles = {id(infant.simulation.bundle): infant.simulation.bundle for infant in here.infants}
        for number, bundle in enumerate(bundles.values()):
            page = mimoc.report(bundle, folder / f"{number}.html", check=False)
            assert page.stat().st_size > 10_000


# Learning.


def learns_with_stable_baselines(kind: Kind, folder: Path) -> None:
    from stable_baselines3 import PPO

    task: dict[str, Any] = {"max_episode_steps": 4}
    if kind is WORLD:
        with kind.open() as here:
            envs = mimoc.world_vec_env(here.env)
            assert PPO("MultiInputPolicy", envs, n_steps=8, batch_size=16).learn(16).num_timesteps == 16
        return
    source = kind.source(KIM)
    envs = mimoc.sb3_vec_env(source, **kind.options, **task)
    assert PPO("MultiInputPolicy", envs, n_steps=8, batch_size=16).learn(16).num_timesteps >= 16
    assert len(envs.get_attr("age_months")) == envs.num_envs
    envs.close()


def learns_with_rsl_rl(kind: Kind, folder: Path) -> None:
    env = mimoc.rsl_rl_env(kind.source(KIM), **kind.options)
    assert env.get_observations()["policy"].shape[0] == env.num_envs
    env.close()


def is_trained(kind: Kind, folder: Path) -> None:
    source = kind.source(KIM)
    build = mimoc.build if isinstance(source, mimoc.InfantSpec) else mimoc.build_world
    mimoc.train(build(source), folder / "run", steps=64, envs=kind.options.get("num_envs", 1), steps_per_episode=8)
    assert (folder / "run" / "policy.zip").exists()
