// `aurasim import`, from the words of the command line to the file.
#include <fstream>
#include <sstream>

#include "cli/import_program.h"
#include "import/imported.h"

namespace aurasim::importing {
namespace {

class ImportCommand : public ::testing::Test {
 protected:
  /// What the command returns; 2 where main() would return it for wrong input.
  int run(const std::string& words) {
    command_line::Action action;
    const auto program = cli::make_import_program(action);
    try {
      program->parse("import " + words, false);
      return action();
    } catch (const config::BadConfig& bad) {
      errors_ = bad.errors();
      return 2;
    }
  }

  std::string model(const std::string& name) const { return (kModels / name).string(); }
  std::filesystem::path out() const { return workspace_.folder() / "out/scene.yaml"; }

  core::Scene written() const {
    return config::read_launch(workspace_.write("out/launch.yaml", config::kSmallLaunch), {}).scene;
  }

  config::Workspace workspace_;
  std::vector<std::string> errors_;
};

TEST_F(ImportCommand, WritesASceneThatALaunchFileTakes) {
  ASSERT_EQ(run(model("arm.urdf") + " --out " + out().string()), 0);
  EXPECT_EQ(written().bodies.size(), 7u);
}

TEST_F(ImportCommand, WritesMeshesBesideTheScene) {
  ASSERT_EQ(run(model("shapes.sdf") + " --out " + out().string()), 0);
  EXPECT_EQ(written().statics.size(), 4u);
}

TEST_F(ImportCommand, EachAsHasItsAt) {
  ASSERT_EQ(
      run(model("arm.urdf") + " --out " + out().string() + " --as left --at 0,-1,0 --as right --at=-1,1,0.5,0,0,90"),
      0);
  const core::Scene scene = written();
  ASSERT_EQ(scene.bodies.size(), 14u);
  EXPECT_NEAR(scene.bodies[7].pose.p_WB.x(), -1 + 0.2, 1e-9);
  EXPECT_EQ(run(model("arm.urdf") + " --as left --as right"), 2);
  EXPECT_EQ(run(model("arm.urdf") + " --as left --at 1,2"), 2);
  EXPECT_THAT(errors_.front(), ::testing::StartsWith("--at 1,2: allowed: x,y,z in metres"));
}

TEST_F(ImportCommand, StrictWritesNothingIfSomethingIsLost) {
  EXPECT_EQ(run(model("screw.sdf") + " --strict --out " + out().string()), 2);
  EXPECT_FALSE(std::filesystem::exists(out()));
  EXPECT_EQ(run(model("arm.urdf") + " --strict --out " + out().string()), 0);
}

TEST_F(ImportCommand, ABrokenFileIsWrongInput) {
  EXPECT_EQ(run(workspace_.write("a.urdf", "<robot").string()), 2);
  EXPECT_THAT(errors_.front(), ::testing::HasSubstr("a.urdf:1: it is no XML"));
}

}  // namespace
}  // namespace aurasim::importing
