// Makes a flag of a stop signal, for work that asks a flag.
#pragma once

#include <atomic>
#include <thread>

#include "host/stop_signal.h"

namespace aurasim::lab::commands {

/// True from about 50 ms after a stop signal on, also while nothing asks for it.
class StopFlag {
 public:
  StopFlag() {
    host::catch_stop_signals();
    watch_ = std::jthread([this](const std::stop_token& done) {
      for (; !done.stop_requested(); std::this_thread::sleep_for(std::chrono::milliseconds(50))) {
        if (host::stop_requested()) stop_ = true;
      }
    });
  }
  operator const std::atomic<bool>&() const { return stop_; }

 private:
  std::atomic<bool> stop_ = false;
  std::jthread watch_;
};

}  // namespace aurasim::lab::commands
