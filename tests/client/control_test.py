"""Steering bodies by a program: in which state it acts, on any number of nodes, recorded, late, refused, and when the
program is gone."""

import os
import signal
import subprocess
import sys
import textwrap
import time
import unittest

import numpy as np

import aurasim
from client_fixture import WorldTest, launch_file, setpoint_rows, wait_until
from lockstep_test import first_difference


def pushes(ids, step):
    """A force on each body, other in each state."""
    phase = ids.astype(float)[:, None] * (1.3, 2.1, 0.7) + 0.11 * step
    return np.sin(phase) * (6, 6, 9)


class LockStep(WorldTest):
    STEPS = 90

    def states(self, report=None, **overrides):
        world = self.launch(time__sync="deterministic", time__lookahead=1, report=report, **overrides)
        states = [world.bodies()]
        steered = states[0].ids[::2]
        for _ in range(self.STEPS):
            step = states[-1].step
            self.assertEqual(world.control(forces=(steered, pushes(steered, step))), step + 1)
            states.append(world.step())
        nodes = world.nodes()
        world.close()
        return states, nodes

    def test_a_force_acts_in_the_next_state(self):
        world = self.launch()
        ball = world.spawn(aurasim.Shape.sphere(0.5), position=(15, -15, 20), mass=4)
        world.step(ball.step - world.bodies().step)
        body = np.array([ball.body], np.uint64)

        def speed(bodies):
            return bodies.linear_velocities[bodies.ids == ball.body][0]

        v = speed(world.step())
        self.assertEqual(world.control(forces=(body, [(240, 0, 4 * 9.81)])), world.bodies().step + 1)
        np.testing.assert_allclose(speed(world.step()) - v, (1, 0, 0), atol=1e-3)
        np.testing.assert_allclose(speed(world.step()) - v, (2, 0, 0), atol=1e-3)  # it holds
        world.control(forces=(body, None))
        np.testing.assert_allclose(speed(world.step()) - v, (2, 0, -9.81 / 60), atol=1e-3)

    def test_on_four_nodes_every_state_is_that_of_one(self):
        four, nodes = self.states()
        one, _ = self.states(regions__count=1)
        self.assertGreater(sum(node.hand_offs_out for node in nodes), 0, "or this test proves nothing")
        self.assertEqual([node.setpoints_late for node in nodes], [0, 0, 0, 0])
        for a, b in zip(four, one):
            self.assertIsNone(first_difference(a, b), f"state {a.step}")

    def test_a_run_of_many_states_is_not_taken_for_silence(self):
        world = self.launch(time__pace="none", control__on_silence="zero")
        ball = world.spawn(aurasim.Shape.sphere(0.5), position=(15, -15, 20), mass=4)
        world.step(ball.step - world.bodies().step)
        body = np.array([ball.body], np.uint64)
        world.control(velocities=(body, (0, 0, 0)), spins=(body, [(0, 0, 0)]))
        bodies = world.step(300)
        height = bodies.positions[bodies.ids == ball.body][0][2]
        self.assertGreater(height, 15, "it fell while nobody had let go of it")


