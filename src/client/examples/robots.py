"""A car and a quadruped, steered state by state along ways that lead through all regions of a 3 x 3 grid of cells of 4 m.

    python3 robots.py LAUNCH_FILE [STATES=1800] [REPORT]

The launch file's scene has a car with wheel joints car/turn_fl, fr, rl, rr (skid steering) and a quadruped with joints
dog/front_left_hip_joint ... (which trots). docs/client.md.
"""

import math
import sys

import numpy as np

import aurasim

LEGS = [f"{end}_{side}" for end in ("front", "hind") for side in ("left", "right")]


def yaw_of(q):
    w, x, y, z = q
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


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
    """A trot: two legs at a time, crosswise, stand and push the trunk on while the others swing ahead. A foot is put down half of
    the way ahead that its leg will stand, and farther where the trunk is faster than it should be (Raibert, Legged Robots
    That Balance, 1986). Nothing but the drives of its twelve joints moves it."""

    PERIOD = 24  # states
    HEIGHT, LIFT = 0.33, 0.07  # m: of the hips, of a swinging foot
    THIGH, SHANK, OUTWARD = 0.22, 0.20, 0.08  # m; each thigh hangs so far outside of its hip
    HIPS = np.array([[0.25, 0.12], [0.25, -0.12], [-0.25, 0.12], [-0.25, -0.12]])  # in the trunk, as LEGS
    REST = np.array([0.0, 0.6, -1.1])  # rad: how the joints of a leg stand where they read 0
    SPEED, TURN = 1.15, 1.8  # m/s, rad/s: at most

    def __init__(self, trunk, way):
        self.trunk, self.way = trunk, way
        self.side = np.sign(self.HIPS[:, 1])
        self.feet = self.HIPS + np.outer(self.side, (0, self.OUTWARD))  # in the trunk's heading, on the ground
        self.lifted = self.feet.copy()

    def steer(self, world, bodies):
        i = int(np.flatnonzero(bodies.ids == self.trunk)[0])
        q = bodies.rotations[i].astype(float)
        yaw = yaw_of(q)
        heading = np.array([[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]])
        v = heading @ bodies.linear_velocities[i][:2]
        distance, turn = self.way.error(bodies.positions[i][:2], yaw)
        pace = min(self.SPEED, 2 * distance) * max(0.0, math.cos(turn)) ** 2
        self.walk(world, bodies.step, v, bodies.angular_velocities[i][2], np.array([pace, 0]),
                  float(np.clip(2.5 * turn, -self.TURN, self.TURN)))

    def walk(self, world, step, v, w, wish_v, wish_w):
        """`v`, `wish_v`: m/s in its heading; `w`, `wish_w`: rad/s about the vertical."""
        names, positions = [], []
        stands_s = self.PERIOD / 2 / 60
        for leg, name in enumerate(LEGS):
            phase = (step / self.PERIOD + (0.5 if leg in (1, 2) else 0)) % 1
            under = self.HIPS[leg] + (0, self.side[leg] * self.OUTWARD)
            going = wish_v + wish_w * np.array([-under[1], under[0]])
            height = self.HEIGHT
            if phase < 0.5:  # it stands
                self.feet[leg] -= going / 60
                self.lifted[leg] = self.feet[leg]
            else:
                share = 2 * phase - 1
                slip = v + w * np.array([-under[1], under[0]]) - going
                target = under + going * stands_s / 2 + 0.06 * slip
                gently = share - math.sin(2 * math.pi * share) / (2 * math.pi)
                self.feet[leg] = self.lifted[leg] + gently * (target - self.lifted[leg])
                height -= self.LIFT * math.sin(math.pi * share)
            names += [f"dog/{name}_{joint}_joint" for joint in ("hip", "thigh", "shank")]
            positions += list(self.joints_of(leg, *(self.feet[leg] - self.HIPS[leg]), height))
        world.drive(names, position=positions, stiffness=300, damping=8, max_effort=40)

    def joints_of(self, leg, x, y, below):
        """The three joints that put its foot there, metres from its hip."""
        outward = self.side[leg] * self.OUTWARD
        length = math.sqrt(max(y * y + below * below - outward * outward, 0.01))
        hip = math.atan2(-below, y) - math.atan2(-length, outward)
        reach = min(math.hypot(x, length), self.THIGH + self.SHANK - 1e-3)
        knee = math.acos((self.THIGH**2 + self.SHANK**2 - reach**2) / (2 * self.THIGH * self.SHANK)) - math.pi
        thigh = math.atan2(-x, length) + math.acos((self.THIGH**2 + reach**2 - self.SHANK**2) / (2 * self.THIGH * reach))
        return np.array([hip, thigh, knee]) - self.REST


def steer(world, states):
    """In lock-step; returns the regions that each of the two has been in."""
    bodies = world.bodies()
    near = lambda x, y: int(bodies.ids[np.argmin(np.linalg.norm(bodies.positions[:, :2] - (x, y), axis=1))])
    car = Car(near(-6, -6), Way([(0, -6), (6, -6), (6, 0), (6, 6), (0, 6), (-6, 6), (-6, 0), (0, 0)], 1.5))
    dog = Dog(near(0, 0), Way([(2.8, 0.4), (2.8, 2.8), (-2.8, 2.8), (-2.8, -2.8), (2.8, -2.8)], 0.3))
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
