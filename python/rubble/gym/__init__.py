"""Environments for learning: many worlds behind the interface of Gymnasium (``pip install gymnasium``).

    from rubble import gym
    env = gym.make("cart-pole", num_envs=1024)
    observations, infos = env.reset(seed=0)
    observations, rewards, terminations, truncations, infos = env.step(env.action_space.sample())
    env.reset(options={"reset_mask": terminations | truncations})
"""
from __future__ import annotations

from typing import Any

from ._ant import Ant
from ._cart_pole import CartPole
from ._four_bar import FourBar
from ._humanoid import Humanoid
from ._lift import LiftCube
from ._quadruped import Quadruped
from ._random import uniform
from ._soft import LiftSoft
from ._vector import WorldsEnv
from ._wall import StackWall

ENVIRONMENTS = {"cart-pole": CartPole, "ant": Ant, "humanoid": Humanoid, "quadruped": Quadruped,
                "four-bar": FourBar, "lift-cube": LiftCube, "lift-soft": LiftSoft,
                "stack-wall": StackWall}


def make(name: str, num_envs: int = 1, **options: Any) -> WorldsEnv:
    """An environment of `ENVIRONMENTS` by name. `options` are those of its class."""
    try:
        kind = ENVIRONMENTS[name]
    except KeyError:
        raise ValueError(f"environment: expected one of {', '.join(ENVIRONMENTS)}, got {name!r}") from None
    return kind(num_envs, **options)


__all__ = ["ENVIRONMENTS", "Ant", "CartPole", "FourBar", "Humanoid", "LiftCube", "LiftSoft", "Quadruped",
           "StackWall", "WorldsEnv", "make", "uniform"]
