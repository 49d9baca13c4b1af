#include "config/workspace.h"

namespace aurasim::config {
namespace {

class Overrides : public testing::Test {
 protected:
  Launch read(const std::vector<std::string>& overrides) const { return workspace_.launch(text_, overrides); }
  void expect_refused(const std::string& change, const std::string& error) const {
    expect_errors(workspace_.launch_errors(text_, {change}), {error});
  }

  const Workspace workspace_;
  std::string text_ = kSmallLaunch;
};

TEST_F(Overrides, ReplaceAndAddValues) {
  const Launch launch = read({"regions.count=4", "time.sync=deterministic", "dds.interfaces=[10.0.0.1]"});
  EXPECT_EQ(launch.regions.size(), 4u);
  EXPECT_EQ(launch.time.sync, core::SyncMode::kDeterministic);
  EXPECT_THAT(launch.dds.interfaces, testing::ElementsAre("10.0.0.1"));
}

TEST_F(Overrides, TheLastOneWins) { EXPECT_EQ(read({"time.substeps=1", "time.substeps=2"}).time.substeps, 2); }

TEST_F(Overrides, ReachIntoLists) {
  text_ = "scene: scene.yaml\nregions: {layout: grid, rows: 2, columns: 2, cell: [40, 40]}\n";
  EXPECT_EQ(read({"regions.cell.1=60"}).regions.version(), core::RegionMap::grid(2, 2, 40, 60).version());
  EXPECT_EQ(read({"regions.cell[0]=60"}).regions.version(), core::RegionMap::grid(2, 2, 60, 40).version());
}

TEST_F(Overrides, ReachIntoTheScene) {
  const Launch launch = read({"scene.gravity=[0, 0, -1.62]", "scene.bodies.0.position=[1, 2, 3]"});
  EXPECT_EQ(launch.scene.gravity.z(), -1.62);
  EXPECT_EQ(launch.scene.bodies[0].pose.p_WB, core::Vec3(1, 2, 3));
}

TEST_F(Overrides, CanNameAnotherScene) {
  workspace_.write("other.yaml", "name: other\n");
  EXPECT_EQ(read({"scene=other.yaml"}).scene.name, "other");
}

TEST_F(Overrides, AnotherLayoutForgetsTheKeysOfTheOldOne) {
  text_ = "scene: scene.yaml\nregions: {layout: grid, rows: 2, columns: 2, cell: [40, 40]}\n";
  const Launch columns = read({"regions.layout=columns", "regions.count=3", "regions.width=50"});
  EXPECT_EQ(columns.regions.version(), core::RegionMap::columns(3, 50).version());
  EXPECT_EQ(read({"regions.layout=brick"}).regions.version(), core::RegionMap::brick(2, 2, 40, 40).version());
  EXPECT_EQ(read({"regions={layout: columns, count: 2, width: 40}"}).regions.size(), 2u);
}

TEST_F(Overrides, ACountOfOneIsTheCentralRunInEveryLayout) {
  for (const char* regions :
       {"{layout: columns, count: 2, width: 40}", "{layout: grid, rows: 2, columns: 2, cell: [40, 40]}",
        "{layout: brick, rows: 2, columns: 2, cell: [40, 40]}",
        "{layout: boxes, boxes: [[0, 0, 40, 40], [40, 0, 80, 40]]}"}) {
    text_ = std::string("scene: scene.yaml\nregions: ") + regions + "\n";
    EXPECT_EQ(read({"regions.count=1"}).regions.size(), 1u) << regions;
  }
}

TEST_F(Overrides, ACountOfAGridIsTheMostSquareOne) {
  text_ = "scene: scene.yaml\nregions: {layout: grid, rows: 2, columns: 2, cell: [40, 40]}\n";
  EXPECT_EQ(read({"regions.count=9"}).regions.version(), core::RegionMap::grid(3, 3, 40, 40).version());
  EXPECT_EQ(read({"regions.count=2"}).regions.version(), core::RegionMap::grid(1, 2, 40, 40).version());
  EXPECT_EQ(read({"regions.rows=4"}).regions.size(), 8u);
}

TEST_F(Overrides, ErrorsNameTheOverride) {
  expect_refused("regions.count=-3",
                 "--set regions.count=-3: regions.count: found \"-3\", allowed: an integer from 1 to 1024");
  expect_refused("regions.colour=red", "--set regions.colour=red: regions.colour: unknown key, allowed: layout, count");
  expect_refused("tme.sync=bounded",
                 "--set tme.sync=bounded: tme: unknown key, allowed: scene, regions, exchange, exchange_limit, time");
  expect_refused("time.sync.deep=1", "--set time.sync.deep=1: time.sync: found a map of 1, allowed: free_running");
  expect_refused("scene.gravity=9.81", "--set scene.gravity=9.81: gravity: found \"9.81\", allowed: a list of 3");
}

TEST_F(Overrides, APathThroughAValueLeadsNowhere) {
  expect_refused("regions.layout.deep=1",
                 "--set regions.layout.deep=1: regions.layout.deep: found \"deep\", allowed: nothing below the value");
  expect_refused("scene.bodies.7.id=1",
                 "--set scene.bodies.7.id=1: bodies.7.id: found \"7\", allowed: an index from 0 to 0");
  expect_refused("scene.bodies.first.id=1",
                 "--set scene.bodies.first.id=1: bodies.first.id: found \"first\", allowed: an");
}

TEST_F(Overrides, WhatIsNoOverrideIsRefused) {
  expect_refused("regions.count",
                 "--set regions.count: the override: found \"regions.count\", allowed: key.path=value");
  expect_refused("=4", "--set =4: the override: found \"=4\", allowed: key.path=value");
  expect_refused("a..b=4", "--set a..b=4: the override: found \"a..b=4\", allowed: key.path=value");
  expect_refused("regions.count=[1", "--set regions.count=[1: the file: found end of sequence flow not found");
  expect_refused("time.sync=", "--set time.sync=: time.sync: found nothing, allowed: free_running");
}

TEST_F(Overrides, AllAreCheckedEvenIfTheFileIsBroken) {
  text_ = "scene: [\n";
  EXPECT_EQ(workspace_.launch_errors(text_, {"nonsense"}).size(), 2u);
}

}  // namespace
}  // namespace aurasim::config
