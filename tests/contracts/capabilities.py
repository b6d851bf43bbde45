"""Everything that can be done with an environment: one list, which is tested and printed for each of its kinds.

A capability states a fact about each kind of environments that has it, and gives the line by which the others refuse
it. `PYTHONPATH=tests python -m contracts.capabilities` writes the table of docs/environments.md anew.
"""

import copy
import pickle
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from contracts.kinds import KIM, KINDS, MANY, NAMES, ON_DEVICE, ONE, WORLD, WORLDS, Driven, Kind
from PIL import Image
from support.same import assert_same

import mimoc
from mimoc.movement.filming import film_recording
from mimoc.runtime.model_fields import expression_of

PAGE = Path(__file__).resolve().parents[2] / "docs" / "environments.md"
Fact = Callable[[Kind, Path], None]  # States what is true of a kind of environments; it may write into a folder.


def row_by_row(kind: Kind, ours: Any, theirs: Any) -> None:
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


def runs(kind: Kind, folder: Path) -> None:
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


ROOM = {"kind": "room", "toys": {"subset": ["ball"], "count": [1, 1]}}
EMPTY = {"kind": "room", "toys": {"count": [0, 0]}}
"""Scenes of infants on a device must have as many things as each other: those of the seeds 0 and 5 have."""


def starts_in_another_scene(kind: Kind, folder: Path) -> None:
    with kind.open(scene=EMPTY if kind is ON_DEVICE else ROOM, is_of_spec=True) as here:
        here.reset(seed=0)
        before = here.infants[0].bundle
        here.reset(seed=0, scene_seed=5)
        assert {infant.manifest.seed for infant in here.infants} == {5}
        assert here.infants[0].bundle.files != before.files


BALL = {"name": "ball", "radius_cm": 3, "at": {"x_cm": 100, "y_cm": 0}}


def starts_with_objects_elsewhere(kind: Kind, folder: Path) -> None:
    with kind.open(scene={"objects": [BALL]}) as here:
        here.reset(seed=0, objects={"ball": {"x_cm": 70, "y_cm": 5}})
        here.rest(1)
        for row in range(len(here.infants)):
            assert place_m(here, "object_ball", row)[:2] == pytest.approx((0.7, 0.05), abs=2e-3)


def place_m(here: Driven, body: str, row: int = 0) -> np.ndarray:
    """Return where a body was before the last step, in the world of an infant, shape (3,)."""
    infant = here.infants[row]
    if hasattr(here.env.unwrapped, "worlds"):
        return here.env.unwrapped.worlds.data.xpos.numpy()[row, infant.model.body(body).id].copy()
    return infant.data.body(body).xpos.copy()


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


def says_what_it_is(kind: Kind, folder: Path) -> None:
    with kind.open() as here:
        for row, infant in zip(here.reset(seed=0), here.infants, strict=kind is not ON_DEVICE):
            assert infant.observation_space.contains(row)
            assert len(infant.layout("proprioception")) == len(row["proprioception"])
            assert infant.action_space.contains(infant.rest)
            assert infant.manifest.of_infant(infant.manifest.root_body) == "hip"
            assert (infant.max_steps, infant.age_months) == (None, 9.0)


def says_how_it_is(kind: Kind, folder: Path) -> None:
    with kind.open({**KIM, "senses": {"touch": {"density": 0.2}}}) as here:
        here.reset(seed=0)
        starts_m = [infant.keypoints() for infant in here.infants]
        here.flail(4)
        for infant, start_m in zip(here.infants, starts_m, strict=True):
            assert np.nanmax(np.abs(infant.keypoints() - start_m)) > 1e-4
            assert infant.effort() > 0
            assert infant.skin.positions.shape == infant.skin.forces.shape
            assert (infant.steps, infant.arousal) == (4, 1.0)


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


@dataclass(frozen=True)
class High(mimoc.Term):
    body: int

    def __call__(self, worlds: Any, action: Any, memory: Any) -> mimoc.Judgement:
        return mimoc.Judgement({"height": worlds.xpos[:, self.body, 2]})


class HeadUp(mimoc.Task):
    def bind(self, model: Any, bundle: Any) -> None:
        self.term = High(model.body(bundle.manifest.anatomy.head).id)


@dataclass(frozen=True)
class Heights(mimoc.Term):
    bodies: np.ndarray

    def __call__(self, worlds: Any, *rest: Any) -> Any:
        return worlds.xp.take(worlds.xpos, self.bodies, axis=1)[..., 2]


class Height:
    space = gymnasium.spaces.Box(-10.0, 10.0, (1,), np.float32)

    def bind(self, model: Any, bundle: Any) -> None:
        self.term = Heights(np.array([model.body(bundle.manifest.anatomy.head).id]))


