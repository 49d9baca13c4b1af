// Runs with keys: the same world, closed to others; and what is said to keys that are wrong.
#include <regex>

#include <sys/stat.h>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Security : public SystemTest {
 protected:
  const Words kSoon = {"--steps", "300"};
  const Words kSameBits = set({"time.sync=deterministic", "time.pace=none"});

  /// Where a run with --secure has its keys; empty: it has not said so yet.
  static std::string keys_of(const Process& run) {
    std::smatch found;
    const std::string said = run.err();
    return std::regex_search(said, found, std::regex("--set dds.security=(\\S+)")) ? found[1].str() : "";
  }

  /// What a process without keys says of others, and what is to be done.
  static constexpr const char* kSpeakWithKeys =
      "with keys, and this one has none: --set dds.security=FOLDER gives it those of the run";

  fs::path keys() const { return folder() / "keys"; }
  void make_keys() {
    expect_exit(start({"keys", "init", keys().string()}), 0);
    expect_exit(start({"keys", "add-region", keys().string(), "0-3"}), 0);
    expect_exit(start({"keys", "add", keys().string(), "desk", "--role", "operator"}), 0);
    expect_exit(start({"keys", "add", keys().string(), "hall", "--role", "viewer"}), 0);
  }
  /// It ends with exit code 2 and says this.
  void expect_refusal(const Words& words, const std::string& what) {
    Process& program = start(words);
    expect_exit(program, 2);
    EXPECT_THAT(program.err(), HasSubstr(what)) << program.said();
  }
  Words with_keys() const { return in_own_domain() + set({"dds.security=" + keys().string()}); }
};

TEST_F(Security, ARunWithKeysHasTheStatesOfAnOpenOne) {
  Process& closed = launch("closed", launch_file("demo"), Words{"--secure"} + kSoon + kSameBits);
  Process& open = launch("open", launch_file("demo"), kSoon + kSameBits);  // in the same domain, without a word
  expect_exit(closed, 0, 120s);
  expect_exit(open, 0, 120s);
  EXPECT_EQ(report_of("closed").state_hash(), report_of("open").state_hash());
  EXPECT_GT(report_of("closed").count("migrations"), 50);
  expect_all_bodies_accounted_for(report_of("closed"));
  ASSERT_NE(keys_of(closed), "") << closed.said();
  EXPECT_FALSE(fs::exists(keys_of(closed))) << "they are thrown away";
  EXPECT_FALSE(fs::exists(fs::path(keys_of(closed)).parent_path()));
}

TEST_F(Security, EverybodyDoesWhatTheirKeysAreFor) {
  make_keys();
  const std::string demo = launch_file("demo");
  Process& run = launch("run", demo, set({"dds.security=" + keys().string()}));
  expect_reaches(report_of("run"), 4, 30);

  const auto sees_them_run = [&] {
    Process& top = start(Words{"top", demo, "--duration", "3"} + with_keys());
    expect_exit(top, 0);
    return top.out().find("running") != std::string::npos;
  };
  EXPECT_TRUE(wait_until(sees_them_run, kGenerous));
  Process& replica = start(Words{"echo", "replica_key", demo, "--count", "1", "--duration", "20"} + with_keys());
  expect_exit(replica, 0);
  expect_refusal(Words{"echo", "migration", demo, "--count", "1", "--as", "hall"} + with_keys(),
                 "may not read migration");
  expect_refusal(Words{"send", "stop", demo, "--as", "hall"} + with_keys(), "allowed for this: operator");
  Process& stranger = start(Words{"top", demo, "--duration", "3"} + in_own_domain());
  expect_exit(stranger, 1);
  EXPECT_THAT(stranger.err(), AllOf(HasSubstr("no node of"), HasSubstr(kSpeakWithKeys)));
  for (const Words& words :
       {Words{"send", "pause", demo}, Words{"node", demo, "--region", "2", "--start-time-out", "4"},
        Words{"echo", "replica_key", demo, "--duration", "3"}}) {
    Process& another = start(words + in_own_domain());
    another.wait(kGenerous);
    EXPECT_THAT(another.err(), HasSubstr(kSpeakWithKeys)) << another.said();
  }
  EXPECT_TRUE(wait_until([&] { return run.err().find("without keys") != std::string::npos; }, kGenerous)) << run.said();

  expect_exit(start(Words{"send", "stop", demo} + with_keys()), 0);
  expect_exit(run, 0);
}

