"""A car and a quadruped, steered state by state along ways that lead through all regions of a 3 x 3 grid of cells of 4 m.

    python3 robots.py LAUNCH_FILE [STATES=1800] [REPORT]

The launch file's scene has a car with wheel joints car/turn_fl, fr, rl, rr (skid steering) and a quadruped with joints
dog/front_left_hip_joint ... (a trot: its legs are held by drives, and a force on its trunk steers). docs/client.md.
"""

import math
import sys

import numpy as np

import aurasim

LEGS = [f"{end}_{side}" for end in ("front", "hind") for side in ("left", "right")]


def yaw_of(q):
    w, x, y, z = q
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def up_of(q):
    """The body's z axis."""
    w, x, y, z = q
    return np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])


class Way:
    """From point to point; the next once it is near."""

    def __init__(self, points, near):
        self.points, self.near, self.at = [np.array(p, float) for p in points], near, 0

    def target(self, p):
        while self.at + 1 < len(self.points) and np.linalg.norm(self.points[self.at] - p) < self.near:
            self.at += 1
        return self.points[self.at]

    def error(self, p, yaw):
        """Distance, and by how much it has to turn."""
        d = self.target(p) - p
        turn = math.atan2(d[1], d[0]) - yaw
        return float(np.linalg.norm(d)), math.atan2(math.sin(turn), math.cos(turn))


class Car:
    RADIUS, TRACK = 0.3, 1.8  # m

    def __init__(self, chassis, way):
        self.chassis, self.way = chassis, way

    def steer(self, world, bodies):
        i = int(np.flatnonzero(bodies.ids == self.chassis)[0])
        distance, turn = self.way.error(bodies.positions[i][:2], yaw_of(bodies.rotations[i].astype(float)))
        v = min(3.5, 1.5 * distance) * max(0.15, math.cos(turn))
        w = float(np.clip(3.0 * turn, -2.5, 2.5))
        left, right = (v - w * self.TRACK) / self.RADIUS, (v + w * self.TRACK) / self.RADIUS
        world.drive([f"car/turn_{wheel}" for wheel in ("fl", "fr", "rl", "rr")], speed=[left, right, left, right],
                    damping=400, max_effort=900)


class Dog:
    def __init__(self, trunk, way, mass):
        self.trunk, self.way, self.mass = trunk, way, mass

    def steer(self, world, bodies):
        i = int(np.flatnonzero(bodies.ids == self.trunk)[0])
        self.hold_legs(world, bodies.step)
        p, v, w = bodies.positions[i], bodies.linear_velocities[i], bodies.angular_velocities[i]
        q = bodies.rotations[i].astype(float)
        distance, turn = self.way.error(p[:2], yaw_of(q))
        wish = 1.1 * (self.way.target(p[:2]) - p[:2]) / max(distance, 1e-9)
        force = np.append(np.clip(6 * self.mass * (wish - v[:2]), -140, 140), 0)
        upright = 60 * np.cross(up_of(q), (0, 0, 1)) - 6 * w
        upright[2] = 8 * turn - 2 * w[2]
        world.control(forces=([self.trunk], [force]), torques=([self.trunk], [np.clip(upright, -40, 40)]))

    def hold_legs(self, world, step):
        """Two legs at a time, crosswise."""
        names, positions = [], []
        for number, leg in enumerate(LEGS):
            phase = 2 * math.pi * (step / 24 + (0.5 if number in (1, 2) else 0))
            lift = max(0.0, math.sin(phase))
            names += [f"dog/{leg}_hip_joint", f"dog/{leg}_thigh_joint", f"dog/{leg}_shank_joint"]
            positions += [0, 0.25 * math.cos(phase) + 0.2 * lift, -0.4 * lift]
        world.drive(names, position=positions, stiffness=120, damping=4, max_effort=40)


def steer(world, states):
    """In lock-step; returns the regions that each of the two has been in."""
    bodies = world.bodies()
    near = lambda x, y: int(bodies.ids[np.argmin(np.linalg.norm(bodies.positions[:, :2] - (x, y), axis=1))])
    car = Car(near(-6, -6), Way([(0, -6), (6, -6), (6, 0), (6, 6), (0, 6), (-6, 6), (-6, 0), (0, 0)], 1.5))
    dog = Dog(near(0, 0), Way([(2.7, 0), (2.7, 2.7), (0, 2.7), (-2.7, 2.7), (-2.7, 0), (-2.7, -2.7), (0, -2.7),
                               (2.7, -2.7)], 0.4), mass=20)
    seen = {"car": set(), "dog": set()}
    for _ in range(states):
        for name, robot, body in (("car", car, car.chassis), ("dog", dog, dog.trunk)):
            seen[name].add(int(bodies.regions[bodies.ids == body][0]))
            robot.steer(world, bodies)
        bodies = world.step()
    return seen


def main():
    states = int(sys.argv[2]) if len(sys.argv) > 2 else 1800
    report = sys.argv[3] if len(sys.argv) > 3 else None
    with aurasim.World.launch(sys.argv[1], paused=True, report=report) as world:
        for name, regions in steer(world, states).items():
            print(f"the {name} was in regions {sorted(regions)}")


if __name__ == "__main__":
    main()
