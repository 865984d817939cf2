"""Joints, deformable objects, queries, recordings and pictures."""
import os
import tempfile

from support import Case, crate_scene, crate_world, main  # first: it skips the test where numpy is missing

import numpy as np
import rubble


class Joints(Case):
    def test_a_hinge_is_added_at_the_present_poses_and_driven(self):
        world = crate_world()
        crate = world.bodies["crate"]
        hinge = world.joints.add("hinge", crate, anchor=(0, 0, 2), axis=(0, 1, 0), name="motor",
                                 axes=[{"target_speed": 2, "drive_damping": "hard"}])
        world.step(30)
        self.assertAlmostEqual(abs(hinge.state.axes[0].speed), 2, places=3)
        self.assertLess(hinge.state.gap, 1e-4)
        self.assertEqual(world.joints["motor"], hinge)
        self.assertEqual(hinge.bodies, (crate, None))
        hinge.set_target(speed=0)
        world.step(5)
        self.assertAlmostEqual(hinge.state.axes[0].speed, 0, places=3)
        hinge.set_limits(-0.1, 0.1)
        hinge.set(axes=[{"friction": 3}])
        self.assertEqual(hinge.definition["axes"][0]["friction"], 3)
        self.assertInvalid("joint.type", lambda: world.joints.add("hing", crate, anchor=(0, 0, 0)))
        hinge.remove()
        self.assertEqual(len(world.joints), 0)

    def test_a_gear_couples_two_hinges(self):
        scene = rubble.Scene(gravity=(0, 0, 0))
        for k, name in enumerate("ab"):
            scene.add_body(rubble.cylinder(0.5, 0.2), name=name, position=(2 * k, 0, 0))
            scene.add_joint("hinge", name, name="pin " + name, anchor=(2 * k, 0, 0), axis=(0, 0, 1))
        world = rubble.World(scene, threads=1)
        world.joints.add_coupling("gear", world.joints["pin a"], world.joints["pin b"], ratio=2)
        world.bodies["a"].angular_velocity = (0, 0, 4)
        world.step(20)
        a, b = (world.joints["pin " + name].state.axes[0].position for name in "ab")
        self.assertGreater(abs(a), 0.1)
        self.assertAlmostEqual(a + 2 * b, 0, places=3)

    def test_a_body_tells_its_joints_its_contacts_and_its_material(self):
        world = rubble.World(crate_scene(material={"friction": 0.25}), threads=1)
        crate, ground = world.bodies["crate"], world.bodies["ground"]
        rail = world.joints.add("slider", crate, anchor=(0, 0, 2), axis=(0, 0, 1), user_data=5)
        self.assertEqual((crate.joints, rail.user_data, rail.frame_bodies), ([rail], 5, (None, None)))
        crate.user_data = 2 ** 63 + 1
        self.assertEqual(crate.user_data, 2 ** 63 + 1)
        self.assertEqual(crate.material(), {"friction": 0.25})
        self.assertInvalid("part", lambda: crate.material(1))
        world.step(100)
        self.assertEqual(len(crate.contacts), 4)
        self.assertNear(world.contact_forces([(ground, crate), (crate, ground)])[:, 2],
                        [2 * 9.81, -2 * 9.81], 0.1)
        rail.set_motor_force(50)
        world.step()
        self.assertAlmostEqual(abs(rail.state.axes[0].motor_force), 50, places=3)
        rail.remove()
        crate.set_velocity((0, 0, 1))
        crate.apply_impulse((0, 0, 2), at=crate.position + (0.5, 0, 0))
        crate.apply_angular_impulse((0, 1, 0))
        self.assertNear(crate.velocity, (0, 0, 2), 1e-6)
        self.assertNear(crate.angular_velocity, (0, 0, 0), 1e-6)
        self.assertIn("position", world.table_hashes())

    def test_a_drawing_for_another_renderer_has_lines_and_triangles(self):
        world = crate_world()
        drawn = world.debug_draw(edges=True, names=True)
        self.assertGreaterEqual(len(drawn.triangles), 12)
        self.assertIn("crate", [text for _, text, _ in drawn.texts])
        self.assertNear(np.ptp(drawn.lines["from"][:, 2]), 2.5, 1e-6)
        self.assertInvalid("options.edge", lambda: world.debug_draw(edge=True))

    def test_a_drag_joint_pulls_a_body(self):
        world = crate_world()
        crate = world.bodies["crate"]
        drag = crate.drag((0, 0, 2), max_force=1000)
        drag.drag_to((3, 0, 4))
        world.step(120)
        self.assertNear(crate.position, (3, 0, 4), 0.1)


