"""Steering statics by a program: lifts and gates that are placed in a state, on any number of nodes, live and recorded."""

import time
import unittest

import numpy as np

import aurasim
from client_fixture import WorldTest, setpoint_rows, wait_until
from lockstep_test import first_difference

LIFT = "lift"  # of sorting_hall, where two regions meet


def height(step):
    """Of the lift, from state 60 on: up and down, 1 m in about a second."""
    return 1.35 + 0.5 * np.sin(0.05 * (step - 60))


class Placed(WorldTest):
    def top_of_lift(self, world):
        """Its height, and in which state."""
        hit = world.ray((0.12, 0.95, 20), (0.12, 0.95, 0))
        self.assertTrue(hit.hit)
        return hit.position[2], hit.step

    def states(self, **overrides):
        world = self.launch("sorting_hall", time__sync="deterministic", **overrides)
        states = [world.step(60)]
        for _ in range(120):
            step = states[-1].step
            self.assertEqual(world.place(LIFT, (0.12, 0, height(step + 1))), step + 1)
            states.append(world.step())
        top, at = self.top_of_lift(world)
        self.assertEqual(at, states[-1].step)
        self.assertAlmostEqual(top, height(at) + 0.15, places=6)
        nodes = world.nodes()
        world.close()
        return states, nodes

    def test_in_lock_step_it_is_there_in_the_next_state_and_on_four_nodes_as_on_one(self):
        four, nodes = self.states()
        one, _ = self.states(regions__count=1)
        self.assertEqual([node.setpoints_late for node in nodes], [0, 0, 0, 0])
        for a, b in zip(four, one):
            self.assertIsNone(first_difference(a, b), f"state {a.step}")

    def test_rays_of_each_state_see_it_where_it_was_in_that_state(self):
        world = self.launch("sorting_hall", time__sync="deterministic")
        down = aurasim.RayFan(np.array([[0.0, 0.0, -1.0]]), range=30, position=(0.12, 0.95, 20))
        observer = world.observe(fans=[down])
        world.step(60)
        seen = {}
        for _ in range(120):
            step = world.bodies().step
            world.place(LIFT, (0.12, 0, height(step + 1)))
            world.step()
            while step + 1 not in seen:
                state = observer.next()
                seen[state.step] = 20 - state.fans[0].distances[0]
                self.assertTrue(state.fans[0].complete)
        wrong = [step for step, top in seen.items() if step > 60 and abs(top - height(step) - 0.15) > 1e-6]
        self.assertEqual(wrong, [])

    def test_live_it_is_where_it_was_to_be_and_a_record_gives_the_same_bits(self):
        live = self.folder / "live"
        world = self.launch("sorting_hall", paused=False, report=live, time__sync="deterministic")
        ahead = world.info().lookahead + 2
        end = world.bodies().step + 240
        placed = set()
        while (step := world.bodies().step) < end:
            if step + ahead not in placed:
                world.place(LIFT, (0.12, 0, height(step + ahead)), at=step + ahead)
                placed.add(step + ahead)
            time.sleep(1 / 240)
        self.assertTrue(wait_until(lambda: abs(self.top_of_lift(world)[0] - height(max(placed)) - 0.15) < 1e-6))
        world.close()
        rows = [row for row in setpoint_rows(live) if row["what"] == "move"]
        self.assertEqual({row["region"] for row in rows}, {"0"})
        self.assertEqual(len(rows), len(placed))
        for regions in (1, 4):
            self.assert_same_from_record("sorting_hall", live, f"{regions} regions", regions__count=regions)

    def test_without_a_state_it_goes_as_soon_as_all_can_know(self):
        world = self.launch("sorting_hall", paused=False)
        self.assertEqual(world.place(LIFT, (0.12, 0, 4), states=30), 0)
        self.assertTrue(wait_until(lambda: abs(self.top_of_lift(world)[0] - 4.15) < 1e-6))
        self.assertEqual({node.setpoints_late for node in world.nodes()}, {0})

    def test_what_is_wrong_is_refused_by_name(self):
        world = self.launch("sorting_hall", paused=False)
        for what, fixed, place in (("no such gate", "no such gate", (0, 0, 0)), ("a plane cannot move", "ground", (0, 0, 0)),
                                   ("three finite numbers", LIFT, (float("nan"), 0, 0)),
                                   ("too far out", LIFT, (1e30, 0, 0))):
            with self.assertRaisesRegex(aurasim.Refused, what):
                world.place(fixed, place)
        with self.assertRaisesRegex(aurasim.Refused, "found 0 states"):
            world.place(LIFT, (0, 0, 1), states=0)
        world.place(9999, (0, 0, 1))  # a client's, for all that the agent knows
        self.assertTrue(wait_until(lambda: all(node.setpoints_refused == 1 for node in world.nodes())))

    def test_another_solver_says_that_it_cannot(self):
        world = self.launch("demo", physics__solver="sequential_impulse")
        with self.assertRaisesRegex(aurasim.Refused, "cannot move statics"):
            world.place(1, (0, 0, 1))


if __name__ == "__main__":
    unittest.main(verbosity=2)
