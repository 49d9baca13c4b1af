// What cannot be done is refused by name, and never called done.
#include <algorithm>
#include <csignal>
#include <stdexcept>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Somebody else's port.
class TakenPort {
 public:
  TakenPort() : file_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    ::sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::socklen_t size = sizeof(place);
    if (::bind(file_, reinterpret_cast<::sockaddr*>(&place), size) != 0 || ::listen(file_, 1) != 0 ||
        ::getsockname(file_, reinterpret_cast<::sockaddr*>(&place), &size) != 0) {
      throw std::runtime_error("cannot take a port");
    }
    number_ = ntohs(place.sin_port);
  }
  ~TakenPort() { ::close(file_); }
  TakenPort(const TakenPort&) = delete;
  TakenPort& operator=(const TakenPort&) = delete;

  std::string number() const { return std::to_string(number_); }

 private:
  int file_;
  int number_ = 0;
};

class Refusals : public SystemTest {
 protected:
  void expect_refused(const Words& words, int code, const std::string& why) {
    Process& program = start(words);
    expect_exit(program, code, kGenerous);
    EXPECT_THAT(program.err(), HasSubstr(why)) << program.said();
  }
  const std::string file_ = launch_file("two_spheres");
};

TEST_F(Refusals, WhoWatchesARunThatIsNotThereIsToldSo) {
  const Words in_domain = in_own_domain();
  Process& top = start(Words{"top", file_} + in_domain);
  Process& echo = start(Words{"echo", "aura", file_} + in_domain);
  for (Process* program : {&top, &echo}) {
    expect_exit(*program, 1, kGenerous);
    EXPECT_THAT(program->err(),
                AllOf(HasSubstr("no node of"), HasSubstr("DDS domain " + std::to_string(test::own_domain()))))
        << program->said();
  }
  expect_refused(Words{"top", file_, "--duration", "1"} + in_domain, 1, "no node of");
}

TEST_F(Refusals, APartitionThatNobodyCanPublishInIsNamed) {
  expect_refused({"echo", "aura", file_, "--partition", "regoin/1"}, 2, "region/0 to region/1");
  expect_refused({"echo", "aura", file_, "--partition", "region/2"}, 2, "region/0 to region/1");
  expect_refused({"echo", "run_control", file_, "--partition", "region/*"}, 2, "world");
}

TEST_F(Refusals, ARecordingThatCannotBeWrittenStopsTheLaunch) {
  expect_refused(
      Words{"launch", file_, "--headless", "--record", (folder() / "none" / "run.rec").string()} + in_own_domain(), 1,
      "No such file or directory");
}

TEST_F(Refusals, AnAddressThatIsNotOursStopsTheLaunch) {
  expect_refused(Words{"launch", file_} + in_own_domain() + set({"overseer.bind=192.0.2.1"}), 1, "192.0.2.1:8080");
}

TEST_F(Refusals, MoreRegionsThanOneHostHasPortsForStartNothing) {
  expect_refused(Words{"launch", file_, "--headless", "--report", (folder() / "report").string()} + in_own_domain() +
                     set({"regions.count=120"}),
                 2, "found 120, allowed: at most 97");
  EXPECT_FALSE(std::filesystem::exists(folder() / "report"));
}

TEST_F(Refusals, ATakenPortIsSaidBesideTheOneThatIsUsed) {
  const TakenPort port;
  Process& run = start(Words{"launch", file_} + in_own_domain() + set({"overseer.port=" + port.number()}));
  EXPECT_TRUE(wait_until([&] { return run.out().find("(port " + port.number() + " is taken)") != std::string::npos; },
                         kGenerous))
      << run.said();
  run.signal(SIGINT);
  expect_exit(run, 0, kGenerous);
}

TEST_F(Refusals, RegionsThatTakeTurnsAreWarnedOf) {
  const std::string count = std::to_string(std::max(2L, ::sysconf(_SC_NPROCESSORS_ONLN) + 1));
  Process& run =
      start(Words{"launch", file_, "--headless", "--steps", "5"} + in_own_domain() + set({"regions.count=" + count}));
  expect_exit(run, 0, kGenerous);
  EXPECT_THAT(run.err(), HasSubstr(count + " regions on "));
}

TEST_F(Refusals, ACommandOfTheLaboratoryIsNamedWithItsProgram) {
  expect_refused({"experiment", "scenes", "--seeds", "1-2"}, 2, "aurasim-lab experiment scenes --seeds 1-2");
}

TEST_F(Refusals, AReportIsNotWrittenWhereNothingWasRecorded) {
  const std::filesystem::path empty = folder() / "empty";
  std::filesystem::create_directories(empty);
  expect_refused({"report", file_, empty.string()}, 2, "region_0 to region_1");
  EXPECT_TRUE(std::filesystem::is_empty(empty));
}

TEST_F(Refusals, WhatIsMistypedIsAnsweredWithTheNearest) {
  expect_refused({"lunch", file_}, 2, "did you mean 'launch'?");
  expect_refused({"launch", file_, "--headles"}, 2, "did you mean '--headless'?");
}

}  // namespace
}  // namespace aurasim::system_test
