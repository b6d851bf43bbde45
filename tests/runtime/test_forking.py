import os
import subprocess
import sys

import pytest
from support.forks import status_of_fork

import mimoc

PATIENCE_S = 60
SEE = """
import sys
import gymnasium, numpy as np
import mimoc

if __name__ == "__main__":
    here = mimoc.InfantEnv(sys.argv[1])
    alone = here.reset(seed=0)[0]["eye_left"]
    envs = gymnasium.make_vec("mimoc/Infant-v0", 2, "async", bundle=sys.argv[1])
    seen = envs.reset(seed=0)[0]["eye_left"]
    envs.step(envs.action_space.sample())
    envs.close()
    print(all(np.array_equal(picture, alone) for picture in seen), alone.std() > 5)
    print(np.array_equal(here.reset(seed=0)[0]["eye_left"], alone))
    here.close()
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> str:
    vision = {"width_px": 32, "height_px": 32}
    spec = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": {"vision": vision}}
    compiled = mimoc.build(mimoc.InfantSpec.model_validate({**spec, "scene": {"pose": "sitting"}}))
    return str(mimoc.write_bundle(compiled, tmp_path_factory.mktemp("bundles") / "infant"))


@pytest.mark.full
def test_processes_that_gymnasium_forks_after_it_has_drawn_draw_the_same(folder, tmp_path):
    """`AsyncVectorEnv` opens an environment, closes it, and then forks: without a remedy, Mesa hangs."""
    (tmp_path / "see.py").write_text(SEE)
    environment = {name: value for name, value in os.environ.items() if name != "LP_NUM_THREADS"}
    command = [sys.executable, "-W", "ignore", str(tmp_path / "see.py"), folder]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    assert (done.returncode, done.stdout) == (0, "True True\nTrue\n"), done.stderr


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_many_infants_go_on_in_a_forked_process(bundle):
    """Which has none of the threads that shared the work before."""
    envs = mimoc.make_vec(bundle, 2, threads=2)
    envs.reset(seed=0)
    envs.step(envs.action_space.sample())
    assert status_of_fork(lambda: envs.step(envs.action_space.sample())) == 0
    envs.close()
