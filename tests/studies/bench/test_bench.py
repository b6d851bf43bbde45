"""The benchmark: what it has, what a policy scores, results that come out again, and runs that are interrupted."""

import json
import sys
from types import SimpleNamespace

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import MimocError, PolicyError
from mimoc.policies.skill import Postures, write_postures
from mimoc.studies import bench
from mimoc.studies.bench import babybench
from mimoc.studies.bench.babybench import RegardLog, TouchLog, hand_regard_score, self_touch_score
from mimoc.studies.bench.scores import markdown_tables, movements_in, read_results, score_cell, wilson_interval
from mimoc.studies.bench.table import BenchTask, Cell, bench_table, chosen_cells

TWO = {"tasks": ["reach", "grasp"], "ages_months": [12], "episodes": 2}
"""Two tasks that take a tenth of a second an episode."""
POLICIES = '''
import numpy as np

class Sway:
    """Sways all joints, from the beginning in each episode."""
    def __init__(self, env):
        self.shape, self.step = env.action_space.shape, 7

    def reset(self):
        self.step = 0

    def act(self, observation):
        self.step += 1
        return np.full(self.shape, 0.3 * np.sin(0.1 * self.step))

class OfSpaces:
    def __init__(self, observation_space, action_space):
        self.action = 0 * action_space.sample()

    def act(self, observation):
        return self.action

class Actless:
    def __init__(self, env):
        pass

class Short:
    def __init__(self, env):
        pass

    def act(self, observation):
        return np.zeros(1)

class Broken(Short):
    def act(self, observation):
        return observation["sonar"]
'''


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delitem(sys.modules, "entered_policies", raising=False)
    (tmp_path / "entered_policies.py").write_text(POLICIES)
    return tmp_path


def test_there_are_eight_tasks_at_four_ages_each_and_no_seed_is_for_practice_and_for_the_test():
    table, seeds = bench_table(), bench_table().seeds
    assert (table.benchmark, len(table.tasks)) == ("mimoc-bench-1", 8)
    assert {len(task.ages_months) for task in table.tasks.values()} == {4}
    assert len(chosen_cells()) == 32
    assert seeds.practice[0] < seeds.practice[1] <= seeds.test[0] < seeds.test[1]
    assert max(cell.episodes for cell in chosen_cells()) < seeds.test[1] - seeds.test[0]


@pytest.mark.parametrize("task", bench_table().tasks)
def test_every_infant_can_be_built(task):
    cells = chosen_cells([task])
    for cell in (cells[0], cells[-1]):
        assert mimoc.build(cell.spec).manifest.child.age_months == cell.age_months


@pytest.mark.parametrize(
    ("successes", "count", "low", "high"),
    [(0, 10, 0.0, 0.2775), (5, 10, 0.2366, 0.7634), (10, 10, 0.7225, 1.0), (81, 263, 0.2553, 0.3662)],
)
def test_the_interval_is_that_of_wilson(successes, count, low, high):
    """The last is that of Newcombe 1998 (Stat Med 17: 857), table I; the others by R's `prop.test` uncorrected."""
    assert wilson_interval(successes, count) == pytest.approx((low, high), abs=5e-5)


def test_smoothness_is_of_windows_in_which_something_moves():
    times_s = np.arange(450) * 0.01
    path_m = np.outer(np.where(times_s < 2, 0.1 * np.sin(3 * times_s), 0.0), [1, 0, 0])
    assert [one.duration_s for one in movements_in(path_m, 0.01)] == [2.0]
    assert [one.duration_s for one in movements_in(path_m[:50], 0.01)] == [pytest.approx(0.49)]
    assert movements_in(path_m[:1], 0.01) == []


@pytest.mark.full
def test_scores_are_those_of_the_episodes(here):
    results = mimoc.run_bench("random", "random.json", **TWO)
    scores = results.cells["reach/12"]
    first = bench_table().seeds.test[0]
    env = mimoc.make(Cell("reach", 12).spec)
    episodes = mimoc.evaluate(env, "random", episodes=2, seed=first)
    assert scores.returns == tuple(episode.total_reward for episode in episodes)
    assert scores.successes == sum(episode.success for episode in episodes)
    assert scores.mean_return == pytest.approx(np.mean(scores.returns))
    assert scores.success_95 == wilson_interval(scores.successes or 0, 2)
    assert scores.effort > 0
    assert (scores.arc_length or 0.0) < -1
    assert (scores.likeness, list(results.cells)) == (None, ["reach/12", "grasp/12"])


