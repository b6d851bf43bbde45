import dataclasses
import json
import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from support.full import FULL

import mimoc
from mimoc.base.errors import BundleError, KindError, SpecError
from mimoc.bundle.io import digests
from mimoc.components.senses.vestibular import VestibularEntry, VestibularSpec
from mimoc.schema import plugins
from mimoc.schema.kinds import SCENES, SENSES, TASKS, PolicyKind, SceneKind, SenseKind, TaskKind

CHECKOUT = Path(__file__).resolve().parents[1]


def record(name: str = "echo") -> SenseKind:
    return SenseKind(name, VestibularSpec, VestibularEntry, "mimoc.components.senses.vestibular", "os")


@pytest.fixture
def spec_at():
    return lambda age_months: mimoc.InfantSpec(mimoc=1, name="a", age_months=age_months, senses={"vestibular": {}})


@pytest.mark.parametrize("name", ["Echo", "1st", "two words", "", "a-b", "a.b"])
def test_a_name_that_is_no_key_is_refused(name):
    with pytest.raises(KindError, match="cannot name a sense; use lower-case letters"):
        mimoc.register(record(name))


def test_a_name_of_mimocs_own_and_what_is_no_record_are_refused():
    with pytest.raises(KindError, match="'touch' is no record of a kind; pass one of SenseKind, ActuationKind"):
        mimoc.register("touch")
    with pytest.raises(KindError, match="there is a sense 'touch' already, from mimoc; choose another name"):
        mimoc.register(record("touch"))


class NoSpec:
    """What is no section."""


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        (record("sensory"), "'sensory_ms' is already another key of DelaysSpec"),
        (record("legs"), "'legs' is already another key of DelaysEntry"),
        (record("motor"), "'motor' is already the name of commands among the delays"),
        (TaskKind("nap", VestibularSpec, VestibularEntry, "os", "os"), "the task 'nap' does not fit"),
        (
            SenseKind("echo", NoSpec, VestibularEntry, "os", "os"),
            "SenseKind.spec is <class .*NoSpec.>: input should be a sub",
        ),
        (SceneKind("seed", "A field.", "os", spec=VestibularSpec), "'seed' is already another key of SceneSpec"),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_a_record_that_does_not_fit_is_refused_and_leaves_everything_as_it_was(wrong, reason):
    before = list(SENSES), list(TASKS), list(SCENES), mimoc.InfantSpec.model_json_schema()
    with pytest.raises(KindError, match=reason):
        mimoc.register(wrong)
    assert (list(SENSES), list(TASKS), list(SCENES), mimoc.InfantSpec.model_json_schema()) == before
    assert mimoc.InfantSpec(mimoc=1, name="a", age_months=3, delays={"motor_ms": 5}).delays.motor_ms == 5


def test_a_record_whose_module_does_not_exist_is_refused():
    message = r"SenseKind.build names the module 'no_such.module', which does not exist"
    with pytest.raises(KindError, match=message):
        mimoc.register(SenseKind("echo", VestibularSpec, VestibularEntry, "no_such.module", "os"))


def wrong_fields():
    for table in plugins.GROUPS.values():
        whole = next(iter(table.values()))
        for field in dataclasses.fields(table.record):
            yield pytest.param(whole, field.name, object(), id=f"{table.record.__name__}.{field.name}")


@pytest.mark.parametrize(("whole", "name", "wrong"), [*wrong_fields()])
def test_a_field_of_the_wrong_type_is_refused_by_its_name(whole, name, wrong):
    record = dataclasses.replace(whole, **({"name": "nap"} | {name: wrong}))
    with pytest.raises(KindError, match=rf"^{type(whole).__name__}\.{name} is <object object at .*>: [^\n]*$"):
        mimoc.register(record)


def test_a_script_may_replace_what_it_registered_before(registered):
    with registered(record()):
        mimoc.register(record())
        assert SENSES.distribution("echo") == ""


