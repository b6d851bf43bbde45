"""Let libraries of others use freshly built default bundles, each group in an environment of its own: `make consumers`.

The programs are in tests/consumers. Environments are under .consumers, with logs beside them; packages come from the
index that pip is set up with, and PyTorch without CUDA where the index of CPU builds answers. The exit code is 0 if all
pass.
"""

import os
import shutil
import sys
from pathlib import Path

import matrix

Commands = tuple[tuple[str, ...], ...]

PLACE = matrix.ROOT / ".consumers"
PROGRAMS = matrix.ROOT / "tests" / "consumers"
TORCH = (
    ("-m", "pip", "install", "uv"),
    ("-m", "uv", "pip", "install", "--python", sys.executable, "--torch-backend", "cpu", "--no-deps", "torch<3"),
)
"""Installs PyTorch without CUDA, as the Makefile does, before packages that ask for any PyTorch."""
ENVIRONMENTS = {
    "mimoc": (
        TORCH,
        ("--editable", ".[train,gpu,record,minari]", "mink>=1.0", "skrl>=2.1", "dm_control>=1.0.40", "usd-core>=25.5"),
        (
            *("attach", "rollout", "checkers", "minari_data_set", "mink_reaching", "skrl_training"),
            *("dm_control_reading", "usd_export", "warp_steps"),
        ),
    ),
    "mjlab": (TORCH, ("mjlab>=1.6,<2",), ("attach", "rollout", "mjlab_entity")),
    "lerobot": ((), ("lerobot>=0.4,<0.5",), ("lerobot_data_set",)),
}
"""What is installed in each, in two steps, and the programs that run there; the first one writes what they read."""


def main() -> None:
    """Run every program and say what came of it."""
    matrix.PLACE, folder = PLACE, PLACE / "read"
    shutil.rmtree(folder, ignore_errors=True)
    PLACE.mkdir(exist_ok=True)
    os.environ.setdefault("MUJOCO_GL", "egl")
    for name, value in {"UV_HTTP_CONNECT_TIMEOUT": "4", "UV_HTTP_TIMEOUT": "8", "UV_HTTP_RETRIES": "1"}.items():
        os.environ.setdefault(name, value)
    passed = [_passes(name, folder, *what) for name, what in ENVIRONMENTS.items()]
    sys.exit(not all(passed))


def _passes(name: str, folder: Path, first: Commands, needs: tuple[str, ...], programs: tuple[str, ...]) -> bool:
    """Return whether an environment can be made, and all its programs pass."""
    own = str(PLACE / name / "bin" / "python")
    first = tuple(tuple(own if word == sys.executable else word for word in command) for command in first)
    environment = matrix.Environment(sys.executable, name, needs, first)
    failed = False
    try:
        environment.set_up()
        if not folder.exists():
            environment.run(str(PROGRAMS / "prepare.py"), str(folder))
    except matrix.TrialError as failure:
        print(f"{name}: FAILED: {failure} ({environment.log.relative_to(matrix.ROOT)})", flush=True)
        return False
    for program in programs:
        try:
            print(f"{name}: passed: {environment.run(str(PROGRAMS / 'use.py'), str(folder), program)}", flush=True)
        except matrix.TrialError as failure:
            print(f"{name}: FAILED: {program}: {failure} ({environment.log.relative_to(matrix.ROOT)})", flush=True)
            failed = True
    return not failed


if __name__ == "__main__":
    main()
