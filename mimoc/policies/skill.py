"""A policy that has a skill: what `mimoc skill` or `mimoc train` found for it, as shipped or in a file."""

from pathlib import Path

from mimoc.base.errors import PolicyError
from mimoc.policies.postures import PosturePolicy, Postures, read_postures
from mimoc.runtime.env import InfantEnv

SHIPPED = Path(__file__).with_name("skills")
"""The movements that come with mimoc, one for a skill and an age."""


def shipped() -> dict[tuple[str, float], Path]:
    """Return the files of the movements that come with mimoc, by skill and age in months."""
    files = {}
    for path in sorted(SHIPPED.glob("*_months.json")):
        skill, age = path.name.removesuffix("_months.json").rsplit("_", 1)
        files[skill, float(age)] = path
    return files


def bind(env: InfantEnv, text: str) -> PosturePolicy:
    """Return the policy of a skill for an environment.

    Args:
        env: The infant.
        text: A skill, such as `roll`, of which the movement for the nearest age is taken; or the path of a movement.

    Raises:
        PolicyError: If there is none, or it is none for this infant.
    """
    return PosturePolicy(env, movement_of(text, env.age_months))


def movement_of(text: str, age_months: float) -> Postures:
    """Return the movement in a file, or the shipped one of a skill for the nearest age.

    Raises:
        PolicyError: If there is none.
    """
    if text.endswith(".json"):
        return read_postures(Path(text))
    ages = {age: path for (skill, age), path in shipped().items() if skill == text}
    if not ages:
        known = ", ".join(sorted({skill for skill, _ in shipped()})) or "none"
        raise PolicyError(
            f"no movement for the skill '{text}' comes with mimoc ({known} do); `mimoc skill` looks for one"
        )
    return read_postures(ages[min(ages, key=lambda age: (abs(age - age_months), age))])
