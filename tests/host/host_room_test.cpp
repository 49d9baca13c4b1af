// What is refused before anything is started.
#include "host/host_room.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::host {
namespace {

using ::testing::HasSubstr;

TEST(HostRoom, HighDomainsHaveFewerPorts) {
  EXPECT_EQ(participants_that_fit(0), 100U);
  EXPECT_EQ(participants_that_fit(231), 100U);
  EXPECT_EQ(participants_that_fit(232), 63U) << "65535 is the last port";
}

TEST(HostRoom, MoreRegionsThanPortsAreRefusedWithTheNumberThatFits) {
  EXPECT_FALSE(problem_with_regions(97, 0));
  EXPECT_THAT(problem_with_regions(98, 0).value_or(""), HasSubstr("found 98, allowed: at most 97"));
  EXPECT_THAT(problem_with_regions(61, 232).value_or(""), HasSubstr("at most 60"));
}

TEST(HostRoom, RegionsThatTakeTurnsAreWarnedOf) {
  EXPECT_FALSE(warning_of_turns(4, 4));
  EXPECT_FALSE(warning_of_turns(4, 0)) << "who does not know how many there are says nothing";
  EXPECT_THAT(warning_of_turns(9, 2).value_or(""), HasSubstr("9 regions on 2 processors"));
  EXPECT_THAT(warning_of_turns(2, 1).value_or(""), HasSubstr("1 processor:"));
}

TEST(HostRoom, AnAddressOfAnotherHostCannotBeListenedOn) {
  EXPECT_FALSE(problem_with_listening("127.0.0.1", 0));
  EXPECT_FALSE(problem_with_listening("localhost", 0));
  EXPECT_THAT(problem_with_listening("192.0.2.1", 8080).value_or(""), HasSubstr("192.0.2.1:8080"));
  EXPECT_THAT(problem_with_listening("nowhere", 8080).value_or(""), HasSubstr("not an address"));
}

}  // namespace
}  // namespace aurasim::host
