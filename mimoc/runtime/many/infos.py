"""The `info` of many infants, as Gymnasium's vector environments give it."""

from typing import Any

from gymnasium.vector import VectorEnv

from mimoc.senses.sense import Observation


class Infos:
    """Collects the `info` of each infant."""

    def __init__(self, env: VectorEnv):
        """Begin with none."""
        self._env, self._found = env, dict[int, dict[str, Any]]()

    def add(self, infant: int, info: dict[str, Any]) -> None:
        """Take that of an infant."""
        self._found[infant] = info

    def replace(self, infant: int, final: Observation, info: dict[str, Any]) -> None:
        """Put the info of a new episode in place of that of an ended one, which stays beside it with what was seen."""
        self._found[infant] = {"final_obs": final, "final_info": self._found[infant], **info}

    def joined(self) -> dict[str, Any]:
        """Return an array of each value, beside a mask of the infants that have it."""
        infos: dict[str, Any] = {}
        for infant, info in sorted(self._found.items()):
            infos = self._env._add_info(infos, info, infant)
        return infos
