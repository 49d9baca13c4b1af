// Shipped files with random damage: whatever the bytes are, reading ends in a launch or in BadConfig.
// AURASIM_FUZZ_SEED and AURASIM_FUZZ_MUTATIONS (per file) in the environment change the seed and the length.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>

#include "config/workspace.h"

namespace aurasim::config {
namespace {

unsigned from_environment(const char* name, unsigned usual) {
  const char* text = std::getenv(name);
  return text == nullptr ? usual : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}

const int kMutationsPerFile = static_cast<int>(from_environment("AURASIM_FUZZ_MUTATIONS", 400));
const unsigned kSeed = from_environment("AURASIM_FUZZ_SEED", 20240);

std::string read_all(const std::filesystem::path& file) {
  std::ostringstream out;
  out << std::ifstream(file, std::ios::binary).rdbuf();
  return out.str();
}

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string damaged(std::string text) {
    for (std::size_t i = 0, times = 1 + below(4); i < times && !text.empty(); ++i) damage_once(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }

  void damage_once(std::string& text) {
    static const std::string kPieces[] = {"{",
                                          "}",
                                          "[",
                                          "]",
                                          ":",
                                          ",",
                                          "- ",
                                          "\n",
                                          "\t",
                                          "&a ",
                                          "*a",
                                          "!!",
                                          "'",
                                          "\"",
                                          "-1",
                                          "1e308",
                                          "nan",
                                          "0",
                                          "99999999999999999999",
                                          "|",
                                          ">",
                                          "%",
                                          "? ",
                                          "\\x"};
    const std::size_t at = below(text.size());
    const std::size_t length = std::min(text.size() - at, 1 + below(30));
    switch (below(5)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, text.substr(at, length));
        break;
      case 2:
        text[at] = static_cast<char>(below(256));
        break;
      case 3:
        text.insert(at, kPieces[below(std::size(kPieces))]);
        break;
      default:
        text.replace(at, length, text.substr(below(text.size()), length));
    }
  }

  std::mt19937 random_;
};

/// How many of the damaged files could still be read.
int read_damaged(const std::filesystem::path& scene, const std::filesystem::path& launch, bool damage_scene,
                 Mutator& mutator) {
  const Workspace workspace;
  const std::string scene_text = read_all(scene), launch_text = read_all(launch);
  workspace.write("scenes/" + scene.filename().string(), scene_text);
  int readable = 0;
  for (int i = 0; i < kMutationsPerFile; ++i) {
    const std::string damaged = mutator.damaged(damage_scene ? scene_text : launch_text);
    if (damage_scene) workspace.write("scenes/" + scene.filename().string(), damaged);
    const auto file = workspace.write("launch.yaml", damage_scene ? launch_text : damaged);
    try {
      read_launch(file);
      ++readable;
    } catch (const BadConfig& bad) {
      EXPECT_FALSE(bad.errors().empty());
    } catch (const std::exception& other) {
      ADD_FAILURE() << "mutation " << i << " of seed " << kSeed << ": " << other.what() << "\n" << damaged;
    }
  }
  return readable;
}

TEST(DamagedFiles, OnlyBadConfigComesOut) {
  std::printf("seed %u, %d mutations of each file\n", kSeed, kMutationsPerFile);
  const auto folder = std::filesystem::path(AURASIM_SOURCE_DIR) / "launch_configs";
  Mutator mutator(kSeed);
  int readable = 0, all = 0;
  for (const char* name : {"two_spheres", "columns_rain", "corner_stacks", "island", "three_way"}) {
    for (const bool damage_scene : {true, false}) {
      readable += read_damaged(folder / "scenes" / (std::string(name) + ".yaml"),
                               folder / (std::string(name) + ".yaml"), damage_scene, mutator);
      all += kMutationsPerFile;
    }
  }
  EXPECT_GT(readable, all / 100) << "damage to comments is harmless";
  EXPECT_LT(readable, all) << "the damage reaches the reader";
}

}  // namespace
}  // namespace aurasim::config
