// What a run says of its bodies in its last line.
#include "launch/merged_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::launch {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(ClosingLineOfAReport, CountsBodies) {
  records::Accounts accounts;
  accounts.bodies = 448;
  EXPECT_THAT(closing_line(accounts), StartsWith("448 bodies alive, 0 lost, 0 duplicated; 0 hand-offs"));
}

TEST(ClosingLineOfAReport, SaysWhatRedosTookWhereThereWereAny) {
  records::Accounts accounts;
  EXPECT_THAT(closing_line(accounts), Not(HasSubstr("redos")));
  accounts.redos = 3;
  accounts.redo_share = 0.1234;
  EXPECT_THAT(closing_line(accounts), HasSubstr("; 3 redos took 12.3 % of the computing time\n"));
}

TEST(ClosingLineOfAReport, NamesThePromisesThatWereBroken) {
  records::Accounts accounts;
  accounts.violations = {{"frame", 0}, {"promise", 5176}};
  EXPECT_THAT(closing_line(accounts), HasSubstr("; broken promises: promise 5176\n"));
  accounts.violations.clear();
  EXPECT_THAT(closing_line(accounts), Not(HasSubstr("promise")));
}

/// A disk was full: nobody has written down who is there.
TEST(ClosingLineOfAReport, SaysWhatIsNotKnown) {
  records::Accounts accounts;
  accounts.unaccounted = 448;
  accounts.incomplete.push_back({core::RegionId{2}, 700, "No space left on device"});
  EXPECT_THAT(closing_line(accounts), HasSubstr("not known of 448 bodies"));
  EXPECT_THAT(closing_line(accounts), HasSubstr("regions [2]"));
  EXPECT_THAT(closing_line(accounts), Not(HasSubstr("0 lost")));
}

}  // namespace
}  // namespace aurasim::launch