def test_a_registered_sense_is_in_the_spec_language_and_among_the_delays(registered):
    with registered(record()):
        spec = mimoc.InfantSpec(mimoc=1, name="a", age_months=3, senses={"echo": {}}, delays={"echo_ms": 10})
        assert spec.senses.echo == VestibularSpec()
        assert spec.delays.echo_ms == 10
    with pytest.raises(
        SpecError, match=r"<a>: senses\.echo: unknown key; choose from hearing, pain, proprioception, touch"
    ):
        mimoc.InfantSpec(mimoc=1, name="a", age_months=3, senses={"echo": {}})


class Distribution:
    name = "broken"


def entry_point(value: str, group: str = "mimoc.senses") -> EntryPoint:
    found = EntryPoint("echo", value, group)
    vars(found)["dist"] = Distribution()
    return found


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ("no_such_module:KIND", "No module named 'no_such_module'"),
        ("mimoc.components.senses.touch:NO_KIND", "has no attribute 'NO_KIND'"),
        ("mimoc.components.senses.touch:KIND", "there is a sense 'touch' already, from mimoc"),
        ("mimoc.components.tasks.reach:KIND", "it is a task, which does not belong to the group 'mimoc.senses'"),
        ("math:pi", "is no record of a kind"),
    ],
)
def test_a_plug_in_that_cannot_be_loaded_is_a_warning_and_left_out(value, reason):
    before = list(SENSES)
    with pytest.warns(UserWarning, match=f"the plug-in 'echo' of 'broken' cannot be loaded: .*{reason}"):
        plugins._load(entry_point(value))
    assert list(SENSES) == before


@pytest.fixture
def foreign(tmp_path, monkeypatch):
    """Return what installs a distribution, such as `mimoc-foreign`, with a sense whose module has some text."""

    def install(text: str, name: str = "foreign", sense: str = "echo") -> None:
        info = tmp_path / f"mimoc_{name}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: mimoc-{name}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[mimoc.senses]\n{sense} = mimoc_{name}:KIND\n")
        (tmp_path / f"mimoc_{name}.py").write_text(text)

    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    return install


RECORD = """
from mimoc.schema.kinds import SenseKind
from mimoc.components.senses.vestibular import VestibularEntry, VestibularSpec
KIND = SenseKind("echo", VestibularSpec, VestibularEntry, {build!r}, "mimoc.components.senses.vestibular.run")
"""
USABLE = RECORD.format(build="mimoc.components.senses.vestibular")


def senses(plugins: str | None, monkeypatch) -> tuple[list[str], str]:
    monkeypatch.delenv("MIMOC_PLUGINS") if plugins is None else monkeypatch.setenv("MIMOC_PLUGINS", plugins)
    program = "import mimoc; mimoc.InfantSpec; from mimoc.schema.kinds import SENSES; print(*SENSES)"
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return process.stdout.split(), process.stderr


@pytest.mark.full
@pytest.mark.parametrize(
    ("plugins", "is_known"), [(None, True), ("none", False), ("", False), ("Mimoc_Foreign", True), ("numpy", False)]
)
def test_a_variable_names_the_plug_ins_that_are_used(plugins, is_known, foreign, monkeypatch):
    foreign(USABLE)
    known, printed = senses(plugins, monkeypatch)
    assert ("echo" in known) == is_known
    assert ("MIMOC_PLUGINS: no installed package 'numpy' has plug-ins" in printed) == (plugins == "numpy")


@pytest.mark.full
@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("import sys; sys.exit(3)", "SystemExit(3)"),
        ("raise ValueError('no')", "ValueError('no')"),
        (RECORD.format(build="mimoc_foreign.build"), "SenseKind.build names the module 'mimoc_foreign.build', which"),
        (RECORD.format(build=None), "SenseKind.build is None: input should be a valid string"),
    ],
    ids=["exit", "error", "no module", "wrong type"],
)
def test_a_bad_plug_in_costs_the_command_line_one_line(text, reason, foreign, monkeypatch):
    foreign(text)
    monkeypatch.delenv("MIMOC_PLUGINS")
    command = [sys.executable, "-m", "mimoc", "schema"]
    process = subprocess.run(command, capture_output=True, text=True, check=False)
    (line,) = process.stderr.splitlines()
    assert process.returncode == 0
    assert line.startswith(f"warning: the plug-in 'echo' of 'mimoc-foreign' cannot be loaded: {reason}")
    assert line.endswith("it is left out (MIMOC_PLUGINS=none leaves out all plug-ins)")


