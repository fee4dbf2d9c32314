"""Proximal policy optimization (Schulman and others 2017) in one file, after the form of CleanRL: an agent learns to
reach a goal, and its way is compared with that of a planner.

    pip install 'hyped[torch]'
    python bindings/python/examples/ppo.py [FRAMES]

The world is that of examples/hills.hyped: over slopes to a picnic. The goal is its flag, without the flowers: which of
them are left the agent does not see. The reward is the progress along x, 5 at the goal, and a little less for each
step. With seeds 1 to 5, 97 % of the episodes reach the goal after 200,000 to 300,000 frames, in 372 to 401 steps at
best, where the planner takes 378.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
import torch
from gymnasium.spaces import Discrete
from torch import nn
from torch.distributions import Categorical

import hyped
from hyped.env import LevelVectorEnv

FILE, GOAL = "examples/hills.hyped", "hero touching flag"
OBSERVE = ["hero.x", "hero.y", "hero.x'", "hero.y'", "hero.mode"]
SCALE = np.array([256.0, 128.0, 100.0, 200.0, 1.0], np.float32)
OPTIONS: dict[str, Any] = {
    "within": 900,
    "observe": OBSERVE,
    "actions": "discrete",
    "reward": {"goal": 5.0, "step": -0.005, "progress": 0.01, "of": "hero.x"},
}
ENVS, STEPS, EPOCHS, MINIBATCHES = 64, 128, 4, 4
GAMMA, LAMBDA, CLIP, ENTROPY, RATE = 0.99, 0.95, 0.2, 0.01, 1e-3
ENOUGH = 0.97
"""The share of episodes that reach the goal at which training ends."""
REPEAT = 4
"""Number of steps of the world for each action: nobody decides sixty times a second."""


def layers(inputs: int, outputs: int, gain: float) -> nn.Sequential:
    """A small network, begun orthogonally."""
    linear = [nn.Linear(inputs, 64), nn.Linear(64, 64), nn.Linear(64, outputs)]
    for layer, of in zip(linear, (2**0.5, 2**0.5, gain)):
        nn.init.orthogonal_(layer.weight, of)
        nn.init.zeros_(layer.bias)
    return nn.Sequential(linear[0], nn.Tanh(), linear[1], nn.Tanh(), linear[2])


class Agent(nn.Module):
    """A policy and a value over a few numbers."""

    def __init__(self, inputs: int, actions: int) -> None:
        super().__init__()
        self.policy, self.value = layers(inputs, actions, 0.01), layers(inputs, 1, 1.0)

    def forward(self, seen: torch.Tensor) -> tuple[Categorical, torch.Tensor]:
        return Categorical(logits=self.policy(seen)), self.value(seen).squeeze(-1)


def repeated(envs: LevelVectorEnv, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[int]]:
    """The same actions for some steps; rewards are added up until a run ends. Also the lengths of ways to the goal."""
    total, over, reached = np.zeros(ENVS), np.zeros(ENVS, bool), []
    for _ in range(REPEAT):
        seen, rewards, terminated, truncated, _ = envs.step(actions)
        total += np.where(over, 0.0, rewards)
        reached += envs.runs.batch.steps[(envs.runs.status == hyped.GOAL) & ~over].tolist()
        over |= terminated | truncated
    return seen / SCALE, total, over, reached


def train(frames: int, seed: int = 1) -> tuple[Agent, float, int | None]:
    """Trains; returns the agent, the share of its last episodes that reach the goal, and the steps of the shortest."""
    torch.manual_seed(seed)
    torch.set_num_threads(1)
    envs = LevelVectorEnv(ENVS, FILE, GOAL, **OPTIONS)
    assert isinstance(envs.single_action_space, Discrete)
    agent = Agent(len(OBSERVE), int(envs.single_action_space.n))
    optimizer = torch.optim.Adam(agent.parameters(), lr=RATE, eps=1e-5)
    seen = envs.reset(seed=seed)[0] / SCALE
    share, began = 0.0, time.perf_counter()
    shortest: int | None = None
    updates = max(1, frames // (ENVS * STEPS * REPEAT))
    for update in range(updates):
        observations, actions, logs, values, rewards, overs = [], [], [], [], [], []
        ended = 0
        lengths: list[int] = []
        for _ in range(STEPS):
            with torch.no_grad():
                policy, value = agent(torch.as_tensor(seen))
                action = policy.sample()
            observations.append(seen)
            actions.append(action.numpy())
            logs.append(policy.log_prob(action).numpy())
            values.append(value.numpy())
            seen, reward, over, goals = repeated(envs, action.numpy())
            rewards.append(reward)
            overs.append(over)
            ended, lengths = ended + int(over.sum()), lengths + goals
        with torch.no_grad():
            last = agent(torch.as_tensor(seen))[1].numpy()
        # Generalized advantage estimation (Schulman and others 2016).
        advantages, running = np.zeros((STEPS, ENVS), np.float32), np.zeros(ENVS)
        for step in reversed(range(STEPS)):
            following = last if step == STEPS - 1 else values[step + 1]
            goes_on = 1.0 - overs[step]
            delta = rewards[step] + GAMMA * goes_on * following - values[step]
            running = delta + GAMMA * LAMBDA * goes_on * running
            advantages[step] = running
        flat = [torch.as_tensor(np.concatenate(of)) for of in (observations, actions, logs)]
        targets = torch.as_tensor((advantages + np.stack(values)).reshape(-1), dtype=torch.float32)
        gains = torch.as_tensor(advantages.reshape(-1))
        for _ in range(EPOCHS):
            for rows in torch.randperm(len(gains)).chunk(MINIBATCHES):
                policy, value = agent(flat[0][rows])
                ratio = (policy.log_prob(flat[1][rows]) - flat[2][rows]).exp()
                gain = (gains[rows] - gains[rows].mean()) / (gains[rows].std() + 1e-8)
                surrogate = torch.minimum(ratio * gain, ratio.clamp(1 - CLIP, 1 + CLIP) * gain).mean()
                loss = -surrogate + 0.5 * (value - targets[rows]).pow(2).mean() - ENTROPY * policy.entropy().mean()
                optimizer.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(agent.parameters(), 0.5)
                optimizer.step()
        share, shortest = len(lengths) / max(1, ended), min(lengths, default=None)
        optimizer.param_groups[0]["lr"] = RATE * (1.0 - update / updates)
        is_done = share >= ENOUGH or update == updates - 1
        if update % 5 == 0 or is_done:
            done = (update + 1) * ENVS * STEPS * REPEAT
            print(
                f"{done} frames, {done / (time.perf_counter() - began):.0f}/s: {share:.0%} of {ended} reached it",
                flush=True,
            )
        if is_done:
            break
    return agent, share, shortest


def main() -> None:
    _, share, shortest = train(int(sys.argv[1]) if len(sys.argv) > 1 else 4_000_000)
    answer = hyped.reach(hyped.compile(FILE), GOAL)[GOAL]
    print(f"the agent: {share:.0%} of its episodes reach the goal, the shortest in {shortest} steps")
    print(f"the planner: {answer.verdict} in {answer.steps} steps, after {answer.seconds:.2f} s")


if __name__ == "__main__":
    main()