TEST_F(Security, WhoHasKeysIsToldOfAnOpenRunAndOfOtherKeys) {
  make_keys();
  const std::string demo = launch_file("demo");
  Process& open = launch("open", demo);
  expect_reaches(report_of("open"), 4, 30);
  Process& send = start(Words{"send", "pause", demo} + with_keys());
  expect_exit(send, 1);
  EXPECT_THAT(send.err(), HasSubstr("without keys, and this one with keys: leave out dds.security")) << send.said();
  expect_exit(start(Words{"send", "stop", demo} + in_own_domain()), 0);
  expect_exit(open, 0);

  const std::string others = (folder() / "others").string();
  expect_exit(start({"keys", "init", others}), 0);
  expect_exit(start({"keys", "add", others, "desk", "--role", "operator"}), 0);
  Process& closed = launch("closed", demo, set({"dds.security=" + keys().string()}));
  expect_reaches(report_of("closed"), 4, 30);
  Process& stranger = start(Words{"send", "pause", demo} + in_own_domain() + set({"dds.security=" + others}));
  expect_exit(stranger, 1);
  EXPECT_THAT(stranger.err(), HasSubstr("with other keys than those in " + others)) << stranger.said();
  expect_exit(start(Words{"send", "stop", demo} + with_keys()), 0);
  expect_exit(closed, 0);
}

TEST_F(Security, KeysThatAreWrongEndAProgramWithWordsAboutThem) {
  make_keys();
  const Words node = Words{"node", launch_file("demo"), "--region", "2"} + with_keys();
  const fs::path own = keys() / "names/region-2";

  expect_exit(start({"keys", "check", keys().string()}), 0);
  fs::permissions(own / "key.pem", fs::perms::others_read, fs::perm_options::add);
  expect_refusal(node, (own / "key.pem").string() + ": found mode 0604, allowed: 0600");
  expect_refusal({"keys", "check", keys().string()}, "");
  fs::permissions(own / "key.pem", fs::perms::owner_read | fs::perms::owner_write);

  fs::rename(own / "permissions.p7s", own / "away");
  expect_refusal(node, (own / "permissions.p7s").string() + ": cannot read it");
  fs::rename(own / "away", own / "permissions.p7s");

  expect_exit(start({"keys", "revoke", keys().string(), "region-2"}), 0);
  expect_refusal(node, (own / "certificate.pem").string() + ": revoked");
  expect_refusal(Words{"launch", launch_file("demo"), "--headless"} + with_keys(), "revoked");
  expect_exit(start({"keys", "rotate", keys().string(), "region-2"}), 0);
  expect_exit(start({"keys", "check", keys().string()}), 0);

  expect_refusal(Words{"check", launch_file("demo")} + set({"dds.security=/nowhere"}), "dds.security");
  expect_refusal({"keys", "add", keys().string(), "a/b", "--role", "viewer"}, "a/b");
  expect_refusal({"keys", "init", keys().string()}, "File exists");
  expect_refusal({"keys", "add-region", keys().string(), "x"}, "REGIONS");
  expect_refusal({"keys", "pack", keys().string(), "region-9", "--to", (folder() / "9.tar").string()}, "region-9");
}

TEST_F(Security, APackedFileIsAllThatAHostNeeds) {
  make_keys();
  const fs::path packed = folder() / "region-2.tar";
  expect_exit(start({"keys", "pack", keys().string(), "region-2", "--to", packed.string()}), 0);
  struct stat status = {};
  ASSERT_EQ(::stat(packed.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600U);
  const fs::path host = folder() / "host";
  fs::create_directory(host);
  expect_exit(start_program({"/bin/tar", "-xpf", packed.string(), "-C", host.string()}), 0);
  EXPECT_FALSE(fs::exists(host / "private"));
  EXPECT_FALSE(fs::exists(host / "names/region-1"));
  expect_exit(start({"keys", "check", host.string()}), 0);
  expect_refusal({"keys", "add", host.string(), "more", "--role", "operator"}, "private/identity_ca.key.pem");
}

}  // namespace
}  // namespace aurasim::system_test
