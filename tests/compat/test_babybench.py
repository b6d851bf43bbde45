"""What each key of a BabyBench configuration becomes, and what is said of the others."""

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import given, settings, strategies as st

import mimoc
from mimoc.base.errors import SpecError, UnknownNameError
from mimoc.compat import SYSTEMS, import_config
from mimoc.compat.babybench import REGIONS
from mimoc.schema import InfantSpec
from mimoc.schema.names import STRENGTH_GROUPS

EXAMPLE = Path(__file__).parents[2] / "configs" / "babybench.yml"
EVERYTHING = {"neck", "trunk", "eyes", "arms", "hands", "legs"}


@pytest.fixture
def imported(tmp_path, monkeypatch) -> Callable[[str], tuple[InfantSpec, list[str]]]:
    """Return what makes a spec of the text of a configuration, and gives the notes on it."""
    monkeypatch.chdir(tmp_path)

    def read(text: str) -> tuple[InfantSpec, list[str]]:
        Path("config.yml").write_text(text)
        found = import_config("babybench", "config.yml")
        Path("spec.yaml").write_text(found.text)
        return mimoc.load_spec("spec.yaml"), [str(note) for note in found.notes]

    return read


@pytest.fixture
def refused(imported) -> Callable[[str], list[str]]:
    def read(text: str) -> list[str]:
        with pytest.raises(SpecError) as caught:
            imported(text)
        return str(caught.value).splitlines()

    return read


def value_at(spec: InfantSpec, path: str):
    """Return the value of a key of a spec, such as `scene.kind`."""
    found = spec
    for step in path.split("."):
        found = getattr(found, step)
    return found


# What becomes of keys.


@pytest.mark.parametrize(
    ("text", "path", "value"),
    [
        ("scene: base", "scene.kind", "flat"),
        ("scene: crib", "scene.kind", "crib"),
        ("scene: cubes", "scene.kind", "flat"),
        ("scene: cubes", "scene.toys.source", "builtin"),
        ("scene: cubes", "scene.pose", "sitting"),
        ("scene: cubes", "scene.held", ("hip",)),
        ("scene: crib", "scene.held", ("lower_body",)),
        ("scene: base", "scene.held", ()),
        ("behavior: hand_regard", "body.hands", "five_finger"),
        ("behavior: self_touch", "body.hands", "mitten"),
        ("behavior: hand_regard\nmimo_version: v1", "body.hands", "mitten"),
        ("position: sitting", "scene.pose", "sitting"),
        ("seed: 7", "scene.seed", 7),
        ("frame_skip: 1", "control.step_ms", 5),
        ("frame_skip: 4", "control.step_ms", 20),
        ("frame_skip: 4", "control.timestep_ms", 5),
        ("max_episode_steps: 500", "task.kind", "free"),
        ("max_episode_steps: 500", "task.steps", 500),
        ("actuation_model: spring_damper", "actuation.model", "torque"),
        ("actuation_model: muscle", "actuation.model", "muscle"),
        ("actuation_model: positional", "actuation.model", "position"),
        ("vision: true\nvision_resolution: 128", "senses.vision.width_px", 128),
        ("vision: true\nvision_resolution: 128", "senses.vision.height_px", 128),
        ("vision_active: true", "senses.vision.acuity", "off"),
        ("vision_active: true\nvision_fovy: 90", "senses.vision.fovy_deg", 90),
        ("vision: false\nvision_resolution: 128", "senses.vision", None),
        ("touch: true", "senses.touch.density", 1),
        ("touch_active: true\ntouch_scale: 2", "senses.touch.density", 0.25),
        ("touch: true\ntouch_scale: 100", "senses.touch.density", 0.1),
        ("touch: true\ntouch_function: normal_force", "senses.touch.quantity", "normal"),
        ("touch: true\ntouch_response: spread_linear", "senses.touch.response", "linear"),
        ("touch: true\ntouch_response: nearest", "senses.touch.response", "nearest"),
        ("touch: false\ntouch_scale: 2", "senses.touch", None),
        ("touch: true\ntouch_scale: 0", "senses.touch", None),
        ("touch_scale: 2", "senses.touch.density", 0.25),
        ("vestibular: True", "senses.vestibular.include", ("accelerometer", "gyro")),
        ("vestibular: False", "senses.vestibular", None),
        ("proprioception: False", "senses.proprioception", None),
        ("proprio_torque: False", "senses.proprioception.include", ("velocity", "limits", "actuation")),
        ("mimo_version: v2", "body.hands", "five_finger"),
        ("model: mimo_v1", "body.hands", "mitten"),
        ("age_months: 6", "age_months", 6),
    ],
)
def test_a_key_has_its_counterpart(imported, text, path, value):
    assert value_at(imported(text)[0], path) == value


