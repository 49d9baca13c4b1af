#include "process/records.h"

#include <stdexcept>
#include <utility>

namespace aurasim::process {

void Records::begin() {
  recorder_.reset();  // the old recorder must not write its last rows into the new one's files
  if (folder_) recorder_.emplace(*folder_, region_);
  exchanges_ = {};
}

std::string Records::go_on_after(std::optional<core::Step> step) {
  recorder_.reset();  // as in begin()
  if (!folder_) return {};
  try {
    recorder_.emplace(*folder_, region_, step);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

void Records::note_frame(core::Step step, double frame_ms) {
  frame_times_[step] = {frame_ms, std::exchange(wait_ms_, 0)};
}

void Records::note_exchanges(const dds::ExchangeTimes& times) {
  for (const double one : times.seconds) exchanges_.times.note(one);
  exchanges_.asked += times.counters.questions;
  exchanges_.repeated += times.counters.repeated;
}

void Records::write(const node::StepReport& report) {
  const auto times = frame_times_.find(report.step);
  if (recorder_) recorder_->write(report, times != frame_times_.end() ? times->second : records::FrameTimes{});
  if (times != frame_times_.end() && !report.put_back_from) frame_times_.erase(times);
}

void Records::write_settling(const node::StepReport& report) {
  if (recorder_) recorder_->write_settling(report);
}

void Records::finish(node::Node& node, const records::Ending& ending) {
  if (recorder_) recorder_->finish(node, ending);
}

}  // namespace aurasim::process