class Live(WorldTest):
    def steer(self, world, states):
        """At the rate of the run, for so many states; returns the states that were named."""
        bodies = world.bodies()
        steered = bodies.ids[::2]
        end = bodies.step + states
        named = 0
        while (bodies := world.bodies()).step < end:
            world.control(forces=(steered, pushes(steered, bodies.step)))
            named += 1
            time.sleep(1 / 120)
        world.control(forces=(steered, None))
        return named

    def assert_same_again(self, live, regions):
        layout = {"regions__count": 1} if regions == 1 else {
            "regions": "{layout: grid, rows: 3, columns: 3, cell: [14, 14]}"}
        self.assert_same_from_record("demo", live, f"{regions} regions", **layout)

    def test_a_record_gives_the_same_bits_on_any_number_of_nodes(self):
        live = self.folder / "live"
        world = self.launch(paused=False, report=live, time__sync="deterministic")
        named = self.steer(world, 240)
        nodes = world.nodes()
        world.close()
        self.assertGreater(named, 20)
        self.assertGreater(sum(node.hand_offs_out for node in nodes), 0)
        self.assertGreater(len(setpoint_rows(live)), 20 * named)
        for regions in (1, 9):
            self.assert_same_again(live, regions)

    def test_a_death_changes_nothing_of_it(self):
        live = self.folder / "live"
        world = self.launch(paused=False, report=live, time__sync="deterministic")
        self.steer(world, 150)
        os.kill(world.nodes()[2].pid, signal.SIGKILL)
        generation = world.bodies().generation
        self.assertTrue(wait_until(lambda: world.bodies().generation > generation), "nobody has taken the region over")
        self.steer(world, 150)
        world.close()
        self.assert_same_again(live, 1)

    def test_what_names_no_state_is_never_late_and_what_names_a_past_one_is(self):
        world = self.launch(paused=False)
        body = world.bodies().ids[:1]
        for _ in range(20):
            world.control(forces=(body, [(0, 0, 1)]))
            time.sleep(0.02)
        self.assertTrue(wait_until(lambda: all(node.setpoints_heard >= 20 for node in world.nodes())))
        self.assertEqual({node.setpoints_late for node in world.nodes()}, {0})
        world.control(forces=(body, [(0, 0, 1)]), at=1)
        self.assertTrue(wait_until(lambda: {node.setpoints_late for node in world.nodes()} == {1}))

    def test_what_is_wrong_is_refused_by_name_and_harms_nothing(self):
        world = self.launch(paused=False)
        body = world.bodies().ids[:1]
        nan = float("nan")
        for what, forces in ((f"{nan}", (body, [(nan, 0, 0)])), ("1e\\+30", (body, [(1e30, 0, 0)])),
                             ("there is no body 999999", (np.array([999999], np.uint64), [(1, 0, 0)]))):
            with self.assertRaisesRegex(aurasim.Refused, what):
                world.control(forces=forces)
        with self.assertRaisesRegex(aurasim.Refused, "no joint is called 'elbow'"):
            world.drive(["elbow"], position=1)
        with self.assertRaisesRegex(aurasim.Refused, "there is no joint 7"):
            world.drive([7], position=1)
        world.control(forces=(body, [(9e8, 0, 0)]))  # sound, but more than the body can bear
        self.assertTrue(wait_until(lambda: sum(node.setpoints_refused for node in world.nodes()) > 0))
        self.assertTrue(np.abs(world.bodies().positions).max() < 1000)
        self.assertEqual({node.state for node in world.nodes()}, {"running"})

    def test_a_flood_is_counted_and_harms_nothing(self):
        world = self.launch(paused=False)
        body = world.bodies().ids[:1]
        end = time.monotonic() + 3
        while time.monotonic() < end:
            world.control(forces=(body, [(0, 0, 1)]))
        step = world.bodies().step
        self.assertTrue(wait_until(lambda: world.bodies().step > step + 60))
        self.assertEqual({node.state for node in world.nodes()}, {"running"})

    def test_when_its_program_dies_a_body_stops(self):
        world = self.launch(paused=False)
        ball = world.spawn(aurasim.Shape.sphere(0.5), position=(15, -15, 20), mass=4)
        self.assertTrue(wait_until(lambda: ball.body in world.bodies().ids))
        script = textwrap.dedent(f"""
            import numpy as np, time, aurasim
            world = aurasim.World.connect({str(launch_file('demo'))!r}, set={self.overrides()!r}, timeout=60)
            world.control(velocities=(np.array([{ball.body}], np.uint64), [(-1.5, 0, 0)]))
            print("steers", flush=True)
            time.sleep(600)
            """)
        steering = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
        try:
            self.assertEqual(steering.stdout.readline().strip(), "steers")

            def speed():
                bodies = world.bodies()
                return abs(bodies.linear_velocities[bodies.ids == ball.body][0][0])

            self.assertTrue(wait_until(lambda: speed() > 1))
            time.sleep(1.5)
            self.assertGreater(speed(), 1, "its program is still there")
        finally:
            steering.send_signal(signal.SIGKILL)
            steering.wait()
            steering.stdout.close()
        self.assertTrue(wait_until(lambda: speed() < 0.3))


if __name__ == "__main__":
    unittest.main(verbosity=2)
