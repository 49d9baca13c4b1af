#include "rtps/delivery.h"

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace aurasim::dds {
namespace {

using namespace std::chrono_literals;

/// Sockets' threads that hand over datagrams without a pause: there is always one on its way.
class Flood : public ::testing::Test {
 protected:
  Flood() {
    for (int i = 0; i < 3; ++i) {
      threads_.emplace_back([this] {
        while (!over_) {
          const auto held = delivery_.begin(false);
          ++seen_;
          ++inside_;
          std::this_thread::sleep_for(1ms);
          --inside_;
        }
      });
    }
  }
  ~Flood() override {
    over_ = true;
    for (std::thread& thread : threads_) thread.join();
  }

  rtps::Delivery delivery_;
  std::atomic<bool> over_ = false;
  std::atomic<int> inside_ = 0;
  std::atomic<int> seen_ = 0;
  std::vector<std::thread> threads_;
};

TEST_F(Flood, IsStoppedAndGoesOn) {
  while (seen_ < 10) std::this_thread::yield();
  for (int i = 0; i < 20; ++i) {
    const auto stopped = delivery_.stop();
    const int seen = seen_;
    EXPECT_EQ(inside_, 0);
    std::this_thread::sleep_for(2ms);
    EXPECT_EQ(seen_, seen);
  }
  const int seen = seen_;
  while (seen_ == seen) std::this_thread::yield();
}

TEST(Delivery, OfWhatIsAloneIsOneAtATime) {
  rtps::Delivery delivery;
  std::atomic<int> inside = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int round = 0; round < 50; ++round) {
        const auto held = delivery.begin(true);
        EXPECT_EQ(++inside, 1);
        std::this_thread::yield();
        --inside;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(Delivery, WhatComesWhileItIsClosedWaits) {
  rtps::Delivery delivery;
  std::atomic<int> seen = 0;
  auto closed = delivery.close();
  std::vector<std::thread> sockets;
  for (int i = 0; i < 3; ++i) {
    sockets.emplace_back([&delivery, &seen, i] {
      const auto held = delivery.begin(i == 0);
      ++seen;
    });
  }
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(seen, 0);
  closed.reset();
  for (std::thread& socket : sockets) socket.join();
  EXPECT_EQ(seen, 3);
  const auto held = delivery.begin(true);  // and nothing waits any more
}

}  // namespace
}  // namespace aurasim::dds
