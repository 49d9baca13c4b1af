// Which files a model may name.
#include "import/places.h"

#include "import/imported.h"

namespace aurasim::importing {
namespace {

class Places : public ::testing::Test {
 protected:
  Places() {
    workspace_.write("robot/robot.urdf", "");
    workspace_.write("robot/meshes/a.stl", "");
    workspace_.write("shared/b.stl", "");
    workspace_.write("secret.stl", "");
  }

  std::string found(const std::string& uri, const std::vector<std::filesystem::path>& paths = {}) const {
    const auto result = find_named_file(uri, workspace_.folder() / "robot", paths);
    const auto* path = std::get_if<std::filesystem::path>(&result);
    return path == nullptr ? ""
                           : std::filesystem::relative(*path, std::filesystem::canonical(workspace_.folder())).string();
  }

  config::Workspace workspace_;
};

TEST_F(Places, UrisAreFoundInTheFolderOfTheModel) {
  EXPECT_EQ(found("meshes/a.stl"), "robot/meshes/a.stl");
  EXPECT_EQ(found("file://meshes/a.stl"), "robot/meshes/a.stl");
  EXPECT_EQ(found("model://robot/meshes/a.stl"), "robot/meshes/a.stl");
  EXPECT_EQ(found("package://meshes/a.stl"), "robot/meshes/a.stl");
}

TEST_F(Places, OtherFoldersHaveToBeGiven) {
  EXPECT_EQ(found("b.stl"), "");
  EXPECT_EQ(found("b.stl", {workspace_.folder() / "shared"}), "shared/b.stl");
  EXPECT_EQ(found("package://shared/b.stl", {workspace_.folder()}), "shared/b.stl");
}

TEST_F(Places, NothingLeadsOut) {
  EXPECT_EQ(found("../secret.stl"), "");
  EXPECT_EQ(found("model://robot/../secret.stl"), "");
  EXPECT_EQ(found((workspace_.folder() / "secret.stl").string()), "");
  std::filesystem::create_symlink(workspace_.folder() / "secret.stl", workspace_.folder() / "robot/link.stl");
  EXPECT_EQ(found("link.stl"), "");
  EXPECT_EQ(found("https://example.org/a.stl"), "");
}

}  // namespace
}  // namespace aurasim::importing
