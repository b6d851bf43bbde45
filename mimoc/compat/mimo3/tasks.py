"""MIMo3's environments, whose tasks are mimoc's."""

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
from gymnasium.envs.registration import register, registry

from mimoc.base.errors import MimocError
from mimoc.compat.mimo3.environment import MIMoEnv
from mimoc.compat.mimo3.keywords import (
    BENCHMARK_XML,
    BENCHMARK_XML_V2,
    CATCH_TOUCH_PARAMS,
    CATCH_XML,
    DEFAULT_PROPRIOCEPTION_PARAMS,
    DEFAULT_TOUCH_PARAMS,
    DEFAULT_TOUCH_PARAMS_V2,
    DEFAULT_VESTIBULAR_PARAMS,
    DEFAULT_VISION_PARAMS,
    REACH_XML,
    ROLL_OVER_XML,
    SELFBODY_TOUCH_PARAMS,
    SELFBODY_XML,
    STANDUP_XML,
)

ENVIRONMENTS = {
    "MIMoReach-v0": ("MIMoReachEnv", 1000),
    "MIMoStandup-v0": ("MIMoStandupEnv", 500),
    "MIMoSelfBody-v0": ("MIMoSelfBodyEnv", 500),
    "MIMoCatch-v0": ("MIMoCatchEnv", 800),
    "MIMoRollOver-v0": ("MIMoRollOverEnv", 500),
    "MIMoBench-v0": ("MIMoDummyEnv", 6000),
    "MIMoBenchV2-v0": ("MIMoV2DummyEnv", 6000),
    "MIMoMuscle-v0": ("MIMoMuscleDummyEnv", 6000),
}
"""The class of each id, and the control steps after which its episodes are truncated."""
ELSEWHERE = {
    "MIMoShowroom-v0": "a spec with 'scene: {kind: room, toys: {}}' as model_path of MIMoBenchV2-v0",
    **dict.fromkeys(
        (
            *("MIMoMuscleStaticTest-v0", "MIMoMuscleStaticTestV2-v0", "MIMoVelocityMuscleTest-v0"),
            *("MIMoVelocityMuscleTestV2-v0", "MIMoComplianceTest-v0", "MIMoComplianceMuscleTest-v0"),
        ),
        "`mimoc experiment strength` and `mimoc.torque_limits`, which measure motors and muscles",
    ),
}
"""Ids without a counterpart, and what to use instead."""


def register_ids() -> None:
    """Let MIMo3's ids be mimoc's from now on; those without a counterpart stay MIMo3's, if it has registered them."""
    for name, (environment, steps) in ENVIRONMENTS.items():
        registry.pop(name, None)
        register(name, f"mimoc.compat.mimo3:{environment}", max_episode_steps=steps)
    for name in ELSEWHERE:
        if name not in registry:
            register(name, "mimoc.compat.mimo3.tasks:refuse", kwargs={"name": name})


def refuse(name: str, **keywords: Any) -> None:
    """Say what to use instead of an environment."""
    raise MimocError(f"{name} has no counterpart in mimoc; use {ELSEWHERE[name]}")


PROPRIO = {"proprio_params": DEFAULT_PROPRIOCEPTION_PARAMS}
BALANCE = {**PROPRIO, "vestibular_params": DEFAULT_VESTIBULAR_PARAMS}
REACH = {**PROPRIO, "goals_in_observation": False, "done_active": True}
MOVEMENT = {**BALANCE, "goals_in_observation": False}
SELFBODY = {**PROPRIO, "frame_skip": 1, "touch_params": SELFBODY_TOUCH_PARAMS, "done_active": True}
CATCH = {**REACH, "touch_params": CATCH_TOUCH_PARAMS, "actuation_model": "MuscleModel"}
DUMMY = {
    **REACH,
    **BALANCE,
    "touch_params": DEFAULT_TOUCH_PARAMS,
    "vision_params": DEFAULT_VISION_PARAMS,
}
DUMMY_V2 = {**DUMMY, "touch_params": DEFAULT_TOUCH_PARAMS_V2}
MUSCLE = {**DUMMY_V2, "actuation_model": "MuscleModel"}


