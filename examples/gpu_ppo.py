"""Learn to reach, with PPO, from thousands of infants of several ages on a GPU: nothing leaves it.

    pip install 'mimoc[gpu]' torch
    python examples/gpu_ppo.py [--device cuda:0] [--infants 4096] [--updates 100]

`--device warp:cpu --infants 8 --updates 2` tries it out without a GPU, slowly. The algorithm is that of Schulman et al.
2017, with generalised advantages (Schulman et al. 2016).
"""

import argparse
import time

import torch
from torch import nn
from torch.distributions import Normal

import mimoc

AGES_MONTHS = (9, 12, 18, 24)
STEPS = 32
"""Control steps of each infant between updates."""
WIDTH = 256
EPOCHS, BATCHES = 4, 4
DISCOUNT, LAMBDA, CLIP = 0.99, 0.95, 0.2
VALUE_WEIGHT, LEARNING_RATE, GRADIENT = 0.5, 3e-4, 0.5
KEPT = ("seen", "actions", "logs", "rewards", "ends", "worth", "next")
"""What is kept of each step."""
EPISODE = 200
"""Control steps after which an episode is truncated."""


def network(numbers: int, outputs: int) -> nn.Module:
    """Return a network with two hidden layers."""
    hidden = nn.Linear(numbers, WIDTH), nn.Tanh(), nn.Linear(WIDTH, WIDTH), nn.Tanh()
    return nn.Sequential(*hidden, nn.Linear(WIDTH, outputs))


class Agent(nn.Module):
    """Policy and value of observations, which are scaled by what has been seen of them."""

    def __init__(self, numbers: int, commands: int):
        super().__init__()
        self.policy, self.value = network(numbers, commands), network(numbers, 1)
        self.log_deviation = nn.Parameter(torch.full((commands,), -0.5))
        self.register_buffer("mean", torch.zeros(numbers))
        self.register_buffer("variance", torch.ones(numbers))
        self.register_buffer("count", torch.tensor(1e-4))

    def see(self, observation: torch.Tensor) -> None:
        """Take observations, shape (n, numbers), into account for their scale (Chan et al. 1979)."""
        count, difference = len(observation), observation.mean(0) - self.mean
        total = self.count + count
        spread = self.variance * self.count + observation.var(0, unbiased=False) * count
        self.variance = (spread + difference**2 * self.count * count / total) / total
        self.mean, self.count = self.mean + difference * count / total, total

    def scaled(self, observation: torch.Tensor) -> torch.Tensor:
        """Return observations in units of their spread."""
        return ((observation - self.mean) / (self.variance + 1e-8).sqrt()).clamp(-10, 10)

    def choices(self, scaled: torch.Tensor) -> Normal:
        """Return how commands are drawn."""
        return Normal(self.policy(scaled), self.log_deviation.exp())

    def worth(self, scaled: torch.Tensor) -> torch.Tensor:
        """Return the discounted rewards that are expected."""
        return self.value(scaled).squeeze(-1)


def numbers_of(observation: dict[str, torch.Tensor]) -> torch.Tensor:
    """Return a copy of all senses side by side, shape (n, numbers): the next step overwrites the originals."""
    return torch.cat([observation[name] for name in sorted(observation)], 1)


def collect(env, agent: Agent, observation: torch.Tensor) -> tuple[dict[str, torch.Tensor], torch.Tensor, torch.Tensor]:
    """Return what happened in some steps, with a leading axis of steps; what is seen then; and who touched the ball."""
    kept: dict[str, list[torch.Tensor]] = {name: [] for name in KEPT}
    touched = []
    for _ in range(STEPS):
        agent.see(observation)
        seen = agent.scaled(observation)
        choices = agent.choices(seen)
        actions = choices.sample()
        told, rewards, terminated, truncated, info = env.step(actions)
        rewards = 0.01 * rewards.clone()
        last = agent.worth(agent.scaled(numbers_of(info["final_obs"])))  # Of the episode, before any reset.
        found = seen, actions, choices.log_prob(actions).sum(1), rewards, terminated | truncated, agent.worth(seen)
        for name, value in zip(kept, (*found, torch.where(terminated, 0.0, last)), strict=True):
            kept[name].append(value)
        touched.append(info["is_success"].clone())
        observation = numbers_of(told)
    return {name: torch.stack(values) for name, values in kept.items()}, observation, torch.stack(touched)


def advantages(kept: dict[str, torch.Tensor]) -> torch.Tensor:
    """Return generalised advantages, shape (steps, n)."""
    surprise = kept["rewards"] + DISCOUNT * kept["next"] - kept["worth"]
    found, later = torch.zeros_like(surprise), torch.zeros_like(surprise[0])
    for step in reversed(range(STEPS)):
        later = surprise[step] + DISCOUNT * LAMBDA * ~kept["ends"][step] * later
        found[step] = later
    return found


def improve(agent: Agent, optimiser: torch.optim.Optimizer, kept: dict[str, torch.Tensor]) -> None:
    """Improve policy and value by what happened."""
    better = advantages(kept)
    returns = (better + kept["worth"]).flatten()
    better = ((better - better.mean()) / (better.std() + 1e-8)).flatten()
    seen, actions, logs = (kept[name].flatten(0, 1) for name in ("seen", "actions", "logs"))
    for _ in range(EPOCHS):
        for part in torch.randperm(len(seen), device=seen.device).chunk(BATCHES):
            ratio = (agent.choices(seen[part]).log_prob(actions[part]).sum(1) - logs[part]).exp()
            gain = torch.min(ratio * better[part], ratio.clamp(1 - CLIP, 1 + CLIP) * better[part])
            miss = (agent.worth(seen[part]) - returns[part]) ** 2
            optimiser.zero_grad()
            (VALUE_WEIGHT * miss.mean() - gain.mean()).backward()
            nn.utils.clip_grad_norm_(agent.parameters(), GRADIENT)
            optimiser.step()


def main() -> None:
    """Learn, and print how often the ball is touched."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="cuda:0")
    parser.add_argument("--infants", type=int, default=4096)
    parser.add_argument("--updates", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    torch.manual_seed(options.seed)
    spec = {"mimoc": 1, "name": "reach", "senses": {"proprioception": {}, "vestibular": {}}, "task": {"kind": "reach"}}
    infants = [mimoc.InfantSpec.model_validate({**spec, "age_months": age}) for age in AGES_MONTHS]
    env = mimoc.make_vec(
        infants,
        options.infants,
        device=options.device,
        arrays="torch",
        autoreset_mode="SameStep",
        max_episode_steps=EPISODE,
    )
    observation = numbers_of(env.reset(seed=options.seed)[0])
    agent = Agent(observation.shape[1], env.single_action_space.shape[0]).to(observation.device)
    optimiser = torch.optim.Adam(agent.parameters(), lr=LEARNING_RATE)
    for update in range(options.updates):
        start = time.perf_counter()
        with torch.no_grad():
            kept, observation, touched = collect(env, agent, observation)
        improve(agent, optimiser, kept)
        ends, touches = int(kept["ends"].sum()), int(touched.sum())
        rate = STEPS * options.infants / (time.perf_counter() - start)
        print(f"{update:4}: {touches} of {ends} ended episodes touched the ball; {rate:,.0f} steps/s", flush=True)
    env.close()


if __name__ == "__main__":
    main()
