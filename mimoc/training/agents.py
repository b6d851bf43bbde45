"""Stable-Baselines3's PPO and SAC: how they learn from infants on the CPU, and the files of their policies."""

import io
import json
import math
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.buffers import DictReplayBuffer
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.policies import BasePolicy
from stable_baselines3.common.preprocessing import is_image_space
from stable_baselines3.common.vec_env import VecNormalize, VecTransposeImage
from stable_baselines3.ppo import MultiInputPolicy as PPOPolicy
from stable_baselines3.sac import MultiInputPolicy as SACPolicy

from mimoc.base.errors import PolicyError
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import pack_arrays
from mimoc.policies.policy import Policy, PolicyMaker
from mimoc.policies.policy_file import (
    ABOUT,
    DAMAGED,
    NOT_A_POLICY,
    OF_AGENT,
    WEIGHTS,
    PolicyFile,
    TrainedPolicy,
    check_fits,
    interface_of,
    spaces_of,
)
from mimoc.recording.recorder import Recording
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.infant import Infant
from mimoc.runtime.quantities import EpisodeResult
from mimoc.runtime.sense import Observation
from mimoc.training.checkpoint import (
    IntervalCurve,
    Progress,
    opened_checkpoint,
    pack,
    restore_state,
    set_weights,
    state_of,
    weights_of,
)
from mimoc.training.curve import CurvePoint, DeviceUse, summarize
from mimoc.training.settings import Number, TrainingSettings, complete
from mimoc.training.tracking import ROW_STEPS, RewardWatch
from mimoc.training.vector_env import normalized_names, seek, set_statistics, statistics

SCALE, REPLAY = "scale.npz", "replay.npz"
"""The files of statistics of the observations, in policies and checkpoints, and of a replay buffer, in checkpoints.
What mimoc does not read in a policy is for Stable-Baselines3, whose `load` accepts the archive too and unpickles it;
mimoc never does."""

_PASSED_ON = {
    "ppo": ("learning_rate", "gamma", "batch_size", "clip_range", "ent_coef", "gae_lambda", "n_epochs", "n_steps"),
    "sac": ("learning_rate", "gamma", "batch_size", "buffer_size", "gradient_steps", "learning_starts", "tau"),
}
"""Hyperparameters passed on to Stable-Baselines3 unchanged."""
_ALGORITHMS: Mapping[str, Callable[..., BaseAlgorithm]] = {"ppo": PPO, "sac": SAC}
_POLICIES: Mapping[str, Callable[..., BasePolicy]] = {"ppo": PPOPolicy, "sac": SACPolicy}


def make_agent(env: VecNormalize, settings: TrainingSettings) -> BaseAlgorithm:
    """Return an untrained agent; the same seed gives the same initial weights."""
    return _ALGORITHMS[settings.algo](
        "MultiInputPolicy",
        env,
        policy_kwargs=_network(settings.hyper),
        device="cpu",
        seed=settings.interval_seed(0),
        **{name: settings.hyper[name] for name in _PASSED_ON[settings.algo]},
    )


def make_policy(algo: str, hyper: Mapping[str, Number], observation_space: Any, action_space: Any) -> BasePolicy:
    """Return the policy network of an algorithm for Gymnasium's spaces, randomly initialised."""
    spaces = {
        name: VecTransposeImage.transpose_space(space, name) if is_image_space(space) else space
        for name, space in observation_space.spaces.items()
    }
    network = _network(hyper)
    return _POLICIES[algo](type(observation_space)(spaces), action_space, lambda _: 0.0, **network)


def torch_devices() -> str:
    """Return what torch can compute on: `CUDA 12.8, NVIDIA H200`, say, or `CPU only`."""
    if not torch.cuda.is_available():
        return "CPU only"
    names = dict.fromkeys(torch.cuda.get_device_name(index) for index in range(torch.cuda.device_count()))
    return f"CUDA {torch.version.cuda}, {', '.join(names)}"


