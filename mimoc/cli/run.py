"""`mimoc run`."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager, nullcontext
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mimoc.base.errors import MimocError, check_name
from mimoc.base.kinds import announced
from mimoc.cli.arguments import (
    Beside,
    Body,
    Eyes,
    InfantPath,
    ShownBody,
    VideoHeight,
    check_video,
    find_world,
    import_object,
    load_counterpart,
    load_infant,
    load_trained,
)
from mimoc.cli.terminal import printable
from mimoc.policies.spec import parse_policies, usage
from mimoc.schema.kinds import MOVEMENT_GROUPS, POLICIES

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from mimoc.bundle.io import Bundle
    from mimoc.bundle.world import WorldBundle
    from mimoc.policies.policy import Policy, PolicyMaker
    from mimoc.policies.rollout import RunSummary
    from mimoc.recording.record import Filming
    from mimoc.runtime.env import InfantEnv
    from mimoc.runtime.infant import Infant
    from mimoc.runtime.world_env import WorldEnv


POLICY_NAMES = ", ".join(
    (*(f"{usage(POLICIES[name])} ({POLICIES[name].about})" for name in POLICIES), *announced("mimoc.policies"))
)
"""What `--policy` can be: mimoc's own policies with what they do, then the names of others'."""
POLICIES_HELP = (
    f"{POLICY_NAMES}; a trained policy.zip; or several at once, which add up: NAME+NAME, such as "
    "sit+look_at:toy+reach_for:toy,right. With parentheses, 'look_at(toy)', a shell needs quotes. Or a class of yours "
    "with act(observation), as MODULE:CLASS."
)
ChosenPolicies = Annotated[
    list[str] | None,
    typer.Option(
        "--policy",
        metavar="POLICY",
        help=f"{POLICIES_HELP} Default: random. In a world, NAME=POLICY,... is for single infants; repeatable.",
    ),
]
Seed = Annotated[int, typer.Option(min=0, help="Random seed of policy and episodes; the same seed gives the same run.")]
VideoFile = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Record a video: .mp4 (needs `mimoc[record]`) or .gif.")
]
RecordFolder = Annotated[
    Path | None, typer.Option(metavar="DIR", help="Record all that it does and senses (needs `mimoc[record]`).")
]
FilmedInfant = Annotated[
    str | None,
    typer.Option(
        "--infant", metavar="NAME", help="Whose eyes and ears a video of several has; default: the first that has any."
    ),
]
MovementGroups = Annotated[
    str | None,
    typer.Option(
        metavar="GROUPS",
        help="Movement columns that are recorded: all, the default, none, or some, with commas: "
        + ", ".join(f"{name} ({about})" for name, about in MOVEMENT_GROUPS.items()),
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
    policy: ChosenPolicies = None,
    steps: Steps = None,
    root: RootOption = None,
    seed: Seed = 0,
    task: OwnTask = None,
    window: Annotated[bool, typer.Option("--window", help="Show the infant in a window, in real time.")] = False,
    video: VideoFile = None,
    record: RecordFolder = None,
    movement: MovementGroups = None,
    eyes: Eyes = False,
    filmed: FilmedInfant = None,
    fps: Annotated[int, typer.Option(min=1, max=100, help="Frames per second of the video.")] = 25,
    size: VideoHeight = 360,
    body: ShownBody = Body.SKIN,
    beside: Beside = None,
) -> None:
    """Run the infants under a policy and print a summary; show them in a window, record a video or all they sense."""
    from mimoc.cli import console
    from mimoc.policies.named import policies_of
    from mimoc.runtime.batch_env import infants_of

    check_video(video, eyes)
    options: Any = {"infant": filmed, "eyes": eyes, "rate_hz": fps, "height_px": size, "body": body.value}
    world = find_world(infant)
    other = _counterpart(infant, world, beside) if beside else None
    env = open_env(world or load_infant(infant), task, render_mode="human" if window else None)
    with closing(env), ExitStack() as recorded:
        infants = infants_of("run", env)
        if filmed is not None and len(infants) == 1:
            raise MimocError("--infant chooses one of several infants, and there is only one here; leave it out")
        if filmed is not None:
            check_name("name of an infant here", filmed, infants)
        chosen = policies_by_infant(policy, infant, root, infants)
        policies = policies_of(infants, chosen, load_trained)  # Refuses bad names before writing anything.
        recorded.enter_context(_recording(infants, record, movement))
        written = _written(infants, video, record, filmed)
        count = steps or max(getattr(item, "whole_steps", 0) for item in policies.values()) or STEPS
        summaries = _run(env, policies, seed, count, _film(video, infants, options), written)
    if other is not None:
        with closing(open_env(other, task)) as env:
            acting = policies_of(infants_of("run", env), chosen, load_trained)
            others = _run(env, acting, seed, count, nullcontext(), [])
        summaries |= {f"{name}, {beside}" if name else str(beside): summary for name, summary in others.items()}
    console.print_run(summaries)
    for item in policies.values():
        console.print_joints(item)
    sys.stdout.writelines(f"{printable(path)}\n" for path in written)


def open_env(shown: "Bundle | WorldBundle", task: str | None, **options: Any) -> "InfantEnv | WorldEnv":
    """Return the environment of an infant or a world, where each infant has the task of a user's class, if any."""
    from mimoc.bundle.world import WorldBundle
    from mimoc.runtime.env import InfantEnv
    from mimoc.runtime.world_env import WorldEnv

    if isinstance(shown, WorldBundle):
        tasks = {name: import_object(task) for name in shown.infants} if task else {}
        return WorldEnv(shown, tasks=tasks, **options)
    return InfantEnv(shown, task=import_object(task) if task else None, **options)


