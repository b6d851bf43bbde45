"""The reference of the commands, made from what Typer reads: signatures, and what is annotated in them."""

import inspect
import types
from collections.abc import Iterator
from typing import Any, get_args, get_origin, get_type_hints

from typer import Typer
from typer.models import ArgumentInfo, OptionInfo

from mimoc.cli.commands import app

NAMES = {"int": "INTEGER", "float": "NUMBER", "str": "TEXT", "Path": "PATH"}


def reference() -> str:
    """Return the reference of all commands as Markdown."""
    return "\n".join(_about_all(app, "mimoc", 2))


def _about_all(group: Typer, path: str, level: int) -> Iterator[str]:
    """Yield the lines about the commands of a group, then those about the groups in it."""
    for command in group.registered_commands:
        name = command.name or command.callback.__name__.replace("_", "-")
        yield f"\n{'#' * level} `{path} {name}`\n"
        yield f"{_flowing(command.help or inspect.getdoc(command.callback))}\n"
        yield from _use(command.callback, f"{path} {name}", command.epilog)
    for inner in group.registered_groups:
        name = inner.typer_instance.info.name
        yield f"\n{'#' * level} `{path} {name}`\n"
        yield f"{_flowing(inner.typer_instance.info.help)}\n"
        yield from _about_all(inner.typer_instance, f"{path} {name}", level + 1)


def _use(function: Any, command: str, epilog: str | None) -> Iterator[str]:
    """Yield how a command is called, an example of it, and what each argument and option means."""
    told = list(_parameters(function))
    places = [
        _placeholder(name, each) if each.default is inspect.Parameter.empty else f"[{_placeholder(name, each)}]"
        for name, each, info, _ in told
        if isinstance(info, ArgumentInfo)
    ]
    yield f"```text\n{' '.join((command, *places))} [OPTIONS]\n```\n"
    if epilog:
        yield f"```sh\n{epilog.removeprefix('Example:').strip()}\n```\n"
    for name, parameter, info, kind in told:
        argument = isinstance(info, ArgumentInfo)
        yield f"`{_placeholder(name, parameter) if argument else _options(name, parameter, info, kind)}`"
        yield f": {_flowing(info.help)}{_default(parameter, argument)}\n"


def _parameters(function: Any) -> Iterator[tuple[str, inspect.Parameter, Any, Any]]:
    """Yield the name, the parameter, what Typer knows of it, and the type of what help shows."""
    hints = get_type_hints(function, include_extras=True)
    for name, parameter in inspect.signature(function).parameters.items():
        for info in getattr(hints[name], "__metadata__", ()):
            if isinstance(info, ArgumentInfo | OptionInfo) and not info.hidden:
                yield name, parameter, info, get_args(hints[name])[0]


def _placeholder(name: str, parameter: inspect.Parameter) -> str:
    """Return the name of an argument, in capitals."""
    infos = [each for each in get_args(parameter.annotation)[1:] if isinstance(each, ArgumentInfo)]
    return str((infos[0].metavar if infos else None) or name.upper()).strip("{}[]")


def _options(name: str, parameter: inspect.Parameter, info: OptionInfo, kind: Any) -> str:
    """Return an option as it is typed: its names, of which Typer keeps the first as a default, and a placeholder."""
    given = [each for each in (info.default, *(info.param_decls or ())) if isinstance(each, str)]
    names = ", ".join(given or [f"--{name.replace('_', '-')}"])
    value = info.metavar or _type_name(kind)
    return f"{names} {value}" if value else names


def _type_name(kind: Any) -> str:
    """Return a placeholder for values of a type; empty for a switch."""
    if isinstance(kind, types.UnionType) or get_origin(kind) in (list, tuple):
        kind = next(each for each in get_args(kind) if each is not types.NoneType)
    if kind is bool:
        return ""
    return NAMES.get(getattr(kind, "__name__", ""), "VALUE")


def _default(parameter: inspect.Parameter, argument: bool) -> str:
    default = parameter.default
    if default is inspect.Parameter.empty:
        return "" if argument else " Required."
    shown = isinstance(default, str | int | float) and not isinstance(default, bool) and default != ""
    return f" Default: `{default}`." if shown else ""


def _flowing(text: Any) -> str:
    return " ".join(str(text or "").split())