class SB3Learner:
    """PPO or SAC of Stable-Baselines3 with its environments; see `Learner`."""

    def __init__(self, settings: TrainingSettings, infant: InfantEnv, env: VecNormalize, recording: Recording | None):
        self._settings, self._infant, self._env, self._recording = settings, infant, env, recording
        self._agent = make_agent(env, settings)
        self._watch = RewardWatch()
        self._recorder: Recorder
        self._interval_steps = 0

    def log_to(self, logger: Logger) -> None:
        """Tell a logger what is learnt from now on."""
        self._agent.set_logger(logger)

    def restore(self, checkpoint: bytes) -> Progress:
        """Restore a checkpoint, and return the progress at that point."""
        with opened_checkpoint(checkpoint) as saved:
            progress = saved.progress()
            restore_agent(self._agent, saved.arrays(WEIGHTS))
            set_statistics(self._env, saved.arrays(SCALE))
            self._agent.num_timesteps = progress.steps
            if (buffer := self._replay_buffer) is not None:
                restore_replay(buffer, saved.arrays(REPLAY))
        return progress

    def begin(self, before: Progress, report: Callable[[int], None], on_row: Callable[[CurvePoint], None]) -> None:
        """Begin an interval."""
        settings = self._settings
        step_s = ms_to_s(self._infant.manifest.step_ms)
        self._recorder = Recorder(before, step_s, report, on_row, self._watch)
        seek(self._env, settings, before.steps)
        if self._recording is not None:  # What a killed process has recorded of this interval comes again.
            self._recording.mark(settings.digest(), before.steps)
        # The outcome of the interval depends only on the weights and statistics of the agent, and on this seed.
        self._agent.set_random_seed(settings.interval_seed(before.steps))
        self._agent._last_obs = None  # Makes `learn` reset the environments.
        self._interval_steps = settings.end_of_interval(before.steps) - before.steps

    def learn(self, others: Sequence[Any] = ()) -> None:
        """Learn until the end of the interval; on the CPU, there are no others."""
        self._agent.learn(self._interval_steps, self._recorder, reset_num_timesteps=False)

    def progress(self) -> Progress:
        """Return the progress at the end of what was learnt last, or where that was interrupted."""
        return self._recorder.progress()

    @property
    def _replay_buffer(self) -> "DictReplayBuffer | None":  # A text, as the documentation mocks Stable-Baselines3.
        buffer = getattr(self._agent, "replay_buffer", None)
        return buffer if isinstance(buffer, DictReplayBuffer) else None

    @property
    def has_learnt(self) -> bool:
        """Whether it was updated since it was made or restored."""
        return self._agent._n_updates > 0  # pyright: ignore[reportAttributeAccessIssue] - Of on- and off-policy algorithms.

    def policy(self) -> bytes:
        """Return the content of the file of its policy."""
        return pack_policy(self._agent, self._env, self._settings, self._infant)

    def checkpoint(self, reached: Progress) -> bytes:
        """Return the content of a checkpoint file."""
        arrays = {WEIGHTS: agent_state(self._agent), SCALE: statistics(self._env)}
        if (buffer := self._replay_buffer) is not None:
            arrays[REPLAY] = replay_arrays(buffer)
        return pack(reached, arrays)

    def use(self, others: Sequence[Any] = ()) -> list[DeviceUse | None]:
        """Return that nothing was taken of a device."""
        return [None]


@contextmanager
def sb3_learner(
    settings: TrainingSettings, infant: InfantEnv, open_envs: Callable[[], VecNormalize], record: str | Path | None
) -> Iterator[list[SB3Learner]]:
    """Open the parallel environments, recorded in a folder if there is one, and what learns from them."""

    def close() -> None:
        with suppress(EOFError, OSError):  # After Ctrl-C, which also ends their processes.
            env.close()

    env = open_envs()
    with ExitStack() as opened:
        opened.callback(close)
        together: Any = env.unwrapped
        recording = opened.enter_context(Recording(together.infants.infants, record)) if record is not None else None
        yield [SB3Learner(settings, infant, env, recording)]