@pytest.mark.full
def test_results_come_out_again_to_the_bit(here):
    written = mimoc.run_bench("random", "random.json", **TWO)
    assert read_results("random.json").content == (here / "random.json").read_bytes() == written.content
    assert mimoc.verify_bench("random.json") == {"reach/12": [], "grasp/12": []}
    assert [path.name for path in here.glob("*.json*")] == ["random.json"]


@pytest.mark.full
@pytest.mark.slow
def test_results_do_not_depend_on_the_number_of_processes(here):
    cells = {"tasks": ["grasp"], "ages_months": [9, 12], "episodes": 2}
    one, two = (mimoc.run_bench("random", f"of_{count}.json", **cells, processes=count) for count in (1, 2))
    assert one.content == two.content
    with pytest.raises(PolicyError, match=r"act failed in entered_policies.py:36"):
        mimoc.run_bench("entered_policies:Broken", "x.json", **cells, processes=2)


def test_what_differs_is_said(here):
    mimoc.run_bench("zero", "zero.json", tasks=["grasp"], ages_months=[12], episodes=1)
    data = json.loads((here / "zero.json").read_text())
    scores = data["cells"]["grasp/12"]
    scores["effort"] = 1.0
    (here / "zero.json").write_text(json.dumps(data))
    (difference,) = mimoc.verify_bench("zero.json")["grasp/12"]
    assert difference.startswith("effort 1, now 0.")
    scores |= {"effort": float(difference.split()[-1]), "states": "sha256:0"}
    (here / "zero.json").write_text(json.dumps(data))
    (difference,) = mimoc.verify_bench("zero.json")["grasp/12"]
    assert difference.startswith("the states of the simulation")


@pytest.mark.full
def test_an_interrupted_run_goes_on(here, monkeypatch):
    def interrupted(done: int, total: int) -> None:
        if done:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        mimoc.run_bench("random", "random.json", **TWO, progress=interrupted)
    assert not (here / "random.json").exists()
    again = []
    monkeypatch.setattr(bench, "score_cell", lambda *job: again.append(job[0]) or score_cell(*job))
    resumed = mimoc.run_bench("random", "random.json", **TWO)
    assert again == [Cell("grasp", 12)]
    assert resumed.content == mimoc.run_bench("random", "whole.json", **TWO).content
    assert len(again) == 3


def test_a_class_acts_and_its_module_is_known(here):
    """Made anew for each infant, and set back for each episode."""
    one = {"tasks": ["grasp"], "ages_months": [12]}
    sway = mimoc.run_bench("entered_policies:Sway", "sway.json", **one, episodes=2)
    assert list(sway.policy_files) == ["entered_policies.py"]
    assert mimoc.verify_bench("sway.json") == {"grasp/12": []}
    spaces = mimoc.run_bench("entered_policies:OfSpaces", "spaces.json", **one, episodes=1)
    zero = mimoc.run_bench("zero", "zero.json", **one, episodes=1)
    assert spaces.cells["grasp/12"] == zero.cells["grasp/12"]
    (here / "entered_policies.py").write_text(f"{POLICIES}\n")
    with pytest.raises(PolicyError, match="the files of its policy 'entered_policies:Sway' are not those that were"):
        mimoc.verify_bench("sway.json")


def test_task_and_age_can_choose_the_policy(here):
    with pytest.raises(PolicyError, match=r"grasp/12: grasp_12\.zip: there is no such file"):
        mimoc.run_bench("{task}_{age}.zip", "x.json", **TWO | {"tasks": ["grasp"]})


def test_movement_is_compared_with_real_infants(monkeypatch):
    """Of an episode of four seconds; one that is too short has no distance."""
    move = bench_table().tasks["move"]
    for steps, is_known in ((400, True), (200, False)):
        short = move.model_copy(update={"spec": {**move.spec, "task": {"kind": "free", "steps": steps}}})
        monkeypatch.setattr(Cell, "row", property(lambda cell, row=short: BenchTask.model_validate(row.model_dump())))
        scores = score_cell(Cell("move", 3), "general_movements", 1)
        assert (scores.likeness is not None, scores.success, scores.success_95) == (is_known, None, None)


@pytest.mark.full
def test_tables_have_a_column_for_each_policy(here):
    zero, random = (mimoc.run_bench(name, f"{name}.json", **TWO) for name in ("zero", "random"))
    table = markdown_tables([zero, random])
    assert "| task | months | `zero` | `random` |" in table
    assert f"| reach | 12 | {zero.cells['reach/12'].success:.2f} (" in table
    assert len({line.count("|") for line in table.partition("\n\n")[0].splitlines()}) == 1


