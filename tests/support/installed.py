"""Environments of their own, with nothing of mimoc's checkout in them."""

import os
import subprocess
import sys
import sysconfig
import venv
from collections.abc import Callable
from pathlib import Path

Program = Callable[..., subprocess.CompletedProcess[str]]


def build_wheel(project: Path, folder: Path) -> Path:
    build = ["-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(project)]
    subprocess.run([sys.executable, *build], check=True, capture_output=True)
    (wheel,) = folder.glob("*.whl")
    return wheel


def install(home: Path, *wheels: Path) -> Program:
    """Return what runs a program of a new environment with some wheels, in an empty folder.

    Args:
        home: An empty folder for the environment.
        wheels: What is installed there; what these depend on comes from this Python.
    """
    venv.create(home, with_pip=False, symlinks=True)
    scheme = {"base": str(home), "platbase": str(home)}
    packages = Path(sysconfig.get_path("purelib", "venv", scheme))
    python = Path(sysconfig.get_path("scripts", "venv", scheme)) / "python"
    options = ["--no-deps", "--no-index", "--no-warn-script-location", "--disable-pip-version-check", "--quiet"]
    pip = [sys.executable, "-m", "pip", "--python", str(python), "install", *options, *map(str, wheels)]
    subprocess.run(pip, check=True)
    # What mimoc needs comes from here, where a .pth file's folders come last and their own .pth files are not read:
    # so not from the checkout, even where mimoc is installed as editable.
    dependencies = [folder for folder in sys.path if folder.endswith(("site-packages", "dist-packages"))]
    (packages / "dependencies.pth").write_text("\n".join(dependencies) + "\n")
    elsewhere = home / "elsewhere"
    elsewhere.mkdir()
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "MIMOC_"))}

    def run(program: str, *arguments: object) -> subprocess.CompletedProcess[str]:
        command = [str(python.with_name(program)), *map(str, arguments)]
        return subprocess.run(
            command, cwd=elsewhere, env=clean, capture_output=True, text=True, timeout=300, check=False
        )

    return run