def test_what_is_not_said_is_as_in_babybench(imported):
    """MIMo's published body of 18 months on a flat floor, all of it moved, and no sense but proprioception."""
    spec, notes = imported("behavior: none")
    assert notes == []
    assert spec == InfantSpec.model_validate(
        {
            "mimoc": 1,
            "name": "config",
            "age_months": 18,
            "development": "published",
            "senses": {"proprioception": {}},
        }
    )


@pytest.mark.parametrize("word", ["False", "false", "no", "off", "0"])
def test_yes_and_no_are_those_of_yaml_1_1(imported, word):
    """`no` is a word in YAML 1.2, which specs are written in."""
    assert set(imported(f"act_legs: {word}")[0].actuation.regions) == EVERYTHING - {"legs"}


# Regions.


@pytest.mark.parametrize(
    ("text", "regions"),
    [
        ("act_arms: true\nact_legs: true", None),
        ("act_head: false", EVERYTHING - {"neck"}),
        ("act_body: false", EVERYTHING - {"trunk"}),
        ("act_left_arm: false", EVERYTHING - {"arms"} | {"right_arm"}),
        ("act_arms: false\nact_left_arm: true", EVERYTHING - {"arms"} | {"left_arm"}),
        ("act_hands: false\nact_fingers: true", None),
        ("act_hands: false\nact_fingers: false", EVERYTHING - {"hands"}),
        ("lock_legs: true", None),
        ("lock_legs: true\nact_legs: true\nact_arms: false", EVERYTHING - {"legs", "arms"}),
        ("".join(f"act_{name}: false\n" for name in sorted(EVERYTHING)), set()),
    ],
)
def test_regions_that_act_are_groups_that_take_commands(imported, text, regions):
    found = imported(text)[0].actuation.regions
    assert (found if found is None else set(found)) == regions


@pytest.mark.parametrize(
    ("text", "locked"),
    [
        ("lock_legs: false", ()),
        ("lock_legs: true", ("legs",)),
        ("lock_eyes: true\nlock_left_hand: true", ("eyes", "left_hand")),
        ("lock_fingers: true", ()),
        ("lock_fingers: true\nlock_hands: true", ("hands",)),
        ("scene: cubes", ("trunk", "legs")),
        ("scene: cubes\nlock_eyes: true\nlock_legs: false", ("trunk", "eyes", "legs")),
    ],
)
def test_locked_regions_are_locked_groups(imported, text, locked):
    assert imported(text)[0].actuation.locked == locked


@pytest.mark.parametrize(
    ("text", "regions"),
    [
        ("touch: true\ntouch_head: true", None),
        ("touch: true\ntouch_legs: false\ntouch_feet: false", EVERYTHING - {"legs"}),
        ("touch_legs: false", EVERYTHING - {"legs"}),
    ],
)
def test_regions_with_touch_are_groups_with_skin(imported, text, regions):
    found = imported(text)[0].senses.touch
    if regions is None:
        assert found.regions is None
    else:
        assert set(found.regions) == regions


def test_touch_of_no_region_is_no_touch(imported):
    text = "touch: true\n" + "".join(f"touch_{name}: false\n" for name in EVERYTHING)
    assert imported(text)[0].senses.touch is None


def test_locked_groups_are_not_actuated_and_this_is_noted(imported):
    spec, notes = imported("act_legs: true\nlock_legs: true\n")
    assert (spec.actuation.regions, spec.actuation.locked) == (None, ("legs",))
    (note,) = notes
    assert note.startswith("config.yml:1:1: act_legs: ")
    assert "'legs' is locked" in note


@pytest.mark.parametrize(
    ("text", "key", "said"),
    [
        ("act_hands: true\nact_fingers: false", "act_fingers", "part of 'hands', which is actuated"),
        ("act_feet: false", "act_feet", "part of 'legs', which is actuated"),
        ("act_legs: false\nact_left_foot: true", None, ""),
        ("lock_toes: true", "lock_toes", "part of 'legs', which is not locked"),
        ("touch_fingers: false", "touch_fingers", "part of 'hands', which has skin"),
    ],
)
def test_regions_that_are_part_of_a_group_are_noted(imported, text, key, said):
    notes = imported(text)[1]
    assert [note.split(": ")[1] for note in notes] == ([key] if key else [])
    assert all(said in note for note in notes)


