"""The `mimoc` program with all its commands."""

from collections.abc import Callable, Mapping
from typing import Annotated

import typer

from mimoc.cli import (
    bench,
    bundles,
    cohort,
    doctor,
    movement,
    new,
    pages,
    pictures,
    recordings,
    run,
    skill,
    train,
    validate,
)
from mimoc.version import __version__

app = typer.Typer(
    name="mimoc",
    help="Compile simulated infants: from a YAML spec to plain MuJoCo XML and a Gymnasium environment.",
    epilog="Start with:  mimoc new kim.yaml  and then:  mimoc build kim.yaml -o out/kim",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"mimoc {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    pass


COMMANDS: Mapping[str, tuple[Callable[..., None], str]] = {
    "new": (new.new, "kim.yaml --age 7.5 --hands five_finger --senses proprioception,touch"),
    "build": (bundles.build, "nine_months.yaml -o out/nine_months"),
    "validate": (validate.validate, "--against who --plot growth.png"),
    "run": (run.run, "out/nine_months --policy random --steps 500 --seed 1 --record recordings/random"),
    "train": (train.train, "reach.yaml -o runs/reach --algo ppo --steps 4096"),
    "evaluate": (train.evaluate, "reach.yaml --policy runs/reach/policy.zip --episodes 4 --envs 4"),
    "skill": (skill.skill, "roll --ages 4,6 --seeds 1 --tries 40 --starts 2 -o out/roll"),
    "movement": (movement.movement, "nine_months.yaml --policy random --seeds 0:3 --seconds 9 --against real"),
    "bench": (bench.bench, "--policy random -o random.json --tasks grasp --ages 12 --episodes 2 --processes 1"),
    "experiment": (pages.experiment, "growth -o out/growth --quick"),
    "check": (bundles.check, "out/nine_months"),
    "explain": (bundles.explain, "out/nine_months body.left_foot.mass"),
    "report": (pages.report, "out/nine_months -o nine_months.html"),
    "render": (pictures.render, "out/nine_months -o nine_months.png --pose supine --azimuth 30 --scale-bar"),
    "see": (pictures.see, "out/nine_months -o seen.png --pose sitting --ages 1,3,9"),
    "view": (pages.view, "nine_months.yaml -o infant.html"),
    "rooms": (pictures.rooms, "playroom.yaml --seeds 0:12 -o rooms.png"),
    "retarget": (movement.retarget, "keypoints.csv -o out/kim --age 3 --rate 30"),
    "replay": (recordings.replay, "recordings/random"),
    "measure": (recordings.measure, "recordings/random right_hand_path_m right_hand_movement_units"),
    "export": (recordings.export, "recordings/random --to csv -o out/random_csv"),
    "import": (new.import_config, "babybench config.yml -o self_touch.yaml"),
    "schema": (new.schema, "-o infant.schema.json"),
    "doctor": (doctor.doctor, ""),
}
"""The commands in the order of the help, each with the arguments of its example."""
for name, (command, arguments) in COMMANDS.items():
    app.command(name, epilog=f"Example:  mimoc {name} {arguments}".rstrip())(command)
app.add_typer(cohort.app)
