// Behaviour of a program that waits for a run and receives no status.
#pragma once

#include <chrono>
#include <string>

#include "config/launch.h"
#include "dds/participant.h"
#include "setup/arguments.h"

namespace aurasim::setup {

/// How long a program waits for a first status. Nodes are discovered in a fraction of a second, on a bad network in a
/// few seconds.
inline constexpr std::chrono::seconds kPatienceWithSilence{10};

/// Prints in which domain no node was found, and ends the process with exit code 1.
[[noreturn]] void fail_for_want_of_a_run(const command_line::FileArguments& files, const config::Launch& launch,
                                         const dds::Participant& participant);

/// Message about processes in the domain that use keys while this one does not, or the other way round, and what to do
/// about it. Empty if there are none. Otherwise it continues a sentence without a full stop.
std::string word_about_keys(const dds::PeersByKeys& peers, const config::Launch& launch);

/// For programs that go on waiting: prints a message once, when no status has come for some time.
class SilenceWord {
 public:
  using Clock = std::chrono::steady_clock;

  SilenceWord(const config::Launch& launch, const dds::Participant& participant)
      : launch_(launch), participant_(participant) {}

  void look(bool somebody_is_heard);

 private:
  const config::Launch& launch_;
  const dds::Participant& participant_;
  Clock::time_point since_ = Clock::now();
  bool said_ = false;
};

}  // namespace aurasim::setup
