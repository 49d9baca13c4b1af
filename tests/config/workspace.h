// A folder of its own for the files of one test, and the verbs to read them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/launch.h"
#include "scratch_folder.h"

namespace aurasim::config {

inline constexpr const char* kSmallScene = R"(shapes:
  ball: {sphere: {radius: 0.5}}
prototypes:
  ball: {shape: ball, mass: 1}
bodies:
  - {prototype: ball}
)";

inline constexpr const char* kSmallLaunch = R"(scene: scene.yaml
regions: {layout: columns, count: 2, width: 40}
)";

class Workspace {
 public:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    return scratch_.write(name, text);
  }

  const std::filesystem::path& folder() const { return scratch_.path(); }

  /// Reads a launch file of two columns with this scene.
  core::Scene scene(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    write("scene.yaml", text);
    return read_launch(write("launch.yaml", kSmallLaunch), overrides).scene;
  }

  /// Reads this launch file, whose scene is `scene.yaml`: one ball.
  Launch launch(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    write("scene.yaml", kSmallScene);
    return read_launch(write("launch.yaml", text), overrides);
  }

  /// What is wrong, without the name of the folder; empty if nothing is.
  template <class Read>
  std::vector<std::string> errors_of(const Read& read) const {
    try {
      read();
    } catch (const BadConfig& bad) {
      std::vector<std::string> errors = bad.errors();
      for (std::string& error : errors) strip_folder(error);
      return errors;
    }
    return {};
  }

  std::vector<std::string> scene_errors(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    return errors_of([&] { scene(text, overrides); });
  }
  std::vector<std::string> launch_errors(const std::string& text,
                                         const std::vector<std::string>& overrides = {}) const {
    return errors_of([&] { launch(text, overrides); });
  }

 private:
  void strip_folder(std::string& text) const {
    const std::string prefix = folder().string() + "/";
    for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix)) text.erase(at, prefix.size());
  }

  test::ScratchFolder scratch_;
};

/// The shape that these words of a scene file make.
inline core::Shape shape_of(const std::string& text) {
  const Workspace workspace;
  return workspace.scene("shapes: {it: " + text + "}\n").shapes.at(0).shape;
}

/// A bad file and all that must be said about it, in order. Each expected text is the beginning of one error.
struct BadCase {
  const char* name;
  std::string text;
  std::vector<std::string> errors;
};

inline void PrintTo(const BadCase& bad, std::ostream* out) { *out << bad.name; }

inline void expect_errors(const std::vector<std::string>& found, const std::vector<std::string>& expected) {
  std::vector<testing::Matcher<std::string>> matchers;
  for (const std::string& text : expected) matchers.push_back(testing::StartsWith(text));
  EXPECT_THAT(found, testing::ElementsAreArray(matchers));
}

}  // namespace aurasim::config
