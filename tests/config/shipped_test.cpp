// The scenes and launch files that come with the project.
#include <filesystem>
#include <set>

#include "config/launch.h"
#include "config/workspace.h"

namespace aurasim::config {
namespace {

const std::filesystem::path kLaunchConfigs = std::filesystem::path(AURASIM_SOURCE_DIR) / "launch_configs";

std::vector<std::filesystem::path> yaml_files_in(const std::filesystem::path& folder) {
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") files.insert(entry.path());
  }
  return {files.begin(), files.end()};
}

Launch shipped(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return read_launch(kLaunchConfigs / (name + ".yaml"), overrides);
}

TEST(ShippedFiles, EveryLaunchFileReads) {
  const auto files = yaml_files_in(kLaunchConfigs);
  EXPECT_GE(files.size(), 6u);
  for (const auto& file : files) {
    SCOPED_TRACE(file);
    EXPECT_NO_THROW(read_launch(file));
    EXPECT_NO_THROW(read_launch(file, {"regions.count=1"})) << "the central run";
  }
}

TEST(ShippedFiles, EverySceneHasALaunchFileOfItsName) {
  for (const auto& scene : yaml_files_in(kLaunchConfigs / "scenes")) {
    EXPECT_TRUE(std::filesystem::exists(kLaunchConfigs / scene.filename())) << scene;
    EXPECT_EQ(read_launch(kLaunchConfigs / scene.filename()).scene_file, scene);
  }
}

TEST(ShippedFiles, TheDemoSpellsOutTheDefaultsOfItsScene) {
  EXPECT_EQ(shipped("demo").agreement(), shipped("corner_stacks").agreement());
  EXPECT_EQ(shipped("demo").regions.size(), 4u);
  EXPECT_EQ(shipped("demo").dds.profiles, std::filesystem::path(AURASIM_SOURCE_DIR) / "qos/aurasim.xml");
}

TEST(ShippedFiles, ScenesAreTheSameOnAnyNumberOfNodes) {
  for (const auto& file : yaml_files_in(kLaunchConfigs)) {
    SCOPED_TRACE(file);
    const auto world_of = [&](const std::string& count) {
      Launch launch =
          read_launch(file, {"regions={layout: columns, width: 80, count: " + count + "}", "exchange=aura"});
      launch.regions = core::RegionMap::columns(1, 1);
      return launch.agreement();
    };
    EXPECT_EQ(world_of("1"), world_of("2"));
    EXPECT_EQ(world_of("1"), world_of("4"));
  }
}

TEST(ShippedFiles, TheRainIsThatOfTheThesis) {
  for (const char* layout : {"scene.layout=launch", "scene.layout={layout: columns, count: 4, width: 80}"}) {
    const core::Scene scene = shipped("columns_rain", {layout}).scene;
    double rate = 0;
    std::uint64_t bodies = 0;
    for (const core::Injector& injector : scene.injectors) {
      rate += injector.rate_per_s;
      bodies += injector.max_bodies;
      EXPECT_EQ(injector.prototypes.size(), 3u);
      EXPECT_EQ(injector.velocity_min, core::Vec3(-10, -10, -10));
      EXPECT_EQ(injector.velocity_max, core::Vec3(10, 10, 0));
    }
    EXPECT_DOUBLE_EQ(rate, 160);
    EXPECT_EQ(bodies, 9600u);
  }
}

TEST(ShippedFiles, TheRainFallsEquallyOnOneTwoAndFourNodes) {
  for (const char* count : {"1", "2", "4"}) {
    const Launch launch = shipped("columns_rain", {std::string("regions.count=") + count});
    std::vector<double> rate(launch.regions.size());
    for (const core::Injector& injector : launch.scene.injectors) {
      rate[value_of(launch.regions.owner(0.5 * (injector.volume_min + injector.volume_max)))] += injector.rate_per_s;
    }
    for (const double r : rate) EXPECT_NEAR(r, 160.0 / static_cast<double>(rate.size()), 1e-9);
  }
}

}  // namespace
}  // namespace aurasim::config
