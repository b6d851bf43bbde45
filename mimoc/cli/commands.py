"""The `mimoc` program with all its commands."""

from typing import Annotated

import typer

from mimoc.cli import (
    build,
    check,
    cohort,
    doctor,
    experiment,
    explain,
    export,
    import_config,
    new,
    render,
    replay,
    report,
    rooms,
    run,
    schema,
    see,
    train,
    validate,
    view,
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


app.command(epilog=new.EXAMPLE)(new.new)
app.command(epilog=build.EXAMPLE)(build.build)
app.command(epilog=validate.EXAMPLE)(validate.validate)
app.command(epilog=run.EXAMPLE)(run.run)
app.command(epilog=train.EXAMPLE)(train.train)
app.command(epilog=experiment.EXAMPLE)(experiment.experiment)
app.add_typer(cohort.app)
app.command(epilog=check.EXAMPLE)(check.check)
app.command(epilog=explain.EXAMPLE)(explain.explain)
app.command(epilog=report.EXAMPLE)(report.report)
app.command(epilog=render.EXAMPLE)(render.render)
app.command(epilog=see.EXAMPLE)(see.see)
app.command(epilog=view.EXAMPLE)(view.view)
app.command(epilog=rooms.EXAMPLE)(rooms.rooms)
app.command(epilog=replay.EXAMPLE)(replay.replay)
app.command(epilog=export.EXAMPLE)(export.export)
app.command("import", epilog=import_config.EXAMPLE)(import_config.import_config)
app.command(epilog=schema.EXAMPLE)(schema.schema)
app.command(epilog=doctor.EXAMPLE)(doctor.doctor)
