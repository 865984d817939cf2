#!/usr/bin/env python3
"""Proximal policy optimization (Schulman et al., 2017) in one file: python examples/ppo.py cart-pole

Needs torch and gymnasium. Prints the mean over all worlds of the return of their last episode, and --out
writes it as lines of "steps, seconds, mean return". With --backend cuda the networks are on the device, too.
"""
import argparse
import time

import numpy as np
import torch
from torch import nn
from torch.distributions import Categorical, Normal

from rubble import gym


def layers(sizes, gain):
    """A network with tanh between its layers, whose last layer is small by `gain`."""
    out = []
    for a, b in zip(sizes, sizes[1:]):
        out += [nn.Linear(a, b), nn.Tanh()]
        nn.init.orthogonal_(out[-2].weight, 2 ** 0.5)
        nn.init.zeros_(out[-2].bias)
    nn.init.orthogonal_(out[-2].weight, gain)
    return nn.Sequential(*out[:-1])


class Agent(nn.Module):
    """Policy and value of observations, which it scales by their running mean and deviation."""

    def __init__(self, observations, actions, discrete):
        super().__init__()
        self.discrete = discrete
        self.policy = layers([observations, 64, 64, actions], 0.01)
        self.value = layers([observations, 64, 64, 1], 1)
        self.log_deviation = nn.Parameter(torch.full((actions,), -0.5))
        self.register_buffer("mean", torch.zeros(observations))
        self.register_buffer("square", torch.ones(observations))
        self.seen = 1e-4

    def see(self, x):
        weight = len(x) / (self.seen + len(x))
        self.mean += weight * (x.mean(0) - self.mean)
        self.square += weight * ((x ** 2).mean(0) - self.square)
        self.seen = min(self.seen + len(x), 1e7)

    def forward(self, x):
        x = ((x - self.mean) / (self.square - self.mean ** 2).clamp(min=1e-4).sqrt()).clamp(-10, 10)
        out = self.policy(x)
        policy = Categorical(logits=out) if self.discrete else Normal(out, self.log_deviation.exp())
        return policy, self.value(x).squeeze(-1)

    def log_prob(self, policy, actions):
        out = policy.log_prob(actions)
        return out if self.discrete else out.sum(-1)


def advantages(rewards, values, ends, last, gamma, decay):
    """Generalized advantage estimates (steps, worlds). `ends`: no step follows in the episode."""
    out, sum_ = torch.zeros_like(rewards), torch.zeros_like(last)
    for t in reversed(range(len(rewards))):
        following = values[t + 1] if t + 1 < len(rewards) else last
        going = 1 - ends[t]
        sum_ = rewards[t] + gamma * going * following - values[t] + gamma * decay * going * sum_
        out[t] = sum_
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("environment", nargs="?", default="cart-pole", choices=list(gym.ENVIRONMENTS))
    parser.add_argument("--worlds", type=int, default=64)
    parser.add_argument("--iterations", type=int, default=60)
    parser.add_argument("--steps", type=int, default=64, help="steps of each world in an iteration")
    parser.add_argument("--epochs", type=int, default=4)
    parser.add_argument("--chunks", type=int, default=4, help="updates in an epoch")
    parser.add_argument("--rate", type=float, default=1e-3, help="learning rate at the start")
    parser.add_argument("--gamma", type=float, default=0.99)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--backend", default="cpu")
    parser.add_argument("--out", help="file for the curve")
    given = parser.parse_args()

    torch.manual_seed(given.seed)
    np.random.seed(given.seed)
    env = gym.make(given.environment, given.worlds, autoreset="same_step", backend=given.backend)
    space = env.single_action_space
    discrete = hasattr(space, "n")
    device = "cuda" if given.backend == "cuda" else "cpu"

    def tensor(array):
        return torch.as_tensor(np.asarray(array, np.float32), device=device)
    agent = Agent(env.single_observation_space.shape[0], space.n if discrete else space.shape[0], discrete)
    agent.to(device)
    optimizer = torch.optim.Adam(agent.parameters(), lr=given.rate, eps=1e-5)
    x = tensor(env.reset(seed=given.seed)[0])
    returns, last = np.zeros(given.worlds), np.full(given.worlds, np.nan)
    begin, curve = time.time(), []
    for iteration in range(given.iterations):
        for group in optimizer.param_groups:
            group["lr"] = given.rate * (1 - iteration / given.iterations)
        rows = []
        for _ in range(given.steps):
            agent.see(x)
            with torch.no_grad():
                policy, value = agent(x)
                action = policy.sample()
                next_x, reward, terminated, truncated, infos = env.step(action.cpu().numpy())
                reward = reward.astype(np.float32)
                returns += reward
                end = terminated | truncated
                last[end], returns[end] = returns[end], 0
                if truncated.any():  # the episode would go on: its value counts
                    after = agent(tensor(infos["final_obs"]))[1].cpu().numpy()
                    reward = reward + given.gamma * after * truncated
            rows.append((x, action, agent.log_prob(policy, action), value, tensor(reward), tensor(end)))
            x = tensor(next_x)
        seen, taken, chances, values, rewards, ends = (torch.stack(each) for each in zip(*rows))
        with torch.no_grad():
            gains = advantages(rewards, values, ends, agent(x)[1], given.gamma, 0.95)
        flat = [each.flatten(0, 1) for each in (seen, taken, chances, gains, gains + values)]
        for _ in range(given.epochs):
            for pick in torch.randperm(len(flat[0]), device=device).chunk(given.chunks):
                seen, taken, before, gain, target = (each[pick] for each in flat)
                policy, value = agent(seen)
                ratio = (agent.log_prob(policy, taken) - before).exp()
                gain = (gain - gain.mean()) / (gain.std() + 1e-8)
                loss = (-torch.min(ratio * gain, ratio.clamp(0.8, 1.2) * gain).mean()
                        + 0.5 * (value - target).pow(2).mean() - 0.005 * policy.entropy().mean())
                optimizer.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(agent.parameters(), 0.5)
                optimizer.step()
        steps = (iteration + 1) * given.steps * given.worlds
        mean = float("nan") if np.isnan(last).all() else float(np.nanmean(last))
        curve.append((steps, time.time() - begin, mean))
        print(f"{steps:9d} steps  {curve[-1][1]:7.1f} s  mean return {mean:8.1f}", flush=True)
    if given.out:
        np.savetxt(given.out, curve, fmt=["%d", "%.1f", "%.2f"], delimiter=", ")


if __name__ == "__main__":
    main()
