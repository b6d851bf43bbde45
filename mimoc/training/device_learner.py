"""Learning on a device, by rsl_rl's PPO: thousands of infants at once, of whom nothing leaves the device.

What is learnt has the names of Stable-Baselines3's networks, so that one kind of policy file runs everywhere.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from math import nan
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import torch
from rsl_rl.algorithms import PPO
from rsl_rl.models import MLPModel
from rsl_rl.storage import RolloutStorage
from tensordict import TensorDict

from mimoc.base.units import ms_to_s
from mimoc.runtime.env import InfantEnv
from mimoc.training.agents import ADAM, interval_seed
from mimoc.training.checkpoint import Progress, pack_state, restore_state
from mimoc.training.curve import Curve, CurvePoint
from mimoc.training.learner import OnRow, Report
from mimoc.training.policies import pack_network
from mimoc.training.rsl_env import RslEnv
from mimoc.training.settings import TrainingSettings

GROUP = "observed"
"""The one group of observations that the networks read: all, one after the other, normalised."""


class Normalizer:
    """Running means and variances of all observations, as numbers of 64 bits on the device."""

    def __init__(self, sizes: Mapping[str, int], clip: float, floor: float, device: Any):
        """Begin with means of 0 and variances of 1, as Stable-Baselines3 does; *sizes* are by observation."""
        self.sizes, self._clip, self._floor = dict(sizes), clip, floor
        total = sum(sizes.values())
        self.mean = torch.zeros(total, dtype=torch.float64, device=device)
        self.var = torch.ones(total, dtype=torch.float64, device=device)
        self.count = torch.tensor(1e-4, dtype=torch.float64, device=device)

    def __call__(self, observed: TensorDict, *, learns: bool) -> TensorDict:
        """Return the observations as the networks read them, shape (k, n); count them first if it *learns*."""
        values: torch.Tensor = torch.cat([observed[name] for name in self.sizes], dim=-1)
        if learns:
            self._count(values.double())
        scaled = (values - self.mean) / torch.sqrt(self.var.clamp(min=0.0) + self._floor**2)
        return TensorDict({GROUP: scaled.clamp(-self._clip, self._clip).float()}, batch_size=observed.batch_size)

    def statistics(self) -> dict[str, np.ndarray]:
        """Return mean, variance and count of each observation, by the names of policy files."""
        arrays, first = dict[str, np.ndarray](), 0
        for name, size in self.sizes.items():
            of_name = slice(first, first + size)
            arrays |= {f"{name}.mean": _array(self.mean[of_name]), f"{name}.var": _array(self.var[of_name])}
            arrays[f"{name}.count"] = _array(self.count)
            first += size
        return arrays

    def restore(self, saved: Mapping[str, np.ndarray]) -> None:
        """Go on from statistics; raise a KeyError or a RuntimeError if they are of other observations."""
        for what in ("mean", "var"):
            values = np.concatenate([saved[f"{name}.{what}"] for name in self.sizes])
            getattr(self, what).copy_(torch.from_numpy(values))
        self.count.fill_(float(saved[f"{next(iter(self.sizes))}.count"]))

    def _count(self, values: torch.Tensor) -> None:
        """Take in values of shape (k, n), as Chan, Golub & LeVeque (1979) add two sets."""
        added, mean, var = len(values), values.mean(dim=0), values.var(dim=0, unbiased=False)
        total, off = self.count + added, mean - self.mean
        both = self.var * self.count + var * added + off**2 * self.count * added / total
        self.mean, self.var, self.count = self.mean + off * added / total, both / total, total


class Episodes:
    """What came of the episodes that ended, summed on the device, and how far the others are."""

    def __init__(self, count: int, device: Any):
        """Begin with as many episodes."""
        self._so_far = torch.zeros((2, count), dtype=torch.float64, device=device)
        self._sums = torch.zeros(5, dtype=torch.float64, device=device)

    def add(self, reward: torch.Tensor, done: torch.Tensor, success: torch.Tensor) -> None:
        """Take in a control step of all, shape (k,) each."""
        self._so_far += torch.stack([reward.double(), torch.ones_like(reward, dtype=torch.float64)])
        ended, succeeded = done.double(), (done.bool() & success.bool()).double()
        total, steps = self._so_far
        of_all = (ended, ended * total, ended * steps, succeeded, succeeded * steps)
        self._sums += torch.stack([numbers.sum() for numbers in of_all])
        self._so_far *= 1 - ended

    def row(self, steps: int, step_s: float, wall_s: float) -> CurvePoint:
        """Return a row of the learning curve, and forget the episodes that ended."""
        count, total, length, successes, length_of_successes = self._sums.tolist()
        self._sums.zero_()
        rewards, lengths = self._so_far
        under_way = lengths > 0
        unfinished = int(under_way.sum())
        return CurvePoint(
            steps=steps,
            episodes=int(count),
            episode_return=total / count if count else nan,
            success_rate=successes / count if count else nan,
            episode_steps=length / count if count else nan,
            time_to_success_s=length_of_successes * step_s / successes if successes else nan,
            wall_s=wall_s,
            unfinished=unfinished,
            unfinished_return=float(rewards[under_way].mean()) if unfinished else nan,
            unfinished_steps=float(lengths[under_way].mean()) if unfinished else nan,
        )


class DeviceLearner:
    """rsl_rl's PPO with infants on a device."""

    infants = None
    """A recording cannot follow what never leaves the device."""

    def __init__(self, settings: TrainingSettings, infant: InfantEnv, open_envs: Callable[[], RslEnv]):
        """Put the infants on the device; *infant* is one like them."""
        self.settings, self._infant, self.env = settings, infant, open_envs()
        hyper, env = settings.hyper, self.env
        sizes = {name: int(np.prod(space.shape)) for name, space in env.spaces.items()}
        self.normalize = Normalizer(sizes, hyper["observation_clip"], hyper["observation_floor"], env.device)
        torch.manual_seed(interval_seed(settings.seed, 0))
        self.ppo, self.steps, self.updates = _ppo(settings, env, sum(sizes.values())), 0, 0
        self.taken, self.spent_s = 0, 0.0
        """Control steps of this process, and the time that they took with the learning."""

    def restore(self, checkpoint: bytes) -> Progress:
        """Go on from a checkpoint."""
        progress = restore_state(checkpoint, self._restore)
        self.steps = progress.steps
        return progress

    def interval(self, before: Progress, report: Report, on_row: OnRow) -> "DeviceInterval":
        """Begin an interval."""
        seed = interval_seed(self.settings.seed, before.steps)
        torch.manual_seed(seed)
        step_s = ms_to_s(self._infant.manifest.step_ms)
        return DeviceInterval(self, self.env.reset(seed), before, step_s, report, on_row)

    def has_learnt(self) -> bool:
        """Return whether anything was learnt since it was made or restored."""
        return self.updates > 0

    def policy(self) -> bytes:
        """Return the content of the policy's file."""
        return pack_network(self._weights(), self.normalize.statistics(), self.steps, self.settings, self._infant)

    def checkpoint(self, reached: Progress) -> bytes:
        """Return the content of a checkpoint."""
        known = self.ppo.optimizer.state_dict()["state"].items()
        moments = {f"adam/{number}/{key}": _array(part[key]) for number, part in known for key in ADAM}
        return pack_state({**self._weights(), **moments}, self.normalize.statistics(), reached)

    @contextmanager
    def tracked(self, folder: Path) -> Iterator[None]:
        """Do nothing: trackers of Stable-Baselines3's logs have none of these."""
        yield

    def speed(self) -> str:
        """Return the device, how fast it was with all that learning takes, its memory, and what did not fit."""
        infants, manifest = self.env.infants, self._infant.manifest
        rate = self.taken / max(self.spent_s, 1e-9)
        physics = rate * manifest.step_ms / manifest.timestep_ms
        lost = ", ".join(f"{count} {flag}" for flag, count in sorted(infants.overflows.items()) if count)
        memory = ""
        if torch.cuda.is_available() and "cuda" in str(self.env.device):
            free, total = torch.cuda.mem_get_info(self.env.device)
            memory = f", {(total - free) / 2**30:.1f} of {total / 2**30:.0f} GiB of its memory"
        rates = f"{rate:,.0f} control steps/s ({physics:,.0f} physics steps/s) with the learning"
        return f"{infants.device.name}: {rates}{memory}; flags of MuJoCo Warp: {lost or 'none'}"

    def close(self) -> None:
        """Close the environments."""
        self.env.close()

    def _weights(self) -> dict[str, np.ndarray]:
        return {name: _array(tensor) for name, tensor in self._tensors().items()}

    def _tensors(self) -> dict[str, torch.Tensor]:
        """Return all that the networks learn, by the names of Stable-Baselines3's `MultiInputPolicy`."""
        distribution: Any = self.ppo.actor.distribution
        named: dict[str, torch.Tensor] = {"log_std": distribution.log_std_param}
        for model, hidden, last in (
            (self.ppo.actor, "policy_net", "action_net"),
            (self.ppo.critic, "value_net", "value_net"),
        ):
            layers = [layer for layer in model.mlp if isinstance(layer, torch.nn.Linear)]
            names = [f"mlp_extractor.{hidden}.{2 * number}" for number in range(len(layers) - 1)]
            for name, layer in zip([*names, last], layers, strict=True):
                named |= {f"{name}.weight": layer.weight, f"{name}.bias": layer.bias}
        return named

    def _restore(self, learnt: Mapping[str, np.ndarray], scale: Mapping[str, np.ndarray]) -> None:
        """Go on from weights, moments and statistics; raise an error of `DAMAGED` if they are of other networks."""
        with torch.no_grad():
            for name, tensor in self._tensors().items():
                if learnt[name].shape != tuple(tensor.shape):
                    raise ValueError(f"{name} is of another shape")
                tensor.copy_(torch.from_numpy(learnt[name].copy()))
        self.normalize.restore(scale)
        optimizer = self.ppo.optimizer
        count = len(list(optimizer.param_groups[0]["params"]))
        moments = {
            number: {key: torch.from_numpy(learnt[f"adam/{number}/{key}"].copy()) for key in ADAM}
            for number in range(count)
            if f"adam/{number}/{ADAM[0]}" in learnt
        }
        optimizer.load_state_dict({"state": moments, "param_groups": optimizer.state_dict()["param_groups"]})


