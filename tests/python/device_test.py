"""Arrays and environments on a GPU."""
# the first import skips the test where numpy is missing
from support import Case, crate_scene, crate_world, lift_cubes

import contextlib
import gc
import importlib
import os
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

CYCLES = 100_000_000  # of a kernel that only waits: some 50 ms
CRATE = 1  # row


def optional(name):
    """A module that works on this GPU, or None."""
    os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
    try:
        module = importlib.import_module(name)
        if name == "jax":
            module.devices("gpu")
        else:
            module.cuda.runtime.getDeviceCount()
    except Exception:  # missing, or without a GPU
        return None
    return module


def tensor(values, kind=torch.float32):
    found = torch.tensor(values, dtype=kind, device="cuda")
    torch.cuda.synchronize()
    return found


def streams():
    """Contexts of the default stream of torch and of another one, by name."""
    return {"default": contextlib.nullcontext(), "own": torch.cuda.stream(torch.cuda.Stream())}


def delay_engine(world):
    """Later work of the engine waits."""
    with torch.cuda.stream(torch.cuda.ExternalStream(world.positions.__cuda_array_interface__["stream"])):
        torch.cuda._sleep(CYCLES)


def as_tensor(array):
    return torch.as_tensor(array, device="cuda")


class OnlyInterface:
    """A tensor with an array interface without a stream, and nothing else."""

    def __init__(self, values):
        self.values, self.__cuda_array_interface__ = values, values.__cuda_array_interface__


class OnlyDlpack:
    """A tensor with DLPack and nothing else."""

    def __init__(self, values):
        self.__dlpack__, self.__dlpack_device__ = values.__dlpack__, values.__dlpack_device__


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

    def test_rays_that_are_arrays_hit_what_they_hit_on_the_cpu(self):
        scene, random = crate_scene(), np.random.default_rng(1)
        origins, directions = random.uniform(-2, 2, (600, 3)) + (0, 0, 3), random.normal(size=(600, 3))
        directions[:, 2] -= 1
        which, down = np.arange(600, dtype=np.int32) % 3, [0.0, 0.0, -1.0]
        cpu, cuda = (rubble.Worlds(scene, 3, backend=backend) for backend in ("cpu", "cuda"))
        for worlds in (cpu, cuda):
            worlds[1].gravity = (0, 0, -90)
            worlds.step(5)
        for given in (which, None):
            wanted = cpu.cast_ray_arrays(origins, directions, 20, worlds=given)
            there = [tensor(origins, torch.float64), tensor(directions)]
            on_device = None if given is None else tensor(given, torch.int32)
            found = cuda.cast_ray_arrays(*there, 20, worlds=on_device)
            self.assertTrue(all(array.on_device for array in found))
            distances, bodies, normals = (torch.from_dlpack(array).cpu().numpy() for array in found)
            same = bodies == wanted.bodies  # of a near tie another one may be found
            self.assertGreater(same.mean(), 0.99)
            self.assertNear(distances[same], wanted.distances[same], 1e-3)
            self.assertNear(normals[same[:, 0]], wanted.normals[same[:, 0]], 1e-3)
            host = cuda.cast_ray_arrays(origins, directions, 20, worlds=given)
            self.assertIsInstance(host.distances, np.ndarray)
            self.assertNear(distances, host.distances, 1e-4)
        one = cuda[2].cast_ray_arrays(tensor([[0, 0, 9]]), tensor([down]), ignore=cuda[2].bodies["crate"])
        self.assertNear(as_tensor(one.distances).cpu(), [[9]], 1e-4)
        self.assertEqual(as_tensor(one.bodies).cpu().tolist(), [[0]])
        none = cuda.cast_ray_arrays(tensor([[0, 0, 9]] * 3), tensor([down, [0, 0, 0], [float("nan"), 0, 1]]))
        self.assertEqual(torch.isnan(as_tensor(none.distances))[:, 0].tolist(), [False, True, True])
        self.assertEqual(as_tensor(none.bodies)[1:, 0].tolist(), [-1, -1])
        beyond = cuda.cast_ray_arrays(tensor([[0, 0, 9]]), tensor([down]), worlds=tensor([3], torch.int32))
        self.assertTrue(torch.isnan(as_tensor(beyond.distances)).all())

    def test_arrays_say_what_they_are(self):
        worlds = rubble.Worlds(crate_scene(), 2, backend="cuda")
        array = worlds.array("position")
        self.assertEqual((array.shape, array.dtype, array.on_device), ((4, 3), np.float64, True))
        self.assertEqual(array.__dlpack_device__(), (2, torch.cuda.current_device()))
        self.assertEqual(worlds[0].positions.__dlpack_device__(), array.__dlpack_device__())
        self.assertIn("device", repr(array))
        self.assertRaises(TypeError, lambda: np.asarray(array))
        self.assertRaises(TypeError, lambda: np.asarray(worlds[0].positions))

    def test_a_tensor_keeps_its_worlds_alive(self):
        worlds = rubble.Worlds(crate_scene(), 2, backend="cuda")
        seen = torch.from_dlpack(worlds.array("position"))
        del worlds
        gc.collect()
        self.assertNear(seen.cpu()[[CRATE, CRATE + 2], 2], [2, 2])

    def test_tensors_that_are_freed_take_no_memory(self):
        world = crate_world(backend="cuda")
        def take():
            for _ in range(50):
                torch.from_dlpack(world.positions).sum(), as_tensor(world.velocities).sum()
            world.step()
            torch.cuda.synchronize()
            return torch.cuda.mem_get_info()[0]
        for _ in range(20):  # what is made once is made here
            before = take()
        for _ in range(20):
            after = take()
        self.assertGreaterEqual(after, before - (1 << 22))


