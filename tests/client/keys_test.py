"""Clients of a run with keys: an operator senses and steers as in an open run, nobody else joins."""

import os
import subprocess
import unittest

import numpy as np

import aurasim
from client_fixture import GENEROUS_S, WorldTest, launch_file

PROGRAM = os.environ["AURASIM_PROGRAM"]


class WithKeys(WorldTest):
    def setUp(self):
        super().setUp()
        self.keys = self.folder / "keys"
        for words in (("init", self.keys), ("add-region", self.keys, "0-3"),
                      ("add", self.keys, "desk", "--role", "operator"),
                      ("add", self.keys, "arm", "--role", "operator"), ("add", self.keys, "hall", "--role", "viewer")):
            subprocess.run([PROGRAM, "keys", *map(str, words)], check=True, capture_output=True, timeout=GENEROUS_S)

    def launch_closed(self, **more):
        return self.launch(dds__security=self.keys, **more)

    def test_an_operator_senses_and_steers_in_lock_step(self):
        world = self.launch_closed()
        self.assertEqual(world.info().key, "arm", "the first of the operators")
        ball = world.spawn(aurasim.Shape.sphere(0.5), position=(15, -15, 20), mass=4)
        world.step(ball.step - world.bodies().step)
        body = ball.body
        with world.observe(bodies=[body]) as observer:
            world.control(velocities=([body], (3, 0, 0)))
            stood = world.step()
            seen = observer.next(GENEROUS_S)
            if seen.step < stood.step:  # as it stood when it began to look
                seen = observer.next(GENEROUS_S)
        self.assertEqual(seen.step, stood.step)
        self.assertEqual(seen.bodies.ids.tolist(), [body])
        self.assertAlmostEqual(float(stood.linear_velocities[stood.ids == body][0][0]), 3, delta=0.01)
        self.assertGreaterEqual(sum(node.setpoints_heard for node in world.nodes()), 1)

    def test_two_operators_by_name_see_the_same_world(self):
        first = self.launch_closed()
        second = self.keep(aurasim.World.connect(launch_file("demo"), set=self.overrides(dds__security=self.keys),
                                                 key="desk", timeout=GENEROUS_S))
        self.assertEqual(second.info().key, "desk")
        stood = first.step(5)
        same = second.bodies()
        self.assertEqual(same.step, stood.step)
        np.testing.assert_array_equal(same.positions, stood.positions)

    def test_whoever_may_not_steer_is_refused_with_words(self):
        self.launch_closed()
        for key, why in (("hall", "operator"), ("nobody", "nobody")):
            with self.assertRaisesRegex(aurasim.Error, why):
                aurasim.World.connect(launch_file("demo"), set=self.overrides(dds__security=self.keys), key=key,
                                      timeout=GENEROUS_S)

    def test_who_has_no_keys_meets_nobody(self):
        self.launch_closed()
        with self.assertRaises(aurasim.Error):
            aurasim.World.connect(launch_file("demo"), set=self.overrides(), timeout=5)


if __name__ == "__main__":
    unittest.main()