class DeviceInterval:
    """Learning from one checkpoint to the next."""

    def __init__(
        self,
        learner: DeviceLearner,
        observed: TensorDict,
        before: Progress,
        step_s: float,
        report: Report,
        on_row: OnRow,
    ):
        """Begin with what the infants observe at their starts."""
        self._learner, self._before, self._step_s = learner, before, step_s
        self._report, self._on_row = report, on_row
        self._read, self._steps = learner.normalize(observed, learns=True), before.steps
        self._rows, self._start_s = list[CurvePoint](), perf_counter()
        self._episodes = Episodes(learner.env.num_envs, learner.env.device)

    def learn(self, until: int) -> None:
        """Learn until so many control steps were taken, in whole rollouts."""
        learner = self._learner
        while self._steps < until:
            began_s = perf_counter()
            with torch.no_grad():
                for _ in range(learner.ppo.storage.num_transitions_per_env):
                    self._step()
                learner.ppo.compute_returns(self._read)
            learner.ppo.update()
            learner.updates += 1
            learner.steps = self._steps
            learner.taken += learner.settings.rollout_steps
            learner.spent_s += perf_counter() - began_s
            self._end_row()

    def progress(self) -> Progress:
        """Return the progress at the end of the interval, or where it was interrupted."""
        if self._rows and self._steps > self._rows[-1].steps:
            self._end_row()
        return Progress(self._steps, self._wall_s(), Curve((*self._before.curve.rows, *self._rows)))

    def _step(self) -> None:
        learner = self._learner
        action = learner.ppo.act(self._read)
        observed, reward, done, extras = learner.env.step(action)
        self._read = learner.normalize(observed, learns=True)
        learner.ppo.process_env_step(self._read, reward, done, extras)
        self._episodes.add(reward, done, extras["success"])
        self._steps += learner.env.num_envs
        self._report(self._steps)

    def _end_row(self) -> None:
        row = self._episodes.row(self._steps, self._step_s, self._wall_s())
        self._rows.append(row)
        self._on_row(row)

    def _wall_s(self) -> float:
        return round(self._before.wall_s + perf_counter() - self._start_s, 3)


