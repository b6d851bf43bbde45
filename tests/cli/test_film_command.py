import shlex
import sys
from pathlib import Path

import pytest
from PIL import Image

import mimoc
from mimoc.policies.named import policy_of
from mimoc.schema.kinds import PolicyKind


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> Path:
    spec = {"mimoc": 1, "name": "infant", "age_months": 9, "scene": {"pose": "sitting"}}
    compiled = mimoc.build(mimoc.InfantSpec.model_validate(spec))
    return mimoc.write_bundle(compiled, tmp_path_factory.mktemp("bundles") / "infant")


@pytest.fixture
def run(invoke, here, built):
    return lambda arguments: invoke("run", built, *shlex.split(arguments))


def test_a_run_is_filmed_with_the_eyes_view_beside_it_and_summed_up(run):
    code, out, err = run("--steps 9 --video film.gif --eyes --fps 50 --size 64")
    assert (code, err) == (0, "")
    assert "9 control steps" in out
    assert out.endswith("film.gif\n")
    with Image.open("film.gif") as film:
        assert (film.size, film.n_frames) == ((85 + 4 + 30, 64), 5)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--video film.avi", "film.avi: not a supported video format; end the name in .mp4 or .gif"),
        ("--video film", "film: not a supported video format"),
        ("--video nowhere/film.gif", "nowhere/film.gif: there is no folder nowhere"),
        ("--eyes", "--eyes adds the eyes' views to a video; give its file with --video FILE"),
        ("--video film.gif --policy zreo", "'zreo' is not a policy; did you mean 'zero'?"),
    ],
)
def test_a_bad_film_ends_in_exit_code_2_with_one_line_and_nothing_written(options, message, run, tmp_path):
    code, out, err = run(f"--steps 1000000000 {options}")
    assert (code, out, len(err.splitlines())) == (2, "", 1)
    assert err.startswith(message)
    assert not list(tmp_path.iterdir())


def test_without_pyav_an_mp4_is_one_clear_line(run, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "av", None)
    found = run("--steps 1000000000 --video film.mp4")
    assert found == (2, "", "av is not installed; run: pip install 'mimoc[record]'\n")
    assert not list(tmp_path.iterdir())


def test_control_c_keeps_what_was_filmed_and_says_so(run, tmp_path, registered):
    def stopping(env):
        act, taken = policy_of(env, "random"), iter(range(12))
        return lambda *seen: act(*seen) if next(taken, None) is not None else (_ for _ in ()).throw(KeyboardInterrupt)

    with registered(PolicyKind("stopping", "stops after 12 steps", stopping)):
        code, out, err = run("--policy stopping --steps 1000000000 --video film.gif --size 64")
    assert (code, out) == (130, "")
    assert err.startswith("stopped; film.gif shows the run up to this point\n")
    assert [path.name for path in tmp_path.iterdir()] == ["film.gif"]
    with Image.open("film.gif") as film:
        assert film.n_frames == 4
