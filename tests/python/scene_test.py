"""Scenes and their errors."""
import json
import os
import tempfile

from support import Case, crate_scene, main  # first: it skips the test where numpy is missing

import numpy as np
import rubble


class Scenes(Case):
    def test_a_scene_written_and_read_is_the_same(self):
        scene = crate_scene(orientation=(0.6, 0.8, 0, 0), velocity=np.array([1, 2, 3.5]))
        scene.add_joint("hinge", "crate", anchor=(0, 0, 3), axis=(0, 1, 0), name="pin")
        again = rubble.Scene.from_json(scene.to_json())
        self.assertEqual(again.to_json(), scene.to_json())
        self.assertEqual(repr(again), "<rubble.Scene 2 bodies, 1 joints, 0 deformables>")
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "scene.json")
            scene.save(file)
            self.assertEqual(rubble.Scene.load(file).to_json(), scene.to_json())

    def test_an_invalid_field_is_named_with_what_was_expected_and_found(self):
        error = self.assertInvalid("bodies[2].mass",
                                   lambda: crate_scene().add_body(rubble.sphere(1), mass=-1))
        self.assertEqual(error.expected, "a mass above 0 [kg]")
        self.assertEqual(error.found, "-1")
        self.assertEqual(f"{type(error).__module__}.{type(error).__name__}", "rubble.Error")
        self.assertEqual(str(error), "bodies[2].mass: expected a mass above 0 [kg], got -1")

    def test_a_body_that_was_refused_leaves_no_trace(self):
        scene = crate_scene()
        self.assertInvalid("bodies[2].density", lambda: scene.add_body(rubble.sphere(1), name="a", density=0))
        self.assertEqual(scene.count("bodies"), 2)
        self.assertEqual(scene.add_body(rubble.sphere(1), name="a"), 2)

    def test_names_and_indices_refer_to_bodies_that_were_added_before(self):
        scene = crate_scene()
        error = self.assertInvalid("joints[0].body_a",
                                   lambda: scene.add_joint("ball", "crat", anchor=(0, 0, 0)))
        self.assertIn("crate", error.found)
        self.assertEqual(scene.add_joint("ball", 1, anchor=(0, 0, 3)), 0)

    def test_unknown_keys_and_infinite_numbers_are_refused(self):
        self.assertInvalid("bodies[2].mas", lambda: crate_scene().add_body(rubble.sphere(1), mas=1))
        self.assertInvalid("definition", lambda: crate_scene().add_body(rubble.sphere(1), mass=float("inf")))

    def test_all_faults_of_a_text_are_listed(self):
        text = json.dumps({"bodies": [{"shape": {"type": "box"}, "mass": -1}, {"mass": 1}]})
        with self.assertRaises(rubble.Error) as caught:
            rubble.Scene.from_json(text)
        self.assertIn("bodies[0].mass", str(caught.exception))
        self.assertIn("bodies[1]", str(caught.exception))

    def test_materials_and_shapes_can_be_named(self):
        scene = rubble.Scene()
        scene.set(materials={"ice": {"friction": 0.01}}, shapes={"ball": rubble.sphere(0.5)})
        scene.add_body("ball", material="ice")
        self.assertEqual(rubble.World(scene).bodies[0].definition["material"]["friction"], 0.01)

    def test_a_model_of_another_program_is_loaded_with_its_report(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "arm.xml")
            with open(file, "w", encoding="utf-8") as out:
                out.write("<mujoco><worldbody><body name='arm'>"
                          "<joint name='j' armature='0.5' springyield='1'/>"
                          "<geom size='0.1'/></body></worldbody></mujoco>")
            scene = rubble.load(file)
            self.assertEqual(scene.to_dict()["joints"][0]["axes"][0]["armature"], 0.5)
            self.assertEqual(scene.report["counts"]["lost"], 1)
            with self.assertRaises(rubble.Error):
                rubble.load(file, strict=True)

    def test_sensors_of_a_model_are_read_after_each_step(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "arm.xml")
            with open(file, "w", encoding="utf-8") as out:
                out.write("<mujoco><worldbody><body name='arm'><joint name='j' axis='0 1 0' damping='1'/>"
                          "<geom size='0.1' pos='0 0 -1' mass='2'/><site name='s'/></body></worldbody>"
                          "<sensor>"
                          "<force name='weight' site='s'/><jointpos joint='j'/></sensor></mujoco>")
            scene = rubble.load(file)
        self.assertEqual(scene.add_sensor("position", name="bob", body="arm", position=(0, 0, -1)), 2)
        self.assertInvalid("sensors[3].type", lambda: scene.add_sensor("smell"))
        world = rubble.World(scene, threads=1)
        sensors = rubble.Sensors(scene, world)
        self.assertEqual(sensors.names, ["weight", "sensor_1", "bob"])
        self.assertEqual(sensors.types, ["force", "joint_position", "position"])
        self.assertNear(sensors.values, np.zeros(7))
        world.bodies["arm"].velocity, world.bodies["arm"].angular_velocity = (-1, 0, 0), (0, 1, 0)
        for _ in range(10):
            world.step()
            sensors.update()
        angle = sensors["sensor_1"][0]
        self.assertGreater(angle, 0.01)
        self.assertNear(sensors["bob"], (-np.sin(angle), 0, -np.cos(angle)), 1e-5)
        self.assertNear(np.concatenate([sensors[name] for name in sensors]), sensors.values)
        with self.assertRaises(KeyError):
            sensors["gyro"]
        other = rubble.World(rubble.Scene(), threads=1)
        self.assertInvalid("sensors[0].body", lambda: rubble.Sensors(scene, other))

    def test_a_rod_is_bodies_and_joints(self):
        scene = rubble.Scene()
        rod = scene.add_rod([(0, 0, 1), (1, 0, 1), (2, 0, 1)], radius=0.02, start="world", name="rod")
        self.assertEqual(rod, (0, 2, 0, 2))
        self.assertEqual(scene.count("bodies"), 2)

    def test_the_mass_of_a_box_is_its_volume_times_its_density(self):
        mass = rubble.mass_of(rubble.box(1, 2, 3), 1000)
        self.assertAlmostEqual(mass.mass, 6000)
        self.assertNear(mass.inertia, 500 * np.array([13, 10, 5]), 1e-6)


class Registry(Case):
    def test_a_scene_of_the_registry_runs_and_is_judged(self):
        self.assertIn("pendulum", rubble.scenes())
        seen = []
        run = rubble.Run("pendulum", threads=1)
        verdict = run.run(observer=lambda world, report: seen.append(report.step))
        self.assertTrue(verdict.holds, verdict.claims)
        self.assertEqual(len(seen), run.steps)
        self.assertIn("max_speed_m_s", verdict.metrics)

    def test_arguments_change_a_scene(self):
        small = rubble.Scene.from_registry("pyramid", base=3)
        large = rubble.Scene.from_registry("pyramid", base=6)
        self.assertLess(small.count("bodies"), large.count("bodies"))
        self.assertRaises(rubble.Error, lambda: rubble.Scene.from_registry("pyramid", bas=3))
        self.assertRaises(rubble.Error, lambda: rubble.Scene.from_registry("pyramidd"))

    def test_events_happen_in_a_run_of_ones_own_scene(self):
        scene = crate_scene()
        scene.add_event(5, add=[{"name": "ball", "shape": rubble.sphere(0.2), "position": [3, 0, 1]}])
        run = rubble.Run(scene, threads=1)
        verdict = run.run(10)
        self.assertIsNone(verdict.holds)
        self.assertIn("ball", run.world.bodies)


if __name__ == "__main__":
    main()
