"""Parsing of the text that chooses a policy: a name, perhaps with an argument, a trained policy, or a sum of these."""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from mimoc.base.errors import PolicyError, check_name
from mimoc.schema.kinds import POLICIES, PolicyKind

TRAINED = ".zip"  # How the path of a trained policy ends.
NAMED = re.compile("[a-z][a-z0-9_]*(:.*)?", re.DOTALL)
CALLED = re.compile(r"([a-z][a-z0-9_]*)\((.*)\)", re.DOTALL)
"""A name with its argument in parentheses, which means the same as after a colon."""
APART = re.compile(r"\+(?![^(]*\))")
FOR_INFANT = re.compile(r"(?:^|,)\s*([a-z][a-z0-9_]*)\s*=(?![^(]*\))")
"""The name of an infant and an equals sign, outside of parentheses, at the beginning or after a comma."""


@dataclass(frozen=True, slots=True)
class PolicyPart:
    """One policy of a sum."""

    kind: PolicyKind | None  # Its record; None for a trained policy.
    argument: str | None
    """What stands after the colon or in the parentheses, None if there are none; the path of a trained policy."""
    text: str

    @property
    def label(self) -> str:
        """What it is called where metrics of several policies have the same name."""
        return self.kind.name if self.kind else "trained"


def parse_policy(text: str) -> tuple[PolicyPart, ...]:
    """Return the policies in a text such as `random`, `NAME:ARGUMENT`, `policy.zip` or `NAME+NAME(ARGUMENT)+NAME`.

    A `+` always separates, but in parentheses, and in a path such as `runs/a+b/policy.zip`, of which `runs/a` can be no
    policy.

    Raises:
        UnknownNameError: If there is no such policy.
        PolicyError: If a part is empty, lacks its argument, or has one that it does not take.
    """
    if "+" in text and not all(text.split("+")):
        raise PolicyError(f"'{text}': a policy is missing beside a '+'; write NAME+NAME, such as random+zero")
    return tuple(_part(piece) for piece in _pieces(text))


def parse_policies(text: str, names: Collection[str]) -> dict[str, str]:
    """Return the policies of the infants of a world in a text such as `anna=sit,ben=look_at(anna)+kick`, by infant.

    A text that begins with no name is the policy of all. A setting of a behaviour that has the name of an infant has to
    be in parentheses: `anna=sit(lean=0.4),lean=zero`.

    Raises:
        UnknownNameError: If there is no such infant.
        PolicyError: If no policy stands behind a name, or an infant has two.
    """
    found = list[re.Match[str]]()
    for match in FOR_INFANT.finditer(text):
        may_be_setting = found and ":" in text[found[-1].end() : match.start()]
        if match[1] in names or not may_be_setting:
            found.append(match)
    if not found or found[0].start():
        return dict.fromkeys(names, text)
    policies = dict[str, str]()
    for match, end in zip(found, [*(item.start() for item in found[1:]), len(text)], strict=True):
        check_name("name of an infant of this world", match[1], names)
        if match[1] in policies:
            raise PolicyError(f"'{text}': '{match[1]}' has two policies; write one, or their sum with a '+'")
        policies[match[1]] = policy = text[match.end() : end].strip()
        if not policy:
            raise PolicyError(f"'{text}': there is no policy behind '{match[0]}'; write {match[1]}=NAME, such as sit")
    return policies


def split_behaviours(parts: Sequence[PolicyPart]) -> tuple[tuple[PolicyPart, ...], tuple[PolicyPart, ...]]:
    """Return the behaviours among the parts of a sum, which one controller does together, and the other policies."""
    is_behaviour = [part.kind is not None and part.kind.is_behaviour for part in parts]
    together = tuple(part for part, flag in zip(parts, is_behaviour, strict=True) if flag)
    return together, tuple(part for part, flag in zip(parts, is_behaviour, strict=True) if not flag)


def trained_policies(text: str) -> tuple[str, ...]:
    """Return the paths of the trained policies in such a text, whether or not its names are policies."""
    return tuple(piece for piece in _pieces(text) if _is_path(piece))


def _pieces(text: str) -> list[str]:
    pieces = APART.split(text)
    if text.endswith(TRAINED) and not all(NAMED.fullmatch(piece) or _is_path(piece) for piece in pieces):
        return [text]
    return pieces


def _is_path(piece: str) -> bool:
    return piece.endswith(TRAINED) and piece.partition(":")[0] not in POLICIES


def _part(text: str) -> PolicyPart:
    if _is_path(text):
        return PolicyPart(None, text, text)
    called = CALLED.fullmatch(text)
    name, colon, argument = (called[1], "()", called[2]) if called else text.partition(":")
    if not called and "(" in name:
        raise PolicyError(f"'{text}': a parenthesis is open; write NAME(ARGUMENT), in quotes where a shell reads it")
    kind = POLICIES.find(name)
    where = ("in parentheses", "in the parentheses") if called else ("after a colon", "after the colon")
    if colon and not kind.argument:
        raise PolicyError(f"'{text}': the policy '{name}' takes nothing {where[0]}; write {name}")
    if colon and not argument:
        raise PolicyError(f"'{text}': nothing stands {where[1]}; write {usage(kind)}")
    if not colon and needs_argument(kind):
        raise PolicyError(f"'{text}': the policy '{name}' needs more than its name; write {usage(kind)}")
    return PolicyPart(kind, argument if colon else None, text)


def needs_argument(kind: PolicyKind) -> bool:
    """Return whether a policy cannot be chosen by its name alone."""
    return bool(kind.argument) and not kind.argument.startswith("[")


def usage(kind: PolicyKind) -> str:
    """Return how a policy is chosen: `zero`, `motion:DIR`, `reach_for:TARGET[,HAND]`, or `reflexes[:MONTHS]`.

    Brackets are around what may be left out.
    """
    if needs_argument(kind):
        return f"{kind.name}:{kind.argument}"
    return f"{kind.name}[:{kind.argument[1:-1]}]" if kind.argument else kind.name
