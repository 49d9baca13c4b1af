// Who meets whom. Domains 140 to 146.
#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using Domains = SystemTest;

TEST_F(Domains, TwoDomainsDoNotSeeEachOther) {
  Process& here = launch("here", launch_file("demo"), 140, {"--duration", "3"});
  Process& there = launch("there", launch_file("three_way"), 141, {"--duration", "3"});
  expect_exit(here, 0);
  expect_exit(there, 0);
  for (const char* name : {"here", "there"}) {
    expect_all_bodies_accounted_for(report_of(name));
    EXPECT_EQ(report_of(name).count("steps"), 180);
    for (const auto& node : report_of(name).entry("nodes")) EXPECT_EQ(node.at("messages_of_non_neighbours"), 0);
  }
}

TEST_F(Domains, TwoMapsInOneDomainRefuseEachOther) {
  Process& first = launch("first", launch_file("two_spheres"), 142, {"--duration", "6"});
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("first"), 2, 0));
  Process& second = launch("second", launch_file("three_way"), 142, {"--duration", "2"});
  expect_exit(second, 3);
  EXPECT_THAT(second.err(), AllOf(HasSubstr("DDS domain 142"), HasSubstr("scene 'two_spheres', 2 regions"),
                                  HasSubstr("this is scene 'three_way', 4 regions")));
  EXPECT_TRUE(first.running());
  expect_exit(first, 0);
  expect_all_bodies_accounted_for(report_of("first"));
  EXPECT_EQ(report_of("first").count("steps"), 360);
}

TEST_F(Domains, TheSameSceneOnAnotherMapIsRefusedToo) {
  Process& first = launch("first", launch_file("two_spheres"), 143, {"--duration", "6"});
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("first"), 2, 0));
  Process& second =
      launch("second", launch_file("two_spheres"), 143, Words{"--duration", "2"} + set({"regions.count=3"}));
  expect_exit(second, 3);
  EXPECT_THAT(second.err(), AllOf(HasSubstr("DDS domain 143"), HasSubstr("2 regions"), HasSubstr("3 regions")));
  expect_exit(first, 0);
  expect_all_bodies_accounted_for(report_of("first"));
}

TEST_F(Domains, TheSameRunTwiceIsRefusedToo) {
  Process& first = launch("first", launch_file("two_spheres"), 145, {"--duration", "6"});
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("first"), 2, 0));
  Process& second = launch("second", launch_file("two_spheres"), 145, {"--duration", "2"});
  expect_exit(second, 3);
  EXPECT_THAT(second.err(), HasSubstr("DDS domain 145"));
  expect_exit(first, 0);
  expect_all_bodies_accounted_for(report_of("first"));
}

TEST_F(Domains, AMissingNeighbourIsNamed) {
  Process& node =
      start(Words{"node", launch_file("demo"), "--region", "0", "--start-time-out", "3"} + set({"dds.domain=144"}));
  const auto begin = Clock::now();
  expect_exit(node, 3, 8s);
  EXPECT_GT(Clock::now() - begin, 2900ms);
  EXPECT_THAT(node.err(), AllOf(HasSubstr("region 1"), HasSubstr("region 2"), HasSubstr("region 3")));
}

}  // namespace
}  // namespace aurasim::system_test
