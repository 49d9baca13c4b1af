"""A whole run by its client: joining and launching, steering, keeping, and errors."""

import os
import signal
import threading
import time
import unittest

import numpy as np

import aurasim
from client_fixture import GENEROUS_S, WorldTest, launch_file, processes_of_domain, wait_until


class Steering(WorldTest):
    def test_what_is_seen_of_a_run(self):
        world = self.launch(paused=False)
        info = world.info()
        self.assertEqual((info.scene, info.domain, info.key, len(info.regions)),
                         ("corner_stacks", self.domain.number, "", 4))
        self.assertAlmostEqual(info.step_s, 1 / 60)
        self.assertTrue(info.prototypes)
        self.assertEqual(info.regions[0][0], float("-inf"))
        nodes = world.nodes()
        self.assertEqual([node.region for node in nodes], [0, 1, 2, 3])
        self.assertEqual({node.state for node in nodes}, {"running"})
        bodies = world.bodies()
        self.assertFalse(bodies.exact)
        n = len(bodies)
        self.assertGreater(n, 50)
        self.assertEqual(bodies.positions.shape, (n, 3))
        self.assertEqual(bodies.rotations.shape, (n, 4))
        self.assertEqual(bodies.ids.dtype, np.uint64)
        self.assertEqual(bodies.asleep.dtype, np.bool_)
        self.assertTrue((np.diff(bodies.ids.astype(np.int64)) > 0).all())
        np.testing.assert_allclose(np.linalg.norm(bodies.rotations, axis=1), 1, atol=1e-5)
        self.assertFalse(bodies.positions.flags.writeable)
        self.assertAlmostEqual(bodies.time, bodies.step / 60)

    def test_arrays_outlive_their_world(self):
        world = self.launch()
        positions = world.bodies().positions
        world.close()
        self.assertTrue(np.isfinite(positions).all())

    def test_pause_step_resume_reset(self):
        world = self.launch(paused=False)
        paused = world.pause()
        self.assertTrue(paused.exact)
        self.assertEqual(world.bodies().step, paused.step)
        self.assertEqual(world.step(5).step, paused.step + 5)
        self.assertEqual({node.state for node in world.nodes()}, {"paused"})
        world.resume()
        self.assertTrue(wait_until(lambda: world.bodies().step > paused.step + 10))
        world.reset()
        self.assertGreater(world.pause().generation, paused.generation)

    def test_a_reset_of_a_paused_run_stands_in_its_first_state(self):
        world = self.launch()
        first = world.bodies()
        other = self.connect()
        for steps in (7, 40):
            world.step(steps)
            world.reset()
            for seen in (world, other):
                self.assertTrue(wait_until(lambda: seen.bodies().generation > first.generation))
                self.assertEqual(seen.bodies().step, 0)
                self.assertEqual(seen.bodies().positions.tobytes(), first.positions.tobytes())
            self.assertEqual({(node.state, node.step) for node in world.nodes()}, {("paused", 0)})
            first = world.bodies()
        self.assertEqual(world.step(3).step, 3)
        world.resume()
        self.assertTrue(wait_until(lambda: world.bodies().step > 30))
        world.reset()
        self.assertTrue(wait_until(lambda: world.bodies().generation > first.generation and world.bodies().step > 30),
                        "a run that is not paused goes on after a reset")

    def test_steps_of_two_clients_add_up(self):
        worlds = [self.launch(), self.connect()]
        self.assertTrue(wait_until(lambda: worlds[1].bodies().step == 0))
        both = threading.Barrier(2)

        def step_ten_times(world):
            both.wait()
            for _ in range(10):
                before = world.bodies().step
                self.assertGreaterEqual(world.step(5).step, before + 5)

        threads = [threading.Thread(target=step_ten_times, args=(world,)) for world in worlds]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(3 * GENEROUS_S)
            self.assertFalse(thread.is_alive())
        for world in worlds:
            self.assertTrue(wait_until(lambda: world.bodies().step >= 100))
            self.assertEqual(world.bodies().step, 100)
        self.assertEqual({node.step for node in worlds[0].nodes()}, {100})
        self.assertEqual(worlds[1].step().step, 101)

    def test_two_clients_of_one_run(self):
        first = self.launch()
        second = self.connect()
        stood = first.step(3)
        self.assertEqual(second.bodies().step, stood.step)
        self.assertEqual(second.step(2).step, stood.step + 2)
        self.assertTrue(wait_until(lambda: first.bodies().step == stood.step + 2))  # it hears of it, too
        self.assertEqual(first.step().step, stood.step + 3)

    def test_no_client_sees_the_middle_of_a_short_step(self):
        first = self.launch()
        second = self.connect()
        for _ in range(5):
            before = first.bodies().step
            self.assertTrue(wait_until(lambda: second.bodies().step == before))
            stepping = threading.Thread(target=first.step, args=(40,))
            stepping.start()
            seen = []
            while stepping.is_alive():
                seen.append(second.bodies())
            stepping.join()
            self.assertTrue(all(bodies.exact for bodies in seen))
            self.assertLessEqual({bodies.step for bodies in seen}, {before, before + 40})

    def test_who_asks_in_a_long_step_is_told_how_far_it_has_come(self):
        first = self.launch()
        second = self.connect()
        first_end = 100_000
        stepping = threading.Thread(target=self.ignore_the_end, args=(lambda: first.step(first_end),))
        stepping.start()
        self.assertTrue(wait_until(lambda: second.bodies().step > 0))
        seen = second.bodies(timeout=GENEROUS_S)
        self.assertFalse(seen.exact)
        self.assertLess(seen.step, first_end)
        second.stop()
        stepping.join(GENEROUS_S)
        self.assertFalse(stepping.is_alive())

    @staticmethod
    def ignore_the_end(call):
        try:
            call()
        except aurasim.Error:
            pass

    def test_who_comes_later_sees_all_bodies_from_the_first_word_on(self):
        before = set(self.launch(paused=False).bodies().ids.tolist())
        for _ in range(4):
            late = self.connect()
            self.assertEqual(before - set(late.bodies().ids.tolist()), set())  # others may have been injected since
            late.close()

    def test_the_rest_of_what_send_can_ask_for(self):
        world = self.launch()
        fixed = world.add_static(aurasim.Shape.box((4, 4, 1)), position=(10, 10, 0.5))
        self.assertIsNotNone(fixed.fixed)
        world.step(fixed.step - world.bodies().step)
        hit = world.ray((10, 10, 20), (10, 10, -1))
        self.assertTrue(hit.hit and hit.complete)
        self.assertEqual(hit.fixed, fixed.fixed)
        self.assertAlmostEqual(hit.distance, 19, delta=0.01)
        sent = world.move_static(fixed.fixed, (10, 10, 4.5), duration=0.5)
        world.step(sent.step + 40 - world.bodies().step)
        self.assertAlmostEqual(world.ray((10, 10, 20), (10, 10, -1)).distance, 15, delta=0.01)
        with self.assertRaisesRegex(aurasim.Refused, "name or number"):
            world.move_static("no such gate", (0, 0, 0))
        gone = world.remove_static(fixed.fixed)
        world.step(gone.step - world.bodies().step)
        self.assertNotEqual(world.ray((10, 10, 20), (10, 10, -1)).fixed, fixed.fixed)
        world.set_rate(0.5)
        self.assertTrue(wait_until(lambda: {node.rate for node in world.nodes()} == {0.5}))
        world.set_rate(1)
        inf = float("inf")
        world.set_regions([(-inf, -inf, 5, 0), (5, -inf, inf, 0), (-inf, 0, 5, inf), (5, 0, inf, inf)])
        self.assertEqual(world.info().regions[0][2], 5)
        self.assertTrue(world.bodies().exact)
        world.set_scene("tower")
        self.assertEqual((world.bodies().step, world.info().scene), (0, "tower"))

    def test_a_region_changes_its_process(self):
        world = self.launch(paused=False)
        before = world.nodes()[2].pid
        after = world.drain(2)
        self.assertNotEqual(before, after)
        self.assertTrue(wait_until(lambda: world.nodes()[2].pid == after))

    def test_a_world_is_saved_and_gone_on_from(self):
        world = self.launch(paused=False, time__sync="deterministic")
        self.assertTrue(wait_until(lambda: world.bodies().step > 100))
        saved = world.save("world.cut")
        file = self.folder / "saves" / "world.cut"
        self.assertEqual(saved.file, str(file))
        self.assertEqual(sorted(path.name for path in file.parent.iterdir()), ["world.cut"])
        world.close()
        again = self.launch(load=file, time__sync="deterministic", regions__count=1)
        self.assertEqual(again.bodies().step, saved.step, "it stands in the state that was saved")
        self.assertEqual(again.step(5).step, saved.step + 5)
        again.reset()
        self.assertEqual(again.bodies().step, saved.step)

    def test_of_a_paused_run_the_state_that_stands_is_saved(self):
        world = self.launch(time__sync="deterministic", time__pace="none")
        seen = {}
        for steps in (0, 1, 10, 9, 15, 35, 20, 33):
            if steps:
                world.step(steps)
            seen[world.save(f"at-{world.bodies().step}").step] = world.bodies()
            self.assertIn(world.bodies().step, seen)
        later = world.step(60)
        for step, bodies in seen.items():
            world.load(f"at-{step}")
            self.assertEqual(world.bodies().step, step)
            for name in ("ids", "positions", "rotations", "linear_velocities", "angular_velocities"):
                self.assertEqual(getattr(world.bodies(), name).tobytes(), getattr(bodies, name).tobytes(),
                                 f"state {step}: {name}")
            went_on = world.step(later.step - step)
            self.assertEqual(went_on.positions.tobytes(), later.positions.tobytes(), f"from state {step}")

    def test_a_saved_world_has_a_name_and_no_path(self):
        world = self.launch()
        for call in (world.save, world.load):
            for name in (str(self.folder / "world.cut"), "../world.cut", "a/b", "", ".hidden", "-x", "a" * 200, "a b"):
                with self.subTest(call=call.__name__, name=name), \
                        self.assertRaisesRegex(aurasim.Refused, "a saved world's name"):
                    call(name)
        self.assertEqual(world.save("a.cut").step, 0)
        with self.assertRaisesRegex(aurasim.Refused, "nothing.cut"):
            world.load("nothing.cut")
        world.step(4)
        world.load("a.cut")
        self.assertEqual(world.bodies().step, 0)

    def test_a_launched_run_writes_its_report(self):
        world = self.launch(report=self.folder / "report")
        world.step(10)
        self.assertEqual(world.close(), 0)
        self.assertTrue((self.folder / "report" / "summary.json").exists())
        self.assertTrue(world.closed)