class Recorder(BaseCallback):
    """Callback that extends a learning curve during a training interval."""

    def __init__(
        self,
        before: Progress,
        step_s: float,
        report: Callable[[int], None],
        on_row: Callable[[CurvePoint], None],
        watch: RewardWatch,
    ):
        """Continue the curve of earlier intervals; *report* gets the steps taken so far, *on_row* each new row."""
        super().__init__()
        self._curve = IntervalCurve(before, on_row)
        self._before_steps = before.steps
        self._step_s = step_s
        self._report, self._watch = report, watch
        self._ended = list[EpisodeResult]()

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if (episode := info.get("episode")) is not None:
                self._ended.append(self._result(episode["r"], episode["l"], success=bool(info["is_success"])))
        if not self._watch.ended:
            self._watch(self._envs.get_original_reward())
        self._report(self.num_timesteps)
        if self.num_timesteps - self._curve.row_start >= ROW_STEPS:
            self._end_row()
        return True

    def progress(self) -> Progress:
        """Return the progress at the end of the interval, or where it was interrupted."""
        if self.num_timesteps > self._curve.row_start:
            self._end_row()
        return self._curve.progress(max(self.num_timesteps, self._before_steps))

    @property
    def _envs(self) -> Any:
        return self.training_env

    def _end_row(self) -> None:
        so_far = zip(self._envs.episode_returns, self._envs.episode_lengths, strict=True)
        unfinished = [self._result(reward, steps) for reward, steps in so_far if steps]
        self._curve.add(summarize(self._ended, self.num_timesteps, self._curve.wall_s(), unfinished))
        self._ended = []

    def _result(self, total_reward: Any, steps: Any, *, success: bool = False) -> EpisodeResult:
        return EpisodeResult(float(total_reward), int(steps), success, duration_s=int(steps) * self._step_s)


def agent_state(agent: BaseAlgorithm) -> dict[str, np.ndarray]:
    """Return all that an agent learns, to go on from: `state_of` its modules, and variables (`log_ent_coef`)."""
    modules, variables = _learnt(agent)
    return {**{name: getattr(agent, name).numpy(force=True) for name in variables}, **state_of(modules)}


def restore_agent(agent: BaseAlgorithm, state: Mapping[str, np.ndarray]) -> None:
    """Restore what `agent_state` has returned; raise a Key-, Runtime- or ValueError if it is of another agent."""
    modules, variables = _learnt(agent)
    restore_state(modules, state)
    with torch.no_grad():
        for name in variables:  # In place: an optimiser holds a reference to it.
            getattr(agent, name).copy_(torch.from_numpy(state[name].copy()))


def _learnt(agent: BaseAlgorithm) -> "tuple[dict[str, torch.nn.Module | torch.optim.Optimizer], list[str]]":
    """Return the networks and optimisers of an agent by name, and the names of its other variables."""
    names, variables = agent._get_torch_save_params()
    return {name: attrgetter(name)(agent) for name in names}, variables


_VECTORS = ("actions", "rewards", "dones", "timeouts")
_DICTIONARIES = ("observations", "next_observations")


def replay_arrays(buffer: DictReplayBuffer) -> dict[str, np.ndarray]:
    """Return what a replay buffer holds, to go on from."""
    used = buffer.buffer_size if buffer.full else buffer.pos
    arrays = {"pos": np.array(buffer.pos), "full": np.array(buffer.full)}
    arrays |= {name: getattr(buffer, name)[:used] for name in _VECTORS}
    for kind in _DICTIONARIES:
        arrays |= {f"{kind}.{name}": part[:used] for name, part in getattr(buffer, kind).items()}
    return arrays


def restore_replay(buffer: DictReplayBuffer, saved: Mapping[str, np.ndarray]) -> None:
    """Restore what `replay_arrays` has returned; raise a Key- or ValueError if it is of another buffer."""
    used, position, full = len(saved["rewards"]), int(saved["pos"]), bool(saved["full"])
    if used != (buffer.buffer_size if full else position) or not 0 <= position < buffer.buffer_size:
        raise ValueError("a replay buffer of another size")
    for name in _VECTORS:
        getattr(buffer, name)[:used] = saved[name]
    for kind in _DICTIONARIES:
        for name, part in getattr(buffer, kind).items():
            part[:used] = saved[f"{kind}.{name}"]
    buffer.pos, buffer.full = position, full


