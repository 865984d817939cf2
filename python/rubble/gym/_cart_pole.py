"""A pole on a cart."""
from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces

from .. import Scene
from ._vector import WorldsEnv, box

FORCE, MOST_ANGLE, MOST_WAY = 10.0, 12 * np.pi / 180, 2.4
_RAIL, _HINGE, _HALF = 0, 1, 0.5


class CartPole(WorldsEnv):
    """The cart-pole of Barto, Sutton and Anderson: keep a pole upright on a cart of 1 kg.

    Observation: position [m] and speed [m/s] of the cart, angle [rad] and angular speed [rad/s] of the pole.
    Action: 0 or 1, a push of 10 N to the left or to the right. Reward: 1 per step. An episode ends beyond
    2.4 m or 12 degrees.

    Args:
        num_envs: Number of worlds.
        options: As for `WorldsEnv`.
    """

    def __init__(self, num_envs: int = 1, **options: Any) -> None:
        self.single_observation_space, self.single_action_space = box(4), spaces.Discrete(2)
        given = {"dt": 0.02, "max_episode_steps": 500, **options}
        super().__init__(Scene.from_registry("cart-pole", lean=0), num_envs, **given)

    def _act(self, actions: np.ndarray, worlds: np.ndarray) -> None:
        push = np.where(actions[worlds] == 1, FORCE, -FORCE)
        self.set_joints("applied_force", worlds, [_RAIL], push[:, None])

    def _observe(self) -> np.ndarray:
        x, v = self.joints("position"), self.joints("speed")
        return np.stack([x[:, _RAIL], v[:, _RAIL], x[:, _HINGE], v[:, _HINGE]], axis=1)

    def _reward(self, observations: np.ndarray, actions: np.ndarray) -> np.ndarray:
        return np.ones(self.num_envs)

    def _terminated(self, observations: np.ndarray) -> np.ndarray:
        return (np.abs(observations[:, 0]) > MOST_WAY) | (np.abs(observations[:, 2]) > MOST_ANGLE)

    def _start(self, worlds: np.ndarray) -> None:
        x, v, angle, rate = self.draw(worlds, 4, -0.05, 0.05).T
        zero = np.zeros_like(x)
        sine, cosine = np.sin(angle), np.cos(angle)
        pole = np.stack([x + _HALF * sine, zero, _HALF * cosine], axis=1)
        cart = np.stack([x, zero, zero], axis=1)
        self.set_states("position", worlds, ["cart", "pole"], np.stack([cart, pole], axis=1))
        # the pole is a rod along its z axis
        turn = np.stack([np.cos(angle / 2), zero, np.sin(angle / 2), zero], axis=1)
        self.set_states("orientation", worlds, ["pole"], turn[:, None])
        along = np.stack([v, zero, zero], axis=1)
        swing = along + _HALF * rate[:, None] * np.stack([cosine, zero, -sine], axis=1)
        self.set_states("velocity", worlds, ["cart", "pole"], np.stack([along, swing], axis=1))
        self.set_states("angular_velocity", worlds, ["pole"], np.stack([zero, rate, zero], axis=1)[:, None])
