"""Which infants can live in one vector environment: those that sense and command the same."""

from collections.abc import Sequence
from typing import Any

from mimoc.errors import MimocError
from mimoc.runtime.env import InfantEnv

SHOWN = 4
"""Names that an error gives of those that only one of two infants has."""


class MixtureError(MimocError):
    """Some infants cannot share a batch."""


def check_mixture(infants: Sequence[InfantEnv]) -> None:
    """Check that all infants can share a batch with the first one.

    Raises:
        MixtureError: If one cannot; it names what differs.
    """
    first = _parts(infants[0])
    for number, infant in enumerate(infants):
        parts = _parts(infant)
        differences = [
            f"{part} ({_difference(first.get(part), parts.get(part))})"
            for part in dict.fromkeys([*first, *parts])
            if first.get(part) != parts.get(part)
        ]
        if differences:
            who = f"infants 0 ('{infants[0].manifest.name}') and {number} ('{infant.manifest.name}')"
            raise MixtureError(
                f"{who} cannot share a batch, because they differ in {'; '.join(differences)}; "
                "make a vector environment of each kind"
            )


def _parts(infant: InfantEnv) -> dict[str, Any]:
    """Return what must be the same of all infants, by what it is called."""
    manifest = infant.manifest
    arrays: Any = infant.observation_space
    return {
        "control step": f"{manifest.step_ms:g} ms",
        "physics step": f"{manifest.timestep_ms:g} ms",
        "actuation model": manifest.actuation.model,
        "commands": tuple(actuator.name for actuator in manifest.actuation.actuators if actuator.commanded),
        "task": manifest.task.kind,
        "senses": tuple(infant.senses),
        "observations": tuple(f"{name} {space.shape}" for name, space in arrays.spaces.items()),
        **{f"numbers of '{name}'": sense.layout for name, sense in infant.senses.items() if name != "touch"},
    }


def _difference(ours: Any, theirs: Any) -> str:
    """Return in a few words how two parts differ."""
    if not (isinstance(ours, tuple) and isinstance(theirs, tuple)):
        return f"{ours or 'none'}, {theirs or 'none'}"
    only = [
        f"only {whose} has {_some(sorted(set(mine) - set(others)))}"
        for whose, mine, others in (("the first", ours, theirs), ("the other", theirs, ours))
        if set(mine) - set(others)
    ]
    return ", ".join(only) or "in another order"


def _some(names: Sequence[str]) -> str:
    shown = ", ".join(names[:SHOWN])
    return shown if len(names) <= SHOWN else f"{shown} and {len(names) - SHOWN} more"
