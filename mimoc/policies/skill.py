"""A policy that has a skill: what `mimoc skill` found or trained for it, as shipped or in a file."""

from pathlib import Path

from mimoc.base.errors import PolicyError
from mimoc.policies.policy import Policy
from mimoc.policies.policy_file import load_network, read_policy
from mimoc.policies.postures import PosturePolicy, read_postures
from mimoc.runtime.infant import Infant

SHIPPED = Path(__file__).with_name("skills")
"""What comes with mimoc, one file for a skill and an age: a movement (.json) or a trained policy (.zip)."""
KINDS = (".json", ".zip")


def shipped() -> dict[tuple[str, float], Path]:
    """Return the files that come with mimoc, by skill and age in months."""
    files = {}
    for path in sorted(SHIPPED.glob("*_months.*")):
        skill, age = path.stem.removesuffix("_months").rsplit("_", 1)
        files[skill, float(age)] = path
    return files


def bind(env: Infant, text: str) -> Policy:
    """Return the policy of a skill for an environment.

    Args:
        env: The infant.
        text: A skill, such as `roll`, of which what is there for the nearest age is taken; or the path of a file.

    Raises:
        PolicyError: If there is none, or it is none for this infant.
    """
    path = file_of(text, env.age_months)
    if path.suffix == ".json":
        return PosturePolicy(env, read_postures(path))
    maker = load_network(read_policy(path))
    if maker is None:
        raise PolicyError(f"{path}: trained by Stable-Baselines3; give the file itself as the policy, without 'skill:'")
    return maker(env)


def file_of(text: str, age_months: float) -> Path:
    """Return the file that a text names, or the shipped one of a skill for the nearest age, or raise a PolicyError."""
    if text.endswith(KINDS):
        return Path(text)
    ages = {age: path for (skill, age), path in shipped().items() if skill == text}
    if not ages:
        known = ", ".join(sorted({skill for skill, _ in shipped()})) or "none"
        raise PolicyError(
            f"nothing for the skill '{text}' comes with mimoc (there are: {known}); `mimoc skill` learns one"
        )
    return ages[min(ages, key=lambda age: (abs(age - age_months), age))]
