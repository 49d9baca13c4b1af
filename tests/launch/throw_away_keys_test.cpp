#include "launch/throw_away_keys.h"

#include <csignal>
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "config/workspace.h"

namespace aurasim::launch {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

/// With a folder for temporary files of its own.
class KeysThatAreThrownAway : public testing::Test {
 protected:
  void SetUp() override { ::setenv("TMPDIR", workspace_.folder().c_str(), 1); }
  void TearDown() override { ::unsetenv("TMPDIR"); }

  /// A process that makes keys and is killed. The folder that it leaves.
  fs::path left_by_a_killed_process() {
    int said[2] = {};
    if (::pipe(said) != 0) return {};
    const pid_t child = ::fork();
    if (child == 0) {
      const ThrowAwayKeys keys(1);
      const std::string folder = keys.folder().parent_path().string();
      if (::write(said[1], folder.data(), folder.size()) < 0) ::_exit(1);
      ::raise(SIGKILL);
    }
    ::close(said[1]);
    std::string folder(4096, '\0');
    const ssize_t size = ::read(said[0], folder.data(), folder.size());
    ::close(said[0]);
    ::waitpid(child, nullptr, 0);
    folder.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return folder;
  }

  config::Workspace workspace_;
};

TEST_F(KeysThatAreThrownAway, ThoseOfAKilledProcessAreRemoved) {
  const fs::path left = left_by_a_killed_process();
  ASSERT_TRUE(fs::is_regular_file(left / "keys/identity_ca.pem")) << left;
  EXPECT_THAT(remove_keys_of_the_gone(), ElementsAre(left));
  EXPECT_FALSE(fs::exists(left));
  EXPECT_THAT(remove_keys_of_the_gone(), IsEmpty());
}

TEST_F(KeysThatAreThrownAway, ThoseOfALiveOneAndOfOthersStay) {
  fs::path own;
  {
    const ThrowAwayKeys keys(1);
    own = keys.folder();
    const fs::path elsewhere = workspace_.folder() / "elsewhere";
    fs::create_directories(elsewhere / "keys");
    fs::create_directory_symlink(elsewhere, workspace_.folder() / "aurasim-keys-linked");
    fs::create_directory(workspace_.folder() / "aurasim-keys-begun");  // made, and not yet locked
    EXPECT_THAT(remove_keys_of_the_gone(), IsEmpty());
    EXPECT_TRUE(fs::is_regular_file(own / "identity_ca.pem"));
    EXPECT_TRUE(fs::exists(elsewhere / "keys"));
  }
  EXPECT_FALSE(fs::exists(own.parent_path()));
}

}  // namespace
}  // namespace aurasim::launch
