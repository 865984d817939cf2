"""Arrays and environments on a GPU."""
from support import Case, crate_scene, crate_world  # first: it skips the test where numpy is missing

import sys
import unittest

import numpy as np

import rubble

try:
    import torch
except ImportError:
    torch = None
if torch is None or "cuda" not in rubble.info()["backends"] or not torch.cuda.is_available():
    print("skipped: it needs a GPU, a library with CUDA, and torch")
    sys.exit(77)

try:
    from rubble import gym
except ImportError:
    gym = None


class DeviceArrays(Case):
    def test_torch_sees_each_step_without_a_copy(self):
        world = crate_world(backend="cuda")
        for take in (torch.from_dlpack, lambda array: torch.as_tensor(array, device="cuda")):
            seen = take(world.positions)
            before = seen.clone()
            world.step(5)
            torch.cuda.synchronize()
            self.assertEqual(seen.device.type, "cuda")
            self.assertLess(float((seen - before)[1, 2]), -0.01)

    def test_a_force_from_torch_pushes_a_body(self):
        pushed, left = crate_world(backend="cuda"), crate_world(backend="cuda")
        rows = torch.tensor([1], dtype=torch.int32, device="cuda")
        pushed.scatter("force", rows, torch.tensor([[12.0, 0, 0]], device="cuda"))
        for world in (pushed, left):
            world.step(1)
        moved = [world.bodies["crate"].velocity[0] for world in (pushed, left)]
        self.assertNear(moved, [12 / 2 / 60, 0], 1e-4)

    def test_arrays_of_many_worlds_are_those_of_the_cpu(self):
        found = []
        for backend in ("cpu", "cuda"):
            worlds = rubble.Worlds(crate_scene(), 3, backend=backend)
            worlds.step(10)
            arrays = [worlds.array(name) for name in ("position", "velocity")]
            found.append([torch.as_tensor(array, device="cuda").cpu().numpy() for array in arrays])
        for cpu, cuda in zip(*found):
            self.assertNear(cuda, cpu, 1e-4)


    def test_values_and_sensors_of_many_worlds_are_those_of_the_cpu(self):
        scene = crate_scene()
        scene.add_joint("hinge", "crate", name="hip", anchor=(1, 0, 2), axis=(0, 1, 0))
        for kind in ("acceleration", "angular_rate", "position", "range", "touch"):
            scene.add_sensor(kind, body="crate", name=kind)
        scene.add_sensor("force", body="crate", joint=0)
        found = []
        for backend in ("cpu", "cuda"):
            worlds = rubble.Worlds(scene, 3, backend=backend)
            worlds.set_values("bodies.crate.mass", [1, 2, 3])
            worlds.set_values("joints.hip.axes.0.drive_stiffness", [0, 10, 20])
            worlds.set_values("bodies.crate.angular_velocity", [(0, 1, 0)], worlds=[1])
            sensors = rubble.Sensors(scene, worlds)
            for _ in range(10):
                worlds.step()
                sensors.update()
            found.append(sensors.values)
        np.testing.assert_allclose(found[1], found[0], rtol=1e-2, atol=1e-2)


@unittest.skipIf(gym is None, "gymnasium is missing")
class DeviceEnvironments(Case):
    def test_every_environment_steps_as_on_the_cpu(self):
        for name in gym.ENVIRONMENTS:
            with self.subTest(name):
                found = []
                for backend in ("cpu", "cuda"):
                    env = gym.make(name, 3, backend=backend, autoreset="same_step")
                    env.reset(seed=1)
                    random = np.random.default_rng(2)
                    space = env.single_action_space
                    for _ in range(4):
                        actions = (random.integers(0, space.n, 3) if hasattr(space, "n")
                                   else random.uniform(-1, 1, (3, *space.shape)))
                        observations, rewards, *_ = env.step(actions)
                    mask = np.array([False, True, False])
                    again = env.reset(options={"reset_mask": mask})[0]
                    self.assertNear(again[~mask], observations[~mask])
                    found.append((observations, rewards, again))
                for cpu, cuda in zip(*found):
                    np.testing.assert_allclose(cuda, cpu, rtol=0.02, atol=0.02)


unittest.main()