class Lift(mimoc.Companion):
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


def has_a_caregiver(kind: Kind, folder: Path) -> None:
    with kind.open({**KIM, "age_months": 4}, scene={"caregiver": {}}) as here:
        here.reset(seed=0)
        for infant in here.infants:
            infant.caregiver.do("show_face", "happy")
        here.rest(2)
        assert all(act[1:3] == ("show_face", "happy") for infant in here.infants for act in infant.caregiver.acts)
        assert all(infant.caregiver.acts for infant in here.infants)


ABOVE = {"frame": "infant", "x_cm": 60, "y_cm": 0, "z_cm": 30}
MOBILE = {"kind": "mobile", "name": "mobile", "at": ABOVE, "tied_to": "left_foot"}


def has_a_ribbon(kind: Kind, folder: Path) -> None:
    with kind.open(scene={"objects": [MOBILE]}) as here:
        here.reset(seed=0)
        (first, *_) = here.infants
        assert first.manifest.objects[0].tied_to.endswith("left_foot")
        here.rest(1)
        before_m = place_m(here, "object_mobile_bell")
        names = [first.model.actuator(int(index)).name for index in first.actuation.actuators]
        legs = np.array([name.endswith(("_hip_flex", "_knee")) for name in names], np.float32)
        for sign in (-1.0, 1.0):
            for _ in range(25):
                here.step(np.tile(sign * legs, (here.count, 1)).astype(np.float32))
        assert np.linalg.norm(place_m(here, "object_mobile_bell") - before_m) > 0.005


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
        here.rest(1)
        before_m = place_m(here, first.manifest.root_body)[2]
        here.rest(30)
        assert place_m(here, first.manifest.root_body)[2] > before_m + 0.02


def starts_at_furniture(kind: Kind, folder: Path) -> None:
    sitting = {**KIM, "scene": {"pose": "sitting"}}
    with kind.open(sitting, scene={"objects": [{"kind": "seat", "name": "seat"}]}, start_at="seat") as here:
        here.reset(seed=0)
        here.rest(1)
        hip_m, seat_m = (place_m(here, body)[:2] for body in (here.infants[0].manifest.root_body, "object_seat"))
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
    size_px = {} if kind is ON_DEVICE else {"width": 48, "height": 32}
    with kind.open(render_mode="rgb_array", **size_px) as here:
        here.reset(seed=0)
        picture = here.env.render()
        assert picture.dtype == np.uint8
        assert picture.std() > 5
        assert picture.shape[0] >= 32


def acts_by_policies(kind: Kind, folder: Path) -> None:
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
        last = {ONE: "", WORLD: NAMES[1]}.get(kind, str(here.count - 1))
        act = mimoc.policy_vec({last: "random"}, here.env)
        generators = [np.random.default_rng(row) for row in range(here.count)]
        actions = here.rows(act(here.joined(generators), here.joined(here.reset(seed=0))))
        assert [bool(action.any()) for action in actions] == [False] * (here.count - 1) + [True]


def is_evaluated(kind: Kind, folder: Path) -> None:
    options: dict[str, Any] = {"episodes": 2, "seed": 4, "steps_per_episode": 3}
    with kind.open(task=HeadUp(steps=3)) as here, ONE.open(task=HeadUp(steps=3)) as alone:
        outcomes = mimoc.evaluate(here.env, "random", **options)
        wanted = mimoc.evaluate(alone.env, "random", **options)
        if kind in (WORLD, WORLDS):
            assert outcomes.keys() == set(NAMES)
            outcomes = outcomes[NAMES[0]]
        assert [episode.steps for episode in outcomes] == [3, 3]
        returns = [episode.total_reward for episode in wanted]
        assert [episode.total_reward for episode in outcomes] == pytest.approx(returns, rel=kind.tolerance, abs=0)


def recorded(kind: Kind, folder: Path, steps: int = 3, **options: Any) -> Path:
    with kind.open(**options) as here:
        recorder = type(here)(mimoc.Recorder(here.env, folder / "recording"))
        recorder.reset(seed=1)
        recorder.flail(steps)
        recorder.env.close()
    return folder / "recording"


def is_recorded(kind: Kind, folder: Path) -> None:
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
    path = recorded(kind, folder, steps=3 if kind is ON_DEVICE else 330)
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


def learns_with_stable_baselines(kind: Kind, folder: Path) -> None:
    from stable_baselines3 import PPO

    if kind is WORLD:
        envs = mimoc.world_vec_env(mimoc.make_parallel(kind.source(KIM)))
    else:
        envs = mimoc.sb3_vec_env(kind.source(KIM), max_episode_steps=4, **kind.options)
    learner = PPO("MultiInputPolicy", envs, n_steps=16, batch_size=16)
    assert learner.learn(16).num_timesteps == 16 * envs.num_envs
    assert envs.get_attr("age_months") == [9.0] * envs.num_envs
    envs.close()


