"""What a policy observes and commands, and how that of one infant differs from that of another."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from mimoc.base.errors import PolicyError, UnknownNameError
from mimoc.runtime.infant import Infant


def interface_of(env: Infant) -> dict[str, Any]:
    """Return shape and layout (empty for images) of each observation, and the actuators that the action commands."""
    spaces = spaces_of(env).items()
    observes = {name: {"shape": list(part.shape), "layout": _layout(env, name)} for name, part in spaces}
    return {"observes": observes, "commands": list(env.manifest.commands)}


def is_description(about: Any) -> bool:
    """Return whether data is what describes a policy in its file."""
    names = [about["infant"], *about["commands"]]
    for name, observation in about["observes"].items():
        names += [name, *observation["layout"]]
        if not all(type(size) is int for size in observation["shape"]):
            return False
    limit = about["settings"].get("steps_per_episode")
    if limit is not None and (type(limit) is not int or limit < 1):
        return False
    return all(isinstance(name, str) and name.isprintable() for name in names)


def check_fits(path: Path, about: Mapping[str, Any], interface: Mapping[str, Any]) -> None:
    """Raise a PolicyError if the policy in a file does not fit the interface of an infant."""
    if problems := differences(about, interface):
        raise PolicyError(f"{path}: trained for a different infant, '{about['infant']}': {'; '.join(problems)}")


def differences(about: Mapping[str, Any], interface: Mapping[str, Any]) -> list[str]:
    """Return how observations and actuators of the infant in training differ from those of another one."""
    trained, current = about["observes"], interface["observes"]
    result = [f"observation '{name}' is missing here" for name in trained.keys() - current.keys()]
    result += [f"observation '{name}' was not there in training" for name in current.keys() - trained.keys()]
    for name in trained.keys() & current.keys():
        if (then := tuple(trained[name]["shape"])) != (now := tuple(current[name]["shape"])):
            result.append(f"'{name}' had shape {then} in training and has {now} here")
        else:
            result += _first_difference(f"'{name}'", trained[name]["layout"], current[name]["layout"])
    commanded, commands = about["commands"], interface["commands"]
    if len(commanded) != len(commands):
        number = f"{len(commanded)} actuators in training and commands {len(commands)} here"
        return [*sorted(result), f"the action commanded {number}"]
    return [*sorted(result), *_first_difference("the action", commanded, commands)]


def spaces_of(env: Infant) -> Mapping[str, Any]:
    """Return the space of each observation of an infant, by name."""
    space: Any = env.observation_space
    return space.spaces


def _first_difference(what: str, trained: Sequence[str], current: Sequence[str]) -> list[str]:
    for number, (then, now) in enumerate(zip(trained, current, strict=False)):
        if then != now:
            return [f"element {number} of {what} was {then} in training and is {now} here"]
    return []


def _layout(env: Infant, name: str) -> list[str]:
    try:
        return list(env.layout(name))
    except UnknownNameError:  # An image, or an observation of the task.
        return []