class DeviceStreams(Case):
    """Kernels that wait stand before what must come first."""

    def test_values_may_be_fresh_and_overwritten_afterwards(self):
        kinds = {"tensor": lambda values: values, "dlpack": OnlyDlpack, "interface": OnlyInterface}
        for (where, stream), (name, kind) in ((s, k) for k in kinds.items() for s in streams().items()):
            if (where, name) in (("own", "interface"), ("own", "dlpack")):
                continue  # nothing says on which stream their memory is used afterwards
            with self.subTest(where, values=name), stream:
                world = crate_world(backend="cuda")
                world.step()
                rows, values, wanted = tensor([0], torch.int32), tensor([[0, 0, 0]]), tensor([[3, 4, 5]])
                torch.cuda._sleep(CYCLES)
                rows.add_(CRATE), values.add_(wanted)
                world.scatter("velocity", kind(rows), kind(values))
                values.zero_()
                self.assertNear(world.bodies["crate"].velocity, (3, 4, 5))

    def test_values_of_dlpack_are_read_behind_the_stream_of_their_library(self):
        with torch.cuda.stream(torch.cuda.Stream()):
            world = crate_world(backend="cuda")
            world.step()
            rows, values, wanted = tensor([CRATE], torch.int32), tensor([[0, 0, 0]]), tensor([[3, 4, 5]])
            torch.cuda._sleep(CYCLES)
            values.add_(wanted)
            world.scatter("velocity", OnlyDlpack(rows), OnlyDlpack(values))
            self.assertNear(world.bodies["crate"].velocity, (3, 4, 5))
            self.assertEqual(len(world._owner.held), 2)
            world.step()
            self.assertEqual(world._owner.held, [])

    def test_a_step_waits_for_reads_under_way(self):
        for where, stream in streams().items():
            for name, take in (("dlpack", torch.from_dlpack), ("interface", as_tensor)):
                if (where, name) == ("own", "interface"):
                    continue  # an interface knows no stream but the default one
                for freed in (False, True):
                    with self.subTest(where, by=name, freed=freed), stream:
                        world = crate_world(backend="cuda")
                        world.step()
                        before = world.bodies["crate"].position
                        seen = take(world.positions)
                        torch.cuda._sleep(CYCLES)
                        copy = seen.clone()
                        if freed:
                            del seen
                        world.step(5)
                        self.assertLess(world.bodies["crate"].position[2], before[2] - 0.001)
                        torch.cuda.synchronize()
                        self.assertNear(copy.cpu()[CRATE], before)

    def test_a_read_waits_for_the_engine(self):
        for where, stream in streams().items():
            for name, take in (("dlpack", torch.from_dlpack), ("interface", as_tensor)):
                if (where, name) == ("own", "interface"):
                    continue
                with self.subTest(where, by=name), stream:
                    world = crate_world(backend="cuda")
                    world.step()
                    held = take(world.velocities)
                    delay_engine(world)
                    world.scatter("velocity", [CRATE], [(1, 2, 3)])
                    self.assertNear(take(world.velocities).cpu()[CRATE], (1, 2, 3))
                    delay_engine(world)
                    world.scatter("velocity", [CRATE], [(4, 5, 6)])
                    self.assertNear(held.cpu()[CRATE], (4, 5, 6))
                    world.scatter("angular_velocity", [CRATE], [(7, 8, 9)])
                    delay_engine(world)
                    rates = take(world.sensor_array("angular_rate"))
                    self.assertNear(rates.cpu()[CRATE], (7, 8, 9), 1e-5)

    def test_an_array_that_is_filled_again_waits_for_its_readers(self):
        worlds = rubble.Worlds(crate_scene(), 2, backend="cuda")
        for where, stream in streams().items():
            with self.subTest(where), stream:
                worlds.scatter("angular_velocity", [CRATE], [(7, 8, 9)])
                seen = torch.from_dlpack(worlds.sensor_array("angular_rate"))
                torch.cuda._sleep(CYCLES)
                copy = seen.clone()
                worlds.scatter("angular_velocity", [CRATE], [(1, 1, 1)])
                worlds.sensor_array("angular_rate")
                self.assertNear(copy.cpu()[CRATE], (7, 8, 9), 1e-5)

    def test_rays_may_be_fresh_and_overwritten_afterwards(self):
        for where, stream in streams().items():
            with self.subTest(where), stream:
                world = crate_world(backend="cuda")
                world.step()
                origins, directions = tensor([[50, 0, 0]]), tensor([[0, 0, -1]])
                wanted, away = tensor([[0, 0, 9]]), tensor([[50, 0, 50]])
                torch.cuda._sleep(CYCLES)
                origins.copy_(wanted)
                found = torch.from_dlpack(world.cast_ray_arrays(origins, directions).bodies)
                origins.copy_(away)
                self.assertEqual(found.cpu().tolist(), [[CRATE]])

    def test_hits_that_are_written_again_wait_for_their_readers(self):
        for where, stream in streams().items():
            with self.subTest(where), stream:
                world = crate_world(backend="cuda")
                world.step()
                crate, ground, down = tensor([[0, 0, 9]]), tensor([[50, 0, 9]]), tensor([[0, 0, -1]])
                seen = torch.from_dlpack(world.cast_ray_arrays(crate, down).bodies)
                torch.cuda._sleep(CYCLES)
                copy = seen.clone()
                world.cast_ray_arrays(ground, down)
                self.assertEqual(copy.cpu().tolist(), [[CRATE]])

    def test_views_of_sorted_bodies_follow_each_step(self):
        world = crate_world(backend="cuda")
        world.bodies.add_many([{"shape": rubble.box(1, 1, 1), "position": (3 * (k * 37 % 200), 0, 20)}
                               for k in range(200)])
        world.sort_bodies()
        world.step()
        with torch.cuda.stream(torch.cuda.Stream()):
            seen = torch.from_dlpack(world.positions)
            for _ in range(5):
                world.step()
                self.assertNear(seen.cpu()[CRATE], world.bodies["crate"].position)


