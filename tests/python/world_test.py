"""Worlds and their bodies, state and events."""
import gc
import signal
import threading
import time

from support import Case, crate_scene, crate_world, main  # first: it skips the test where numpy is missing

import numpy as np
import rubble


class Worlds(Case):
    def test_a_crate_falls_and_rests_on_the_ground(self):
        world = crate_world(iterations=4)
        report = world.step(120)
        crate = world.bodies["crate"]
        self.assertNear(crate.position, (0, 0, 0.5), 0.01)
        self.assertEqual((report.step, report.bodies, report.manifolds), (119, 2, 1))
        self.assertEqual(world.step_count, 120)
        self.assertAlmostEqual(world.time, 2)
        self.assertNear(crate.contact_load.force, (0, 0, 2 * 9.81), 0.2)
        self.assertGreater(len(world.contacts), 0)
        self.assertLess(world.quality.penetration_max, 0.01)
        self.assertIn("stages_ms", world.report)

    def test_an_impulse_changes_the_velocity_by_impulse_over_mass(self):
        world = crate_world()
        crate = world.bodies["crate"]
        crate.apply_impulse((4, 0, 0))
        self.assertNear(crate.velocity, (2, 0, 0), 1e-6)
        crate.apply_force((0, 0, 2 * 9.81))
        world.step()
        self.assertNear(crate.velocity, (2, 0, 0), 1e-4)

    def test_batches_are_many_calls_at_once(self):
        world = crate_world()
        balls = world.bodies.add_many([{"shape": rubble.sphere(0.1), "mass": 1, "position": [k, 5, 9]}
                                       for k in range(4)])
        world.bodies.apply_impulses(balls, [(k, 0, 0) for k in range(4)])
        states = world.bodies.states(balls)
        self.assertNear(states["velocity"][:, 0], range(4), 1e-6)
        states["position"][:, 2] = 7
        world.bodies.set_states(balls, states)
        self.assertNear([ball.position[2] for ball in balls], [7] * 4, 1e-6)
        world.bodies.remove_many(balls[1:])
        self.assertEqual([ball.alive for ball in balls], [True, False, False, False])
        self.assertEqual(len(world.bodies), 3)

    def test_a_removed_body_is_refused_and_says_so(self):
        world = crate_world()
        crate = world.bodies["crate"]
        self.assertIn(crate, world.bodies)
        crate.remove()
        self.assertFalse(crate.alive)
        self.assertNotIn("crate", world.bodies)
        self.assertRaises(rubble.Error, lambda: crate.position)
        self.assertEqual(repr(crate), f"<rubble.Body {crate.index} removed>")

    def test_wrong_vectors_are_named(self):
        crate = crate_world().bodies["crate"]
        self.assertInvalid("impulse", lambda: crate.apply_impulse((1, 2)))
        self.assertInvalid("body.position", lambda: setattr(crate, "position", 3))

    def test_options_and_parameters_have_names(self):
        world = crate_world(dt=1 / 240, iterations=7)
        self.assertEqual(world.params.iterations, 7)
        world.params.iterations = 3
        self.assertEqual(dict(world.params)["iterations"], 3)
        self.assertAlmostEqual(world.params.dt, 1 / 240)
        self.assertRaises(rubble.Error, lambda: world.params.set(iterations=-1))
        self.assertInvalid("options.iteration", lambda: crate_world(iteration=7))
        self.assertRaises(rubble.Error, lambda: crate_world(backend="abacus"))
        world.gravity = (0, 0, -1)
        self.assertNear(world.gravity, (0, 0, -1))

    def test_a_snapshot_continues_bit_for_bit(self):
        world = crate_world()
        world.step(20)
        snapshot = world.snapshot()
        world.step(30)
        first = world.hash()
        world.restore(snapshot)
        self.assertNotEqual(world.hash(), first)
        world.step(30)
        self.assertEqual(world.hash(), first)

    def test_a_snapshot_in_a_file_continues_bit_for_bit(self):
        world = crate_world()
        world.step(20)
        data = world.snapshot().to_bytes()
        world.step(30)
        again = crate_world()
        again.restore(rubble.Snapshot.from_bytes(data))
        again.step(30)
        self.assertEqual(again.hash(), world.hash())
        with self.assertRaisesRegex(rubble.Error, "undamaged|fewer"):
            rubble.Snapshot.from_bytes(data[:-1])

    def test_a_body_changes_while_it_rests(self):
        world = crate_world()
        world.step(120)
        crate = world.bodies["crate"]
        before = world.hash()
        crate.set(user_data=7)
        self.assertEqual((crate.definition["user_data"], world.hash()), (7, before))
        crate.set(mass=6)
        world.step(60)
        self.assertNear(crate.contact_load.force, (0, 0, 6 * 9.81), 0.6)
        crate.set(mask=[])
        world.step(30)
        self.assertLess(crate.position[2], 0)
        with self.assertRaisesRegex(rubble.Error, "mas"):
            crate.set(mas=1)

    def test_contacts_begin_stay_and_end(self):
        world = crate_world(events=True)
        phases = []
        for _ in range(60):
            world.step()
            phases += world.events.contacts["phase"].tolist()
        self.assertEqual(phases[:2], [0, 1])
        crate = world.bodies["crate"]
        crate.position = (0, 0, 9)
        world.step()
        self.assertEqual(world.events.contacts["phase"].tolist(), [2])

    def test_a_kinematic_body_reaches_its_target(self):
        world = rubble.World(crate_scene(motion="kinematic"), threads=1)
        crate = world.bodies["crate"]
        crate.set_target((1, 2, 3))
        world.step()
        self.assertNear(crate.position, (1, 2, 3), 1e-5)

    def test_a_run_inside_outlives_its_owner(self):
        world = rubble.Run("pendulum", threads=1).world
        gc.collect()
        world.step(3)
        self.assertEqual(world.step_count, 3)


class Steps(Case):
    def test_ctrl_c_ends_a_long_run(self):
        world = crate_world()
        timer = threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            world.step(100_000_000)
        self.assertGreater(world.step_count, 0)

    def test_other_threads_run_during_a_step(self):
        world = rubble.World(rubble.Scene.from_registry("pyramid", base=100), threads=1)
        ticks, started, done = [], threading.Event(), threading.Event()

        def tick():
            while not done.wait(0.001):
                ticks.append(time.perf_counter())
                started.set()

        other = threading.Thread(target=tick)
        other.start()
        started.wait()
        begin = time.perf_counter()
        world.step()
        end = time.perf_counter()
        done.set()
        other.join()
        self.assertGreater(sum(begin < moment < end for moment in ticks), 1)


if __name__ == "__main__":
    main()
