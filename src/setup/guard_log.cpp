#include "setup/guard_log.h"

#include <spdlog/spdlog.h>

#include "dds/guarding.h"

namespace aurasim::setup {

void log_new_refusals(dds::Participant& participant) {
  for (const auto& source : dds::take_new_refusals(participant)) {
    spdlog::warn("datagrams from {} are not what a run's peers send, and dropped: so far {}",
                 rtps::text_of_address(source.address), rtps::text_of(source.refused));
  }
}

void log_refusals(dds::Participant& participant) {
  const rtps::GuardReport report = dds::guarded(participant);
  if (report.total() == 0) return;
  for (const auto& source : report.addresses) {
    spdlog::warn("datagrams dropped, from {}: {}", rtps::text_of_address(source.address),
                 rtps::text_of(source.refused));
  }
  if (report.of_others > 0) spdlog::warn("datagrams dropped, from yet more addresses: {}", report.of_others);
  spdlog::info("datagrams dropped: {} of {}", report.total(), report.passed + report.total());
}

}  // namespace aurasim::setup