def learns_with_rsl_rl(kind: Kind, folder: Path) -> None:
    env = mimoc.rsl_rl_env(kind.source(KIM), **{"device": "cpu", **kind.options})
    assert env.get_observations()["policy"].shape[0] == env.num_envs
    env.close()


def is_trained(kind: Kind, folder: Path) -> None:
    sizes = {"steps": 64, "envs": kind.options.get("num_envs", 1), "steps_per_episode": 8}
    on = {"device": kind.options["device"]} if kind is ON_DEVICE else {}
    training = mimoc.train(kind.source(KIM), folder / "run", task=HeadUp(steps=8), **sizes, **on)
    assert training.policy.exists()


@dataclass(frozen=True)
class Capability:
    about: str  # What it is, as the table says it.
    fact: Fact
    names: str = ""  # Methods and attributes of environments that it uses.
    functions: Mapping[str, Sequence[Kind]] = field(default_factory=dict)
    """Public functions of mimoc that it gives an environment to, with the kinds that each of them takes."""
    refusals: Mapping[str, str] = field(default_factory=dict)
    """By kind that does not have it, the line that says so, or a part of that."""
    extras: bool = False  # Whether it needs libraries that only `make test-all` installs.
    is_slow: bool = False  # Whether some kinds take more than 5 s for it.

    def has(self, kind: Kind) -> bool:
        return kind.name not in self.refusals


ALL = (*KINDS, ON_DEVICE)
ON_CPU = {"device": "expected an environment of mimoc's on the CPU"}
NOT_COPIED = {"device": "infants on a device cannot be copied or pickled; keep what get_state returns"}
NOT_REPLAYED = {"device": "cannot be replayed: recorded on a device, without states"}
RSL_RL = "rsl_rl learns from infants on a device; give device='cuda:0', or 'warp:cpu' to try it out"
WHAT_IT_IS = (
    "infants model bundle manifest senses task actuation companions layout max_steps age_months rest voice"
    " observation_space action_space state_space get_attr call"
)
STANDS_FOR_OTHERS = {"device": "those in 'infants' stand for them, as they start"}


OUT = "on the CPU only: leave {} out, or leave out device"
SILENT = {"device": "a voice sounds " + OUT.format("actuation.voice")}
NO_COMPANIONS = {"device": "companions act " + OUT.format("them")}
NO_CAREGIVER = {"device": "companion 'caregiver' acts " + OUT.format("it")}
NO_WATER = {"device": "companion 'water' acts " + OUT.format("it")}


