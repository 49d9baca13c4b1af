#include "lab/commands/progress_bar.h"

#include <cstdio>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "host/stop_signal.h"

namespace aurasim::lab::commands {

ProgressBar::ProgressBar() : is_terminal_(::isatty(STDERR_FILENO) != 0) { host::catch_stop_signals(); }

ProgressBar::~ProgressBar() {
  if (is_terminal_ && last_tenth_ >= 0) fmt::print(stderr, "\n");
}

bool ProgressBar::operator()(double share) {
  constexpr int kWidth = 40;
  const int tenth = static_cast<int>(10 * share);
  if (is_terminal_ || tenth != last_tenth_) {
    const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    const double left_s = share > 0 ? elapsed_s * (1 - share) / share : 0;
    last_tenth_ = tenth;
    fmt::print(stderr, "{}[{:<{}}] {:5.1f}%  {:.0f} s, {:.0f} s left  {}", is_terminal_ ? "\r" : "",
               std::string(static_cast<std::size_t>(kWidth * share), '='), kWidth, 100 * share, elapsed_s, left_s,
               is_terminal_ ? "" : "\n");
    std::fflush(stderr);
  }
  return !host::stop_requested();
}

}  // namespace aurasim::lab::commands