def test_every_region_belongs_to_groups_of_the_spec_language():
    assert {group for region in REGIONS.values() for group in region.groups} <= set(STRENGTH_GROUPS)


# Notes.


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("behavior: self_touch", "behavior: no counterpart; mimoc has no reward for 'self_touch'"),
        ("behavior: hand_regard", "behavior: no counterpart; mimoc has no reward for 'hand_regard'"),
        ("save_dir: results", "save_dir: no counterpart; "),
        ("save_dir:", "save_dir: no counterpart; "),
        ("save_logs_every: 10", "save_logs_every: no counterpart; "),
        ("render_size: 480", "render_size: no counterpart; "),
        ("scene: crib", "scene: the initial pose is mimoc's 'supine'"),
        ("actuation_model: spring_damper", "actuation_model: the action is ordered by limb"),
        ("actuation_model: muscle", "; the two muscles of a joint are adjacent"),
        (
            "actuation_model: positional",
            "; its range is -1 to 1 for the range of each joint, where BabyBench uses angles",
        ),
        ("proprio_limits: false", "proprio_limits: excluded here; BabyBench's code ignores this key"),
        (
            "touch: true\ntouch_response: spread_exponential",
            "touch_response: no counterpart; converted to spread_linear",
        ),
        ("frame_skipp: 3", "frame_skipp: no counterpart; unknown key; did you mean 'frame_skip'?"),
        ("warp: 9", "warp: no counterpart; unknown key"),
        ("act_tail: true", "act_tail: no counterpart; mimoc has no region 'tail', "),
        ("model: ppo", "model: no counterpart; not one of MIMo's bodies; "),
    ],
)
def test_settings_without_counterpart_are_noted_with_their_line(imported, text, said):
    (note,) = imported(f"# A comment.\n{text}\n")[1]
    assert said in note
    assert note.startswith(f"config.yml:{2 + text.count(chr(10))}:1: ")


def test_a_reclined_infant_and_its_cubes_are_both_noted(imported):
    notes = imported("scene: cubes")[1]
    assert len(notes) == 2
    for said in ("BabyBench's leans back by 55 degrees", "mimoc has no toy cubes"):
        assert sum(said in note for note in notes) == 1


def test_the_notes_stand_in_the_spec_as_well(imported):
    _, notes = imported("save_dir: x\nwarp: 9\n")
    comments = [line for line in Path("spec.yaml").read_text().splitlines() if line.startswith("#")]
    assert comments[0] == "# Converted from BabyBench's config.yml by `mimoc import`."
    assert [line.split(": ", 1)[1] for line in comments[2:]] == [note.split(": ", 1)[1] for note in notes]


def test_no_key_can_break_out_of_its_comment(imported):
    _, notes = imported('"a\\u2028b\\nname: evil": 1\n')
    assert len(notes) == 1
    assert mimoc.load_spec("spec.yaml").name == "config"


# A whole configuration.


def test_a_whole_configuration(snapshot):
    assert import_config("babybench", EXAMPLE).text == snapshot


def test_the_spec_does_not_depend_on_where_the_configuration_lies(tmp_path):
    (tmp_path / EXAMPLE.name).write_bytes(EXAMPLE.read_bytes())
    assert import_config("babybench", tmp_path / EXAMPLE.name).text == import_config("babybench", EXAMPLE).text


def test_what_an_example_becomes_is_built_and_runs(tmp_path):
    (tmp_path / "spec.yaml").write_text(import_config("babybench", EXAMPLE).text)
    with closing(mimoc.make(mimoc.load_spec(tmp_path / "spec.yaml"))) as env:
        observation, _ = env.reset(seed=0)
        assert observation.keys() == {"proprioception", "vestibular", "touch", "eye_left", "eye_right"}
        assert env.action_space.shape == (44 - 3 - 6,)  # The trunk has three actuators, the eyes six.
        for _ in range(7):
            _, _, terminated, truncated, _ = env.step(env.action_space.sample())
        assert not terminated
        assert not truncated


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("config_self_touch.yml", "config_self_touch"),
        ("My Config-2.yaml", "my_config_2"),
        ("2025.yml", "babybench_2025"),
        ("Säugling.yml", "s_ugling"),
        ("赤.yml", "babybench"),
        ("x" * 80 + ".yml", "x" * 64),
    ],
)
def test_the_infant_is_called_after_the_file(tmp_path, file, name):
    (tmp_path / file).write_text("scene: base\n")
    assert import_config("babybench", tmp_path / file).spec["name"] == name


