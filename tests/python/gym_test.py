"""Environments for Gymnasium."""
from support import Case, lift, lift_cubes  # first: it skips the test where numpy is missing

import sys
import unittest

import numpy as np

try:
    import gymnasium
except ImportError:
    print("skipped: gymnasium is missing")
    sys.exit(77)

from rubble import gym


def bits(env):
    return [env.worlds[w].hash() for w in range(env.num_envs)]


def hand_cart(observations):
    """A linear law that balances the pole."""
    return (observations @ np.array([0.1, 0.3, 10, 2]) > 0).astype(int)


class Environments(Case):
    def test_random_policies_give_finite_numbers_of_the_spaces(self):
        for name in gym.ENVIRONMENTS:
            with self.subTest(name):
                env = gym.make(name, 3, threads=1, autoreset="next_step", max_episode_steps=20)
                self.assertIsInstance(env, gymnasium.vector.VectorEnv)
                observations, _ = env.reset(seed=1)
                env.action_space.seed(2)
                for _ in range(30):
                    self.assertIn(observations, env.observation_space)
                    observations, rewards, ended, truncated, _ = env.step(env.action_space.sample())
                    self.assertTrue(np.isfinite(observations).all() and np.isfinite(rewards).all())
                    self.assertEqual(rewards.shape, (3,))

    def test_seeds_give_the_same_bits_and_other_seeds_others(self):
        for name in gym.ENVIRONMENTS:
            with self.subTest(name):
                def run(seed):
                    env = gym.make(name, 2, threads=1)
                    env.reset(seed=seed)
                    env.action_space.seed(3)
                    for _ in range(10):
                        env.step(env.action_space.sample())
                    return bits(env)
                first = run(5)
                self.assertEqual(first, run(5))
                self.assertNotEqual(first[0], run(6)[0])
                self.assertNotEqual(first[0], first[1])

    def test_an_episode_of_a_world_does_not_depend_on_the_others(self):
        def third_start(count, order):
            env = gym.make("ant", count, threads=1)
            env.reset(seed=7)
            for which in order:
                env.step(np.zeros((count, 8)))
                env.reset(options={"reset_mask": np.isin(np.arange(count), which)})
            return env
        few, many = third_start(2, [[1], [1]]), third_start(5, [[0, 1, 4], [3], [1, 2]])
        self.assertEqual(few.worlds.random_state(1), many.worlds.random_state(1))
        self.assertEqual(few.worlds[1].hash(), many.worlds[1].hash())
        self.assertNotEqual(many.worlds[1].hash(), many.worlds[0].hash())

    def test_an_episode_that_has_ended_stays_until_its_mask_is_given(self):
        env = gym.make("cart-pole", 3, threads=1)
        observations, _ = env.reset(seed=0)
        ended = np.zeros(3, bool)
        while not ended.any():  # pushed to one side the poles fall at different times
            observations, rewards, over, _, _ = env.step(np.array([1, 1, 0]))
            ended |= over
        before = bits(env)
        observations, rewards, _, _, _ = env.step(np.array([1, 1, 0]))
        after = bits(env)
        for w in range(3):
            self.assertEqual(before[w] == after[w], ended[w])
            self.assertEqual(rewards[w], 0 if ended[w] else 1)
        observations, _ = env.reset(options={"reset_mask": ended})
        self.assertTrue((np.abs(observations[ended]) <= 0.051).all())
        self.assertEqual([a == b for a, b in zip(bits(env), after)], list(~ended))

    def test_autoreset_in_the_same_and_in_the_next_step(self):
        for mode in ("same_step", "next_step"):
            env = gym.make("cart-pole", 2, threads=1, autoreset=mode, max_episode_steps=5)
            self.assertEqual(env.metadata["autoreset_mode"].name.lower(), mode)
            env.reset(seed=0)
            for k in range(1, 6):
                _, rewards, _, truncated, infos = env.step(np.array([0, 1]))
                self.assertEqual(truncated.all(), k == 5)
            if mode == "same_step":
                self.assertGreater(np.abs(infos["final_obs"]).max(), 0.06)
                self.assertEqual([env.worlds.random_state(w)[1] for w in range(2)], [1, 1])
            else:
                observations, rewards, _, truncated, _ = env.step(np.array([0, 1]))
                self.assertEqual(list(rewards), [0, 0])
                self.assertFalse(truncated.any())
                self.assertTrue((np.abs(observations) <= 0.051).all())

    def test_a_linear_law_balances_the_cart_pole(self):
        env = gym.make("cart-pole", 8, threads=1)
        observations, _ = env.reset(seed=3)
        for k in range(500):
            observations, _, ended, truncated, _ = env.step(hand_cart(observations))
            self.assertFalse(ended.any(), f"step {k}")
        self.assertTrue(truncated.all())

    def test_the_ant_and_the_humanoid_stand(self):
        for name, steps, height in (("ant", 200, 0.4), ("humanoid", 100, 1.1)):
            env = gym.make(name, 4, threads=1)
            observations, _ = env.reset(seed=3)
            for _ in range(steps):
                observations, _, ended, _, _ = env.step(np.zeros(env.action_space.shape))
                self.assertFalse(ended.any(), name)
            self.assertTrue((observations[:, 0] > height).all(), f"{name} {observations[:, 0]}")

    def test_a_controller_lifts_the_cube(self):
        env = gym.make("lift-cube", 6, threads=1)
        heights = lift_cubes(env, 250)
        self.assertTrue((heights > 0.1).all(), str(heights))

    def test_a_controller_lifts_the_soft_block_and_squeezes_it(self):
        env = gym.make("lift-soft", 2, threads=1)
        observations, _ = env.reset(seed=4)
        self.assertEqual(len(env.worlds[0].deformables["block"].definition["tetrahedra"]), 480)
        self.assertNear(observations[:, 21:], np.full((2, 2), 0.06), 1e-3)
        for k in range(110):
            held = (observations[:, 10:12] < -0.3).all(axis=1)
            action = lift(observations[:, 15:18] + (0, 0, 0.02 + 0.07 / 2), held)
            observations, rewards, _, _, _ = env.step(action)
        heights = env.vertices("block")[..., 2].mean(axis=1)
        self.assertTrue((heights > 0.2).all(), str(heights))
        squeezed = np.abs(observations[:, 21:] - 0.06).max(axis=1)
        self.assertTrue((squeezed > 1e-3).all(), str(squeezed))
        self.assertGreater(rewards.min(), 5)

    def test_a_controller_turns_the_crank(self):
        env = gym.make("four-bar", 4, threads=1)
        observations, _ = env.reset(seed=4)
        for _ in range(399):
            error = observations[:, 5] - observations[:, 2]
            observations, rewards, _, _, _ = env.step(np.clip(0.4 * error[:, None], -1, 1))
        self.assertGreater(rewards.min(), 0.5)
        gaps = [joint.state.gap for w in range(4) for joint in env.worlds[w].joints]
        self.assertLess(max(gaps), 1e-3)

    def test_values_differ_between_worlds(self):
        env = gym.make("cart-pole", 4, threads=1)
        env.reset(seed=0)
        env.worlds.set_values("bodies.pole.mass", [0.1, 0.2, 0.3], worlds=[0, 1, 3])
        env.worlds.set_values("bodies.cart.material.friction", np.linspace(0, 1, 4))
        env.worlds.set_values("gravity", [(0, 0, -9.8 - w) for w in range(4)])
        env.worlds.set_values("joints.rail.axes.0.friction", [0.5], worlds=[2])
        masses = [env.worlds[w].bodies["pole"].mass for w in range(4)]
        self.assertNear(masses, [0.1, 0.2, 0.1, 0.3])
        self.assertNear(env.worlds[3].gravity, (0, 0, -12.8))
        self.assertEqual(env.worlds[2].joints["rail"].definition["axes"][0]["friction"], 0.5)
        self.assertInvalid("worlds[0].body",
                           lambda: env.worlds.set_values("bodies.none.mass", [1], worlds=[0]))


if __name__ == "__main__":
    unittest.main()
