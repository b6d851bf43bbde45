"""Reading specs from files, and the examples that come with mimoc."""

import os
from pathlib import Path

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import Problem, SpecError
from mimoc.schema import source
from mimoc.schema.infant import InfantSpec, read_spec

SPEC_SUFFIXES = (".yaml", ".yml")


@takes("the path of a spec", *PATH)
def load_spec(path: str | Path) -> InfantSpec:
    """Return the spec in a YAML file.

    Raises:
        SpecError: If the spec is invalid; the error lists all problems. If there is no such file, and one of the
            examples that come with mimoc has its name, the error says how to write it.

    Example:
        >>> import mimoc
        >>> spec = mimoc.load_spec("nine_months.yaml")
        >>> spec.name, spec.age_months, spec.scene.pose
        ('nine_months', 9.0, 'sitting')
    """
    path = Path(path)
    if not os.path.exists(path) and path.stem in example_specs():  # A path's own method fails where it is too long.
        message = f"the file does not exist; write this example with: mimoc new {path.name} --like {path.stem}"
        raise SpecError([Problem(str(path), 1, 1, "", message)])
    return read_spec(source.read(path))


def example_specs() -> dict[str, Path]:
    """Return the specs that come with mimoc, by name: those in `configs/`."""
    package = Path(__file__).resolve().parents[1]
    folders = (package / "configs", package.parent / "configs")
    return {path.stem: path for folder in folders for path in sorted(folder.glob("*.yaml"))}
