"""`mimoc report`, `mimoc experiment` and `mimoc view`: pages that open in a browser."""

import sys
import webbrowser
from pathlib import Path
from typing import Annotated

import typer

import mimoc
from mimoc.base.errors import MimocError
from mimoc.bundle.files import check_page
from mimoc.cli.arguments import STDIN, Beside, find_world, load_infant, load_spec, load_trained
from mimoc.cli.run import open_env, policies_by_infant
from mimoc.cli.terminal import printable, resumable
from mimoc.studies.experiments import EXPERIMENTS


def report(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="BUNDLE|WORLD|RUN|COHORT",
            help="Folder written by `mimoc build`, `mimoc train` or `mimoc cohort run`; or a spec (.yaml, or `-` for "
            "standard input) to build in memory.",
        ),
    ],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="Page to write: .html.")],
    no_check: Annotated[
        bool, typer.Option("--no-check", help="Leave out whether an infant's simulation is stable, as `check` finds.")
    ] = False,
    cohort: Annotated[
        Path | None, typer.Option(metavar="YAML", help="File of the cohort, to count jobs that are not done yet, too.")
    ] = None,
    beside: Beside = None,
) -> None:
    """Write one HTML page on an infant, a world, a training run or a cohort, which opens anywhere without a network."""
    from mimoc.cli import console

    study = mimoc.read_cohort(cohort) if cohort else None
    infant = load_spec(source) if source == STDIN else source
    with console.progress("writing the page") as show:
        print(printable(mimoc.report(infant, out, check=not no_check, cohort=study, progress=show, beside=beside)))


def experiment(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME|FILE", help=f"One of: {', '.join(EXPERIMENTS)}. Or that of a plug-in, or a .py file."
        ),
    ],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="DIR", help="Folder for tables, figures and report.")],
    quick: Annotated[
        bool,
        typer.Option("--quick", help="Fewer ages, seeds or steps: takes seconds, or minutes for delays and growing."),
    ] = False,
    development: Annotated[
        str | None,
        typer.Option(
            metavar="LAW",
            help="Body of the infants: published (MIMo v2's; the report then has the paper's figures beside ours) or "
            "maturing (mimoc's own). Default: published for strength, delays and inverse, maturing for growth, acuity "
            "and rooms; all others have their own.",
        ),
    ] = None,
) -> None:
    """Reproduce an experiment: tables (CSV), figures (PNG), and a report that compares them with published ones."""
    from mimoc.cli import console
    from mimoc.studies.experiment import find_experiment, law_of, run_experiment

    law = law_of(find_experiment(name), development)
    with console.progress(Path(name).stem) as show, resumable():
        page = run_experiment(name, out, quick=quick, development=law, progress=show)
    print(printable(page))


Shown = Annotated[
    Path,
    typer.Argument(
        metavar="INFANT|WORLD|RECORDING",
        help="Bundle, spec (.yaml, or `-` for standard input), world or recording to show.",
    ),
]
Number = Annotated[
    int | None, typer.Option(min=0, help="Show the recorded episode of this number; default: the first.")
]
Live = Annotated[
    bool, typer.Option("--live", help="Run it instead and serve what it does, until Ctrl-C (needs `mimoc[live]`).")
]
Physics = Annotated[
    bool, typer.Option("--physics", help="Let it fall, be pulled and act: adds MuJoCo to the page (4 MB).")
]


def view(
    shown: Shown,
    file: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE", help="Page to write: .html.")] = None,
    open_page: Annotated[
        bool | None,
        typer.Option("--open/--no-open", help="Open it in the browser; default: in a terminal with a display."),
    ] = None,
    physics: Physics = False,
    infant: Annotated[int | None, typer.Option(min=0, help="Show this one of several recorded infants.")] = None,
    episode: Number = None,
    live: Live = False,
    policy: Annotated[
        list[str] | None, typer.Option(metavar="POLICY", help="What it does with --live; see `mimoc run`.")
    ] = None,
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port of this machine for --live.")] = 8080,
) -> None:
    """Write a page that shows infants in 3D in any browser: one file, which needs no server and no network.

    On the page of a spec or bundle the infant grows from 0 to 24 months, takes poses and can be moved by its joints; on
    that of a world, the infant that is chosen, with the others around it. The page of a recording replays an episode,
    with what the infant felt and saw.
    """
    from mimoc.cli import console
    from mimoc.render.opengl import has_screen
    from mimoc.viewer import viewing

    opens = has_screen() and _in_a_terminal() if open_page is None else open_page
    is_recording = viewing.is_recording(shown)
    if not is_recording and (infant, episode) != (None, None):
        raise MimocError(f"{shown}: this is no recording; --infant and --episode choose from one")
    if live:
        if is_recording:
            raise MimocError(f"{shown}: --live runs an infant; name a bundle or a spec instead of a recording")
        _serve(shown, policy, port, opens)
        return
    if file is None:
        raise MimocError("say where to write the page with -o FILE.html, or serve a running infant with --live")
    check_page(file)
    source = shown if is_recording else find_world(shown, physics=physics) or load_infant(shown)
    with console.progress("replaying" if is_recording else "growing") as show:
        page = viewing.view(source, file, physics=physics, infant=infant, episode=episode, progress=show)
    if page.difference:
        message = "the page shows what is simulated now, which differs from the recording"
        print(printable(f"{message}: {page.difference}"), file=sys.stderr)
    print(printable(page.path))
    if opens:
        page.open()


def _in_a_terminal() -> bool:
    return sys.stdout.isatty()


def _serve(shown: Path, policy: list[str] | None, port: int, open_page: bool) -> None:
    from mimoc.policies.rollout import Run
    from mimoc.runtime.batch_env import infants_of
    from mimoc.viewer.live import LiveView

    env = open_env(find_world(shown) or load_infant(shown), None)
    chosen = policies_by_infant(policy, shown, None, infants_of("view", env))
    run = Run(env, chosen, seed=0, load=load_trained)
    with LiveView(next(iter(run.infants.values())), port) as live:
        print(f"{live.address}   (Ctrl-C ends it)", flush=True)
        if open_page:
            webbrowser.open(live.address)
        while True:
            run.step()
            live.show()
