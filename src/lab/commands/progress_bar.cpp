#include "lab/commands/progress_bar.h"

#include <cstdio>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

namespace aurasim::lab::commands {

ProgressBar::ProgressBar() : is_terminal_(::isatty(STDERR_FILENO) != 0) {}

void ProgressBar::show(const lab::Progress& p) {
  constexpr int kWidth = 40;
  const int tenth = static_cast<int>(10 * p.share);
  if (!is_terminal_ && tenth == last_tenth_) return;
  last_tenth_ = tenth;
  const auto filled = static_cast<std::size_t>(kWidth * p.share);
  fmt::print(stderr, "{}[{:<{}}] {:5.1f}%  {:.0f} s, {:.0f} s left  {}", is_terminal_ ? "\r" : "",
             std::string(filled, '='), kWidth, 100 * p.share, p.elapsed_s, p.left_s, is_terminal_ ? "" : "\n");
  std::fflush(stderr);
}

void ProgressBar::end() const {
  if (is_terminal_) fmt::print(stderr, "\n");
}

}  // namespace aurasim::lab::commands
