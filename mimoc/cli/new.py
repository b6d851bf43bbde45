"""`mimoc new`, `mimoc import` and `mimoc schema`: specs to begin with, and what editors know of them."""

import re
import shlex
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mimoc.base.errors import MimocError, OutputError, SpecError, check_name
from mimoc.cli.arguments import Force
from mimoc.cli.terminal import printable

if TYPE_CHECKING:
    from mimoc.compat.settings import Imported
    from mimoc.schema.starter import Choices

STDOUT = Path("-")
QUESTIONS = {
    "age_months": "Age in months, from 0 to 24",
    "hands": "Hands",
    "actuation": "What moves it",
    "senses": "Senses, with commas between, or none",
    "scene": "Scene",
    "pose": "Pose",
}
"""What is asked for each of the choices; what can be answered is added."""


def _of(field: str) -> Callable[[], Sequence[str]]:

    def values() -> Sequence[str]:
        from mimoc.schema.starter import offered

        return offered()[field]

    return values


Like = Annotated[
    str | None, typer.Option(metavar="NAME", help="Begin with an example, such as nine_months or playroom.")
]
Hands = Annotated[str | None, typer.Option(help="mitten or five_finger.", autocompletion=_of("hands"))]
Actuation = Annotated[str | None, typer.Option(help="torque, muscle or position.", autocompletion=_of("actuation"))]
Scene = Annotated[str | None, typer.Option(help="empty, flat, crib or room.", autocompletion=_of("scene"))]
Pose = Annotated[str | None, typer.Option(help="supine, prone, sitting or standing.", autocompletion=_of("pose"))]
Task = Annotated[
    str | None,
    typer.Option(
        help="reach, standup, selfbody, catch, rollover, roll, sit_up, sit, crawl, pull_to_stand, stand, "
        "cruise, walk or grasp.",
        autocompletion=_of("task"),
    ),
]
Impairment = Annotated[
    str | None,
    typer.Option(
        help="hemiparesis, diplegia, brachial_plexus_palsy, hypotonia or preterm.", autocompletion=_of("impairment")
    ),
]
Side = Annotated[str | None, typer.Option(help="left or right.", autocompletion=_of("side"))]


def new(
    spec: Annotated[Path, typer.Argument(metavar="SPEC", help="YAML file to write, or `-` for standard output.")],
    like: Like = None,
    age: Annotated[float | None, typer.Option(metavar="MONTHS", help="Age, 0 to 24.")] = None,
    hands: Hands = None,
    actuation: Actuation = None,
    senses: Annotated[str | None, typer.Option(help="Names with commas between; `none` for none.")] = None,
    scene: Scene = None,
    pose: Pose = None,
    held: Annotated[str | None, typer.Option(metavar="BODY", help="What somebody holds, such as chest.")] = None,
    task: Task = None,
    impairment: Impairment = None,
    side: Side = None,
    force: Force = False,
) -> None:
    """Write a commented spec to begin with, from a few choices; in a terminal, without any, it asks."""
    from mimoc.bundle.files import write_file
    from mimoc.schema import read_spec, source
    from mimoc.schema.json_schema import shipped_schema
    from mimoc.schema.starter import new_spec, with_schema

    options = {
        "age_months": age, "hands": hands, "actuation": actuation, "senses": senses, "scene": scene, "pose": pose,
        "held": held, "task": task, "impairment": impairment, "side": side,
    }  # fmt: skip
    given: dict[str, Any] = {key: value for key, value in options.items() if value is not None}
    if like and given:
        raise MimocError("'--like' takes an example as it is; give either that or choices")
    if spec != STDOUT and spec.exists() and not force:
        raise MimocError(f"{spec}: there is such a file; choose another name, or add '--force' to replace it")
    name = _name(spec)
    if like:
        text = with_schema(_example(like, name), shipped_schema())
    else:
        if not given and sys.stdin.isatty() and sys.stdout.isatty():
            given = _answers(name)
        text = new_spec(_choices(name, given), shipped_schema())
    read_spec(source.parse(text, str(spec)))
    if spec == STDOUT:
        print(text, end="")
    else:
        write_file(spec, text.encode())
        print(printable(f"{spec}: build it with: mimoc build {shlex.quote(str(spec))} -o out/{name}"))


def _name(spec: Path) -> str:
    words = re.sub("[^a-z0-9]+", "_", spec.stem.lower()).strip("_")
    return words[:64] if words[:1].isalpha() else f"infant_{words}"[:64].rstrip("_")


def _choices(name: str, given: dict[str, Any]) -> "Choices":
    from mimoc.schema.starter import Choices

    words = given.get("senses", ",".join(Choices.senses)).replace(",", " ").split()
    return Choices(**{**given, "name": name, "senses": () if words == ["none"] else tuple(words)})