REGION_KEYS = [f"{prefix}{name}" for prefix in ("act_", "lock_", "touch_") for name in REGIONS]
SETTINGS = {
    "behavior": ["none", "self_touch", "hand_regard"],
    "save_dir": ["results"],
    "max_episode_steps": [1, 1000],
    "frame_skip": [1, 2, 200],
    "render_size": [480],
    "scene": ["base", "crib", "cubes"],
    "position": ["supine", "sitting"],
    "proprioception": ["True", "False"],
    "proprio_limits": ["True", "False"],
    "proprio_velocity": ["False"],
    "vestibular": ["True", "False"],
    "vision": ["True", "False"],
    "vision_resolution": [1, 64, 2048],
    "touch": ["True", "False"],
    "touch_scale": [0.001, 1, 3.0, 1000],
    "touch_function": ["force_vector", "normal_force"],
    "touch_response": ["nearest", "spread_linear", "spread_exponential"],
    "actuation_model": ["spring_damper", "muscle", "positional"],
    "mimo_version": [1, "v2"],
    "seed": [0, 2**53],
    **{key: ["True", "False"] for key in REGION_KEYS},
}


@settings(max_examples=40)
@given(
    st.fixed_dictionaries({}, optional={key: st.sampled_from(values) for key, values in SETTINGS.items()}).filter(bool)
)
def test_any_configuration_gives_a_spec_that_reads(tmp_path_factory, settings):
    folder = tmp_path_factory.mktemp("any")
    (folder / "config.yml").write_text("".join(f"{key}: {value}\n" for key, value in settings.items()))
    imported = import_config("babybench", folder / "config.yml")
    (folder / "spec.yaml").write_text(imported.text)
    spec = mimoc.load_spec(folder / "spec.yaml")
    assert spec.age_months == 18
    assert {note.key for note in imported.notes} <= settings.keys()


# Bad configurations.

BAD = {
    "no such region's value": "act_hands: maybe",
    "nothing for a value": "act_hands:\nscene:\nframe_skip:\n",
    "a section for a value": "touch: {scale: 3}",
    "a list for a number": "vision: true\nvision_resolution: [64, 64]",
    "text for a number": "frame_skip: one\ntouch: true\ntouch_scale: large",
    "numbers out of range": "frame_skip: 0\nmax_episode_steps: 0\nvision: true\nvision_resolution: 4096\nseed: -1",
    "half a number": "frame_skip: 1.5",
    "unknown words": "scene: kitchen\nactuation_model: musle\nposition: flying\nmimo_version: 3",
    "a truth for a word": "scene: true",
    "two names for one thing": "vision: true\nvision_active: false",
    "repeated keys": "scene: base\nscene: crib",
    "not a number": "touch: true\ntouch_scale: .nan",
    "a tag": "scene: !!python/name:os.system base",
    "a list": "- scene: base",
    "nothing": "# nothing\n",
    "no YAML": "scene: [base",
}


@pytest.mark.parametrize("case", BAD)
def test_what_a_bad_configuration_is_told(refused, snapshot, case):
    assert refused(BAD[case]) == snapshot


def test_a_configuration_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(SpecError, match="the file does not exist"):
        import_config("babybench", tmp_path / "nowhere.yml")


def test_an_unknown_system_is_refused():
    assert set(SYSTEMS) == {"babybench", "mimo"}
    with pytest.raises(UnknownNameError, match="'babybnch' is not a format to import from; did you mean 'babybench'"):
        import_config("babybnch", EXAMPLE)


def test_a_dash_is_standard_output_and_notes_are_beside_it(invoke, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = invoke("import", "babybench", EXAMPLE, "-o", "-")
    assert (done.code, done.out) == (0, import_config("babybench", EXAMPLE).text)
    assert "save_dir: no counterpart" in done.err
    assert not list(tmp_path.iterdir())