def _network(hyper: Mapping[str, Number]) -> dict[str, Any]:
    return {"net_arch": [int(hyper["width"])] * int(hyper["layers"])}


def pack_policy(agent: BaseAlgorithm, vector_env: VecNormalize, settings: TrainingSettings, env: Infant) -> bytes:
    """Return the content of an agent's policy file, for `load_policy`."""
    content = io.BytesIO()
    agent.save(content)
    about = {
        "policy": OF_AGENT,
        "infant": env.manifest.name,
        "steps": agent.num_timesteps,
        "settings": settings.data(),
        **interface_of(env),
    }
    with zipfile.ZipFile(content, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(ABOUT, json.dumps(about, indent=1))
        archive.writestr(SCALE, pack_arrays(statistics(vector_env)))
        archive.writestr(WEIGHTS, pack_arrays(weights_of(agent.policy)), zipfile.ZIP_STORED)
    return content.getvalue()


def load_agent(file: PolicyFile) -> PolicyMaker:
    """Return the policy in a file of one that was trained by Stable-Baselines3.

    The returned function raises a PolicyError for an infant whose observations or actuators differ from those of the
    trained infant.

    Raises:
        PolicyError: If it is damaged.
    """
    path, about = file.path, file.about
    try:
        known, weights = file.arrays(SCALE), file.arrays(WEIGHTS)
        if not all(np.isfinite(array).all() for array in (*known.values(), *weights.values())):
            raise ValueError("numbers that are not finite")
        hyper = complete(about["settings"]["algo"], about["settings"]["hyper"])
    except DAMAGED:
        raise PolicyError(f"{path}: {NOT_A_POLICY}") from None
    return lambda env: _bind(path, about, hyper, known, weights, env)


def _bind(
    path: Path,
    about: dict[str, Any],
    hyper: Mapping[str, Any],
    known: Mapping[str, np.ndarray],
    weights: Mapping[str, np.ndarray],
    env: Infant,
) -> Policy:
    check_fits(path, about, interface_of(env))
    scale = dict[str, tuple[np.ndarray, np.ndarray]]()
    try:
        width, layers = int(hyper["width"]), int(hyper["layers"])
        inputs = sum(math.prod(space.shape) for space in spaces_of(env).values() if len(space.shape) == 1)
        if width * (inputs + width * (layers - 1)) > sum(array.size for array in weights.values()):
            raise ValueError("fewer weights than its layers have")
        network = make_policy(about["settings"]["algo"], hyper, env.observation_space, env.action_space)
        set_weights(network, weights)
        for name in normalized_names(env.observation_space):
            mean = known[f"{name}.mean"]
            variance = np.maximum(known[f"{name}.var"], 0.0)
            if not mean.shape == variance.shape == spaces_of(env)[name].shape:
                raise ValueError(f"the statistics of '{name}' are of another shape")
            scale[name] = mean, np.sqrt(variance + hyper["observation_floor"] ** 2)
    except (KeyError, RuntimeError, ValueError, TypeError, AttributeError):
        raise PolicyError(f"{path}: {NOT_A_POLICY}") from None
    network.set_training_mode(False)
    act = partial(_act, network, scale, float(hyper["observation_clip"]))
    return TrainedPolicy(act, about["settings"].get("steps_per_episode"))


def _act(
    network: BasePolicy, scale: Mapping[str, tuple[np.ndarray, np.ndarray]], clip: float, observation: Observation
) -> np.ndarray:
    """Return the action for an observation, of which what has a mean and a deviation is normalised and clipped."""
    inputs = dict(observation)
    for name, (mean, deviation) in scale.items():
        inputs[name] = np.clip((observation[name] - mean) / deviation, -clip, clip).astype(np.float32)
    try:
        return network.predict(inputs, deterministic=True)[0]
    except ValueError:  # A distribution of numbers that are not finite.
        return np.array(np.nan)