@unittest.skipIf(optional("jax") is None, "JAX is missing, or has no GPU")
class DeviceJax(Case):
    def test_arrays_come_and_go_without_a_copy(self):
        import jax
        import jax.numpy as jnp
        world = crate_world(backend="cuda")
        world.step()
        velocities = jax.dlpack.from_dlpack(world.velocities)
        address = world.velocities.__cuda_array_interface__["data"][0]
        self.assertEqual(velocities.unsafe_buffer_pointer(), address)
        self.assertNear(velocities[CRATE], world.bodies["crate"].velocity, 1e-6)
        large = jnp.ones((4096, 4096))
        for _ in range(20):  # still under way when its result is scattered
            large = large @ large / 4096
        world.scatter("velocity", jnp.array([CRATE]), large[:1, :3] * jnp.array([3.0, 4.0, 5.0]))
        del large
        self.assertNear(world.bodies["crate"].velocity, (3, 4, 5), 1e-3)
        world.step()
        self.assertEqual(world._owner.held, [])
        worlds = rubble.Worlds(crate_scene(), 2, backend="cuda")
        worlds.scatter("velocity", jnp.array([CRATE]), jnp.array([[3.0, 4, 5]]))
        self.assertNear(jax.dlpack.from_dlpack(worlds.array("velocity"))[CRATE], (3, 4, 5))


@unittest.skipIf(optional("cupy") is None, "CuPy is missing, or has no GPU")
class DeviceCupy(Case):
    def test_arrays_come_and_go_without_a_copy(self):
        import cupy
        own = cupy.cuda.Stream(non_blocking=True)
        for stream in (cupy.cuda.Stream.null, own):
            for take in (cupy.from_dlpack, cupy.asarray):
                with self.subTest(stream, by=take), stream:
                    world = crate_world(backend="cuda")
                    world.step()
                    velocities = take(world.velocities)
                    self.assertEqual(velocities.data.ptr,
                                     world.velocities.__cuda_array_interface__["data"][0])
                    self.assertNear(cupy.asnumpy(velocities)[CRATE], world.bodies["crate"].velocity, 1e-6)
                    large = cupy.ones((4096, 4096), "f4")
                    for _ in range(20):  # still under way when its result is scattered
                        large = large @ large / 4096
                    values = large[:1, :3] * cupy.array([3, 4, 5], "f4")
                    world.scatter("velocity", cupy.array([CRATE], "i4"), values)
                    values[:] = 0
                    self.assertNear(world.bodies["crate"].velocity, (3, 4, 5), 1e-3)
                    del velocities  # before its stream


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

    def test_nothing_is_dropped_where_12288_hands_grasp(self):
        found = []
        for count in (50, 12288):
            env = gym.make("lift-cube", count, backend="cuda")
            heights = lift_cubes(env, 250)
            self.assertTrue((heights > 0.1).all(), f"{(heights <= 0.1).sum()} of {count} cubes fell")
            found.append([env.worlds[w].hash() for w in range(50)])
        self.assertEqual(*found)


unittest.main()
