"""What a program senses: only what it has asked for, state by state, and the same on four nodes as on one."""

import os
import signal
import time
import unittest

import numpy as np

import aurasim
from client_fixture import GENEROUS_S, WorldTest, wait_until

COLUMNS = ("ids", "positions", "rotations", "linear_velocities", "angular_velocities", "prototypes", "asleep")


def same_bodies(a, b):
    return [name for name in COLUMNS if getattr(a, name).tobytes() != getattr(b, name).tobytes()]


class Sensing(WorldTest):
    STEPS = 120

    def sensed(self, name="corner_stacks", ball=True, interest=None, **overrides):
        """Of every state of a run that is stepped."""
        world = self.launch(name, time__sync="deterministic", time__pace="none", **overrides)
        first = world.bodies()
        if ball:
            world.spawn(aurasim.Shape.sphere(0.4), position=(0.3, -0.2, 7), linear_velocity=(0, 0, -4), mass=15, at=30)
        with world.observe(**interest(world, first)) as observer:
            states = {}
            for _ in range(self.STEPS // 20):
                world.step(20)
                while not states or max(states) < world.bodies().step:
                    state = observer.next(timeout=GENEROUS_S)
                    states[state.step] = state
        nodes = world.nodes()
        world.close()
        return states, sum(node.hand_offs_out for node in nodes)

    def compare(self, interest, check, **overrides):
        four, hand_offs = self.sensed(interest=interest, **overrides)
        one, _ = self.sensed(interest=interest, regions__count=1, **overrides)
        self.assertGreater(hand_offs, 0, "or this test proves nothing")
        both = sorted(set(four) & set(one))
        self.assertEqual(both, list(range(self.STEPS + 1)), "no state is left out")
        for step in both:
            if four[step].complete:
                check(four[step], one[step])
        complete = sum(four[step].complete for step in both)
        print(f"{len(both)} states, {complete} of them complete, {hand_offs} hand-offs")
        self.assertGreater(complete, 0.9 * len(both))
        return four, one

    def test_bodies_and_contacts_are_those_of_one_node(self):
        rows = [0]

        def check(a, b):
            self.assertEqual(same_bodies(a.bodies, b.bodies), [], f"state {a.step}")
            for name in ("a", "b", "positions", "normals", "impulses"):
                self.assertEqual(getattr(a.contacts, name).tobytes(), getattr(b.contacts, name).tobytes(),
                                 f"state {a.step}: contacts, {name}")
            rows[0] += len(a.contacts)

        for lookahead in (1, 2):
            self.compare(lambda world, first: {"all": True, "contacts": True}, check, time__lookahead=lookahead)
        self.assertGreater(rows[0], 1000)

    def test_in_lock_step_nobody_is_missing(self):
        for lookahead in (2, 3):
            world = self.launch("corner_stacks", time__sync="deterministic", time__pace="none",
                                time__lookahead=lookahead)
            with world.observe(all=True, contacts=True) as observer:
                self.assertEqual(observer.next().step, 0)
                for step in range(1, self.STEPS + 1):
                    self.assertEqual(world.step().step, step)
                    state = observer.next(timeout=GENEROUS_S)
                    self.assertEqual((state.step, state.missing.tolist()), (step, []))
            self.assertGreater(sum(node.hand_offs_out for node in world.nodes()), 0, "or this test proves nothing")
            world.close()

    def test_a_lidar_over_four_regions_sees_what_it_sees_on_one_node(self):
        directions = aurasim.RayFan.grid(-np.pi, np.pi, 100, -0.4, 0.3, 10)
        self.assertEqual(directions.shape, (1000, 3))
        hits = [0]

        def interest(world, first):
            on_a_body = int(first.ids[len(first) // 2])
            return {"fans": [aurasim.RayFan(directions, 40, position=(0, 0, 2.5), every=3),
                             aurasim.RayFan(directions, 20, body=on_a_body, position=(0, 0, 1))]}

        def check(a, b):
            self.assertEqual(len(a.bodies), 0, "nobody has asked for bodies")
            self.assertEqual(a.fans[0].cast, a.step % 3 == 0)
            for mine, other in zip(a.fans, b.fans):
                if not (mine.complete and other.complete):
                    continue
                for name in ("objects", "distances", "positions", "normals"):
                    self.assertEqual(getattr(mine, name).tobytes(), getattr(other, name).tobytes(),
                                     f"state {a.step}: {name}")
                hits[0] += int((mine.objects >= 0).sum())

        four, one = self.compare(interest, check, time__lookahead=2)
        for states in (four, one):
            cast = [state.fans[0] for state in states.values() if state.fans[0].cast]
            self.assertGreater(sum(fan.complete for fan in cast), 0.9 * len(cast))
            self.assertGreater(sum(state.fans[1].complete for state in states.values()), 0.9 * len(states))
        self.assertGreater(hits[0], 1000)
        print(f"{hits[0]} hits of bodies, all bits equal")

    def test_triggers_say_who_is_in_on_four_nodes_as_on_one(self):
        events = [0]

        def interest(world, first):
            return {"triggers": [aurasim.Trigger.box((12, 12, 6), position=(0, 0, 3)),
                                 aurasim.Trigger.ball(6, body=int(first.ids[0]))]}

        def check(a, b):
            for mine, other in zip(a.triggers, b.triggers):
                if mine.complete and other.complete:
                    self.assertEqual(mine.inside.tolist(), other.inside.tolist(), f"state {a.step}")
                    events[0] += len(mine.inside)

        self.compare(interest, check, time__lookahead=1)
        self.assertGreater(events[0], 0)

    def test_joints_stand_as_on_one_node(self):
        rows = [0]

        def check(a, b):
            for name in ("ids", "positions", "speeds"):
                self.assertEqual(getattr(a.joints, name).tobytes(), getattr(b.joints, name).tobytes(),
                                 f"state {a.step}: {name}")
            rows[0] += len(a.joints)

        self.compare(lambda world, first: {"all": True, "joints": True}, check, name="vehicle_tour", ball=False,
                     time__lookahead=1)
        self.assertGreater(rows[0], 0)


class Asking(WorldTest):
    def test_only_what_is_asked_for_comes(self):
        world = self.launch()
        bodies = world.bodies()
        wanted = sorted(int(i) for i in bodies.ids[::7])
        box = ((-5, -5, 0), (5, 5, 2))
        with world.observe(bodies=wanted) as by_id, world.observe(boxes=[box]) as by_box, \
                world.observe(patterns=["*"], every=10) as by_pattern:
            self.assertEqual(by_id.next().bodies.ids.tolist(), wanted)
            inside = ((bodies.positions >= box[0]) & (bodies.positions <= box[1])).all(axis=1)
            self.assertEqual(by_box.next().bodies.ids.tolist(), bodies.ids[inside].tolist())
            self.assertEqual(by_pattern.next().bodies.ids.tolist(), bodies.ids.tolist())

    def test_what_makes_no_sense_is_refused_by_name(self):
        world = self.launch()
        nan = float("nan")
        for name, wanted in [
                ("interest", {}),
                ("every", {"all": True, "every": 10_000_000}),
                ("patterns", {"patterns": ["unicorn*"]}),
                ("low", {"boxes": [((nan, 0, 0), (1, 1, 1))]}),
                ("boxes", {"boxes": [((1, 0, 0), (0, 1, 1))]}),
                ("boxes", {"boxes": [((0, 0, 0), (1, 1, 1))] * 1000}),
                ("range", {"fans": [aurasim.RayFan([[1, 0, 0]], 1e30)]}),
                ("directions", {"fans": [aurasim.RayFan([[0, 0, 0]], 10)]}),
                ("fans", {"fans": [aurasim.RayFan([[1, 0, 0]], 10)] * 100}),
                ("size", {"triggers": [aurasim.Trigger.box((0, 1, 1))]})]:
            with self.subTest(name), self.assertRaisesRegex(aurasim.Refused, name):
                world.observe(**wanted)
        self.assertTrue(world.step().exact)

    def test_a_running_world_is_seen_at_the_step_rate(self):
        world = self.launch(paused=False)
        with world.observe(all=True) as observer:
            first = observer.next()
            begin = time.monotonic()
            states = [observer.next() for _ in range(180)]
            took = time.monotonic() - begin
            behind = max(node.step for node in world.nodes()) - states[-1].step
        steps = [state.step for state in states]
        lost = steps[-1] - first.step - len(states)
        late = sum(not state.complete for state in states)
        print(f"180 states in {took:.2f} s: {180 / took:.0f} a second; {lost} lost, {late} incomplete, "
              f"the run is {behind} ahead")
        self.assertEqual(steps, sorted(steps))
        self.assertLess(behind, 90, "an observer that takes half of the states would be 180 behind")
        self.assertLess(late, 18)

    def test_a_client_that_is_killed_leaves_nothing(self):
        world = self.launch(paused=False)
        other = self.connect()
        observer = other.observe(all=True, contacts=True)
        observer.next()
        os.kill(other.agent_pid, signal.SIGKILL)
        with self.assertRaises(aurasim.Ended):
            while True:
                observer.next()
        step = world.bodies().step
        self.assertTrue(wait_until(lambda: world.bodies().step > step + 60))
        self.assertTrue(all(node.state == "running" for node in world.nodes()))

    def test_an_observer_is_closed_with_its_world(self):
        world = self.launch()
        observer = world.observe(all=True)
        observer.next()
        observer.close()
        with self.assertRaises(aurasim.Ended):
            observer.next()
        observer = world.observe(all=True)
        world.close()
        with self.assertRaises(aurasim.Ended):
            observer.next()


class LockStep(WorldTest):
    def test_a_state_costs_a_few_milliseconds(self):
        world = self.launch("tug_of_war", time__pace="none", time__lookahead=1)
        world.step()
        times = []
        for _ in range(200):
            begin = time.perf_counter()
            self.assertTrue(world.step().exact)
            times.append(1e3 * (time.perf_counter() - begin))
        print(f"a state in lock-step: p50 {np.percentile(times, 50):.1f} ms, p99 {np.percentile(times, 99):.1f} ms")


if __name__ == "__main__":
    unittest.main(verbosity=2)
