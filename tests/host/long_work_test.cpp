#include "host/long_work.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::host {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class WorkThatIsLong : public ::testing::Test {
 protected:
  /// It is this far after this time, and is asked about it every 10 ms.
  void work(std::chrono::milliseconds time) {
    const auto begin = LongWork::Clock::time_point();
    LongWork work(
        "counting sheep", [this](const std::string& text) { said_.push_back(text); }, begin);
    for (auto at = 0ms; at < time; at += 10ms) work.reached(at / std::chrono::duration<double>(time), begin + at);
  }

  std::vector<std::string> said_;
};

TEST_F(WorkThatIsLong, SaysNothingForASecond) {
  work(1000ms);
  EXPECT_THAT(said_, IsEmpty());
}

TEST_F(WorkThatIsLong, SaysHowFarItIsEverMoreSeldom) {
  work(40s);
  EXPECT_THAT(said_, ElementsAre("counting sheep: 2%, 1 s", "counting sheep: 5%, 2 s", "counting sheep: 10%, 4 s",
                                 "counting sheep: 20%, 8 s", "counting sheep: 40%, 16 s", "counting sheep: 65%, 26 s",
                                 "counting sheep: 90%, 36 s"));
}

}  // namespace
}  // namespace aurasim::host