@pytest.mark.parametrize(
    ("policy", "reason"),
    [
        ("zeero", "'zeero' is not a policy; did you mean 'zero'?"),
        ("entered_policies:Nobody", "the module has no class 'Nobody'"),
        ("entered_policies:Actless", "grasp/12: 'entered_policies:Actless': has no method 'act'"),
        ("entered_policies:Short", r"act must return an array of \(\d+,\) finite numbers, not of \(1,\) float64"),
        ("entered_policies:Broken", "act failed in entered_policies.py:36: KeyError: 'sonar'"),
        ("no.zip", "there is no such file"),
    ],
)
def test_what_cannot_be_scored_is_one_line_and_writes_no_results(here, policy, reason):
    with pytest.raises(MimocError, match=reason) as error:
        mimoc.run_bench(policy, "x.json", tasks=["grasp"], ages_months=[12], episodes=1)
    assert "\n" not in str(error.value)
    assert [path.name for path in here.iterdir() if path.name != "__pycache__"] == ["entered_policies.py"]


@pytest.mark.parametrize(
    ("arguments", "reason"),
    {
        "": "say what to score: --policy NAME -o FILE.json; or see the tasks with --list",
        "--policy zero": "name the file of the results with -o FILE.json",
        "--policy zero --list": "--policy and --list do different things; choose one",
        "--list -o x.json": "--out, --episodes and --babybench are for a --policy that is entered; leave them out",
        "--policy zero -o x.txt": "x.txt: results are JSON; end the name in .json",
        "--policy zero -o no/x.json": "no/x.json: there is no folder no; make it, or choose another place",
        "--policy zero -o x.json --tasks raech": "'raech' is not a task of the benchmark; did you mean 'reach'?",
        "--policy zero -o x.json --tasks reach --ages 7": "7 months is not an age of reach; choose from 4, 6, 9, 12",
        "--verify x.json": "x.json: there is no such file; name what `mimoc bench -o FILE` wrote",
        "--table old.json": "old.json: of 'mimoc-bench-0', but this mimoc has mimoc-bench-1; enter again",
        "--babybench smile --policy zero -o x.json": "'smile' is not a behaviour of BabyBench; choose from "
        "hand_regard, self_touch",
        "--babybench self_touch --policy zero -o x.json --ages 3": "--babybench has one infant and one process; leave "
        "out --tasks, --ages and --processes",
    }.items(),
)
def test_the_command_refuses_in_one_line(here, invoke, arguments, reason):
    old = {"benchmark": "mimoc-bench-0", "policy": "zero", "policy_files": {}, "seeds": [0, 1], "software": {}}
    (here / "old.json").write_text(json.dumps({**old, "cells": {}}))
    assert invoke("bench", *arguments.split()) == (2, "", f"{reason}\n")
    assert not (here / "x.json").exists()


def test_the_command_enters_verifies_lists_and_tabulates(here, invoke):
    chosen = ("--tasks", "grasp", "--ages", "12", "--processes", "1")
    entered = invoke("bench", "--policy", "zero", "-o", "zero.json", *chosen, "--episodes", "1")
    assert (entered.code, entered.err, entered.out.splitlines()[-1]) == (0, "", "zero.json")
    same = invoke("bench", "--verify", "zero.json", *chosen)
    assert same == (0, "zero.json: the same to the bit for 1 of 1 infant\n", "")
    assert "| grasp | 12 | 0.00 (" in invoke("bench", "--table", "zero.json").out
    listed = invoke("bench", "--list").out
    assert all(name in listed for name in bench_table().tasks)
    specs = invoke("bench", "--specs", "specs", *chosen[:4])
    assert specs == (0, "specs/grasp_12.yaml\n", "")
    assert mimoc.load_spec("specs/grasp_12.yaml") == Cell("grasp", 12).spec
    data = read_results("zero.json").model_dump(mode="json")
    data["cells"]["grasp/12"]["mean_return"] = 3.5
    (here / "zero.json").write_text(json.dumps(data))
    other = invoke("bench", "--verify", "zero.json", "--processes", "1")
    assert (other.code, other.out.splitlines()[-1]) == (1, "zero.json: the same to the bit for 0 of 1 infant")
    assert other.out.startswith("grasp/12: differs in mean_return 3.5, now ")