CAPABILITIES: Mapping[str, Sequence[Capability]] = {  # Everything that can be done, under headings.
    "Episodes": (
        Capability("delays, jitter and noise; each infant as alone with its seed", runs, "reset step"),
        Capability("`pose` at a reset", starts_in_a_pose),
        Capability("`arousal` at a reset", starts_with_arousal),
        Capability("`age_months` at a reset", starts_at_an_age),
        Capability("`scene_seed` at a reset", starts_in_another_scene),
        Capability("`objects` elsewhere at a reset", starts_with_objects_elsewhere),
        Capability("`grow` in the midst of an episode", grows, "grow"),
        Capability(
            "growth by a schedule: `GrowthWrapper` of one infant, else `grow_by`",
            grows_by_a_schedule,
            "grow_by steps_done seek",
            {"GrowthWrapper": (ONE,)},
            {"device": "make it with mimoc.make, or call grow_by of a world or of many infants on the CPU"},
        ),
    ),
    "Infants": (
        Capability("manifest, layouts, limits and spaces", says_what_it_is, WHAT_IT_IS),
        Capability(
            "`keypoints`, `effort`, `skin` and `data`",
            says_how_it_is,
            "data keypoints effort skin observe steps arousal state",
            refusals=STANDS_FOR_OTHERS,
        ),
        Capability("`set_expression`", has_expressions, "set_expression", refusals=STANDS_FOR_OTHERS),
        Capability("`set_arousal`", is_aroused, "set_arousal"),
        Capability("eyes", sees),
        Capability("voice and ears", speaks_and_hears, "play", refusals=SILENT),
    ),
    "States": (
        Capability("`get_state` and `set_state`", keeps_states, "get_state set_state"),
        Capability("`copy.deepcopy`", is_copied, refusals=NOT_COPIED),
        Capability("`pickle`", is_pickled, refusals=NOT_COPIED),
    ),
    "Around infants": (
        Capability("a task of your own", has_a_task_of_a_script),
        Capability("a sense of your own", has_a_sense_of_a_script),
        Capability("a companion of your own", has_a_companion_of_a_script, refusals=NO_COMPANIONS),
        Capability("a caregiver", has_a_caregiver, "caregiver", refusals=NO_CAREGIVER),
        Capability("a mobile with a ribbon", has_a_ribbon),
        Capability("water", is_in_water, refusals=NO_WATER),
        Capability("furniture to start at", starts_at_furniture),
    ),
    "Policies": (
        Capability("policies by name: `policy_vec`", acts_by_policies, functions={"policy_vec": ALL}),
        Capability("a policy for each infant: `policy_vec`", has_policies_by_infant, refusals=ON_CPU),
        Capability("`evaluate`", is_evaluated, functions={"evaluate": KINDS}, refusals=ON_CPU),
    ),
    "Recordings": (
        Capability("`Recorder`", is_recorded, functions={"Recorder": ALL}),
        Capability("`replay_recording`", is_replayed, refusals=NOT_REPLAYED),
        Capability("`measure_recordings`", is_measured),
        Capability("`measure_movement`", has_its_movement_measured, refusals=NOT_REPLAYED),
        Capability("`export_recording`", is_exported),
    ),
    "Pictures": (
        Capability("`render`", is_rendered, "render", refusals={"device": "cannot be rendered; leave out render_mode"}),
        Capability("videos: `record`", is_filmed, functions={"record": KINDS}, refusals=ON_CPU),
        Capability(
            "a page: `view`",
            has_a_page,
            functions={"view": KINDS},
            refusals={"device": "cannot be shown; give a bundle, a spec, a world, a recording or an environment"},
            is_slow=True,
        ),
        Capability("a report of the bundle: `report`", has_a_report),
    ),
    "Learning": (
        Capability("`train`", is_trained, extras=True),
        Capability(
            "Stable-Baselines3: `sb3_vec_env`, `world_vec_env`",
            learns_with_stable_baselines,
            functions={"world_vec_env": (WORLD,)},
            refusals={"device": "Stable-Baselines3 learns from infants on the CPU; leave out device"},
            extras=True,
        ),
        Capability(
            "rsl_rl: `rsl_rl_env`",
            learns_with_rsl_rl,
            functions={"rsl_rl_env": (ON_DEVICE,)},
            refusals=dict.fromkeys([kind.name for kind in KINDS], RSL_RL),
            extras=True,
        ),
    ),
}

PARTS = {  # Other public names of environments, and what they are.
    "bind binding checked close_senses draw_from judge name observer random restore_model restore_signals schedule"
    " spaces start_signals start_task": "what a simulation calls of its infants",
    "close closed metadata render_mode spec np_random np_random_seed close_extras": "Gymnasium's own",
    "reset_each step_each set_attr simulations threads": "what learners, and others that step many, use",
    "overflows room": "how much of a device there is",
}


def all_capabilities() -> list[Capability]:
    return [capability for group in CAPABILITIES.values() for capability in group]


def names_of(kind: Kind) -> set[str]:
    return {name for capability in all_capabilities() if capability.has(kind) for name in capability.names.split()}


def functions_of(kind: Kind) -> set[str]:
    pairs = [pair for capability in all_capabilities() for pair in capability.functions.items()]
    return {name for name, kinds in pairs if kind in kinds}


def table() -> str:
    lines, notes = [f"| | {' | '.join(kind.title for kind in ALL)} |", f"|---{'|:-:' * len(ALL)}|"], list[str]()
    for heading, group in CAPABILITIES.items():
        lines.append(f"| **{heading}** |{' |' * len(ALL)}")
        for capability in group:
            cells = []
            for kind in ALL:
                if (refusal := capability.refusals.get(kind.name)) and refusal not in notes:
                    notes.append(refusal)
                cells.append(f"[{notes.index(refusal) + 1}]" if refusal else "✔")
            lines.append(f"| {capability.about} | {' | '.join(cells)} |")
    reasons = [f"{number}. `{refusal}`" for number, refusal in enumerate(notes, 1)]
    return "\n".join([*lines, "", "Where a number stands, mimoc says in one line why not:", "", *reasons])


BEGIN, END = "<!-- The table of tests/contracts/capabilities.py. -->\n", "\n<!-- End of the table. -->"


def page_with(text: str) -> str:
    page = PAGE.read_text(encoding="utf-8")
    before, _, rest = page.partition(BEGIN)
    return before + BEGIN + text + END + rest.partition(END)[2]


if __name__ == "__main__":
    PAGE.write_text(page_with(table()), encoding="utf-8")
