"""A car and a quadruped of URDF and SDF files, imported, steered by a program through the regions of a 3 x 3 grid: from
the record of it the same bits come out on one node and on four."""

import os
import subprocess
import sys
import unittest

from client_fixture import GENEROUS_S, SOURCES, WorldTest, hashes

sys.path.insert(0, str(SOURCES / "src" / "client" / "examples"))
import robots  # noqa: E402

import aurasim  # noqa: E402

SCENE = """name: robots
statics: [{name: ground, shape: {plane: {}}}]
include:
  - {file: car.yaml, name: car, at: {position: [-7, -8, -0.05]}}
  - {file: quadruped.yaml, name: dog, at: {position: [0, 0, 0.37]}}
"""
LAUNCH = """scene: robots.yaml
regions: {layout: grid, rows: 3, columns: 3, cell: [4, 4]}
time: {sync: deterministic, pace: none, lookahead: 1}
"""


class Robots(WorldTest):
    STATES = 1800

    def aurasim(self, *words):
        done = subprocess.run([os.environ["AURASIM_PROGRAM"], *words], capture_output=True, text=True,
                              timeout=6 * GENEROUS_S, check=False)
        self.assertEqual(done.returncode, 0, done.stderr[-2000:])

    def test_are_steered_through_all_regions_with_the_same_bits_again(self):
        for model in ("car.sdf", "quadruped.urdf"):
            self.aurasim("import", str(SOURCES / "tests" / "import" / "models" / model), "--out",
                         str(self.folder / model.replace("sdf", "yaml").replace("urdf", "yaml")))
        (self.folder / "robots.yaml").write_text(SCENE)
        file = self.folder / "launch.yaml"
        file.write_text(LAUNCH)
        live = self.folder / "live"
        world = self.keep(aurasim.World.launch(file, set=self.overrides(), paused=True, report=live,
                                               timeout=GENEROUS_S))
        seen = robots.steer(world, self.STATES)
        late = {node.setpoints_late + node.setpoints_refused for node in world.nodes()}
        world.close()
        self.assertEqual(late, {0})
        self.assertEqual(seen["car"], set(range(9)))
        self.assertEqual(seen["dog"], set(range(9)))
        for regions in ("regions.count=1", "regions={layout: grid, rows: 2, columns: 2, cell: [5, 5]}"):
            again = self.folder / f"again_{len(regions)}"
            self.aurasim("launch", str(file), "--headless", "--steps", str(self.STATES), "--report", str(again), "--set",
                         f"dds.domain={self.domain.number}", "--set", regions, "--set",
                         f"control.replay={live / 'setpoints.csv'}")
            self.assertEqual(hashes(again), hashes(live), regions)


if __name__ == "__main__":
    unittest.main(verbosity=2)