def strange(folder, policy: str, files: dict[str, str] | None = None) -> None:
    results = mimoc.run_bench("zero", "zero.json", tasks=["grasp"], ages_months=[12], episodes=1)
    data = results.model_dump(mode="json") | {"policy": policy, "policy_files": files or {}}
    (folder / "strange.json").write_text(json.dumps(data))


@pytest.mark.parametrize(
    ("policy", "reason"),
    {
        "motion:/": "reads /, outside of this folder; if you trust it, name it yourself with --policy",
        "motion:..": "reads .., outside of this folder; if you trust it, name it yourself with --policy",
        "skill:link.json": "reads link.json, outside of this folder; if you trust it, name it yourself with --policy",
        "motion:recorded": "reads recorded/a.csv, which is not among the files that were scored",
        "spiteful:Policy": "reads spiteful.py, which is not among the files that were scored",
        "spiteful.inner:Policy": "is in a package, whose other modules are not recorded; if you trust it, name it "
        "yourself with --policy",
    }.items(),
)
def test_verifying_the_results_of_a_stranger_reads_nothing_else_and_imports_nothing(here, tmp_path, policy, reason):
    (here / "spiteful.py").write_text("from pathlib import Path\nPath('imported').touch()\n")
    (here / "recorded").mkdir()
    (here / "recorded" / "a.csv").touch()
    (here / "link.json").symlink_to("/etc/hostname")
    strange(here, policy)
    with pytest.raises(PolicyError) as refused:
        mimoc.verify_bench("strange.json")
    assert str(refused.value) == f"strange.json: its policy '{policy}' {reason}"
    assert not (here / "imported").exists()


def test_a_module_is_not_imported_if_it_is_not_the_one_that_was_scored(here):
    (here / "spiteful.py").write_text("from pathlib import Path\nPath('imported').touch()\n")
    strange(here, "spiteful:Policy", {"spiteful.py": "sha256:0"})
    with pytest.raises(PolicyError, match="the files of its policy 'spiteful:Policy' are not those that were scored"):
        mimoc.verify_bench("strange.json")
    assert not (here / "imported").exists()


def test_a_policy_elsewhere_is_verified_if_the_user_names_it(here, invoke):
    elsewhere = here.parent / f"{here.name}_skill.json"
    write_postures(Postures(task="grasp", age_months=12, joints=("robot:left_elbow",), postures=((0.5,),)), elsewhere)
    mimoc.run_bench(f"skill:{elsewhere}", "skill.json", tasks=["grasp"], ages_months=[12], episodes=1)
    assert invoke("bench", "--verify", "skill.json", "--processes", "1").code == 2
    named = invoke("bench", "--verify", "skill.json", "--processes", "1", "--policy", f"skill:{elsewhere}")
    assert named == (0, "skill.json: the same to the bit for 1 of 1 infant\n", "")
    other = invoke("bench", "--verify", "skill.json", "--policy", "zero")
    assert other == (2, "", "skill.json: 'zero' is not the policy that was scored, or its files have changed\n")


@pytest.mark.parametrize(
    ("policy", "cell"),
    {
        "look_at(toy)+reflexes": "`look_at(toy)+reflexes`",
        "x` | <img src=x onerror=alert(1)> |": "<code>x&#96; &#124; &lt;img src=x onerror=alert(1)&gt; &#124;</code>",
        "[a](http://b)\n# c": "<code>&#91;a](http://b)?# c</code>",
    }.items(),
)
def test_names_of_policies_are_nothing_but_text_in_tables(here, policy, cell):
    strange(here, policy)
    lines = markdown_tables([read_results("strange.json")]).splitlines()
    assert lines[0] == f"| task | months | {cell} |"
    assert lines[-1].startswith(f"| {cell} | 1 | ")


EVALUATED = {
    2: (0.058823529411764705, 0.36993865030674844),
    3: (0.1323529411764706, 0.41255506607929515),
    12: (0.47058823529411764, 0.5068334398976982),
    10_001: (0.5147058823529411, 0.5022195278140182),
    10_005: (0.45588235294117646, 0.4986697175278499),
}
"""What `EvalSelfTouch` and `EvalHandRegard` of `babybench/eval.py` returned for so many of the logs below, run once in
a folder of its own: BabyBench2025_Starter_Kit, commit 645ad73."""
SIDES = "right", "left"