class Errors(WorldTest):
    def test_a_file_or_a_set_that_is_wrong(self):
        with self.assertRaisesRegex(aurasim.BadFile, "nowhere.yaml"):
            aurasim.World.connect(self.folder / "nowhere.yaml")
        with self.assertRaisesRegex(aurasim.BadFile, "time.step_hz"):
            aurasim.World.launch(launch_file("demo"), set=self.overrides(time__step_hz=-3))
        with self.assertRaises(ValueError):
            aurasim.World.launch(launch_file("demo"), set=["no.such.key=1"])

    def test_no_run_and_a_run_that_differs(self):
        with self.assertRaises(aurasim.NoSuchRun):
            self.connect(timeout=2)
        self.launch(paused=False)
        with self.assertRaises(aurasim.RunDiffers):
            self.connect(time__substeps=4)
        with self.assertRaisesRegex(aurasim.LaunchFailed, "exit code 3"):
            self.launch(time__substeps=4)

    def test_a_load_that_does_not_fit(self):
        (self.folder / "no.cut").write_text("this is no world")
        with self.assertRaisesRegex(aurasim.LaunchFailed, "no.cut"):
            self.launch(load=self.folder / "no.cut")

    def test_what_is_refused_says_why(self):
        world = self.launch()
        nan = float("nan")
        with self.assertRaisesRegex(aurasim.Refused, "finite"):
            world.spawn(aurasim.Shape.sphere(0.5), position=(0, nan, 5))
        with self.assertRaisesRegex(aurasim.Refused, "finite"):
            world.impulses(world.bodies().ids[:2], np.array([[0, 0, 1], [0, nan, 0]]))
        with self.assertRaises(aurasim.Refused):
            world.spawn("no such kind", position=(0, 0, 5))
        with self.assertRaises(aurasim.Refused):
            world.spawn(aurasim.Shape.sphere(-1), position=(0, 0, 5))
        with self.assertRaises(aurasim.Refused):
            world.set_rate(1e30)
        with self.assertRaises(aurasim.Refused):
            world.set_scene("no_such_scene")
        with self.assertRaisesRegex(aurasim.Refused, "no_mesh.obj"):
            world.spawn(aurasim.Shape.mesh(str(self.folder / "no_mesh.obj")))
        with self.assertRaises(aurasim.Refused):
            world.step(0)
        with self.assertRaisesRegex(aurasim.Refused, "region 17"):
            world.drain(17)
        with self.assertRaises(ValueError):
            world.impulses(np.arange(3), np.zeros((2, 3)))
        self.assertEqual(world.step().step, 1)

    def test_steps_are_for_a_run_that_is_paused(self):
        world = self.launch(paused=False)
        other = self.connect()
        begin = time.monotonic()
        for _ in range(3):
            with self.assertRaisesRegex(aurasim.Refused, "paused"):
                world.step()
        self.assertLess(time.monotonic() - begin, 10, "at once, and not after a time-out")
        for _ in range(5):
            paused = other.pause()
            self.assertEqual(world.step(2).step, paused.step + 2)
            other.resume()
            self.assertTrue(wait_until(lambda: {node.state for node in world.nodes()} == {"running"}))

    def test_a_time_out_ends_the_call_and_not_the_world(self):
        world = self.launch()
        with self.assertRaises(aurasim.TimedOut):
            world.step(600, timeout=0.5)
        self.assertTrue(wait_until(lambda: {node.state for node in world.nodes()} == {"paused"}))
        self.assertEqual(world.bodies().step, 600)
        self.assertEqual(world.step().step, 601)

    def test_ctrl_c_ends_the_call_and_not_the_world(self):
        world = self.launch()
        threading.Timer(1, os.kill, (os.getpid(), signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            world.step(600)
        self.assertTrue(wait_until(lambda: {node.state for node in world.nodes()} == {"paused"}))
        self.assertEqual(world.step().step, 601)

    def test_after_the_end(self):
        world = self.launch()
        world.close()
        with self.assertRaises(aurasim.Ended):
            world.step()
        stopped = self.launch(paused=False)
        stopped.stop()
        with self.assertRaises(aurasim.Ended):
            for _ in range(1000):
                stopped.bodies()
                time.sleep(0.02)

    def test_an_agent_that_dies(self):
        world = self.launch(paused=False)
        os.kill(world.agent_pid, signal.SIGKILL)
        with self.assertRaises(aurasim.Ended):
            world.bodies()
        self.assertNotEqual(world.close(), 0, "it has not ended as it should")
        self.assertEqual(processes_of_domain(self.domain.number), [], "its run ends with it")

    def test_close_after_the_agent_has_died_waits_for_the_end_of_its_run(self):
        for paused in (False, True):
            world = self.launch(paused=paused, report=self.folder / f"report {paused}")
            os.kill(world.agent_pid, signal.SIGKILL)
            self.assertNotEqual(world.close(), 0)
            self.assertEqual(processes_of_domain(self.domain.number), [])
            self.assertEqual(world.close(), 0, "closed already")

    def test_no_program(self):
        with self.assertRaises(aurasim.NoProgram):
            aurasim.World.connect(launch_file("demo"), program=str(self.folder / "aurasim"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
