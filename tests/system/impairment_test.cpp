// Runs over a network that is made worse, by launch keys and by a profile.
#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

class ImpairedRun : public SystemTest {
 protected:
  /// As fast as the network allows, so that the run lasts as long as its messages take.
  Process& run(const std::string& name, const Words& overrides) {
    Process& process =
        launch(name, launch_file("two_spheres"),
               Words{"--steps", "150"} + set(Words{"time.sync=deterministic", "time.pace=none"} + overrides));
    expect_exit(process, 0, 2 * kGenerous);
    expect_all_bodies_accounted_for(report_of(name));
    return process;
  }

  /// All regions together, in all steps.
  double waited_ms(const std::string& name) const {
    const Table steps = report_of(name).steps();
    double sum = 0;
    for (std::size_t row = 0; row < steps.rows(); ++row) sum += steps.number(row, "wait_ms");
    return sum;
  }

  void expect_equal(const std::string& a, const std::string& b) {
    Process& compare = start({"compare", report_of(a).folder().string(), report_of(b).folder().string()});
    expect_exit(compare, 0);
    EXPECT_THAT(compare.out(), ::testing::HasSubstr("equal"));
  }
};

TEST_F(ImpairedRun, HasTheBitsOfTheCentralOne) {
  const Process& impaired = run("impaired", {"dds.impair.delay=0.016", "dds.impair.jitter=0.005", "dds.impair.loss=0.1",
                                             "tolerances.latency=0.03"});
  EXPECT_GT(report_of("impaired").count("migrations"), 0);
  EXPECT_THAT(impaired.err(), ::testing::ContainsRegex("region 0: impaired network: delay 16 ms.* lost [1-9]"));
  EXPECT_THAT(impaired.err(), ::testing::ContainsRegex("region 1: impaired network: delay 16 ms.* lost [1-9]"));
  const Process& central = run("central", {"regions.count=1", "tolerances.latency=0.03"});
  EXPECT_THAT(central.err(), ::testing::Not(::testing::HasSubstr("impaired network")));
  expect_equal("impaired", "central");
}

TEST_F(ImpairedRun, IsMadeByAProfileAlone) {
  const Process& impaired = run("impaired", {"dds.profiles=../qos/impaired/lan_8ms.xml"});
  EXPECT_THAT(impaired.err(), ::testing::HasSubstr("impaired network: delay 8 ms"));
  // No step without the neighbour's message of K = 2 steps ago, which was 8 ms on its way: 75 times 8 ms for each.
  // Nothing impaired, it is less than 100 ms.
  EXPECT_GT(waited_ms("impaired"), 800);
}

TEST_F(ImpairedRun, RefusesWhatCannotBe) {
  Process& process =
      start(Words{"launch", launch_file("two_spheres"), "--headless"} + in_own_domain() + set({"dds.impair.loss=1.5"}));
  expect_exit(process, 2);
  EXPECT_THAT(process.err(), ::testing::HasSubstr("dds.impair.loss"));
  Process& profile =
      start(Words{"launch",
                  write("launch.yaml", "scene: " AURASIM_SOURCE_DIR "/launch_configs/scenes/two_spheres.yaml\n"
                                       "regions: {layout: columns, count: 2, width: 40}\n"
                                       "dds:\n  impair: {dealy: 0.1}\n")
                      .string(),
                  "--headless"} +
            in_own_domain());
  expect_exit(profile, 2);
  EXPECT_THAT(profile.err(), ::testing::HasSubstr("launch.yaml:4:12: dds.impair.dealy: unknown key"));
}

}  // namespace
}  // namespace aurasim::system_test