class _Scene(MIMoEnv):
    """An environment with a scene and keywords of its own."""

    scene: ClassVar[str] = BENCHMARK_XML
    keywords: ClassVar[Mapping[str, Any]] = {}
    """Keywords that differ from those of `MIMoEnv` by default."""

    def __init__(self, model_path: Any = None, **keywords: Any):
        super().__init__(self.scene if model_path is None else model_path, **{**self.keywords, **keywords})

    @property
    def _task(self) -> Any:
        return self.infant.manifest.task


class MIMoReachEnv(_Scene):
    """mimoc's `reach`: touch a ball that hangs within reach."""

    scene = REACH_XML
    keywords = REACH

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start an episode; the ball hangs from then on where `reset_model` left it."""
        started = super().reset(seed=seed, options=options)
        self.target_init_pos = self.data.body("target").xpos.copy()
        self.infant.task.remember(start_m=self.target_init_pos)
        return started


class MIMoStandupEnv(_Scene):
    """mimoc's `standup`: get the head up high while holding on to a rail."""

    scene = STANDUP_XML
    keywords = MOVEMENT

    def sample_goal(self) -> float:
        """Return the height of the head that counts as standing, [m]."""
        return self._task.success_m

    def get_achieved_goal(self) -> float:
        """Return the height of the head, [m]."""
        return float(self.data.body("head").xpos[2])


class MIMoRollOverEnv(_Scene):
    """mimoc's `rollover`, from the back."""

    scene = ROLL_OVER_XML
    keywords = MOVEMENT

    def sample_goal(self) -> float:
        """Return how far it has to turn: 1 is flat on the belly."""
        return self._task.goal

    def get_achieved_goal(self) -> float:
        """Return how far it has turned."""
        return float(self.infant.task.memory["turned"])


class MIMoSelfBodyEnv(_Scene):
    """mimoc's `selfbody`: touch the part of the body that the desired goal names."""

    scene = SELFBODY_XML
    keywords = SELFBODY

    def sample_goal(self) -> Any:
        """Return 1 for the part to be touched and 0 for all others."""
        return self.infant.task.observe()["goal"].astype(np.float64)

    @property
    def target_body(self) -> str:
        """Name of the part to be touched."""
        return self._task.targets[int(np.argmax(self.goal))].name


class MIMoCatchEnv(_Scene):
    """mimoc's `catch`: hold a ball that falls on the open hand; its radius is observed, too."""

    scene = CATCH_XML
    keywords = CATCH

    def __init__(
        self,
        model_path: Any = None,
        action_penalty: bool = True,
        jitter: bool = False,
        position_inaccurate: bool = False,
        **keywords: Any,
    ):
        if jitter or position_inaccurate:
            raise MimocError(
                "jitter and position_inaccurate have no counterpart; give a spec with 'noise: {motor: .1}'"
            )
        self.action_penalty = action_penalty
        super().__init__(model_path, **keywords)

    @property
    def ball_size(self) -> float:
        """Radius of the ball, [m]."""
        return float(self.model.geom(self._task.ball.geom).size[0])

    def _get_obs(self) -> dict[str, Any]:
        observation = super()._get_obs()
        observation["observation"] = np.append(observation["observation"], np.float32(self.ball_size))
        return observation

    def compute_reward(self, achieved_goal: Any, desired_goal: Any, info: dict[str, Any]) -> float:
        """Return the reward of the task, on request without what effort costs."""
        effort = 0.0 if self.action_penalty else info["reward_terms"].get("effort", 0.0)
        return super().compute_reward(achieved_goal, desired_goal, info) - effort


class MIMoDummyEnv(_Scene):
    """All senses, and no task."""

    keywords = DUMMY

    def __init__(
        self, model_path: Any = None, show_sensors: bool = False, print_space_sizes: bool = False, **keywords: Any
    ):
        if show_sensors:
            raise MimocError("show_sensors has no counterpart; `mimoc render --skin` draws the skin points")
        self.steps = 0
        super().__init__(model_path, **keywords)
        if print_space_sizes:
            sizes = {"action": self.action_space, **self.observation_space}
            print("\n".join(f"{name}: {space.shape}" for name, space in sizes.items()))

    def _obs_callback(self) -> None:
        self.steps += 1


class MIMoV2DummyEnv(MIMoDummyEnv):
    """All senses of an infant with five fingers, and no task."""

    scene = BENCHMARK_XML_V2
    keywords = DUMMY_V2


class MIMoMuscleDummyEnv(MIMoV2DummyEnv):
    """All senses of an infant with five fingers and muscles, and no task."""

    keywords = MUSCLE