def touch_logs(count: int) -> list[dict]:
    if count > 100:  # Those of the oldest episodes touch what no others do.
        touched = [index % 30 if index > 5 else 100 + index for index in range(count)]
        return [{"right_hand_touches": [geom], "left_hand_touches": []} for geom in touched]
    generator = np.random.default_rng(count)
    return [
        {f"{side}_hand_touches": generator.integers(0, 34, generator.integers(0, 5)).tolist() for side in SIDES}
        for _ in range(count)
    ]


def regard_logs(count: int) -> list[dict]:
    generator, logs = np.random.default_rng(count), []
    for _ in range(count):
        steps = int(generator.integers(1, 1001))
        names = [f"{eye}_eye_{hand}_hand" for hand in SIDES for eye in SIDES]
        logs.append({name: int(generator.integers(0, steps + 2)) for name in names} | {"steps": steps})
    return logs


@pytest.mark.parametrize("count", EVALUATED)
def test_scores_are_those_of_its_own_program(count):
    assert (self_touch_score(touch_logs(count)), hand_regard_score(regard_logs(count))) == EVALUATED[count]


def test_hand_regard_needs_an_episode():
    with pytest.raises(ValueError, match="no episode has any steps"):
        hand_regard_score(regard_logs(1))


@pytest.fixture(scope="module")
def infant():
    env = mimoc.make(babybench.babybench_spec("self_touch")).unwrapped
    env.reset(seed=0)
    return env


def touching(env, *pairs: tuple[str, str]) -> dict:
    geoms = np.array([[env.model.geom(name).id for name in pair] for pair in pairs])
    data = SimpleNamespace(contact=SimpleNamespace(geom=geoms))
    logger = TouchLog(SimpleNamespace(model=env.model, manifest=env.manifest, data=data))
    logger.look()
    return logger.log()


def test_hands_touch_the_own_body_each_other_for_the_right_one_and_nothing_by_fingers(infant):
    floor = infant.model.geom(int(np.flatnonzero(infant.model.geom_bodyid == 0)[0])).name
    fingers = ("head", "left_hand1"), ("right_fingers1", "ub2"), ("right_hand2", "lb"), ("right_hand1", "lb")
    for pairs, right, left in (
        (fingers, ("lb",), ("head",)),
        ([("left_hand1", "right_hand1")], ("left_hand1",), ()),
        ([("right_hand1", "left_hand1")], ("left_hand1",), ()),
        ([(floor, "left_hand1")], (), ()),
    ):
        assert touching(infant, *pairs) == {"right_hand_touches": right, "left_hand_touches": left}


def test_its_formula_looks_down_where_eyes_look_ahead(infant):
    """A hand straight ahead of the right eye is in sight; one straight below is what BabyBench's code counts."""
    data, eye = infant.data, infant.data.body("right_eye")
    x, z = eye.xmat.reshape(3, 3)[:, 0], eye.xmat.reshape(3, 3)[:, 2]
    assert -data.cam("eye_right").xmat.reshape(3, 3)[:, 2] == pytest.approx(x, abs=1e-6)
    for place_m, in_sight in ((eye.xpos + 0.2 * x, True), (eye.xpos - 0.2 * z, False)):
        data.body("right_hand").xpos[:] = place_m
        data.body("left_hand").xpos[:] = eye.xpos + 0.2 * z
        for of_cameras in (True, False):
            logger = RegardLog(infant, in_sight=of_cameras)
            logger.look()
            assert logger.log()["right_eye_right_hand"] == int(of_cameras == in_sight)
            assert logger.log()["right_eye_left_hand"] == 0


@pytest.mark.parametrize("behaviour", ["self_touch", "hand_regard"])
def test_a_policy_is_scored_by_its_logs(behaviour, invoke, tmp_path, monkeypatch):
    """The same log each time, of fewer steps than BabyBench has."""
    monkeypatch.setattr(babybench, "STEPS", 40)
    file = tmp_path / "scored.json"
    arguments = ("bench", "--babybench", behaviour, "--policy", "random", "-o", file, "--episodes", "2")
    done = invoke(*arguments)
    assert (done.code, done.err) == (0, "")
    content = file.read_bytes()
    data = json.loads(content)
    score = self_touch_score if behaviour == "self_touch" else hand_regard_score
    assert data["score"] == pytest.approx(score(data["logs"]), abs=1e-8)
    assert [log["steps"] for log in data["logs"]] == [0, 40, 40]
    assert (data["in_sight"] is None) == (behaviour == "self_touch")
    assert f"{behaviour}: {score(data['logs']):.4g} in 2 episodes" in done.out
    assert invoke(*arguments).code == 0
    assert file.read_bytes() == content
