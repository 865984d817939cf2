"""Many worlds in one engine."""
from support import Case, crate_scene, main  # first: it skips the test where numpy is missing

import gc

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

    def test_arrays_are_views_that_keep_their_worlds(self):
        for count in (3, 70):  # in one set of tables, and in several
            worlds = crates(count)
            views = [worlds.array("position"), worlds.array("force"), worlds.sensor_array("touch")]
            self.assertFalse(any(view.flags.writeable for view in views))
            worlds.step(10)
            latest = worlds.array("position")
            self.assertEqual(latest.ctypes.data, views[0].ctypes.data)
            self.assertLess(views[0].reshape(count, -1, 3)[-1, 1, 2], 2)
            forces = worlds.contact_forces([worlds.rows(0)[:2]])
            del worlds, views
            gc.collect()
            self.assertLess(latest.reshape(count, -1, 3)[-1, 1, 2], 2)
            self.assertTrue(forces.flags.writeable)  # answers to queries are copies

    def test_actuators_have_a_row_of_controls_for_each_world(self):
        scene = rubble.Scene(gravity=(0, 0, 0))
        scene.add_body(rubble.box(1, 1, 1), name="crate", mass=2)
        scene.add_actuator("wrench", name="jet", body="crate", force=(0, 3, 0), dynamics="integrator")
        worlds = rubble.Worlds(scene, 3, threads=1)
        actuators = rubble.Actuators(scene, worlds)
        self.assertEqual((actuators.controls.shape, actuators.forces.shape), ((3, 1), (3, 1)))
        start = worlds[0].snapshot()
        actuators["jet"] = [1, 2, 3]
        actuators.apply(active=[True, False, True])
        dt = worlds.params["dt"]
        np.testing.assert_allclose(actuators.activations[:, 0], [dt, 0, 3 * dt])
        middle = worlds[2].snapshot()
        actuators.apply()
        worlds.step()
        np.testing.assert_allclose(actuators.forces[:, 0], [dt, 0, 3 * dt])
        self.assertNear(worlds[2].bodies["crate"].velocity, (0, 1.5 * 3 * dt * dt, 0), 1e-6)
        worlds.reset(np.array([False, True, True]), middle)
        np.testing.assert_allclose(actuators.activations[:, 0], [2 * dt, 3 * dt, 3 * dt])
        np.testing.assert_array_equal(actuators["jet"], [1, 3, 3])
        worlds.reset([0], start)
        self.assertEqual((actuators.controls[0, 0], actuators.activations[0, 0]), (0, 0))
        self.assertInvalid("active", lambda: actuators.apply(active=[True]))
        self.assertInvalid("count", lambda: rubble.Actuators(scene, worlds, 1, 3))
        controls = actuators.controls
        del actuators  # the array keeps its numbers alive
        self.assertEqual(controls.sum(), 6)

    def test_joints_and_sensors_have_rows_of_all_worlds(self):
        scene = rubble.Scene.from_registry("cart-pole", lean=0.1)
        worlds = rubble.Worlds(scene, 4, threads=1, dt=0.02, iterations=4)
        self.assertEqual(worlds[0].axes(), [(0, 0), (1, 0)])
        self.assertEqual(worlds.first_axis(2), 4)
        worlds.scatter_joints("applied_force", [worlds.first_axis(2)], [5])
        worlds.step(10)
        position, speed = (worlds.joint_array(name).reshape(4, 2) for name in ("position", "speed"))
        state = worlds[2].joints["rail"].state.axes[0]
        self.assertNear((position[2, 0], speed[2, 0]), (state.position, state.speed), 1e-6)
        self.assertGreater(position[2, 0], position[1, 0] + 0.0005)
        self.assertNear(position[0], position[3])
        self.assertNear(worlds.joint_array("lower_limit")[0], [-2.4], 1e-6)
        self.assertNear(worlds[2].joint_array("position")[:, 0], position[2])
        self.assertEqual(worlds.sensor_array("joint_force").shape, (8, 3))
        self.assertInvalid("array", lambda: worlds.joint_array("applied_force"))

    def test_vertices_are_those_of_each_world(self):
        scene = crate_scene()
        scene.add_deformable(rubble.straight_cable((0, 0, 4), (1, 0, 4), 4))
        scene.add_deformable(rubble.cloth_sheet((3, 0, 2), (1, 0, 0), (0, 1, 0), 2, 2), name="sheet")
        worlds = rubble.Worlds(scene, 3, threads=1)
        worlds[1].deformables["sheet"].apply_force(4, (0, 0, 1))
        worlds.step(3)
        first = worlds[1].deformables["sheet"].first_vertex
        self.assertEqual((first, worlds.first_vertex(2)), (5, 28))
        for name in ("position", "velocity"):
            rows = worlds.vertex_array(name).reshape(3, -1, 3)
            np.testing.assert_array_equal(rows[0], rows[2])
            own = getattr(worlds[1].deformables["sheet"], {"position": "positions"}.get(name, "velocities"))
            np.testing.assert_array_equal(rows[1, first:], own)
            np.testing.assert_array_equal(rows[1], worlds[1].vertex_array(name))
            self.assertTrue((rows[1] != rows[0]).any())
        self.assertInvalid("array", lambda: worlds.vertex_array("force"))

    def test_touch_is_the_weight_of_what_rests(self):
        worlds = crates(3)
        worlds.step(200)
        touch = worlds.sensor_array("touch").reshape(3, 2)
        self.assertNear(touch, np.full((3, 2), 2 * 9.81), 0.05)
        forces = worlds.sensor_array("contact_force").reshape(3, 2, 3)
        self.assertNear(forces[:, 1], [(0, 0, 2 * 9.81)] * 3, 0.05)
        pairs = worlds.contact_forces([worlds.rows(w)[:2] for w in (2, 0)])
        self.assertNear(pairs, [(0, 0, 2 * 9.81)] * 2, 0.05)
        self.assertNear(worlds.contact_forces([worlds.rows(1)[[1, 0]]]), -pairs[:1], 0.05)
        self.assertNear(worlds.sensor_array("acceleration").reshape(3, 2, 3)[:, 1, 2], [9.81] * 3, 0.01)

    def test_rays_are_cast_in_the_world_of_each(self):
        worlds = crates(3)
        worlds[1].bodies["crate"].position = (5, 0, 2)
        hits = worlds.cast_rays([0, 1, 1], [(0, 0, 9), (0, 0, 9), (5, 0, 9)], [(0, 0, -1)] * 3)
        self.assertNear(hits["distance"], [6.5, 9, 6.5], 1e-6)
        self.assertInvalid("world", lambda: worlds.cast_rays([3], [(0, 0, 9)], [(0, 0, -1)]))

    def test_values_of_bodies_change_in_some_worlds(self):
        worlds = crates(3)
        worlds.set_values("bodies.crate.mass", [4], worlds=[1])
        worlds.set_values("bodies.crate.shape", [], worlds=[])
        self.assertEqual([worlds[w].bodies["crate"].mass for w in range(3)], [2, 4, 2])
        worlds[0].bodies["crate"].set(gravity_scale=0)
        worlds.step(10)
        heights = worlds.array("position").reshape(3, 2, 3)[:, 1, 2]
        self.assertEqual(heights[0], 2)
        self.assertEqual(heights[1], heights[2])

    def test_values_of_all_kinds_are_set_and_read(self):
        scene = crate_scene(name="left.crate", material={"friction": 0.5, "name": "wood"})
        scene.add_deformable(rubble.straight_cable((3, 0, 4), (4, 0, 4), 4), name="rope")
        worlds = rubble.Worlds(scene, 3, threads=1)
        mask = np.array([True, False, True])
        for key, values in (("gravity", [(0, 0, -1), (0, 1, 0)]), ('bodies["left.crate"].mass', [3, 4]),
                            ("bodies[1].material.friction", [0.25, 0.75]),
                            ("materials.wood.restitution", [0, 1]),
                            ("deformables.rope.density", [500, 700])):
            with self.subTest(key):
                before = worlds.values(key, [1])
                worlds.set_values(key, values, worlds=mask)
                self.assertNear(worlds.values(key, mask), values)
                self.assertNear(worlds.values(key)[1], before[0])
        worlds.set_values('bodies["left.crate"].position', [(1, 2, 3)], worlds=[2])
        self.assertNear(worlds[2].bodies["left.crate"].position, (1, 2, 3), 1e-6)

    def test_values_change_in_all_worlds_or_in_none(self):
        worlds = crates(3)
        error = self.assertInvalid("worlds[2].body.mass",
                                   lambda: worlds.set_values("bodies.crate.mass", [1, 2, -3]))
        self.assertEqual(error.found, "-3")
        self.assertNear(worlds.values("bodies.crate.mass"), [2, 2, 2])
        self.assertInvalid("path", lambda: worlds.set_values("dt", [1, 2, 3]))
        self.assertInvalid("values", lambda: worlds.set_values("gravity", [1, 2]))

    def test_random_numbers_of_a_world_are_its_own(self):
        few, many = crates(2), crates(9)
        few.set_seed(3), many.set_seed(3)
        first = few.uniform([1], 4)
        np.testing.assert_array_equal(first, many.uniform([5, 1], 4)[1:])
        self.assertEqual(few.uniform(count=2, low=5, high=6).shape, (2, 2))
        start, other = few[0].snapshot(), many[0].snapshot()
        few.reset([0, 1], start), many.reset([1], other), many.reset([4], other)
        np.testing.assert_array_equal(few.uniform([1], 3), many.uniform([1], 3))
        self.assertEqual(few.random_state(1)[1:], (1, 3))
        many.set_random_state(7, few.random_state(1))
        np.testing.assert_array_equal(few.uniform([1], 3), many.uniform([7], 3))
        few.set_seed(3, [1])
        np.testing.assert_array_equal(few.uniform([1], 4), first)

    def test_sensors_of_a_scene_have_the_readings_of_each_world(self):
        scene = crate_scene()
        scene.add_joint("hinge", "crate", anchor=(1, 0, 2), axis=(0, 1, 0))
        scene.add_body(rubble.sphere(0.5), name="ball", position=(5, 0, 0.5))
        for kind in ("acceleration", "angular_rate", "position", "range"):
            scene.add_sensor(kind, body="crate", name=kind)
        scene.add_sensor("force", body="crate", joint=0)
        scene.add_sensor("touch", body="ball", name="foot", volume=rubble.sphere(0.6))
        worlds = rubble.Worlds(scene, 3, threads=1)
        alone = [rubble.World(scene, threads=1) for _ in range(3)]
        for w, world in enumerate(alone):
            for own in (world, worlds[w]):
                own.bodies["crate"].velocity = (0, 0, w)
        sensors, single = rubble.Sensors(scene, worlds), [rubble.Sensors(scene, world) for world in alone]
        for _ in range(5):
            worlds.step()
            sensors.update()
            for world, own in zip(alone, single):
                world.step()
                own.update()
        np.testing.assert_array_equal(sensors.values, [own.values for own in single])
        self.assertEqual(sensors["position"].shape, (3, 3))
        self.assertEqual(sensors.of_type("touch").shape, (3, 1, 1))
        self.assertGreater(sensors["foot"].min(), 1)
        before = sensors.values
        worlds.step()
        sensors.update(active=[False, True, False])
        self.assertEqual([(a == b).all() for a, b in zip(before, sensors.values)], [True, False, True])
        self.assertInvalid("active", lambda: sensors.update(active=[True]))
        self.assertInvalid("type", lambda: sensors.of_type("velocity"))

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