class Sensors(Case):
    def test_they_read_a_world_of_their_scene(self):
        scene = crate_scene()
        scene.add_sensor("position", name="height", body="crate")
        scene.add_sensor("touch", name="foot", body="crate", position=(0, 0, -0.5),
                         volume=rubble.box(1.2, 1.2, 0.2))
        world = rubble.World(scene, threads=1)
        sensors = rubble.Sensors(scene, world)
        self.assertEqual((list(sensors), len(sensors.values)), (["height", "foot"], 4))
        self.assertNear(sensors["height"], (0, 0, 0))
        world.step(100)
        sensors.update()
        self.assertNear(sensors["height"], world.bodies["crate"].position)
        self.assertNear(sensors["foot"], [2 * 9.81], 0.1)
        with self.assertRaises(KeyError):
            sensors["hand"]


class Actuators(Case):
    def test_their_controls_and_activations_act_before_each_step(self):
        scene = rubble.Scene()
        scene.add_body(rubble.box(1, 1, 1), name="crate", mass=2)
        scene.set(gravity=(0, 0, 0))
        scene.add_actuator("wrench", name="jet", body="crate", force=(0, 3, 0), dynamics="integrator",
                           max_activation=1)
        world = rubble.World(scene, threads=1)
        actuators = rubble.Actuators(scene, world)
        self.assertEqual((list(actuators), actuators.types), (["jet"], ["wrench"]))
        actuators.activations[0] = 1
        actuators["jet"] = 0.5
        for _ in range(60):
            actuators.apply()
            world.step()
        self.assertNear(actuators.forces, [1])
        self.assertNear(world.bodies["crate"].velocity, (0, 1.5, 0), 1e-5)
        with self.assertRaises(KeyError):
            actuators["hand"] = 1


class Deformables(Case):
    def test_a_cloth_hangs_by_its_attachment(self):
        world = rubble.World(rubble.Scene(), threads=1)
        sheet = world.deformables.add(rubble.cloth_sheet((0, 0, 2), (1, 0, 0), (0, 1, 0), 6, 6), name="flag")
        held = world.attachments.add(sheet, [0])
        world.attachments.add(sheet, [6])
        world.step(60)
        self.assertEqual(len(sheet), 49)
        self.assertNear(sheet.positions[0], (0, 0, 2), 1e-2)
        self.assertLess(sheet.positions[48][2], 1.8)
        self.assertEqual(sheet.surface.triangles.shape, (72, 3))
        self.assertFalse(held.state.broken)
        self.assertEqual(held.ends[0], sheet)
        self.assertEqual(world.deformables["flag"], sheet)
        self.assertEqual(len(world.attachments), 2)

    def test_vertices_are_set_and_pushed(self):
        world = rubble.World(rubble.Scene(gravity=(0, 0, 0)), threads=1)
        ball = world.deformables.add(rubble.tet_ball((0, 0, 0), 0.5, 4), youngs_modulus=1e4)
        moved = ball.positions + (1, 0, 0)
        ball.set_vertices(moved, np.tile((0, 0, 1.0), (len(ball), 1)))
        self.assertNear(ball.positions, moved, 1e-6)
        world.step(10)
        self.assertNear(ball.velocities.mean(axis=0), (0, 0, 1), 1e-3)
        self.assertAlmostEqual(ball.masses.sum(), 523, delta=40)
        self.assertInvalid("positions", lambda: ball.set_vertices(np.zeros((3, 3))))

    def test_solids_cables_and_scenes_take_definitions(self):
        scene = rubble.Scene()
        scene.add_deformable(rubble.tet_box((0, 0, 0), (1, 1, 1), (2, 2, 2)), name="block", density=500)
        scene.add_deformable(rubble.straight_cable((0, 0, 3), (1, 0, 3), 5), name="cord", fixed=[0])
        scene.add_deformable(rubble.cable_along([(0, 0, 4), (1, 0, 4), (1, 1, 4)], 0.25))
        scene.add_attachment("cord", [5])
        self.assertEqual(scene.count("deformables"), 3)
        tetrahedron = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        sides = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
        self.assertGreater(len(rubble.tet_solid(tetrahedron, sides, 0.2)["tetrahedra"]), 4)


