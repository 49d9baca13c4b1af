#include "config/workspace.h"

namespace aurasim::config {
namespace {

const std::string kTwo = "scene: scene.yaml\nregions: {layout: columns, count: 2, width: 40}\n";

const std::vector<BadCase> kBadLaunches = {
    {"UnknownKey",
     kTwo + "speed: 3\n",
     {"launch.yaml:3:1: speed: unknown key, allowed: scene, regions, exchange, exchange_limit, time, tolerances, aura, "
      "physics, dds, "
      "survival, "
      "observe"}},
    {"KeyGivenTwice",
     kTwo + "scene: other.yaml\n",
     {"launch.yaml:3:1: scene: found a second time, first at line 1, allowed: once"}},
    {"KeyGivenTwiceInside",
     kTwo + "time: {substeps: 2, substeps: 4}\n",
     {"launch.yaml:3:21: time.substeps: found a second time, first at line 3, allowed: once"}},
    {"TlsWithoutAKey",
     kTwo + "overseer: {tls: {certificate: c.pem}}\n",
     {"launch.yaml:3:17: overseer.tls.key: missing, allowed: a PEM file"}},
    {"TlsThatIsNoMap",
     kTwo + "overseer: {tls: c.pem}\n",
     {"launch.yaml:3:17: overseer.tls: found \"c.pem\", allowed: a map of certificate, key"}},
    {"ReplayOfNothing",
     kTwo + "control: {replay: nowhere.csv}\n",
     {"launch.yaml:3:19: control.replay: found \"nowhere.csv\", allowed: setpoints.csv of an earlier run"}},
    {"SilenceOfNoTime",
     kTwo + "control: {silence: 0}\n",
     {"launch.yaml:3:20: control.silence: found \"0\", allowed: a number from 0.001 to 1000000"}},
    {"NoScene", "regions: {count: 1}\n", {"launch.yaml:1:1: scene: missing, allowed: a scene file"}},
    {"NoRegions", "scene: scene.yaml\n", {"launch.yaml:1:1: regions: missing, allowed: a map such as"}},
    {"SceneDoesNotExist",
     "scene: nowhere.yaml\nregions: {count: 1}\n",
     {"launch.yaml:1:8: scene: found \"nowhere.yaml\", allowed: a scene file (nowhere.yaml: No such file"}},
    {"SceneIsADirectory", "scene: .\nregions: {count: 1}\n", {"launch.yaml:1:8: scene: found \".\", allowed: a scene"}},
    {"SceneIsAList",
     "scene: [a]\nregions: {count: 1}\n",
     {"launch.yaml:1:8: scene: found a list of 1, allowed: a scene file"}},
    {"RegionsIsANumber",
     "scene: scene.yaml\nregions: 4\n",
     {"launch.yaml:2:10: regions: found \"4\", allowed: a map of layout, count, width, rows"}},
    {"RegionsIsEmpty", "scene: scene.yaml\nregions:\n", {"launch.yaml:2:1: regions: found nothing, allowed: a map"}},
    {"NegativeCount",
     "scene: scene.yaml\nregions: {layout: columns, count: -3, width: 40}\n",
     {"launch.yaml:2:35: regions.count: found \"-3\", allowed: an integer from 1 to 1024"}},
    {"AbsurdCount",
     "scene: scene.yaml\nregions: {layout: columns, count: 1000000, width: 40}\n",
     {"launch.yaml:2:35: regions.count: found \"1000000\", allowed: an integer from 1 to 1024"}},
    {"FractionalCount",
     "scene: scene.yaml\nregions: {layout: columns, count: 2.5, width: 40}\n",
     {"launch.yaml:2:35: regions.count: found \"2.5\", allowed: an integer from 1 to 1024"}},
    {"CountInQuotes",
     "scene: scene.yaml\nregions: {layout: columns, count: \"2\", width: 40}\n",
     {"launch.yaml:2:35: regions.count: found \"2\", allowed: an integer"}},
    {"WidthMissing",
     "scene: scene.yaml\nregions: {layout: columns, count: 2}\n",
     {"launch.yaml:2:10: regions.width: missing, allowed: a number from 0.001"}},
    {"WidthZero",
     "scene: scene.yaml\nregions: {layout: columns, count: 2, width: 0}\n",
     {"launch.yaml:2:45: regions.width: found \"0\", allowed: a number from 0.001"}},
    {"WidthNotANumber",
     "scene: scene.yaml\nregions: {layout: columns, count: 2, width: .nan}\n",
     {"launch.yaml:2:45: regions.width: found \".nan\", allowed: a number from 0.001"}},
    {"WidthNan",
     "scene: scene.yaml\nregions: {layout: columns, count: 2, width: nan}\n",
     {"launch.yaml:2:45: regions.width: found \"nan\""}},
    {"WidthInfinite",
     "scene: scene.yaml\nregions: {layout: columns, count: 2, width: inf}\n",
     {"launch.yaml:2:45: regions.width: found \"inf\""}},
    {"WidthOverflows",
     "scene: scene.yaml\nregions: {layout: columns, count: 2, width: 1e999}\n",
     {"launch.yaml:2:45: regions.width: found \"1e999\""}},
    {"WidthWithUnit",
     "scene: scene.yaml\nregions: {layout: columns, count: 2, width: 40 m}\n",
     {"launch.yaml:2:45: regions.width: found \"40 m\""}},
    {"UnknownLayout",
     "scene: scene.yaml\nregions: {layout: hexagons, count: 2}\n",
     {"launch.yaml:2:19: regions.layout: found \"hexagons\", allowed: columns, grid, brick, boxes"}},
    {"KeyOfAnotherLayout",
     "scene: scene.yaml\nregions: {layout: columns, count: 2, width: 40, rows: 2}\n",
     {"launch.yaml:2:49: regions.rows: unknown key, allowed: layout, count, width, neighbour_distance"}},
    {"GridWithoutCell",
     "scene: scene.yaml\nregions: {layout: grid, rows: 2, columns: 2}\n",
     {"launch.yaml:2:10: regions.cell: missing, allowed: a list of 2"}},
    {"GridOfTooManyRegions",
     "scene: scene.yaml\nregions: {layout: grid, rows: 40, columns: 40, cell: [40, 40]}\n",
     {"launch.yaml:2:44: regions.columns: found \"40\", allowed: at most 1024 regions"}},
    {"CellOfOneNumber",
     "scene: scene.yaml\nregions: {layout: grid, rows: 2, columns: 2, cell: [40]}\n",
     {"launch.yaml:2:52: regions.cell: found a list of 1, allowed: a list of 2"}},
    {"CellWithANegativeSide",
     "scene: scene.yaml\nregions: {layout: brick, rows: 2, columns: 2, cell: [40, -40]}\n",
     {"launch.yaml:2:58: regions.cell[1]: found \"-40\", allowed: a number from 0.001"}},
    {"OverlappingBoxes",
     "scene: scene.yaml\nregions: {layout: boxes, boxes: [[0, 0, 40, 40], [30, 0, 80, 40]]}\n",
     {"launch.yaml:2:33: regions.boxes: boxes 0 [0.000000, 0.000000, 40.000000, 40.000000] and 1"}},
    {"GapBetweenBoxes",
     "scene: scene.yaml\nregions: {layout: boxes, boxes: [[0, 0, 40, 40], [50, 0, 90, 40]]}\n",
     {"launch.yaml:2:33: regions.boxes: the boxes leave a gap"}},
    {"BoxInsideOut",
     "scene: scene.yaml\nregions: {layout: boxes, boxes: [[40, 0, 0, 40]]}\n",
     {"launch.yaml:2:34: regions.boxes[0]: found a list of 4, allowed: [x0, y0, x1, y1] with x0 < x1"}},
    {"NoBoxes",
     "scene: scene.yaml\nregions: {layout: boxes, boxes: []}\n",
     {"launch.yaml:2:33: regions.boxes: found a list of 0, allowed: a list of 1 to 256"}},
    {"RegionsNarrowerThanTheReach",
     "scene: scene.yaml\nregions: {layout: columns, count: 4, width: 3}\n",
     {"launch.yaml:2:10: regions: the narrowest region is 3 m wide, allowed: at least 3.933 m, the reach of an aura: "
      "speed 32 m/s, lookahead 2, contacts looked for at 4 instants of a step, largest bounding radius 0.5 m"}},
    {"NeighbourDistanceBelowTheZone",
     kTwo.substr(0, kTwo.size() - 2) + ", neighbour_distance: 1}\n",
     {"launch.yaml:2:10: regions: neighbour_distance is 1 m, allowed: at least"}},
    {"RedoWhereNobodyAgrees",
     kTwo + "time: {sync: free_running, redo: on}\n",
     {"launch.yaml:2:10: regions: time.redo is on, allowed: auto or off where time.sync is free_running"}},
    {"StepRateZero",
     kTwo + "time: {step_hz: 0}\n",
     {"launch.yaml:3:17: time.step_hz: found \"0\", allowed: a number from 1 to 10000"}},
    {"TooManySubsteps",
     kTwo + "time: {substeps: 65}\n",
     {"launch.yaml:3:18: time.substeps: found \"65\", allowed: an integer from 1 to 64"}},
    {"UnknownSync",
     kTwo + "time: {sync: sometimes}\n",
     {"launch.yaml:3:14: time.sync: found \"sometimes\", allowed: free_running, bounded, deterministic"}},
    {"LookaheadZero",
     kTwo + "time: {lookahead: 0}\n",
     {"launch.yaml:3:19: time.lookahead: found \"0\", allowed: auto, or an integer from 1 to 64"}},
    {"LookaheadAWord",
     kTwo + "time: {lookahead: far}\n",
     {"launch.yaml:3:19: time.lookahead: found \"far\", allowed: auto, or an integer from 1 to 64"}},
    {"LookaheadAList",
     kTwo + "time: {lookahead: [1]}\n",
     {"launch.yaml:3:19: time.lookahead: found a list of 1, allowed: auto, or an integer from 1 to 64"}},
    {"LookaheadFromTolerancesTooLong",
     kTwo + "exchange: aura\ntolerances: {frame: 9}\n",
     {"launch.yaml:2:10: regions: tolerances and step_hz give a lookahead of 541 steps, allowed: at most 64"}},
    {"SpeedToleranceZero",
     kTwo + "tolerances: {speed: 0, latency: -1, frame: 0}\n",
     {"launch.yaml:3:21: tolerances.speed: found \"0\"", "launch.yaml:3:33: tolerances.latency: found \"-1\"",
      "launch.yaml:3:44: tolerances.frame: found \"0\""}},
    {"UnknownAura",
     kTwo + "aura: {radius: wide}\n",
     {"launch.yaml:3:16: aura.radius: found \"wide\", allowed: none, thesis, tight, swept"}},
    {"NoIterations",
     kTwo + "physics: {iterations: 0}\n",
     {"launch.yaml:3:23: physics.iterations: found \"0\", allowed: an integer from 1 to 1000"}},
    {"BlocksTooSmall",
     kTwo + "physics: {block: 0.5}\n",
     {"launch.yaml:3:18: physics.block: found \"0.5\", allowed: a number from 1 to 1000000"}},
    {"UnknownSolverAndPreset",
     kTwo + "physics: {solver: magic, preset: best}\n",
     {"launch.yaml:3:19: physics.solver: found \"magic\", allowed: sequential_impulse, soft_step",
      "launch.yaml:3:34: physics.preset: found \"best\", allowed: fast, balanced, exact"}},
    {"KeysThatAreGone",
     kTwo + "physics: {precision: double, origin: world}\n",
     {"launch.yaml:3:11: physics.precision: this key is gone: physics computes in double precision only",
      "launch.yaml:3:30: physics.origin: this key is gone: Bullet's coordinates begin at the world's origin"}},
    {"SolverNncgIsGone",
     kTwo + "physics: {solver: nncg}\n",
     {"launch.yaml:3:19: physics.solver: found \"nncg\", which is gone: this solver was removed, because piles with "
      "friction fell apart with it. Choose soft_step (the default), or sequential_impulse"}},
    {"SolverDantzigIsGone",
     kTwo + "physics: {iterations: 0, solver: dantzig}\n",
     {"launch.yaml:3:23: physics.iterations: found \"0\", allowed: an integer from 1 to 1000",
      "launch.yaml:3:34: physics.solver: found \"dantzig\", which is gone: this solver was removed, because its time "
      "grew with the cube of a pile's contacts. Choose soft_step (the default), or sequential_impulse"}},
    {"GoingOnWithoutTheDeadIsGone",
     kTwo + "survival: {checkpoint: 2, on_death: go_on}\n",
     {"launch.yaml:3:37: survival.on_death: found \"go_on\", which is gone: a run does not go on without the bodies of "
      "a "
      "dead node any more. Choose recover (the default: another process takes its region over, and no body is lost), "
      "or "
      "stop"}},
    {"UnknownOnDeath",
     kTwo + "survival: {on_death: panic}\n",
     {"launch.yaml:3:22: survival.on_death: found \"panic\", allowed: recover, stop"}},
    {"DomainOutOfRange",
     kTwo + "dds: {domain: 233}\n",
     {"launch.yaml:3:15: dds.domain: found \"233\", allowed: an integer from 0 to 232"}},
    {"ProfilesMissing",
     kTwo + "dds: {profiles: none.xml}\n",
     {"launch.yaml:3:17: dds.profiles: found \"none.xml\", allowed: an XML file (none.xml is none)"}},
    {"KeysMissing",
     kTwo + "dds: {security: none}\n",
     {"launch.yaml:3:17: dds.security: found \"none\", allowed: a folder of keys ("}},
    {"NoInterfaces",
     kTwo + "dds: {interfaces: []}\n",
     {"launch.yaml:3:19: dds.interfaces: found a list of 0, allowed: a list of 1 to 256"}},
    {"ImpairmentUnknown",
     kTwo + "dds: {impair: {dealy: 0.1}}\n",
     {"launch.yaml:3:16: dds.impair.dealy: unknown key, allowed: delay, jitter, loss, bandwidth, reorder, discovery, "
      "seed"}},
    {"ImpairmentImpossible",
     kTwo + "dds: {impair: {delay: 11, loss: 1.5, reorder: maybe, seed: -1}}\n",
     {"launch.yaml:3:23: dds.impair.delay: found \"11\", allowed: a number from 0 to 10",
      "launch.yaml:3:33: dds.impair.loss: found \"1.5\", allowed: a number from 0 to 1",
      "launch.yaml:3:47: dds.impair.reorder: found \"maybe\", allowed: ",
      "launch.yaml:3:60: dds.impair.seed: found \"-1\", allowed: an integer from 0 to "}},
    {"PeersMissing", kTwo + "dds: {discovery: server}\n", {"launch.yaml:3:6: dds: needs peers"}},
    {"Ros2Unknown", kTwo + "ros2: maybe\n", {"launch.yaml:3:7: ros2: found \"maybe\", allowed: on, off"}},
    {"Ros2TooFast",
     kTwo + "ros2: {domain: 233, tf_hz: 0, tf: 20}\n",
     {"launch.yaml:3:16: ros2.domain: found \"233\", allowed: an integer from 0 to 232",
      "launch.yaml:3:28: ros2.tf_hz: found \"0\", allowed: a number from 0.001 to 1000",
      "launch.yaml:3:31: ros2.tf: unknown key, allowed: domain, tf_hz, frame, cmd_vel"}},
    {"Ros2DrivesNobody",
     kTwo + "ros2: {cmd_vel: [nobody, my robot, a//b, 2d]}\n",
     {"launch.yaml:3:7: ros2: cmd_vel: the scene has no body \"nobody\"",
      "launch.yaml:3:7: ros2: cmd_vel: \"my robot\" is no name of a topic of ROS",
      "launch.yaml:3:7: ros2: cmd_vel: \"a//b\" is no name of a topic of ROS",
      "launch.yaml:3:7: ros2: cmd_vel: \"2d\" is no name of a topic of ROS"}},
    {"TickRateTooHigh",
     kTwo + "observe: {tick_hz: 100000}\n",
     {"launch.yaml:3:20: observe.tick_hz: found \"100000\", allowed: a number from 0.001 to 1000"}},
    {"BindThatIsNoAddress",
     kTwo + "overseer: {bind: 0x10}\n",
     {"launch.yaml:3:18: overseer.bind: found \"0x10\", allowed: an address to listen on, such as 127.0.0.1"}},
    {"BindOfTooManyNumbers",
     kTwo + "overseer: {bind: 127.0.0.1.1}\n",
     {"launch.yaml:3:18: overseer.bind: found \"127.0.0.1.1\", allowed: an address to listen on"}},
    {"PortBeyondAll",
     kTwo + "overseer: {port: 70000}\n",
     {"launch.yaml:3:18: overseer.port: found \"70000\", allowed: an integer from 0 to 65535"}},
    {"InterfaceThatIsNoAddress",
     kTwo + "dds: {interfaces: [127.0.0.1, 0x10]}\n",
     {"launch.yaml:3:31: dds.interfaces[1]: found \"0x10\", allowed: an IPv4 address of this host"}},
    {"PeerThatIsNoAddress",
     kTwo + "dds: {peers: [10.0.0.300]}\n",
     {"launch.yaml:3:15: dds.peers[0]: found \"10.0.0.300\", allowed: ADDRESS or ADDRESS:PORT, IPv4"}},
    {"PeerWithAPortBeyondAll",
     kTwo + "dds: {peers: [\"10.0.0.3:0\", \"10.0.0.3:65536\"]}\n",
     {"launch.yaml:3:15: dds.peers[0]: found \"10.0.0.3:0\", allowed: ADDRESS or ADDRESS:PORT, IPv4",
      "launch.yaml:3:29: dds.peers[1]: found \"10.0.0.3:65536\", allowed: ADDRESS or ADDRESS:PORT, IPv4"}},
    {"BandwidthThatLetsNothingThrough",
     kTwo + "dds: {impair: {bandwidth: 1e-320}}\n",
     {"launch.yaml:3:27: dds.impair.bandwidth: found \"1e-320\", allowed: 0, or at least 1 B/s"}},
    {"RegionOfNoWidth",
     "scene: scene.yaml\nregions: {layout: columns, count: 2, width: 1e-20}\ntime: {sync: deterministic}\n",
     {"launch.yaml:2:45: regions.width: found \"1e-20\", allowed: a number from 0.001"}},
    {"BoxOfNoWidth",
     "scene: scene.yaml\nregions: {layout: boxes, boxes: [[0, 0, 1e-20, 40], [1e-20, 0, 40, 40]]}\n",
     {"launch.yaml:2:34: regions.boxes[0]: found a list of 4, allowed: [x0, y0, x1, y1] with x0 < x1 and y0 < y1, each "
      "side at least 0.001 m"}},
    {"TickRateOfOnceInAnAge",
     kTwo + "observe: {tick_hz: 1e-320}\n",
     {"launch.yaml:3:20: observe.tick_hz: found \"1e-320\", allowed: a number from 0.001 to 1000"}},
};

class BadLaunch : public testing::TestWithParam<BadCase> {};

TEST_P(BadLaunch, IsRefusedWithPlaceFieldAndReason) {
  const Workspace workspace;
  expect_errors(workspace.launch_errors(GetParam().text), GetParam().errors);
}

INSTANTIATE_TEST_SUITE_P(All, BadLaunch, testing::ValuesIn(kBadLaunches),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(BadLaunchFile, AllErrorsAreCollectedInTheOrderOfTheFile) {
  const Workspace workspace;
  workspace.write("scene.yaml", "gravity: 9.81\nprototypes: {ball: {shape: ball, mass: -1}}\n");
  const std::string text = "colour: red\nscene: scene.yaml\nregions: {layout: columns, count: 0, width: -1}\n";
  const auto file = workspace.write("launch.yaml", text);
  expect_errors(workspace.errors_of([&] { read_launch(file); }),
                {"launch.yaml:1:1: colour: unknown key", "launch.yaml:3:35: regions.count: found \"0\"",
                 "launch.yaml:3:45: regions.width: found \"-1\"", "scene.yaml:1:10: gravity: found \"9.81\"",
                 "scene.yaml:2:28: prototypes.ball.shape: found \"ball\", allowed: a shape of this scene: nothing",
                 "scene.yaml:2:40: prototypes.ball.mass: found \"-1\", allowed: a number from 1e-06 to 1000000000"});
}

TEST(BadLaunchFile, AnOverrideWithAValueThatIsGoneIsToldWhatBecameOfIt) {
  const Workspace workspace;
  expect_errors(workspace.launch_errors(kTwo, {"physics.solver=nncg"}),
                {"--set physics.solver=nncg: physics.solver: found \"nncg\", which is gone: this solver was removed"});
}

TEST(BadLaunchFile, AThousandErrorsAreCutAndCounted) {
  const Workspace workspace;
  std::string text = kTwo;
  for (int i = 0; i < 1000; ++i) text += "key" + std::to_string(i) + ": 1\n";
  const auto errors = workspace.launch_errors(text);
  ASSERT_EQ(errors.size(), 201u);
  EXPECT_THAT(errors.back(), testing::HasSubstr("800 more errors are not shown"));
}

TEST(BadLaunchFile, WhatIsWrongIsAlsoTheMessageOfTheException) {
  const Workspace workspace;
  try {
    workspace.launch("scene: scene.yaml\nregions: {count: 0}\nx: 1\n");
    FAIL() << "must throw";
  } catch (const BadConfig& bad) {
    EXPECT_EQ(bad.errors().size(), 3u);
    EXPECT_THAT(bad.what(), testing::HasSubstr("regions.count"));
    EXPECT_THAT(bad.what(), testing::HasSubstr("x: unknown key"));
  }
}

}  // namespace
}  // namespace aurasim::config
