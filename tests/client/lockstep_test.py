"""Lock-step: what a program sees and does state by state."""

import unittest

import numpy as np

import aurasim
from client_fixture import WorldTest

COLUMNS = ("ids", "positions", "rotations", "linear_velocities", "angular_velocities", "prototypes", "asleep")


def first_difference(a, b):
    """The name of a column that differs, bit by bit; None: there is none."""
    if a.step != b.step:
        return "step"
    for name in COLUMNS:
        if getattr(a, name).tobytes() != getattr(b, name).tobytes():
            return name
    return None


class LockStep(WorldTest):
    STEPS = 150

    def states(self, count=1, **overrides):
        """Of all that is done here: the scene, a ball thrown at it, a push. `count` of them are computed at a time."""
        world = self.launch(time__sync="deterministic", **overrides)
        states = [world.bodies()]
        self.assertEqual(states[0].step, 0)
        ball = world.spawn(aurasim.Shape.sphere(0.4), position=(0.3, -0.2, 7), linear_velocity=(0, 0, -4), mass=15,
                           at=40)
        world.impulse(int(states[0].ids[0]), (40, 30, 0), at=60)
        self.assertEqual(ball.step, 40)
        while states[-1].step < self.STEPS:
            states.append(world.step(count))
        hand_offs = sum(node.hand_offs_out for node in world.nodes())
        world.close()
        self.assertEqual({state.step for state in states if ball.body in state.ids},
                         {state.step for state in states if state.step >= 40})
        return states, hand_offs

    def test_on_four_nodes_every_state_is_that_of_one(self):
        four, hand_offs = self.states(time__lookahead=1)
        one, _ = self.states(time__lookahead=1, regions__count=1)
        self.assertGreater(hand_offs, 0, "or this test proves nothing")
        self.assertGreater(len(np.unique(four[0].regions)), 1)
        self.assertEqual([state.step for state in four], list(range(self.STEPS + 1)))
        self.assertTrue(all(state.exact for state in four))
        for a, b in zip(four, one):
            self.assertIsNone(first_difference(a, b), f"state {a.step}")
        print(f"{self.STEPS + 1} states of {len(four[-1])} bodies, {hand_offs} hand-offs, all bits equal")

    def test_with_more_lookahead_every_row_is_that_of_one_node_too(self):
        for lookahead in (2, 3):
            one, _ = self.states(time__lookahead=lookahead, regions__count=1)
            for count in (1, 3):
                four, hand_offs = self.states(time__lookahead=lookahead, count=count)
                self.assertGreater(hand_offs, 0)
                self.assertTrue(all(state.exact for state in four))
                for a in four:
                    self.assertIsNone(first_difference(a, one[a.step]), f"state {a.step}, lookahead {lookahead}")
                under_way = sum(int(state.under_way.sum()) for state in four)
                self.assertGreater(under_way, hand_offs / count, "or this test proves nothing")
                print(f"lookahead {lookahead}, {count} states at a time: {under_way} rows under way of "
                      f"{sum(len(state) for state in four)}, all bits equal")


class Acts(WorldTest):
    def row(self, bodies, body):
        rows = np.flatnonzero(bodies.ids == body)
        return int(rows[0]) if len(rows) else None

    def step_until_before(self, world, step):
        """The last state without the effect."""
        return world.step(step - 1 - world.bodies().step)

    def test_a_new_body_is_there_in_the_state_that_is_said_and_not_before(self):
        world = self.launch()
        done = world.spawn(aurasim.Shape.box((0.6, 0.6, 0.6)), position=(12, 12, 9), mass=2)
        self.assertIsNotNone(done.body)
        self.assertIsNone(self.row(self.step_until_before(world, done.step), done.body))
        bodies = world.step()
        self.assertEqual(bodies.step, done.step)
        row = self.row(bodies, done.body)
        self.assertIsNotNone(row)
        np.testing.assert_allclose(bodies.positions[row], (12, 12, 9), atol=0.01)

    def test_velocities_and_impulses_show_in_the_state_that_is_said_and_not_before(self):
        world = self.launch()
        ball = world.spawn(aurasim.Shape.sphere(0.5), position=(15, -15, 20), mass=4)
        world.step(ball.step - world.bodies().step)
        for act, value in ((world.set_velocity, (3, 0, 0)), (world.impulse, (0, 8, 0))):
            done = act(ball.body, value)
            before = self.step_until_before(world, done.step)
            v_before = before.linear_velocities[self.row(before, ball.body)]
            after = world.step()
            self.assertEqual(after.step, done.step)
            v_after = after.linear_velocities[self.row(after, ball.body)]
            if act == world.set_velocity:
                self.assertAlmostEqual(v_before[0], 0, delta=1e-6)
                self.assertAlmostEqual(v_after[0], 3, delta=0.01)
            else:
                self.assertAlmostEqual(v_before[1], 0, delta=1e-6)
                self.assertAlmostEqual(v_after[1], 8 / 4, delta=0.01)

    def test_a_removed_body_is_gone_in_the_state_that_is_said_and_not_before(self):
        world = self.launch()
        body = int(world.bodies().ids[3])
        done = world.remove_body(body)
        self.assertIsNotNone(self.row(self.step_until_before(world, done.step), body))
        self.assertIsNone(self.row(world.step(), body))

    def test_many_at_once(self):
        world = self.launch()
        ids = world.bodies().ids[:80]
        done = world.set_velocities(ids, np.tile((0.0, 0.0, 5.0), (len(ids), 1)))
        self.assertEqual(len(done), len(ids))
        self.assertEqual(len({one.step for one in done}), 1)
        after = world.step(done[0].step - world.bodies().step)
        self.assertGreater(np.median(after.linear_velocities[np.isin(after.ids, ids), 2]), 4)


if __name__ == "__main__":
    unittest.main(verbosity=2)