def _counterpart(infant: Path, world: "WorldBundle | None", beside: str) -> "Bundle | WorldBundle":
    from mimoc.compiler.building import build
    from mimoc.compiler.variants import plan_of_bundle
    from mimoc.compiler.worlds import build_world
    from mimoc.schema.counterparts import world_counterpart

    if world:
        return build_world(world_counterpart(plan_of_bundle(world), beside))
    return build(load_counterpart(infant, beside))


def _written(
    infants: "Mapping[str, Infant]", video: Path | None, record: Path | None, filmed: str | None
) -> list[Path]:
    from mimoc.recording.record import heard_in, sound_file

    sound = sound_file(video) if video and heard_in(infants, filmed) else None
    return [path for path in (video, sound, record) if path]


def _recording(
    infants: "Mapping[str, Infant]", folder: Path | None, movement: str | None
) -> "AbstractContextManager[object]":
    if folder is None:
        if movement:
            raise MimocError("--movement says which movement columns are recorded; name a folder with --record")
        return nullcontext()
    from mimoc.recording.movement_columns import groups_named
    from mimoc.recording.recorder import Recording

    return Recording([*infants.values()], folder, movement=groups_named(movement or "all"))


def _film(
    video: Path | None, infants: "Mapping[str, Infant]", options: dict[str, Any]
) -> "AbstractContextManager[Filming] | AbstractContextManager[None]":
    from mimoc.recording.record import film_of

    return film_of(video, next(iter(infants.values())).manifest.step_ms, **options) if video else nullcontext()


def policies_by_infant(
    texts: Sequence[str] | None, source: Path, root: Root | None, infants: "Mapping[str, Infant]"
) -> "Mapping[str, str | PolicyMaker]":
    """Return the policy of each infant, by name; `motion` alone follows the motion in the infant's own folder."""
    from mimoc.policies import motion
    from mimoc.policies.class_policy import class_or_text

    by_infant = dict[str, str]()
    for text in texts or ["random"]:
        by_infant |= parse_policies(text, infants)
    follows = {name: text.partition(":") for name, text in by_infant.items() if "+" not in text}
    motions = {name: folder for name, (kind, _, folder) in follows.items() if kind == MOTION}
    if root and not motions:
        raise MimocError("--root says how the trunk follows a motion; choose --policy motion, and no other")
    bind = partial(motion.bind, root=(root or Root.FREE).value)
    chosen = dict[str, Any]()
    for name, text in by_infant.items():
        chosen[name] = partial(bind, text=motions[name] or str(source)) if name in motions else class_or_text(text)
    return chosen


def _run(
    env: "InfantEnv | WorldEnv",
    policies: "Mapping[str, Policy]",
    seed: int,
    steps: int,
    filmed: "AbstractContextManager[Filming | None]",
    written: Sequence[Path],
) -> "dict[str, RunSummary]":
    from mimoc.cli import console
    from mimoc.policies.rollout import Run

    rollout = Run(env, {name: lambda _, policy=policy: policy for name, policy in policies.items()}, seed)
    with _interruptible(written), console.progress("running") as show, filmed as film:
        if film:
            film(rollout.infants, rollout.observations)
        for step in range(steps):
            rollout.step()
            if film:
                film(rollout.infants, rollout.observations)
            show(step + 1, steps)
    return rollout.summaries()


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
