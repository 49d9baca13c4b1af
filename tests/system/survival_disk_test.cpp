// A site loses its power: all processes of a run end at once. What its nodes have kept on disk goes on with one
// command.
#include <csignal>
#include <fstream>
#include <map>
#include <sstream>

#include <sys/resource.h>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

namespace fs = std::filesystem;

class SurvivalDisk : public SystemTest {
 protected:
  static constexpr std::int64_t kLast = 600;

  Process& run(const std::string& name, const Words& more = {}) {
    return launch(name, launch_file("demo"),
                  Words{"--steps", std::to_string(kLast)} + set({"time.sync=deterministic"}) + more);
  }
  Words with_saves() const { return {"--saves", saves().string()}; }
  fs::path saves() const { return folder() / "saves"; }

  std::map<std::int64_t, std::string> hashes(const std::string& name) const {
    std::map<std::int64_t, std::string> all;
    std::istringstream rows(report_of(name).state_hash());
    for (std::string line; std::getline(rows, line);) {
      const std::size_t comma = line.find(',');
      if (comma != std::string::npos && line != "step,hash") all[std::stoll(line)] = line.substr(comma + 1);
    }
    return all;
  }
  /// The launcher stands meanwhile, or it would start nodes again.
  void kill_all(Process& launcher) const {
    launcher.signal(SIGSTOP);
    for (int region = 0; region < 4; ++region) kill_node(launcher, region);
    launcher.signal(SIGKILL);
    ASSERT_TRUE(launcher.wait(kGenerous));
  }
  /// Folders of runs that keep something on disk.
  std::vector<fs::path> kept() const {
    std::vector<fs::path> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(saves(), none)) {
      if (entry.is_directory()) found.push_back(entry.path());
    }
    return found;
  }
  static std::size_t count_of(const std::string& text, const std::string& word) {
    std::size_t count = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
    return count;
  }
};

TEST_F(SurvivalDisk, AllProcessesAtOnceAreSurvivedWithOneCommand) {
  Process& whole = run("never_stopped", set({"time.pace=none"}));
  expect_exit(whole, 0);
  Process& lost = run("lost", with_saves());
  expect_reaches(report_of("lost"), 4, 220);
  kill_all(lost);
  EXPECT_THAT(lost.err(), HasSubstr("--resume"));
  ASSERT_EQ(kept().size(), 1U);
  const fs::path ours = kept().front();

  // What else may lie there, and is not of this run: newer than all that is.
  const fs::path other = saves() / "run-00000000000000aa";
  fs::create_directories(other);
  fs::path one_part;
  for (const auto& entry : fs::directory_iterator(ours)) {
    if (entry.path().extension() != ".new") one_part = entry.path();
    fs::copy_file(entry.path(), other / entry.path().filename(), fs::copy_options::overwrite_existing);
  }
  ASSERT_FALSE(one_part.empty());
  std::ofstream(ours / "state-999999.cut") << "junk";
  std::ofstream(one_part.string() + ".new") << "half";

  Process& again = run("again", with_saves() + Words{"--resume"} + set({"time.pace=none"}));
  expect_exit(again, 0);
  expect_all_bodies_accounted_for(report_of("again"));
  const auto found = hashes("again");
  ASSERT_FALSE(found.empty());
  EXPECT_GE(found.begin()->first, 120) << "it has not begun with state 0";
  auto wanted = hashes("never_stopped");
  wanted.erase(wanted.begin(), wanted.find(found.begin()->first));
  EXPECT_EQ(found, wanted);
  EXPECT_THAT(again.err(), HasSubstr("of another run"));
  EXPECT_THAT(again.err(), HasSubstr("state-999999.cut"));
  EXPECT_THAT(again.err(), HasSubstr("half-written"));
}

TEST_F(SurvivalDisk, ARunThatHasComeToItsEndLeavesNothing) {
  Process& whole = run("whole", with_saves() + set({"time.pace=none"}));
  expect_exit(whole, 0);
  EXPECT_TRUE(kept().empty());
  Process& none =
      start(Words{"launch", launch_file("demo"), "--headless", "--resume"} + with_saves() + in_own_domain());
  expect_exit(none, 2);
  EXPECT_THAT(none.err(), HasSubstr("--resume: found no whole world"));
}