@FULL
@pytest.mark.slow
def test_tests_do_not_see_what_others_have_installed(foreign, monkeypatch):
    foreign(USABLE)
    foreign("import sys; sys.exit(3)", "broken", "noise")
    known, printed = senses(None, monkeypatch)
    assert "echo" in known
    assert "the plug-in 'noise' of 'mimoc-broken' cannot be loaded" in printed
    tests = [CHECKOUT / "tests" / "schema" / f"test_{name}.py" for name in ("spec_fields", "json_schema")]
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *tests]
    process = subprocess.run(command, cwd=CHECKOUT, capture_output=True, text=True, check=False)
    assert process.returncode == 0, process.stdout


def test_a_plug_in_whose_import_hangs_is_left_out(tmp_path, monkeypatch):
    (tmp_path / "mimoc_hanging.py").write_text("while True:\n    try: pass\n    except Exception: pass")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(plugins, "IMPORT_LIMIT_S", 0.1)
    with pytest.warns(UserWarning, match=r"the plug-in 'echo' of 'broken' .* importing it takes more than 0\.1 s"):
        plugins._load(entry_point("mimoc_hanging:KIND"))


def test_a_plug_in_whose_module_fails_when_it_is_first_needed_is_one_error(tmp_path, monkeypatch, registered):
    (tmp_path / "mimoc_late.py").write_text("import sys; sys.exit()")
    monkeypatch.syspath_prepend(str(tmp_path))
    late = SenseKind("echo", VestibularSpec, VestibularEntry, "mimoc_late", "mimoc_late")
    with registered(late), pytest.raises(KindError, match="the plug-in module 'mimoc_late' has no usable function"):
        mimoc.build(mimoc.InfantSpec(mimoc=1, name="a", age_months=3, senses={"echo": {}}))


@pytest.fixture(scope="module")
def folder(bundle_at, tmp_path_factory):
    return mimoc.write_bundle(bundle_at(9), tmp_path_factory.mktemp("bundles") / "infant")


def resealed(folder, **changes):
    manifest = json.loads((folder / "manifest.json").read_text())
    content = json.dumps({**manifest, **changes}).encode()
    (folder / "manifest.json").write_bytes(content)
    lock = json.loads((folder / "lock.json").read_text())
    lock["files"] |= digests({"manifest.json": content})
    (folder / "lock.json").write_text(json.dumps(lock))
    return folder


