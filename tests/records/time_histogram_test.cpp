#include "records/time_histogram.h"

#include <gtest/gtest.h>

namespace aurasim::records {
namespace {

TEST(TimeHistogramTest, PercentilesAreAtMostTwoPerCentTooLong) {
  TimeHistogram times;
  for (int i = 1; i <= 1000; ++i) times.note(i * 1e-5);
  EXPECT_EQ(times.count(), 1000U);
  EXPECT_EQ(times.longest_s(), 1e-2);
  for (const double q : {0.1, 0.5, 0.99}) {
    EXPECT_GE(times.percentile_s(q), q * 1e-2);
    EXPECT_LE(times.percentile_s(q), 1.021 * (q * 1e-2 + 1e-5));
  }
  EXPECT_EQ(times.percentile_s(1), times.longest_s());
}

TEST(TimeHistogramTest, DurationsOfAnyLengthAreCounted) {
  TimeHistogram times;
  EXPECT_EQ(times.percentile_s(0.5), 0);
  times.note(0);
  times.note(1e4);
  EXPECT_EQ(times.count(), 2U);
  EXPECT_LE(times.percentile_s(0), 1.03e-6);
  EXPECT_GE(times.percentile_s(0.9), 90);
  EXPECT_EQ(times.longest_s(), 1e4);
}

}  // namespace
}  // namespace aurasim::records