class Queries(Case):
    def setUp(self):
        self.world = crate_world(sleeping=False)
        self.crate = self.world.bodies["crate"]

    def test_a_ray_hits_the_first_body(self):
        hit = self.world.cast_ray((0, 0, 9), (0, 0, -1))
        self.assertEqual(hit.body, self.crate)
        self.assertAlmostEqual(hit.distance, 6.5, places=4)
        self.assertNear(hit.normal, (0, 0, 1), 1e-6)
        beyond = self.world.cast_ray((0, 0, 9), (0, 0, -1), ignore=self.crate)
        self.assertEqual(beyond.body.name, "ground")
        self.assertIsNone(self.world.cast_ray((0, 0, 9), (0, 0, 1)))

    def test_many_rays_are_one_call(self):
        origins = np.array([(x, 0, 9) for x in np.linspace(-2, 2, 101)])
        hits = self.world.cast_rays(origins, np.tile((0, 0, -1.0), (101, 1)))
        self.assertTrue(hits["hit"].all())
        self.assertEqual(int((hits["body"]["index"] == self.crate.index).sum()), 25)
        self.assertInvalid("directions", lambda: self.world.cast_rays(origins, [(0, 0, 1)]))

    def test_shapes_are_cast_and_overlapped(self):
        ball = rubble.sphere(0.5)
        hit = self.world.cast_shape(ball, (0, 0, 6), (0, 0, -6))
        self.assertEqual(hit.body, self.crate)
        self.assertAlmostEqual(hit.distance, 0.5, places=3)
        self.assertEqual(self.world.overlap(ball, (0.9, 0, 2)), [self.crate])
        self.assertEqual(self.world.overlaps(ball, [(0, 0, 2), (9, 9, 9)]), [[self.crate], []])

    def test_queries_hit_deformable_objects_that_they_ask_for(self):
        sheet = self.world.deformables.add(rubble.cloth_sheet((-1, -1, 4), (2, 0, 0), (0, 2, 0), 2, 2))
        def hits(**filter):
            return [self.world.cast_ray((0.1, 0.2, 9), (0, 0, -1), **filter),
                    self.world.cast_shape(rubble.sphere(0.1), (0.1, 0.2, 9), (0, 0, -9), **filter),
                    self.world.closest_point((0.1, 0.2, 9), **filter)]
        for hit in hits():
            self.assertEqual((hit.body, hit.object), (self.crate, None))
        for hit in hits(deformables=True):
            self.assertEqual((hit.body, hit.object), (None, sheet))
            self.assertGreaterEqual(hit.triangle, 0)
        self.assertEqual(hits(deformables=True, ignore_object=sheet)[0].body, self.crate)
        found, = self.world.cast_rays_all([(0.1, 0.2, 9)], [(0, 0, -1)], deformables=True)
        self.assertEqual(found["object"]["index"].tolist(), [sheet.index, -1, -1])

    def test_the_closest_point_lies_on_the_surface(self):
        hit = self.world.closest_point((3, 0, 2))
        self.assertEqual(hit.body.name, "ground")
        near = self.world.closest_point((1, 0, 2))
        self.assertNear(near.position, (0.5, 0, 2), 1e-5)
        self.assertIsNone(self.world.closest_point((3, 0, 90), max_distance=1))


