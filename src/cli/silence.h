// What a program does that listens to a run, and hears nobody.
#pragma once

#include <chrono>
#include <string>

#include "cli/commands.h"
#include "config/launch.h"
#include "dds/participant.h"

namespace aurasim::cli {

/// Nodes are found in a fraction of a second, on a bad network in a few.
inline constexpr std::chrono::seconds kPatienceWithSilence{10};

/// Says in which domain nobody was heard, and ends the process with 1.
[[noreturn]] void fail_for_want_of_a_run(const FileArguments& files, const config::Launch& launch,
                                         const dds::Participant& participant);

/// Who is in the domain and cannot be understood, as they have keys and this process has none, or the other way round;
/// and what to do about it. Empty: nobody. Otherwise it goes on behind a sentence without a full stop.
std::string word_about_keys(const dds::PeersByKeys& peers, const config::Launch& launch);

/// For programs that go on listening: says so once, when nobody has been heard for some time.
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

}  // namespace aurasim::cli
