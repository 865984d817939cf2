"""The base of all environments."""
from __future__ import annotations

from typing import Any, Callable, Optional, Sequence

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from .. import Scene, Snapshot, Worlds


class WorldsEnv(VectorEnv):
    """Worlds of one scene as a vector environment of Gymnasium.

    World i begins episode k with the same bits for a seed, whatever the other worlds do, and has the bits
    that it has alone.

    A subclass sets `single_observation_space` and `single_action_space` before it calls the constructor, and
    defines `_act`, `_observe`, `_reward` and, if it needs them, `_terminated` and `_start`.

    Args:
        scene: Scene of every world.
        num_envs: Number of worlds.
        dt: Time step of the physics [s].
        frame_skip: Physics steps in each step of the environment.
        max_episode_steps: Steps until an episode is truncated.
        autoreset: "disabled": an episode that has ended stays as it is until `reset` with the option
            "reset_mask". "next_step": the next step begins a new one in place of a step. "same_step": the
            same step does, and the last observation is in ``infos["final_obs"]``.
        render_mode: "rgb_array" or None.
        render_worlds: Worlds that `render` shows.
        backend, threads, iterations: As for `rubble.Worlds`.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}

    def __init__(self, scene: Scene, num_envs: int, *, dt: float, frame_skip: int = 1,
                 max_episode_steps: int = 1000, autoreset: str = "disabled",
                 render_mode: Optional[str] = None, render_worlds: Sequence[int] = (0,), backend: str = "cpu",
                 threads: int = 0, iterations: int = 4) -> None:
        modes = {mode.name.lower(): mode for mode in AutoresetMode}
        if autoreset not in modes:
            raise ValueError(f"autoreset: expected one of {', '.join(modes)}, got {autoreset!r}")
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode: expected None or 'rgb_array', got {render_mode!r}")
        self.num_envs, self.render_mode, self.render_worlds = num_envs, render_mode, tuple(render_worlds)
        self.frame_skip, self.max_episode_steps = frame_skip, max_episode_steps
        self.autoreset = modes[autoreset]
        self.metadata = {**self.metadata, "autoreset_mode": self.autoreset,
                         "render_fps": round(1 / (dt * frame_skip))}
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.worlds = Worlds(scene, num_envs, dt=dt, iterations=iterations, backend=backend, threads=threads)
        self.bodies = {body.name: body.index for body in self.worlds[0].bodies if body.name}
        self._body_count = len(self.worlds.rows(0))
        self._axis_count = len(self.worlds[0].axes())
        self._starts: Optional[Snapshot] = None
        self._seeded = np.zeros(num_envs, bool)
        self._steps = np.zeros(num_envs, np.int64)
        self._ended = np.zeros(num_envs, bool)

    # What an environment defines.

    def _act(self, actions: np.ndarray, worlds: np.ndarray) -> None:
        """Applies actions (num_envs, ...) to the active worlds (numbers), before each physics step."""
        raise NotImplementedError

    def _observe(self) -> np.ndarray:
        """Observations of all worlds: (num_envs, ...)."""
        raise NotImplementedError

    def _reward(self, observations: np.ndarray, actions: np.ndarray) -> np.ndarray:
        """Rewards of all worlds after a step: (num_envs,)."""
        raise NotImplementedError

    def _terminated(self, observations: np.ndarray) -> np.ndarray:
        """Which episodes are over: (num_envs,) booleans."""
        return np.zeros(self.num_envs, bool)

    def _start(self, worlds: np.ndarray) -> None:
        """Changes the initial states of these worlds, by `draw`."""

    # What it may use.

    def draw(self, worlds: np.ndarray, count: int, low: float = -1, high: float = 1) -> np.ndarray:
        """The next random numbers (n, count) of the present episodes of n worlds: `rubble.Worlds.uniform`."""
        return self.worlds.uniform(worlds, count, low, high)

    def states(self, name: str, body: Optional[str] = None) -> np.ndarray:
        """`rubble.Worlds.array` as (num_envs, bodies, numbers), or of one body as (num_envs, numbers)."""
        array = on_host(self.worlds.array(name))
        array = array.reshape(self.num_envs, self._body_count, array.shape[1])
        return array if body is None else array[:, self.bodies[body]]

    def sensors(self, name: str, body: str) -> np.ndarray:
        """`rubble.Worlds.sensor_array` of one body: (num_envs, numbers)."""
        array = on_host(self.worlds.sensor_array(name))
        return array.reshape(self.num_envs, self._body_count, array.shape[1])[:, self.bodies[body]]

    def vertices(self, name: str, what: str = "positions", of: Optional[Callable] = None) -> np.ndarray:
        """Positions [m] or "velocities" [m/s] of a deformable object: (num_envs, vertices, 3).

        With `of`, ``of(them)`` in their place. With the backend "cuda" it is called with a tensor of torch on
        the device, so that only its result goes to the host.
        """
        block = self.worlds[0].deformables[name]
        array = self.worlds.vertex_array({"positions": "position", "velocities": "velocity"}[what])
        rows = slice(block.first_vertex, block.first_vertex + len(block))

        def chosen(all: Any) -> Any:
            own = all.reshape(self.num_envs, -1, 3)[:, rows]
            return own if of is None else of(own)
        return on_host(array, chosen)

    def joints(self, name: str) -> np.ndarray:
        """`rubble.Worlds.joint_array` as (num_envs, axes)."""
        return on_host(self.worlds.joint_array(name)).reshape(self.num_envs, -1)

    def set_joints(self, name: str, worlds: np.ndarray, axes: Sequence[int], values: np.ndarray) -> None:
        """`rubble.Worlds.scatter_joints` for these axes of some worlds. `values`: (n, axes)."""
        rows = (np.asarray(worlds)[:, None] * self._axis_count + np.asarray(axes)[None]).reshape(-1)
        self.worlds.scatter_joints(name, rows, np.asarray(values, np.float64).reshape(-1))

    def set_states(self, name: str, worlds: np.ndarray, bodies: Sequence[str], values: np.ndarray) -> None:
        """`rubble.Worlds.scatter` for these bodies of some worlds. `values`: (n, bodies, numbers)."""
        of = [self.bodies[body] for body in bodies]
        rows = (np.asarray(worlds)[:, None] * self._body_count + np.asarray(of)[None]).reshape(-1)
        values = np.asarray(values, np.float64)
        self.worlds.scatter(name, rows, values.reshape(len(rows), values.shape[-1]))

    # The interface of Gymnasium.

    def reset(self, *, seed: Optional[int] = None,
              options: Optional[dict[str, Any]] = None) -> tuple[Any, dict]:
        """Begins new episodes, in all worlds or in those of ``options["reset_mask"]``. A seed begins with
        episode 0 again."""
        mask = (options or {}).get("reset_mask")
        mask = np.ones(self.num_envs, bool) if mask is None else np.asarray(mask, bool)
        if mask.shape != (self.num_envs,):
            raise ValueError(f"reset_mask: expected shape ({self.num_envs},), got {mask.shape}")
        if seed is not None:
            super().reset(seed=seed)
        self._begin(np.flatnonzero(mask), seed)
        return self._observations(), {}

    def step(self, actions: Any) -> tuple[Any, np.ndarray, np.ndarray, np.ndarray, dict]:
        """One step of the worlds whose episode goes on. The others have reward 0."""
        actions = np.asarray(actions)
        going = ~self._ended
        if self.autoreset is AutoresetMode.NEXT_STEP and self._ended.any():
            self._begin(np.flatnonzero(self._ended))
        active = np.flatnonzero(going)
        for _ in range(self.frame_skip if len(active) else 0):
            self._act(actions, active)
            self.worlds.step(active=None if going.all() else going)
        self._steps[going] += 1
        observations = self._observations()
        rewards = np.where(going, self._reward(observations, actions), 0.0)
        terminated = going & self._terminated(observations)
        truncated = going & ~terminated & (self._steps >= self.max_episode_steps)
        ended, infos = terminated | truncated, {}
        if self.autoreset is AutoresetMode.SAME_STEP and ended.any():
            infos = {"final_obs": observations, "_final_obs": ended}
            self._begin(np.flatnonzero(ended))
            observations = self._observations()
        elif self.autoreset is AutoresetMode.NEXT_STEP:
            self._ended = ended
        else:
            self._ended |= ended
        return observations, rewards, terminated, truncated, infos

    def render(self) -> Optional[tuple[np.ndarray, ...]]:
        """Pictures (height, width, 3) of `render_worlds`."""
        if self.render_mode is None:
            return None
        return tuple(self.worlds[w].render() for w in self.render_worlds)

    def _observations(self) -> np.ndarray:
        return self._observe().astype(self.single_observation_space.dtype)

    def _begin(self, worlds: np.ndarray, seed: Optional[int] = None) -> None:
        """Begins the next episode in these worlds, or episode 0 of a seed."""
        if self._starts is None:
            self._starts = self.worlds[0].snapshot()
        if not len(worlds):
            return
        self._steps[worlds], self._ended[worlds] = 0, False
        self.worlds.reset(worlds, self._starts)
        fresh = worlds if seed is not None else worlds[~self._seeded[worlds]]
        if len(fresh):
            self.worlds.set_seed(seed or 0, fresh)
            self._seeded[fresh] = True
        self._start(worlds)


def on_host(array: Any, of: Callable = lambda array: array) -> np.ndarray:
    """``of(array)`` of an array of `rubble.Worlds`, in host memory. It sees device arrays as tensors."""
    if isinstance(array, np.ndarray):
        return of(array)
    import torch
    return of(torch.from_dlpack(array)).cpu().numpy()


def box(size: int, low: float = -np.inf, high: float = np.inf) -> spaces.Box:
    """A space of `size` numbers."""
    return spaces.Box(low, high, (size,), np.float32)
