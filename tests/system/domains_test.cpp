// Who meets whom.
#include <csignal>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using Domains = SystemTest;

std::string domain_named() { return "DDS domain " + std::to_string(test::own_domain()); }

TEST_F(Domains, TwoDomainsDoNotSeeEachOther) {
  Process& here = launch("here", launch_file("demo"), {"--duration", "3"});
  Process& there = launch("there", launch_file("three_way"), in_own_domain(1) + Words{"--duration", "3"});
  expect_exit(here, 0);
  expect_exit(there, 0);
  for (const char* name : {"here", "there"}) {
    expect_all_bodies_accounted_for(report_of(name));
    EXPECT_EQ(report_of(name).count("steps"), 180);
    for (const auto& node : report_of(name).entry("nodes")) EXPECT_EQ(node.at("messages_of_non_neighbours"), 0);
  }
}

TEST_F(Domains, TwoMapsInOneDomainRefuseEachOther) {
  Process& first = launch("first", launch_file("two_spheres"), {"--duration", "6"});
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("first"), 2, 0));
  Process& second = launch("second", launch_file("three_way"), {"--duration", "2"});
  expect_exit(second, 3);
  EXPECT_THAT(second.err(), AllOf(HasSubstr(domain_named()), HasSubstr("scene 'two_spheres', 2 regions"),
                                  HasSubstr("this is scene 'three_way', 4 regions")));
  EXPECT_TRUE(first.running());
  expect_exit(first, 0);
  expect_all_bodies_accounted_for(report_of("first"));
  EXPECT_EQ(report_of("first").count("steps"), 360);
}

TEST_F(Domains, TheSameSceneOnAnotherMapIsRefusedToo) {
  Process& first = launch("first", launch_file("two_spheres"), {"--duration", "6"});
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("first"), 2, 0));
  Process& second = launch("second", launch_file("two_spheres"), Words{"--duration", "2"} + set({"regions.count=3"}));
  expect_exit(second, 3);
  EXPECT_THAT(second.err(), AllOf(HasSubstr(domain_named()), HasSubstr("2 regions"), HasSubstr("3 regions")));
  expect_exit(first, 0);
  expect_all_bodies_accounted_for(report_of("first"));
}

TEST_F(Domains, TheSameRunTwiceIsRefusedToo) {
  Process& first = launch("first", launch_file("two_spheres"), {"--duration", "6"});
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("first"), 2, 0));
  Process& second = launch("second", launch_file("two_spheres"), {"--duration", "2"});
  expect_exit(second, 3);
  EXPECT_THAT(second.err(), HasSubstr(domain_named()));
  expect_exit(first, 0);
  expect_all_bodies_accounted_for(report_of("first"));
}

/// The second's processes leave the domain without a word; 5 s later their participants are given up. Whoever took
/// their silence for that of the first run's nodes called those lost, and could not end the run.
TEST_F(Domains, ARefusedLaunchDoesNotHarmTheFirst) {
  Process& first = launch("first", launch_file("two_spheres"));
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("first"), 2, 0));
  Process& top = start(Words{"top", launch_file("two_spheres"), "--duration", "14"} + in_own_domain());
  ASSERT_TRUE(wait_until([&] { return top.out().find("running") != std::string::npos; }, kGenerous));
  expect_exit(launch("second", launch_file("two_spheres")), 3);
  expect_exit(top, 0);
  EXPECT_THAT(top.out(), ::testing::Not(HasSubstr("lost")));
  first.signal(SIGINT);
  expect_exit(first, 0);
  expect_all_bodies_accounted_for(report_of("first"));
}

TEST_F(Domains, StoppingARefusedLaunchDoesNotStopTheFirst) {
  Process& first = launch("first", launch_file("two_spheres"), {"--duration", "6"});
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("first"), 2, 0));
  Process& second = launch("second", launch_file("two_spheres"));
  ASSERT_TRUE(wait_until([&] { return children_of(second.pid()).size() == 2; }, kGenerous));
  second.signal(SIGINT);
  ASSERT_TRUE(second.wait(kGenerous)) << second.said();
  expect_exit(first, 0);
  EXPECT_EQ(report_of("first").count("steps"), 360);
}

TEST_F(Domains, ASecondLaunchDoesNotWriteOverTheReportOfTheFirst) {
  Process& first = launch("first", launch_file("two_spheres"), {"--duration", "4"});
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("first"), 2, 0));
  Process& second = launch("first", launch_file("two_spheres"), in_own_domain(1));
  expect_exit(second, 1);
  EXPECT_THAT(second.err(), HasSubstr("another run is writing its report"));
  expect_exit(first, 0);
  expect_all_bodies_accounted_for(report_of("first"));
  EXPECT_EQ(report_of("first").count("steps"), 240);
}

TEST_F(Domains, OfTwoThatBeginTogetherAtMostOneRuns) {
  Process& one = launch("one", launch_file("two_spheres"), {"--duration", "2"});
  Process& other = launch("other", launch_file("two_spheres"), {"--duration", "2"});
  ASSERT_TRUE(one.wait(kGenerous)) << one.said();
  ASSERT_TRUE(other.wait(kGenerous)) << other.said();
  const std::vector<int> codes = {*one.wait(0s), *other.wait(0s)};
  EXPECT_THAT(codes, ::testing::Contains(3)) << one.said() << other.said();
  EXPECT_THAT(codes, ::testing::Each(::testing::AnyOf(0, 3))) << one.said() << other.said();
}

TEST_F(Domains, AMissingNeighbourIsNamed) {
  Process& node = start(Words{"node", launch_file("demo"), "--region", "0", "--start-time-out", "3"} + in_own_domain());
  const auto begin = Clock::now();
  expect_exit(node, 3);
  EXPECT_GT(Clock::now() - begin, 2900ms);
  EXPECT_THAT(node.err(), AllOf(HasSubstr("region 1"), HasSubstr("region 2"), HasSubstr("region 3")));
}

}  // namespace
}  // namespace aurasim::system_test
