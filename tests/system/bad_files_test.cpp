// What is wrong with a file is said with its place, and nothing is started. (tests/config has every error.)
#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kScene = R"(shapes:
  ball: {sphere: {radius: 0.5}}
prototypes:
  ball: {shape: ball, mass: 1}
bodies:
  - {prototype: ball}
)";

struct BadFile {
  const char* name;
  const char* launch;
  const char* place;  ///< what stderr says first, after the folder
};

class BadFiles : public SystemTest, public ::testing::WithParamInterface<BadFile> {};

TEST_P(BadFiles, ExitWithTwoAndNameThePlace) {
  write("scene.yaml", kScene);
  const std::string file = write("launch.yaml", GetParam().launch);
  for (const Words& words : {Words{"check", file}, Words{"launch", file, "--headless", "--duration", "1"},
                             Words{"node", file, "--region", "0"}, Words{"send", "stop", file}}) {
    Process& program = start(words);
    expect_exit(program, 2);
    EXPECT_THAT(program.err(), HasSubstr((folder() / GetParam().place).string())) << words[0];
    EXPECT_TRUE(program.out().empty()) << program.said();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Handful, BadFiles,
    ::testing::Values(BadFile{"UnknownKey", "scene: scene.yaml\nregions: {count: 2, width: 40}\ngravity: 9.81\n",
                              "launch.yaml:3:1: gravity"},
                      BadFile{"WrongValue",
                              "scene: scene.yaml\nregions: {count: 2, width: 40}\ntime: {sync: sometimes}\n",
                              "launch.yaml:3:14: time.sync"},
                      BadFile{"NoScene", "regions: {count: 2, width: 40}\n", "launch.yaml:1:1: "},
                      BadFile{"SceneThatIsNotThere", "scene: nowhere.yaml\nregions: {count: 2, width: 40}\n",
                              "launch.yaml:1:8: scene"},
                      BadFile{"NotYaml", "scene: [scene.yaml\nregions: {count: 2, width: 40}\n", "launch.yaml:"}),
    [](const auto& info) { return info.param.name; });

using CommandLines = SystemTest;

TEST_F(CommandLines, ThatMakeNoSenseExitWithTwo) {
  const std::string file = launch_file("two_spheres");
  for (const Words& words :
       {Words{}, Words{"fly"}, Words{"check"}, Words{"check", "/nowhere.yaml"}, Words{"launch", file, "--steps", "-5"},
        Words{"launch", file, "--steps", "5", "--duration", "5"}, Words{"launch", file, "--set", "dds.domain=1000"},
        Words{"launch", file, "--set", "nonsense"}, Words{"node", file}, Words{"node", file, "--region", "2"},
        Words{"node", file, "--region", "0", "--start-time-out", "0"}, Words{"send", "jump", file}}) {
    Process& program = start(words);
    expect_exit(program, 2);
    EXPECT_FALSE(program.err().empty()) << program.said();
  }
}

TEST_F(CommandLines, ThatAreGoodExitWithZero) {
  for (const char* name : {"demo", "columns_rain", "corner_stacks", "island", "three_way", "tower", "two_spheres"}) {
    Process& program = start({"check", launch_file(name)});
    expect_exit(program, 0);
    EXPECT_TRUE(program.err().empty()) << program.said();
  }
  expect_exit(start({"--help"}), 0);
}

TEST_F(CommandLines, AWarningIsNoError) {
  write("scene.yaml", std::string(kScene) + "  - {prototype: ball, name: bullet, velocity: [900, 0, 0]}\n");
  const std::string file = write("launch.yaml", "scene: scene.yaml\nregions: {count: 1}\ntime: {pace: none}\n");
  for (const Words& words : {Words{"check", file}, Words{"launch", file, "--headless", "--steps", "2"}}) {
    Process& program = start(words);
    expect_exit(program, 0, 60s);
    EXPECT_THAT(program.err(), HasSubstr("scene.yaml:7:5: body 1 (\"bullet\") starts with 900 m/s")) << words[0];
    EXPECT_THAT(program.err(), HasSubstr("body 0 overlaps body 1")) << words[0];
  }
}

TEST_F(CommandLines, KeysArePrintedBySections) {
  Process& tolerances = start({"schema", "tolerances"});
  expect_exit(tolerances, 0, 10s);
  EXPECT_THAT(tolerances.out(), HasSubstr("0.001 to 10000 m/s; default 32"));
  EXPECT_THAT(tolerances.out(), Not(HasSubstr("step_hz")));
  expect_exit(start({"schema", "no such section"}), 2, 10s);
}

}  // namespace
}  // namespace aurasim::system_test