TEST_F(SurvivalDisk, ARunThatIsEndedByASignalSaysHowItGoesOn) {
  Process& ended = run("ended", with_saves());
  expect_reaches(report_of("ended"), 4, 100);
  ended.signal(SIGTERM);
  expect_exit(ended, 0);
  EXPECT_THAT(ended.err(), HasSubstr("is kept on disk: `aurasim launch"));
  Process& again = run("again", with_saves() + Words{"--resume"} + set({"time.pace=none"}));
  expect_exit(again, 0);
  EXPECT_GE(hashes("again").begin()->first, 60);
}

TEST_F(SurvivalDisk, TheLastMessageOfALostRunNamesTheCommand) {
  Process& lost = run("lost", with_saves());
  expect_reaches(report_of("lost"), 4, 200);
  for (int region = 0; region < 4; ++region) kill_node(lost, region);
  expect_exit(lost, 1);
  const std::string said = lost.err();
  EXPECT_THAT(said.substr(said.rfind("state ")), HasSubstr("--resume` goes on from it"));
}

TEST_F(SurvivalDisk, OfOneNodeToo) {
  const Words alone = set({"regions.count=1"});
  Process& lost = run("lost", with_saves() + alone);
  expect_reaches(report_of("lost"), 1, 200);
  kill_node(lost, 0);
  expect_exit(lost, 1);
  Process& again = run("again", with_saves() + alone + Words{"--resume"} + set({"time.pace=none"}));
  expect_exit(again, 0);
  EXPECT_GE(hashes("again").begin()->first, 120);
}

/// From then on no file of a node may grow beyond some octets, as on a full disk.
TEST_F(SurvivalDisk, AWriteThatFailsIsNamedOnceAndTheRunGoesOn) {
  Process& full =
      start(Words{"launch", launch_file("demo"), "--headless", "--steps", "500"} + with_saves() + in_own_domain());
  ASSERT_TRUE(wait_until([&] { return !kept().empty(); }, kGenerous));
  const ::rlimit no_room{4096, RLIM_INFINITY};
  ::prlimit(node_of(full, 2), RLIMIT_FSIZE, &no_room, nullptr);
  expect_exit(full, 0);
  EXPECT_EQ(count_of(full.err(), "is not kept on disk"), 1U) << full.err();
}

TEST_F(SurvivalDisk, AFolderThatCannotBeWrittenIsRefusedAtTheStart) {
  const fs::path file = write("file", "no folder");
  Process& saves =
      start(Words{"launch", launch_file("demo"), "--headless", "--saves", (file / "saves").string()} + in_own_domain());
  expect_exit(saves, 2);
  EXPECT_THAT(saves.err(), HasSubstr("--saves: found " + (file / "saves").string() + ": Not a directory"));
  Process& disk = start(Words{"launch", launch_file("demo"), "--headless"} +
                        set({"survival.disk=" + (file / "kept").string()}) + in_own_domain());
  expect_exit(disk, 2);
  EXPECT_THAT(disk.err(), HasSubstr("survival.disk: found"));
}

TEST_F(SurvivalDisk, ARunOfWhichNothingWasSavedSaysSoOnceAndDoesNotEndWithZero) {
  Process& full = start(Words{"launch", launch_file("demo"), "--headless", "--steps", "400", "--save-every", "1"} +
                        with_saves() + set({"survival.disk=off"}) + in_own_domain());
  ASSERT_TRUE(wait_until([&] { return fs::exists(saves()) && node_of(full, 3) != 0; }, kGenerous));
  fs::remove_all(saves());
  write("saves", "a file in its place");
  expect_exit(full, 6);
  EXPECT_EQ(count_of(full.err(), "was not saved"), 1U) << full.err();
  EXPECT_EQ(count_of(full.err(), "no world was saved"), 1U) << full.err();
}

}  // namespace
}  // namespace aurasim::system_test
