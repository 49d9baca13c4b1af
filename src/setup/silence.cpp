#include "setup/silence.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "command_line/leave.h"

namespace aurasim::setup {
namespace {

constexpr std::chrono::seconds kUntilSaid{3};

std::string processes(std::size_t count) {
  return count == 1 ? "1 process there speaks" : fmt::format("{} processes there speak", count);
}

}  // namespace

void fail_for_want_of_a_run(const command_line::FileArguments& files, const config::Launch& launch,
                            const dds::Participant& participant) {
  if (!participant.has_way_to_all()) {
    spdlog::error(
        "no hub of a run is in DDS domain {}{}: dds.discovery is neighbours here, and there is no run, or one with "
        "other discovery. Another domain is named by --set dds.domain=N, another site's hub by --set dds.hub=ADDRESS",
        launch.dds.domain, launch.dds.hub.empty() ? "" : " at " + launch.dds.hub);
    command_line::leave(1);
  }
  const std::string keys = word_about_keys(participant.peers_by_keys(), launch);
  spdlog::error(
      "no node of {} was heard in DDS domain {}{}. Another domain is named by --set dds.domain=N, other hosts are "
      "reached by --set 'dds.interfaces=[ADDRESS]'",
      files.file, launch.dds.domain, keys);
  command_line::leave(1);
}

std::string word_about_keys(const dds::PeersByKeys& peers, const config::Launch& launch) {
  if (launch.dds.security.empty()) {
    if (peers.with_keys == 0) return {};
    return fmt::format(
        ". {} with keys, and this one has none: --set dds.security=FOLDER gives it those of the run (the first line of "
        "`launch --secure` names its folder)",
        processes(peers.with_keys));
  }
  std::string word;
  if (peers.without_keys > 0) {
    word += fmt::format(". {} without keys, and this one with keys: leave out dds.security to join an open run",
                        processes(peers.without_keys));
  }
  if (peers.refused > 0) {
    word += fmt::format(". {} with other keys than those in {}: --set dds.security=FOLDER names the run's",
                        processes(peers.refused), launch.dds.security.string());
  }
  return word;
}

void SilenceWord::look(bool somebody_is_heard) {
  if (somebody_is_heard || said_) {
    since_ = Clock::now();
    return;
  }
  if (Clock::now() < since_ + kUntilSaid) return;
  const std::string keys = word_about_keys(participant_.peers_by_keys(), launch_);
  if (keys.empty()) return;
  said_ = true;
  spdlog::warn("no node of the run is heard in DDS domain {}{}", launch_.dds.domain, keys);
}

}  // namespace aurasim::setup
