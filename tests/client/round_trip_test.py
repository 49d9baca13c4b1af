"""How long words of a program take: none waits for a period of DDS or of a node, whatever the machine does besides."""

import time
import unittest

import aurasim
from client_fixture import GENEROUS_S, WorldTest, wait_until

PERIOD_S = 0.020  # of a heartbeat of topics control and command, and of the rounds of a node that stands


def seconds_of(act, times):
    """Of each of so many calls, ascending."""
    taken = []
    for _ in range(times):
        begin = time.monotonic()
        act()
        taken.append(time.monotonic() - begin)
    return sorted(taken)


class OneRoundTrip(WorldTest):
    """The fastest of many calls says what a call waits for; all the others say how busy the machine is."""

    def test_a_step_does_not_wait_for_a_heartbeat_once_the_program_steers(self):
        world = self.launch(time__pace="none")
        steered = world.bodies().ids[:10]

        def tick():
            world.control(forces=(steered, (0, 0, 1)))
            world.step()

        tick()
        self.assertLess(seconds_of(tick, 200)[10], PERIOD_S / 2)
        self.assertEqual({node.setpoints_late + node.setpoints_refused for node in world.nodes()}, {0})

    def test_a_new_body_does_not_wait_for_the_next_round_of_a_node_that_stands(self):
        world = self.launch()

        def spawn():
            world.spawn(aurasim.Shape.sphere(0.1), position=(15, -15, 20), mass=1)

        spawn()
        self.assertLess(seconds_of(spawn, 200)[50], PERIOD_S / 2)

    def test_an_observer_of_a_standing_run_is_told_at_once(self):
        world = self.launch(regions__count=1)

        def observe():
            with world.observe(every=0, all=True) as observer:
                observer.next()

        self.assertLess(seconds_of(observe, 20)[0], PERIOD_S)


class OnABadNetwork(WorldTest):
    def test_no_state_of_a_step_is_computed_without_what_was_said_before_it(self):
        world = self.launch(time__pace="none", time__lookahead=1, dds__impair__loss=0.1)
        steered = world.bodies().ids[::2]
        for _ in range(100):
            step = world.bodies().step
            self.assertEqual(world.control(forces=(steered, (0, 0, 0.1 * step))), step + 1)
            self.assertEqual(world.step().step, step + 1)
        self.assertEqual([node.setpoints_late + node.setpoints_refused for node in world.nodes()], [0, 0, 0, 0])


class AfterAChange(WorldTest):
    """The state in which a run stands is told once, and may come before the agent has heard of the new scene."""

    def test_the_bodies_of_a_new_scene_are_there_at_once(self):
        world = self.launch(regions__count=1)
        taken = []
        for name in ("tower", "corner_stacks") * 8:
            world.set_scene(name)
            begin = time.monotonic()
            bodies = world.bodies()
            taken.append(time.monotonic() - begin)
            self.assertTrue(bodies.exact)
            self.assertEqual(bodies.step, 0)
        self.assertLess(max(taken), 2.5, [round(seconds, 2) for seconds in taken])


class TooSlow(WorldTest):
    """10,000 bodies, as fast as nodes compute them: some 850 kB for each state, far more than a program takes."""

    SIDE = 100

    def launch_field(self, regions):
        rows = "\n".join(f"  - {{prototype: ball, position: [{1.5 * (i % self.SIDE - 49.5)}, {1.5 * (i // self.SIDE - 49.5)}, 0.4]}}"
                         for i in range(self.SIDE ** 2))
        (self.folder / "field.yaml").write_text(f"""name: field
shapes: {{ball: {{sphere: {{radius: 0.4}}}}}}
prototypes: {{ball: {{shape: ball, mass: 1}}}}
statics: [{{name: ground, shape: {{plane: {{}}}}}}]
bodies:
{rows}
""")
        file = self.folder / "launch.yaml"
        file.write_text(f"scene: field.yaml\nregions: {regions}\ntime: {{sync: deterministic, pace: none}}\n")
        return self.keep(aurasim.World.launch(file, set=self.overrides(), paused=True, timeout=GENEROUS_S))

    def assert_goes_on_being_told(self, regions):
        world = self.launch_field(regions)
        with world.observe(all=True) as observer:
            world.resume()
            # By then everybody sleeps, and states are computed many times faster than they are sent.
            self.assertTrue(wait_until(lambda: observer.next().step > 200))
            end = time.monotonic() + 12
            states = []
            while time.monotonic() < end:
                states.append(observer.next())
        steps = [state.step for state in states]
        print(f"{regions}: {len(states)} states of {steps[-1] - steps[0]} in 12 s, "
              f"{sum(state.complete for state in states)} complete")
        self.assertGreater(sum(state.complete for state in states), 8, "it was 2, and it is 100 where there is room")
        self.assertEqual(steps, sorted(set(steps)))
        self.assertEqual({len(state.bodies) for state in states if state.complete}, {self.SIDE ** 2})
        for before, state in zip(states, states[1:]):
            self.assertEqual(state.skipped, state.step - before.step - 1)

    def test_an_observer_of_one_node_goes_on_being_told_states(self):
        self.assert_goes_on_being_told("{count: 1}")

    def test_an_observer_of_four_nodes_goes_on_being_told_whole_states(self):
        self.assert_goes_on_being_told("{layout: grid, rows: 2, columns: 2, cell: [80, 80]}")


if __name__ == "__main__":
    unittest.main(verbosity=2)
