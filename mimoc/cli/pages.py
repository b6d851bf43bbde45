"""`mimoc report` and `mimoc experiment`: pages about infants, trainings, cohorts and experiments."""

from pathlib import Path
from typing import Annotated

import typer

import mimoc
from mimoc.cli.arguments import STDIN, Beside, load_spec
from mimoc.cli.terminal import printable, resumable
from mimoc.studies.names import EXPERIMENTS


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
        typer.Argument(metavar="NAME", help=f"One of: {', '.join(EXPERIMENTS)}."),
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
    from mimoc.studies import experiments

    law = experiments.check_experiment(name, development)
    with console.progress(name) as show, resumable():
        page = experiments.run_experiment(name, out, quick=quick, development=law, progress=show)
    print(printable(page))
