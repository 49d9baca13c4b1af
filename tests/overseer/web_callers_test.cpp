// Who has to go when all connections are taken.
#include "overseer/web_callers.h"

#include <gtest/gtest.h>

namespace aurasim::overseer {
namespace {

class Caller final : public WebCaller {
 public:
  Caller(std::string address, bool silent) : WebCaller(std::move(address)) { set_silent(silent); }
  void drop() override { dropped = true; }
  bool dropped = false;
};

class FullHouse : public ::testing::Test {
 protected:
  std::shared_ptr<Caller> comes(const char* address, bool silent = true) {
    auto caller = std::make_shared<Caller>(address, silent);
    callers_.enter(caller);
    return caller;
  }
  WebCallers callers_{3, 3};
};

TEST_F(FullHouse, NobodyGoesWhileThereIsRoom) {
  const auto first = comes("a"), second = comes("a"), third = comes("a");
  EXPECT_FALSE(first->dropped || second->dropped || third->dropped);
  EXPECT_EQ(callers_.count(), 3U);
}

TEST_F(FullHouse, TheOldestSilentOneGoes) {
  const auto asked = comes("a", false), first = comes("a"), second = comes("a"), fourth = comes("a");
  EXPECT_TRUE(first->dropped);
  EXPECT_FALSE(asked->dropped || second->dropped || fourth->dropped);
  EXPECT_EQ(callers_.count(), 3U);
}

TEST_F(FullHouse, WhoTakesMostGivesFirst) {
  const auto modest = comes("a"), greedy = comes("b"), greedier = comes("b"), other = comes("c");
  EXPECT_TRUE(greedy->dropped);
  EXPECT_FALSE(modest->dropped || greedier->dropped || other->dropped);
}

TEST_F(FullHouse, WhereAllHaveAskedTheOldestGoes) {
  const auto first = comes("a", false), second = comes("a", false), third = comes("a", false), fourth = comes("a");
  EXPECT_TRUE(first->dropped);
  EXPECT_FALSE(second->dropped || third->dropped || fourth->dropped);
}

TEST_F(FullHouse, WhoHasAllPlacesOfOneAddressGivesUpOneOfThem) {
  callers_ = WebCallers(10, 2);
  const auto other = comes("a"), first = comes("b"), second = comes("b"), third = comes("b");
  EXPECT_TRUE(first->dropped);
  EXPECT_FALSE(other->dropped || second->dropped || third->dropped);
  EXPECT_EQ(callers_.count(), 3U);
}

TEST_F(FullHouse, WhoHasEndedTakesNoPlace) {
  auto first = comes("a");
  const auto second = comes("a"), third = comes("a");
  first.reset();
  EXPECT_EQ(callers_.count(), 2U);
  const auto fourth = comes("a");
  EXPECT_FALSE(second->dropped || third->dropped);
}

}  // namespace
}  // namespace aurasim::overseer