def _ppo(settings: TrainingSettings, env: RslEnv, size: int) -> PPO:
    """Return an untrained agent, whose networks have the activations of Stable-Baselines3's."""
    hyper = settings.hyper
    example = TensorDict({GROUP: torch.zeros((env.num_envs, size), device=env.device)}, batch_size=[env.num_envs])
    groups = {"actor": [GROUP], "critic": [GROUP]}
    form: dict[str, Any] = {"hidden_dims": [int(hyper["width"])] * int(hyper["layers"]), "activation": "tanh"}
    spread = {"class_name": "GaussianDistribution", "init_std": hyper["init_std"], "std_type": "log"}
    actor = MLPModel(example, groups, "actor", env.num_actions, **form, distribution_cfg=spread)
    critic = MLPModel(example, groups, "critic", 1, **form)
    storage = RolloutStorage("rl", env.num_envs, int(hyper["n_steps"]), example, [env.num_actions], str(env.device))
    return PPO(
        actor,
        critic,
        storage,
        num_learning_epochs=int(hyper["n_epochs"]),
        num_mini_batches=int(hyper["mini_batches"]),
        clip_param=hyper["clip_range"],
        gamma=hyper["gamma"],
        lam=hyper["gae_lambda"],
        entropy_coef=hyper["ent_coef"],
        learning_rate=hyper["learning_rate"],
        max_grad_norm=hyper["max_grad_norm"],
        schedule="fixed",
        device=str(env.device),
    )


def _array(tensor: torch.Tensor) -> np.ndarray:
    return tensor.detach().cpu().numpy().copy()
