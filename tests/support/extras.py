"""Tests that need libraries which only `make test-all` installs, and are marked `extras`."""

from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
FILES = tuple(
    TESTS / name
    for name in (
        "consumers",
        "fuzz/test_crafted_folders.py",
        "fuzz/test_crafted_policies.py",
        "fuzz/test_linked_folders.py",
        "fuzz/test_lives.py",
        "runtime/device",
        "runtime/test_learning.py",
        "render/test_triton.py",
        "studies/experiments/test_experiments.py",
        "studies/experiments/test_figures.py",
        "studies/experiments/test_growing.py",
        "studies/skills/test_trainings.py",
        "test_docstrings.py",
        "test_notebook.py",
        "test_trainings_in_docs.py",
        "viewer/test_live.py",
        *(f"training/test_{name}.py" for name in ("custom", "device_training", "episodes", "evaluation", "policies")),
        *(f"training/test_{name}.py" for name in ("recorded", "sb3_vec_env", "tracking", "train_command", "trainer")),
        *(f"training/test_{name}.py" for name in ("training_together", "world_vec_env")),
    )
)
"""Files and folders that need them throughout; elsewhere, single tests are marked."""


def needs_extras(path: Path) -> bool:
    """Return whether a file of tests, or a folder, needs such libraries throughout."""
    return any(path == file or file in path.parents for file in FILES)
