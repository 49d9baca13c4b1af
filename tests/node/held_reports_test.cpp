// When reports and hashes are given out, and what becomes of them when the run goes back.
#include "node/held_reports.h"

#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::node {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

constexpr int kK = 2;

class Held : public ::testing::Test {
 protected:
  /// Reports state `step` with one part of its hash, and parts of earlier states that late bodies have made up.
  void add(core::Step step, std::vector<HashPart> made_up = {}) {
    StepReport report;
    report.step = step;
    report.hash = std::move(made_up);
    report.hash.push_back({step, static_cast<std::uint64_t>(step)});
    held_.add(std::move(report));
  }
  void add_redo(core::Step from, core::Step to, std::vector<HashPart> made_up = {}) {
    StepReport report;
    report.step = to;
    report.put_back_from = from;
    report.hash = std::move(made_up);
    held_.add(std::move(report));
  }
  std::vector<core::Step> given_out() const {
    std::vector<core::Step> steps;
    for (const StepReport& report : held_.given_out()) steps.push_back(report.step);
    return steps;
  }
  std::vector<std::pair<core::Step, std::uint64_t>> hashes() const {
    std::vector<std::pair<core::Step, std::uint64_t>> parts;
    for (const StepReport& report : held_.given_out()) {
      for (const HashPart& part : report.hash) parts.emplace_back(part.step, part.sum);
    }
    return parts;
  }

  HeldReports held_{true, kK};
};

TEST_F(Held, WithoutRedoEveryReportIsGivenOutAtOnceAndWhole) {
  held_ = HeldReports(false, kK);
  add(1, {{0, 7}});
  EXPECT_THAT(given_out(), ElementsAre(1));
  EXPECT_THAT(hashes(), ElementsAre(Pair(0, 7), Pair(1, 1)));
  held_.begin_step();
  EXPECT_THAT(given_out(), IsEmpty());
}

TEST_F(Held, AReportWaitsForItsStateToBeConfirmed) {
  for (core::Step step = 1; step <= 4; ++step) add(step);
  held_.release(2);
  EXPECT_THAT(given_out(), ElementsAre(1, 2));
  EXPECT_EQ(held_.released(), 2);
}

TEST_F(Held, AHashWaitsForTheLastBodyThatMayJoinItsState) {
  for (core::Step step = 1; step <= 4; ++step) add(step);
  held_.release(4);
  EXPECT_THAT(hashes(), ElementsAre(Pair(1, 1), Pair(2, 2)));
}

TEST_F(Held, PartsOfAHashThatComeLaterAreGivenOutWithIt) {
  add(1);
  add(2, {{1, 100}});
  add(3);
  held_.release(3);
  EXPECT_THAT(hashes(), ElementsAre(Pair(1, 1), Pair(1, 100)));
}

TEST_F(Held, StatesThatAreComputedAgainAreReportedOnce) {
  for (core::Step step = 1; step <= 5; ++step) add(step);
  held_.release(3);
  held_.begin_step();
  add_redo(5, 1);
  for (core::Step step = 2; step <= 5; ++step) add(step);
  held_.release(5);
  EXPECT_THAT(given_out(), ElementsAre(1, 4, 5)) << "1: the report of the redo";
  EXPECT_EQ(held_.released(), 5);
}

TEST_F(Held, AHashIsGivenOutOnceHoweverOftenTheRunGoesBack) {
  for (core::Step step = 1; step <= 5; ++step) add(step);
  held_.release(5);
  EXPECT_THAT(hashes(), ElementsAre(Pair(1, 1), Pair(2, 2), Pair(3, 3)));
  held_.begin_step();
  add_redo(5, 2);
  for (core::Step step = 3; step <= 6; ++step) add(step);
  held_.release(6);
  EXPECT_THAT(hashes(), ElementsAre(Pair(4, 4)));
}

TEST_F(Held, BodiesThatJoinAnewAfterASecondRedoCountOnce) {
  add(1);
  add_redo(4, 1, {{1, 50}});
  add_redo(4, 1, {{1, 50}});
  add(2);
  add(3);
  held_.release(3);
  EXPECT_THAT(hashes(), ElementsAre(Pair(1, 1), Pair(1, 50)));
}

TEST_F(Held, TheEndGivesOutWhatHasJoinedTheLastState) {
  for (core::Step step = 1; step <= 3; ++step) add(step);
  StepReport later;
  later.step = 4;
  later.arrivals.resize(2);
  later.arrivals[0].stamp = 3;
  later.arrivals[1].stamp = 4;
  later.hash = {{3, 300}, {4, 4}};
  held_.add(later);
  held_.release(3);
  held_.finish(3);
  EXPECT_THAT(given_out(), ElementsAre(1, 2, 3, 3));
  EXPECT_EQ(held_.given_out().back().arrivals.size(), 1U) << "what was sent after the last state is not of the run";
  EXPECT_THAT(hashes(), ElementsAre(Pair(1, 1), Pair(2, 2), Pair(3, 3), Pair(3, 300)));
  held_.begin_step();
  held_.release(9);
  EXPECT_THAT(given_out(), IsEmpty());
}

}  // namespace
}  // namespace aurasim::node
