"""What is left of a run when a client's program dies."""

import subprocess
import sys
import textwrap
import time
import unittest

from client_fixture import GENEROUS_S, WorldTest, command_line, launch_file, processes_of_domain, wait_until


class KilledClients(WorldTest):
    def start_client(self, body):
        """A program that prints a line, and then sleeps."""
        script = textwrap.dedent(body).format(file=str(launch_file("demo")), overrides=self.overrides())
        client = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
        self.addCleanup(client.stdout.close)
        self.addCleanup(client.wait)
        self.addCleanup(client.kill)
        line = client.stdout.readline().split()
        self.assertTrue(line)
        return client, [int(word) for word in line]

    def test_a_run_ends_with_the_program_that_has_launched_it(self):
        client, (agent,) = self.start_client("""
            import aurasim, time
            world = aurasim.World.launch({file!r}, set={overrides!r}, timeout=90)
            print(world.agent_pid, flush=True)
            time.sleep(600)
        """)
        self.assertGreaterEqual(len(processes_of_domain(self.domain.number)), 5)
        client.kill()
        self.assertTrue(wait_until(lambda: not command_line(agent)))
        self.assertTrue(wait_until(lambda: not processes_of_domain(self.domain.number)))

    def test_in_the_middle_of_a_step_too(self):
        client, (agent,) = self.start_client("""
            import aurasim, os, time
            world = aurasim.World.launch({file!r}, set={overrides!r}, timeout=90, paused=True)
            print(world.agent_pid, flush=True)
            world.step(6000)
        """)
        client.kill()
        self.assertTrue(wait_until(lambda: not command_line(agent)))
        self.assertTrue(wait_until(lambda: not processes_of_domain(self.domain.number)))

    def test_a_run_that_others_have_started_goes_on(self):
        world = self.launch(paused=False)
        client, (agent,) = self.start_client("""
            import aurasim, time
            world = aurasim.World.connect({file!r}, set={overrides!r}, timeout=90)
            world.set_rate(1)
            print(world.agent_pid, flush=True)
            time.sleep(600)
        """)
        before = world.bodies().step
        client.kill()
        self.assertTrue(wait_until(lambda: not command_line(agent)))
        self.assertTrue(wait_until(lambda: world.bodies().step > before + 120))
        self.assertEqual({node.state for node in world.nodes()}, {"running"})
        self.assertEqual({node.generation for node in world.nodes()}, {0}, "nobody has gone back")

    def test_a_program_that_just_ends_leaves_nothing(self):
        client, (agent,) = self.start_client("""
            import aurasim
            world = aurasim.World.launch({file!r}, set={overrides!r}, timeout=90)
            print(world.agent_pid, flush=True)
        """)
        self.assertEqual(client.wait(GENEROUS_S), 0)
        self.assertFalse(command_line(agent))
        self.assertEqual(processes_of_domain(self.domain.number), [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
