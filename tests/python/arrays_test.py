"""Views of state arrays, and writing to them."""
import gc
import sys
import weakref

from support import Case, crate_scene, crate_world, main  # first: it skips the test where numpy is missing

import numpy as np
import rubble


class Arrays(Case):
    def test_a_view_shows_each_step_without_being_read_again(self):
        world = crate_world()
        crate = world.bodies["crate"]
        positions = world.positions
        self.assertEqual(positions.dtype, np.float64)
        self.assertEqual(positions.shape[1], 3)
        for _ in range(3):
            world.step()
            self.assertNear(positions[crate.index], crate.position, 1e-12)
        self.assertIs(world.positions, positions)
        self.assertFalse(positions.flags.writeable)
        self.assertFalse(positions.flags.owndata)

    def test_arrays_of_one_place_on_a_device_share_their_interface(self):
        # torch keeps what it reads of an interface, so a new one for each call would fill the memory
        view = rubble._abi.Array(data=4096, shape=(3, 3), strides=(24, 8), typestr=b"<f8", device=1, stream=7)
        first, second = (rubble.DeviceArray(None, view).__cuda_array_interface__ for _ in range(2))
        self.assertIs(first, second)
        self.assertEqual(first, {"data": (4096, False), "shape": (3, 3), "strides": (24, 8),
                                 "typestr": "<f8", "version": 3, "stream": 7})
        view.shape[0] = 4
        self.assertEqual(rubble.DeviceArray(None, view).shape, (4, 3))

    def test_rays_that_are_arrays_hit_what_the_same_rays_hit(self):
        scene = crate_scene()
        scene.add_body(rubble.sphere(0.5), name="ball", position=(3, 0, 2))
        worlds, random = rubble.Worlds(scene, 3, threads=1), np.random.default_rng(1)
        worlds[1].gravity = (0, 0, -90)
        worlds.step(5)
        origins, directions = random.uniform(-2, 4, (60, 3)) + (0, 0, 4), random.normal(size=(60, 3))
        directions[:, 2] -= 1
        which = np.arange(60, dtype=np.int32) % 3
        options = {"max_distance": 20, "ignore": worlds[0].bodies["ball"]}
        for cast, wanted in (
                (worlds.cast_ray_arrays(origins, directions, worlds=which, **options), which),
                (worlds.cast_ray_arrays(origins.astype(np.float32), directions, **options), np.sort(which)),
                (worlds[1].cast_ray_arrays(origins, directions, **options), np.full(60, 1))):
            hits = worlds.cast_rays(wanted, origins, directions, **options)
            found = hits["hit"].astype(bool)
            self.assertTrue(20 < found.sum() < 60)
            self.assertEqual([(a.shape, a.dtype) for a in cast],
                             [((60, 1), np.float32), ((60, 1), np.int32), ((60, 3), np.float32)])
            self.assertNear(cast.distances[:, 0], np.where(found, hits["distance"], 20), 1e-4)
            self.assertEqual(cast.bodies[:, 0].tolist(), np.where(found, hits["body"]["index"], -1).tolist())
            self.assertNear(cast.normals, hits["normal"] * found[:, None], 1e-4)
            self.assertNotIn(worlds[0].bodies["ball"].index, cast.bodies)

    def test_rays_that_are_arrays_name_what_is_wrong(self):
        world, worlds = crate_world(), rubble.Worlds(crate_scene(), 2, threads=1)
        down = np.tile((0.0, 0, -1), (3, 1))
        self.assertInvalid("directions.shape", lambda: world.cast_ray_arrays(down, down[:2]))
        self.assertInvalid("rays[0].direction", lambda: world.cast_ray_arrays(down, 0 * down))
        self.assertInvalid("maxDistance", lambda: world.cast_ray_arrays(down, down, -1))
        self.assertInvalid("filter.deformables", lambda: world.cast_ray_arrays(down, down, deformables=True))
        self.assertInvalid("origins.shape", lambda: worlds.cast_ray_arrays(down, down))
        self.assertInvalid("world", lambda: worlds.cast_ray_arrays(down, down, worlds=[0, 1, 2]))
        self.assertEqual(world.cast_ray_arrays(down[:0], down[:0]).normals.shape, (0, 3))

    def test_edits_are_seen_in_the_view(self):
        world = crate_world()
        crate = world.bodies["crate"]
        crate.velocity = (1, 2, 3)
        self.assertNear(world.velocities[crate.index], (1, 2, 3), 1e-6)

    def test_a_view_is_made_anew_when_bodies_come(self):
        world = crate_world()
        before, epoch = world.positions, world.epoch
        more = [{"shape": rubble.sphere(0.1), "position": [k, 0, 9]} for k in range(50)]
        bodies = world.bodies.add_many(more)
        self.assertNotEqual(world.epoch, epoch)
        self.assertIsNot(world.positions, before)
        self.assertNear(world.positions[bodies[-1].index], (49, 0, 9))

    def test_a_view_keeps_its_world_alive(self):
        positions = crate_world().positions
        gc.collect()
        self.assertEqual(positions.shape[1], 3)
        self.assertNear(positions[1], (0, 0, 2))

    def test_a_world_is_freed_with_its_last_reference(self):
        world = crate_world()
        world.positions, world.bodies["crate"].position, world.params.dt
        gone = weakref.ref(world)
        gc.disable()
        try:
            del world
            self.assertIsNone(gone())
        finally:
            gc.enable()

    def test_scatter_writes_rows(self):
        world = crate_world()
        crate = world.bodies["crate"]
        world.scatter("velocity", [crate.index], [(3, 0, 0)])
        self.assertNear(crate.velocity, (3, 0, 0), 1e-6)
        world.scatter("position", np.array([crate.index]), np.array([(1, 0, 5)], np.float32))
        self.assertNear(crate.position, (1, 0, 5), 1e-6)
        self.assertRaises(rubble.Error, lambda: world.scatter("velocity", [0, 1], [(1, 0, 0)]))
        self.assertInvalid("array", lambda: world.scatter("speed", [0], [(1, 0, 0)]))

    def test_dlpack_shares_the_memory(self):
        world = crate_world()
        array = world.array("position")
        self.assertEqual(array.__dlpack_device__(), (1, 0))
        shared = np.from_dlpack(array)
        self.assertEqual(shared.ctypes.data, world.positions.ctypes.data)
        world.step(5)
        self.assertNear(shared, world.positions)
        del world, array
        gc.collect()
        self.assertEqual(shared.shape[1], 3)

    def test_a_capsule_that_nobody_takes_is_freed(self):
        world = crate_world()
        before = sys.getrefcount(world._owner)
        for _ in range(100):
            world.array("velocity").__dlpack__()
        gc.collect()
        self.assertEqual(sys.getrefcount(world._owner), before)

    def test_an_array_on_the_host_has_no_cuda_interface(self):
        array = crate_world().array("force")
        self.assertFalse(hasattr(array, "__cuda_array_interface__"))
        self.assertIn("host", repr(array))

    def test_poses_are_copied_beside_the_steps(self):
        world = crate_world()
        world.begin_poses()
        place = world.bodies["crate"].position
        world.step(10)
        seconds, positions, orientations = world.take_poses()
        self.assertEqual(seconds, 0)
        self.assertNear(positions[world.bodies["crate"].index], place)
        self.assertEqual(orientations.shape[1], 4)


def calls_of(function):
    """How many functions of Python and C a call of `function` calls."""
    count = 0

    def tally(frame, event, argument):
        nonlocal count
        count += event in ("call", "c_call")
    sys.setprofile(tally)
    try:
        function()
    finally:
        sys.setprofile(None)
    return count - 1  # the last one switches the tally off


# of functions: a check of the world, the look for the array that is kept, and one to spare
_MOST_CALLS = 4


class Costs(Case):
    """The price of a call is in the functions that it calls; `tools/bench_worlds calls` measures the time."""

    def test_reading_an_array_calls_few_functions(self):
        world = crate_world()
        self.assertGreater(calls_of(lambda: world.positions), 0)
        self.assertLessEqual(calls_of(lambda: world.positions), _MOST_CALLS)

    def test_a_step_calls_few_functions(self):
        world = crate_world()
        world.step()
        self.assertLessEqual(calls_of(world.step), _MOST_CALLS)


if __name__ == "__main__":
    main()
