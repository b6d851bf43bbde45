"""`mimoc run`."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, nullcontext
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mimoc.base.errors import MimocError
from mimoc.base.kinds import announced
from mimoc.cli import worlds
from mimoc.cli.arguments import (
    Beside,
    Body,
    InfantPath,
    ShownBody,
    check_video,
    import_object,
    load_counterpart,
    load_infant,
    load_trained,
)
from mimoc.cli.terminal import printable
from mimoc.policies.class_policy import class_or_text
from mimoc.policies.spec import usage
from mimoc.recording.movement_columns import ALL, GROUPS, groups_named
from mimoc.schema.components.policies import POLICIES

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from mimoc.policies.policy import Policy, PolicyMaker
    from mimoc.policies.rollout import Summary
    from mimoc.recording.record import Watch
    from mimoc.runtime.env import InfantEnv
    from mimoc.schema.infant import InfantSpec


POLICY_NAMES = ", ".join(
    (*(f"{usage(POLICIES[name])} ({POLICIES[name].about})" for name in POLICIES), *announced("mimoc.policies"))
)
"""What `--policy` can be: mimoc's own policies with what they do, then the names of others'."""
POLICIES_HELP = (
    f"{POLICY_NAMES}; a trained policy.zip; or several at once, which add up: NAME+NAME, such as "
    "sit+look_at:toy+reach_for:toy,right. With parentheses, 'look_at(toy)', a shell needs quotes. Or a class of yours "
    "with act(observation), as MODULE:CLASS."
)
Seed = Annotated[int, typer.Option(min=0, help="Random seed of policy and episodes; the same seed gives the same run.")]
VideoFile = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Record a video: .mp4 (needs `mimoc[record]`) or .gif.")
]
RecordFolder = Annotated[
    Path | None, typer.Option(metavar="DIR", help="Record all that it does and senses (needs `mimoc[record]`).")
]
MovementGroups = Annotated[
    str | None,
    typer.Option(
        metavar="GROUPS",
        help="Movement columns that are recorded: all, the default, none, or some, with commas: "
        + ", ".join(f"{group.name} ({group.about})" for group in GROUPS.values()),
    ),
]
Steps = Annotated[
    int | None, typer.Option(min=1, help="Number of control steps to run; default: 1000, or a whole motion.")
]


class Root(StrEnum):
    """How the trunk moves while a motion is followed."""

    FREE = "free"
    ASSISTED = "assisted"


RootOption = Annotated[
    Root | None, typer.Option(help="For `motion`: the trunk is `free`, the default, or `assisted` by a wrench.")
]
MOTION, STEPS = "motion", 1000
OwnTask = Annotated[
    str | None, typer.Option(metavar="MODULE:CLASS", help="Take rewards from a class of your own, as in training.")
]


def run(
    infant: InfantPath,
    policy: Annotated[str, typer.Option(help=POLICIES_HELP)] = "random",
    steps: Steps = None,
    root: RootOption = None,
    seed: Seed = 0,
    task: OwnTask = None,
    window: Annotated[bool, typer.Option("--window", help="Show the infant in a window, in real time.")] = False,
    video: VideoFile = None,
    record: RecordFolder = None,
    movement: MovementGroups = None,
    eyes: Annotated[bool, typer.Option("--eyes", help="Show the views of both eyes beside the video.")] = False,
    fps: Annotated[int, typer.Option(min=1, max=100, help="Frames per second of the video.")] = 25,
    size: Annotated[int, typer.Option(min=64, max=2160, help="Height of the video in pixels.")] = 360,
    body: ShownBody = Body.SKIN,
    beside: Beside = None,
) -> None:
    """Run the infant under a policy and print a summary; show it in a window, record a video or all it senses."""
    from mimoc.cli import console
    from mimoc.runtime.env import InfantEnv

    check_video(video, eyes)
    options: Any = {"rate_hz": fps, "height_px": size, "body": body.value}
    single = {"root": root, "task": task, "record": record, "movement": movement, "eyes": eyes, "beside": beside}
    if world := worlds.find_world(infant, **single):
        worlds.run(world, policy, steps or STEPS, seed, video, window, options)
        return
    others = {beside: load_counterpart(infant, beside)} if beside else {}
    user_task, chosen = import_object(task) if task else None, _chosen(policy, infant, root)
    env = InfantEnv(load_infant(infant), render_mode="human" if window else None, task=user_task)
    with closing(env), ExitStack() as recorded:
        act = _policy(env, chosen)  # Refuses bad names before writing anything.
        recorded.enter_context(_recording(env, record, movement))
        written = _written(env, video, record)
        filmed = _film(video, env, {"eyes": eyes, **options})
        summary = _run(env, act, seed, steps or getattr(act, "whole_steps", STEPS), filmed, written)
    runs = {name: _run_beside(other, chosen, summary.steps, seed, user_task) for name, other in others.items()}
    console.print_run(summary, runs)
    console.print_joints(act)
    sys.stdout.writelines(f"{printable(path)}\n" for path in written)


def _written(env: "InfantEnv", video: Path | None, record: Path | None) -> list[Path]:
    """Return what a run writes: a video, the sound of an infant that hears, and a recording."""
    from mimoc.recording.sound_track import hears, sound_file

    sound = sound_file(video) if video and hears(env) else None
    return [path for path in (video, sound, record) if path]


def _recording(env: "InfantEnv", folder: Path | None, movement: str | None) -> "AbstractContextManager[object]":
    if folder is None:
        if movement:
            raise MimocError("--movement says which movement columns are recorded; name a folder with --record")
        return nullcontext()
    from mimoc.recording.recorder import Recording

    return Recording([env], folder, movement=groups_named(movement or ALL))


def _run_beside(
    infant: "InfantSpec", policy: "str | PolicyMaker", steps: int, seed: int, task: object | None
) -> "Summary":
    """Return the summary of the same run of another infant."""
    from mimoc.compiler.pipeline import build
    from mimoc.runtime.env import InfantEnv

    with closing(InfantEnv(build(infant), task=task)) as env:
        return _run(env, _policy(env, policy), seed, steps, nullcontext(), [])


def _policy(env: "InfantEnv", policy: "str | PolicyMaker") -> "Policy":
    from mimoc.policies.named import policy_of

    return policy_of(env, policy, load_trained)


def _film(
    video: Path | None, env: "InfantEnv", options: dict[str, Any]
) -> "AbstractContextManager[Watch] | AbstractContextManager[None]":
    from mimoc.recording import film_of

    return film_of(video, env.manifest.step_ms, **options) if video else nullcontext()


def _chosen(policy: str, infant: Path, root: Root | None) -> "str | PolicyMaker":
    """Return what is said of a policy; `motion` alone follows the motion in the infant's own folder."""
    name, _, folder = policy.partition(":")
    if name != MOTION or "+" in policy:
        if root:
            raise MimocError("--root says how the trunk follows a motion; choose --policy motion, and no other")
        return class_or_text(policy)
    from mimoc.policies import motion

    return partial(motion.bind, text=folder or str(infant), root=(root or Root.FREE).value)


def _run(
    env: "InfantEnv",
    act: "Policy",
    seed: int,
    steps: int,
    filmed: "AbstractContextManager[Watch | None]",
    written: Sequence[Path],
) -> "Summary":
    """Take some control steps with a progress bar, film them if there is a video, and return the summary."""
    from mimoc.cli import console
    from mimoc.policies.rollout import Run

    rollout = Run(env, lambda env: act, seed)
    with _interruptible(written), console.progress("running") as show, filmed as watch:
        if watch:
            watch(rollout.env, rollout.observation)
        for step in range(steps):
            rollout.step()
            if watch:
                watch(rollout.env, rollout.observation)
            show(step + 1, steps)
    return rollout.summary()


@contextmanager
def _interruptible(written: Sequence[Path]) -> Iterator[None]:
    """On Ctrl-C, say that what was recorded so far is kept."""
    try:
        yield
    except KeyboardInterrupt:
        if written:
            shows = "shows" if len(written) == 1 else "show"
            kept = printable(" and ".join(map(str, written)))
            print(f"stopped; {kept} {shows} the run up to this point", file=sys.stderr)
        raise
