"""The record of a quantity: its name, label and unit, and how it is measured."""

from dataclasses import dataclass
from typing import Literal

from mimoc.base.kinds import Code, Component


@dataclass(frozen=True, slots=True)
class Quantity(Component):
    """Something that is measured, or that an axis or a column shows: its only label and unit."""

    name: str
    """Name in tables, files and Python, which ends with the unit, such as `joint_speed_rad_s`."""
    label: str
    """What people read, such as `Joint speed`."""
    unit: str = ""
    """Unit as people write it, such as `rad/s`; empty for none."""
    about: str = ""
    """What it is, in a sentence."""
    over: Literal["child", "pose", "milestone", "step", "episode", "movement", "recording"] = "step"
    """What each value belongs to: a child, a pose of a check, the search for a milestone, a control step, a completed
    episode, the movement columns of a recorded episode, or a recording of points."""
    reduce: Literal["mean", "min", "max", "path", "all", "any", "count"] = "mean"
    """How these values become that of a run: `path` is the length of the path through points, `count` their number."""
    term: Code | None = None
    """`bind(model, manifest) -> Term`: what measures a control step of one infant, of many, and on a device; or the
    module that defines this function by the quantity's name."""
    read: Code | None = None
    """`bind(env) -> Callable[[], float]`: what measures a control step where no term can; of one infant, on the CPU."""
    compute: Code | None = None
    """`compute(columns) -> float | None`: from the movement columns of an episode and `time_s`, each by its name with a
    value for each row, to the value of the episode; see `docs/movement_data.md`."""
    field: str = ""
    """Where the value is read if `term`, `read` and `compute` are None; by default `name`. It is a key or attribute of
    the child's entry in a manifest, of the check of a pose, of a step's `info`, or of an `EpisodeResult`; or the
    movement column that is reduced."""
    curve: str = ""
    """Its column in a learning curve."""
    steps: tuple[str, ...] = ("run", "record")
    """Where it is measured: by `build`, `check`, `run`, `train` and so on of a cohort, of which `run` is also
    `mimoc run`; `record` is each control step of a recording, where points have no column."""
    limits: tuple[float | None, float | None] = (None, None)
    """Least and largest possible value, where an axis begins and ends; None for no limit."""
    source: str | None = None
    """What defines it: a publication, a convention, or fields of MuJoCo's data."""
    frame: str = ""
    """The axes that it is given in, and the moment that it belongs to."""
    is_text: bool = False
    """Whether it has names instead of numbers."""

    @property
    def key(self) -> str:
        """The attribute or key that holds its value."""
        return self.field or self.name

    @property
    def title(self) -> str:
        """Label with unit: `Joint speed [rad/s]`."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    @property
    def heading(self) -> str:
        """The same within a sentence or above a column: `joint speed [rad/s]`."""
        return self.title[:1].lower() + self.title[1:]