def _answers(name: str) -> dict[str, Any]:
    """Return what the user answers to each question; it is asked again if no spec can say that, with those before."""
    from mimoc.schema.starter import Choices, offered

    usual = {**vars(Choices()), "senses": ",".join(Choices.senses)}
    values = offered()
    answers = dict[str, Any]()
    for key, question in QUESTIONS.items():
        text = f"{question} ({', '.join(values[key])})" if key in values else question
        answers[key] = typer.prompt(text, default=usual[key], value_proc=partial(_checked, name, answers, key))
    return answers


def _checked(name: str, answers: dict[str, Any], key: str, answer: Any) -> Any:
    """Return an answer that a spec can say, with those before it; else a prompt prints the error, and asks again."""
    from mimoc.schema import read_spec, source
    from mimoc.schema.source import scalar
    from mimoc.schema.starter import new_spec

    value = str(answer).strip()
    try:
        value = scalar(value) if key == "age_months" else value
        read_spec(source.parse(new_spec(_choices(name, {**answers, key: value})), name))
    except SpecError as error:
        raise typer.BadParameter("; ".join(f"{problem.key}: {problem.message}" for problem in error.problems)) from None
    except ValueError as error:  # A number that YAML does not have.
        raise typer.BadParameter(str(error)) from None
    return value


def _example(like: str, name: str) -> str:
    from mimoc.schema.infant import example_specs

    examples = example_specs()
    check_name("name of an example", like, examples)
    text = examples[like].read_text(encoding="utf-8")
    return re.sub("^name: .*$", f"name: {name}", text, count=1, flags=re.MULTILINE)


def import_config(
    system: Annotated[str, typer.Argument(metavar="FORMAT", help="Format of the configuration: babybench or mimo.")],
    config: Annotated[Path, typer.Argument(metavar="CONFIG", help="YAML file of BabyBench's, or MIMo's scene (XML).")],
    file: Annotated[
        Path, typer.Option("-o", "--out", metavar="FILE.yaml", help="Spec to write, or `-` for standard output.")
    ],
    force: Force = False,
) -> None:
    """Convert another system's configuration into a spec, and list the settings that have no counterpart.

    Of a scene with MIMo in it, the rest is written beside the spec: FILE_scene.xml, with a folder for its assets.
    """
    from mimoc import compat
    from mimoc.bundle import files

    imported = compat.import_config(system, config)
    if file == STDOUT:
        print(*imported.notes, sep="\n", end="\n" if imported.notes else "", file=sys.stderr)
        print(imported.text, end="")
        if imported.scene:
            print("the rest of the scene is not written; for that, give a file: -o FILE.yaml", file=sys.stderr)
        return
    if file.resolve() in {config.resolve(), *imported.sources}:
        raise OutputError(f"{file}: this is the configuration itself; choose another file")
    if file.exists() and not force:
        raise OutputError(f"{file}: already exists; choose another file, or replace it with --force")
    out = (file.parent if imported.scene else Path()) / "out" / imported.spec["name"]
    beside = _write_scene(imported, file, out, force) if imported.scene else ""
    written = files.write_file(file, imported.text.encode())
    for note in imported.notes:
        print(printable(note))
    print(f"{printable(written)}: try it with: mimoc build {printable(written)} -o {printable(out)}{beside}")


def _write_scene(imported: "Imported", file: Path, bundle: Path, force: bool) -> str:
    from mimoc.bundle import files

    content = {file.parent / name: data for name, data in imported.scene(file.stem).items()} if imported.scene else {}
    if (existing := [path for path in content if path.exists()]) and not force:
        raise OutputError(f"{existing[0]}: already exists; choose another file, or replace it with --force")
    if sources := [path for path in existing if path.resolve() in imported.sources]:
        raise OutputError(f"{sources[0]}: this is part of the scene that was read; choose another file")
    for path, data in content.items():
        files.make_folder(path.parent, below=file.parent)
        files.write_file(path, data, below=file.parent)
    scene = printable(next(iter(content)))
    return f"\n{scene}: the scene, which takes its infant from {printable(bundle)}; open it with MuJoCo"


def schema(
    of: Annotated[
        str,
        typer.Argument(
            metavar="FILES", help="infant (specs), cohort (cohort files) or world (worlds with several infants)."
        ),
    ] = "infant",
    out: Annotated[
        Path | None, typer.Option("-o", "--out", metavar="FILE", help="File to write; default: standard output.")
    ] = None,
) -> None:
    """Print the JSON Schema of specs, by which editors complete keys and underline mistakes."""
    from mimoc.bundle.files import write_file
    from mimoc.schema.json_schema import json_schema, json_text

    text = json_text(json_schema(of))
    if out is None:
        print(text, end="")
    else:
        print(printable(write_file(out, text.encode())))
