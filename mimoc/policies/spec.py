"""What the text that chooses a policy can say: a name, a name with an argument, a trained policy, or a sum of these."""

import re
from dataclasses import dataclass

from mimoc.base.errors import PolicyError
from mimoc.base.kinds import PolicyKind
from mimoc.policies import POLICIES

TRAINED = ".zip"
"""How the path of a trained policy ends."""
NAMED = re.compile("[a-z][a-z0-9_]*(:.*)?", re.DOTALL)


@dataclass(frozen=True, slots=True)
class PolicyPart:
    """One policy of a sum."""

    kind: PolicyKind | None
    """Its record; None for a trained policy."""
    argument: str | None
    """What stands after the colon, None if there is no colon; the path of a trained policy."""
    text: str
    """The part as it was written."""

    @property
    def label(self) -> str:
        """What it is called where metrics of several policies have the same name."""
        return self.kind.name if self.kind else "trained"


def parse_policy(text: str) -> tuple[PolicyPart, ...]:
    """Return the policies in a text such as `random`, `NAME:ARGUMENT`, `policy.zip` or `NAME+NAME:ARGUMENT+NAME`.

    A `+` always separates, but in a path such as `runs/a+b/policy.zip`, of which `runs/a` can be no policy.

    Raises:
        UnknownNameError: If there is no such policy.
        PolicyError: If a part is empty, lacks its argument, or has one that it does not take.
    """
    if "+" in text and not all(text.split("+")):
        raise PolicyError(f"'{text}': a policy is missing beside a '+'; write NAME+NAME, such as random+zero")
    return tuple(_part(piece) for piece in _pieces(text))


def trained_policies(text: str) -> tuple[str, ...]:
    """Return the paths of the trained policies in such a text, whether or not its names are policies."""
    return tuple(piece for piece in _pieces(text) if _is_path(piece))


def _pieces(text: str) -> list[str]:
    pieces = text.split("+")
    if text.endswith(TRAINED) and not all(NAMED.fullmatch(piece) or _is_path(piece) for piece in pieces):
        return [text]
    return pieces


def _is_path(piece: str) -> bool:
    return piece.endswith(TRAINED) and piece.partition(":")[0] not in POLICIES


def _part(text: str) -> PolicyPart:
    if _is_path(text):
        return PolicyPart(None, text, text)
    name, colon, argument = text.partition(":")
    kind = POLICIES.find(name)
    if colon and not kind.argument:
        raise PolicyError(f"'{text}': the policy '{name}' takes nothing after a colon; write {name}")
    if colon and not argument:
        raise PolicyError(f"'{text}': nothing stands after the colon; write {usage(kind)}")
    if not colon and needs_argument(kind):
        raise PolicyError(f"'{text}': the policy '{name}' needs more than its name; write {usage(kind)}")
    return PolicyPart(kind, argument if colon else None, text)


def needs_argument(kind: PolicyKind) -> bool:
    """Return whether a policy cannot be chosen by its name alone."""
    return bool(kind.argument) and not kind.argument.startswith("[")


def usage(kind: PolicyKind) -> str:
    """Return how a policy is chosen: `zero`, `motion:DIR`, or `reflexes[:MONTHS]` if its argument may be left out."""
    argument = kind.argument.strip("[]")
    if not argument:
        return kind.name
    return f"{kind.name}[:{argument}]" if kind.argument.startswith("[") else f"{kind.name}:{argument}"
