"""Many worlds in one engine."""
from support import Case, crate_scene, main  # first: it skips the test where numpy is missing

import numpy as np
import rubble


def crates(count, **options):
    return rubble.Worlds(crate_scene(), count, threads=1, iterations=4, **options)


class ManyWorlds(Case):
    def test_each_has_the_bits_that_it_has_alone(self):
        worlds, alone = crates(5), rubble.World(crate_scene(), threads=1, iterations=4)
        worlds[3].bodies["crate"].apply_impulse((1, 0, 0))
        alone.bodies["crate"].apply_impulse((1, 0, 0))
        worlds.step(100)
        alone.step(100)
        np.testing.assert_array_equal(worlds[3].bodies["crate"].position, alone.bodies["crate"].position)
        self.assertEqual(worlds[0].hash(), worlds[4].hash())
        self.assertNotEqual(worlds[0].hash(), worlds[3].hash())

    def test_a_world_that_is_left_out_stays(self):
        worlds = crates(3)
        worlds.step(5)
        before = worlds[1].hash()
        worlds.step(2, active=[True, False, True])
        self.assertEqual(worlds[1].hash(), before)
        self.assertEqual([world.step_count for world in (worlds[0], worlds[1])], [7, 5])
        self.assertInvalid("active", lambda: worlds.step(active=[True]))

    def test_resets_bring_back_one_state_or_one_each(self):
        worlds = crates(4)
        start = worlds[0].snapshot()
        worlds.step(10)
        later = worlds[0].snapshot()
        worlds.reset([1, 3], start)
        self.assertEqual(worlds[1].hash(), worlds[3].hash())
        self.assertEqual(worlds[0].hash(), worlds[2].hash())
        worlds.reset(np.array([True, True, False, False]), [start, later])
        self.assertEqual(worlds[0].hash(), worlds[3].hash())
        self.assertEqual(worlds[1].hash(), worlds[2].hash())

    def test_arrays_have_a_leading_axis_of_worlds(self):
        worlds = crates(3)
        positions = worlds.array("position").reshape(3, -1, 3)
        self.assertNear(positions[:, 1], [(0, 0, 2)] * 3)
        rows = [worlds.rows(w)[1] for w in range(3)]
        worlds.scatter("velocity", rows, [(w, 0, 0) for w in range(3)])
        worlds.step()
        self.assertNear(worlds.array("velocity")[rows][:, 0], range(3), 1e-6)

    def test_worlds_differ_and_outlive_their_batch(self):
        worlds = crates(1)
        self.assertEqual(worlds.add(rubble.Scene(gravity=(0, 0, 0)), 2), 1)
        self.assertEqual(len(worlds), 3)
        self.assertNear(worlds[-1].gravity, (0, 0, 0))
        world = worlds[0]
        del worlds
        world.step()
        self.assertEqual(len(world.bodies), 2)


if __name__ == "__main__":
    main()