class Shapes(Case):
    def test_a_shape_is_shared_and_ends_with_its_last_use(self):
        world = rubble.World(rubble.Scene(gravity=(0, 0, 0)), threads=1)
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        shape = world.shapes.add({**rubble.hull(points), "user_data": 5})
        bodies = [world.bodies.add(shape=shape, position=(3 * k, 0, 0), mass=2) for k in range(3)]
        self.assertEqual({body.shape for body in bodies}, {shape})
        self.assertEqual((shape.uses, shape.user_data, bodies[0].shape_user_data()), (4, 5, 5))
        self.assertEqual(world.cast_ray((0.2, 0.2, 9), (0, 0, -1)).shape_user_data, 5)
        shape.remove()
        other = world.bodies.add(shape=rubble.sphere(1), position=(0, 9, 0))
        for body in bodies:
            body.set(shape=other.shape, mass=3)
        self.assertFalse(shape.alive)
        self.assertEqual((other.shape.uses, bodies[1].mass), (4, 3))
        self.assertEqual(list(world.shapes), [other.shape])
        self.assertInvalid("shape", shape.remove)


class Recordings(Case):
    def test_a_recording_reads_back_what_was_written(self):
        world = crate_world()
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "out.rubble")
            written = []
            with rubble.Recorder(world, file, title="crate") as out:
                for _ in range(40):
                    world.step()
                    out.write()
                    written.append(world.bodies["crate"].position)
            recording = rubble.Recording(file)
            self.assertEqual((len(recording), recording.title, recording.complete), (40, "crate", True))
            read = [frame.positions[1] for frame in recording]
            self.assertNear(read, written, recording.resolution)
            self.assertEqual([body["name"] for body in recording.objects()["bodies"]], ["ground", "crate"])
            self.assertEqual(recording[-1].step, 40)
            self.assertRaises(IndexError, lambda: recording[40])
            size = os.path.getsize(file)
            self.assertEqual((recording.file_bytes, recording.intact_bytes), (size, size))
            os.truncate(file, size * 9 // 10)
            torn = rubble.Recording(file)
            self.assertFalse(torn.complete)
            self.assertTrue(0 < torn.intact_bytes <= torn.file_bytes == size * 9 // 10)
            self.assertEqual(len(torn), 32)
            self.assertNear(torn[31].positions[1], written[31], torn.resolution)
            self.assertIn("cut off", repr(torn))
            self.assertRaises(rubble.Error, lambda: rubble.Recorder(world, os.path.join(folder, "out.csv")))
        self.assertRaises(rubble.Error, lambda: rubble.Recording(os.path.join(folder, "none.rubble")))


class Pictures(Case):
    def test_a_picture_shows_the_crate_or_the_error_says_why_not(self):
        world = rubble.World(crate_scene(), threads=1)
        status = rubble.info()["opengl"]
        if status.startswith("off"):
            with self.assertRaises(rubble.Error) as caught:
                world.render(64, 48)
            self.assertIn("libepoxy", str(caught.exception))
            return
        try:
            picture = world.render(160, 90, samples=1)
        except rubble.Error as error:
            self.skipTest(f"no OpenGL on this machine: {error}")
        self.assertEqual((picture.shape, picture.dtype), ((90, 160, 3), np.uint8))
        self.assertGreater(picture.std(), 5)
        close = world.render(160, 90, eye=(4, -4, 3), target=(0, 0, 2), samples=1)
        self.assertFalse(np.array_equal(picture, close))
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "crate.png")
            rubble.save_png(close, file)
            with open(file, "rb") as stream:
                self.assertEqual(stream.read(4), b"\x89PNG")


if __name__ == "__main__":
    main()