@pytest.fixture
def canary(tmp_path, monkeypatch):
    (tmp_path / "mimoc_canary.py").write_text("KIND = None\ndef bind(*_): ...\ndef build(*_): ...\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield "mimoc_canary"
    assert "mimoc_canary" not in sys.modules


@pytest.mark.parametrize(
    "hostile",
    [
        lambda name: {"plugins": {f"senses.{name}": name}},
        lambda name: {"plugins": {f"tasks.{name}": ""}},
        lambda name: {"plugins": {"senses.touch": name}},
        lambda name: {"plugins": {name: name, "": "", "senses.": name, "tasks.a.b": name, "os.path": name}},
        lambda name: {"plugins": [name]},
        lambda name: {"plugins": {"senses.sound": {"run": name}}},
        lambda name: {"task": {"kind": name, "steps": None}},
        lambda name: {"task": {"kind": "free", "steps": None, "run": name}},
        lambda name: {"senses": {name: {}}},
        lambda name: {"senses": {"touch": {"run": f"{name}:bind"}}},
        lambda name: {"actuation": {"model": f"{name}.run", "actuators": []}},
        lambda name: {"actuation": {"model": name, "actuators": [], "build": name}},
    ],
)
def test_no_manifest_makes_mimoc_import_a_module(hostile, canary, bundle_at, tmp_path):
    folder = resealed(mimoc.write_bundle(bundle_at(9), tmp_path / "infant"), **hostile(canary))
    with pytest.raises(BundleError) as caught:
        mimoc.make(folder)
    assert str(folder) in str(caught.value)


def test_a_bundle_names_the_kind_that_is_missing_and_what_to_install(bundle_at, tmp_path):
    folder = resealed(mimoc.write_bundle(bundle_at(9), tmp_path / "infant"), plugins={"tasks.kick": "mimoc-nursery"})
    message = "needs the task 'kick' from the plug-in 'mimoc-nursery', which is not here; install 'mimoc-nursery'"
    with pytest.raises(BundleError, match=message):
        mimoc.read_bundle(folder)


def test_a_kind_of_the_same_name_from_elsewhere_does_not_count(bundle_at, tmp_path):
    folder = resealed(mimoc.write_bundle(bundle_at(9), tmp_path / "infant"), plugins={"senses.touch": "other"})
    with pytest.raises(BundleError, match="the sense 'touch' from the plug-in 'other', but here it comes from 'mimoc'"):
        mimoc.read_bundle(folder)


class Clock:
    delay_ms = 10

    def bind(self, model, bundle):
        self.space = gymnasium.spaces.Box(0.0, 1.0, (2,), np.float32)
        self.step_s = model.opt.timestep

    def __call__(self, data):
        return [data.time, 5.0]


class Countdown:
    steps = 3
    spaces = {"left": gymnasium.spaces.Box(0.0, 3.0, (1,), np.float32)}  # noqa: RUF012 - As a user would write it.

    def start(self, data, generator):
        self.state = {"left": 3}

    def observe(self):
        return {"left": np.array([self.state["left"]], np.float32)}

    def judge(self, data, action, effort):
        self.state = {"left": self.state["left"] - 1}
        return mimoc.Verdict({"left": float(self.state["left"])}, success=self.state["left"] == 0)


class Stillness:
    """A task that has no more than it must."""

    def judge(self, data, action, effort):
        return -1.0


def test_a_sense_and_a_task_can_be_passed_as_objects(spec_at):
    env = mimoc.make(spec_at(9), task=Countdown(), senses={"clock": Clock()})
    check_env(env.unwrapped, skip_render_check=True)
    observation, _ = env.reset(seed=0)
    assert observation["left"] == [3]
    seen = [env.step(env.action_space.sample()) for _ in range(3)]
    assert [reward for _, reward, *_ in seen] == [2, 1, 0]
    assert [truncated for *_, truncated, _ in seen] == [False, False, True]
    assert seen[-1][-1]["is_success"]
    np.testing.assert_allclose(seen[-1][0]["clock"], [0.02, 1.0], atol=1e-6)  # 10 ms late, and clipped.


def test_a_reward_alone_is_enough_for_a_task(spec_at):
    env = mimoc.make(spec_at(9), task=Stillness())
    env.reset(seed=0)
    assert env.step(env.action_space.sample())[1:4] == (-1.0, False, False)


def test_a_state_of_an_infant_with_objects_comes_back(spec_at):
    env = mimoc.make(spec_at(9), task=Countdown(), senses={"clock": Clock()}).unwrapped
    env.reset(seed=0)
    env.step(env.action_space.sample())
    state = env.get_state()
    action = env.action_space.sample()
    there = env.step(action)
    env.set_state(state)
    here = env.step(action)
    assert here[1:] == there[1:]
    for name, value in there[0].items():
        np.testing.assert_array_equal(here[0][name], value)


def test_a_sense_of_a_name_that_is_taken_is_refused(spec_at):
    with pytest.raises(KindError, match="has a sense 'vestibular' already; pass yours under another name"):
        mimoc.make(spec_at(9), senses={"vestibular": Clock()})


def test_a_delay_that_is_no_whole_number_of_physics_steps_is_refused(spec_at):
    clock = Clock()
    clock.delay_ms = 3
    with pytest.raises(KindError, match=r"sense 'clock': 3 ms is 0\.60 steps of 5 ms"):
        mimoc.make(spec_at(9), senses={"clock": clock})


def test_tasks_and_policies_of_others_are_in_their_tables(registered):
    task = TASKS["free"]
    own = TaskKind("nap", task.spec, task.entry, task.build, task.run)
    with registered(PolicyKind("still", "does nothing", many="mimoc.policies.policy:bind_zero")), registered(own):
        assert list(TASKS)[-1] == "nap"
