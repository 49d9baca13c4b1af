#!/usr/bin/env python3
"""A ball falls onto the demo's stacks, on four nodes, state by state; and is thrown up again.

    python3 lockstep.py [DDS_DOMAIN]
"""

import sys

import numpy as np

import aurasim


def main() -> None:
    domain = int(sys.argv[1]) if len(sys.argv) > 1 else 0
    with aurasim.World.launch("demo", set={"dds.domain": domain}, paused=True) as world:
        info = world.info()
        print(f"{info.scene}: {len(info.regions)} regions, {len(world.bodies())} bodies")

        ball = world.spawn(aurasim.Shape.sphere(0.5), position=(0.5, 0.5, 6), mass=20)
        bodies = world.step(ball.step - world.bodies().step)  # the first state that it is in
        while bodies.step < ball.step + 60:
            bodies = world.step()
            row = int(np.flatnonzero(bodies.ids == ball.body)[0])
            if bodies.step % 10 == 0:
                x, y, z = bodies.positions[row]
                print(f"state {bodies.step}: region {bodies.regions[row]}, x {x:.2f} y {y:.2f} z {z:.2f}")

        thrown = world.set_velocity(ball.body, (0, 0, 8))
        bodies = world.step(thrown.step - bodies.step)
        row = int(np.flatnonzero(bodies.ids == ball.body)[0])
        print(f"state {bodies.step}: thrown up at {bodies.linear_velocities[row, 2]:.1f} m/s")


if __name__ == "__main__":
    main()
