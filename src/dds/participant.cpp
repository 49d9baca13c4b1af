#include "dds/participant.h"

#include <utility>

#include <fmt/format.h>

#include "dds/domain.h"
#include "dds/security_log.h"
#include "rtps/datagram_guard.h"

namespace aurasim::dds {

Participant::Participant(const Settings& settings)
    : settings_(settings), domain_(std::make_unique<Domain>(settings_)) {}

Participant::~Participant() = default;

void Participant::progress() { domain_->liveliness().progress(); }

bool Participant::stays_on_this_host() const { return domain_->loopback_only(); }

bool Participant::has_way_to_all() const { return domain_->has_way_to_all(); }

std::optional<Participant::ImpairmentReport> Participant::impairment() const {
  const DelayLine* line = domain_->delay_line();
  if (line == nullptr) return std::nullopt;
  return ImpairmentReport{line->impairment(), line->counters()};
}

std::uint64_t Participant::refused_of_strangers() const {
  const rtps::GuardReport guarded = domain_->guard().report();
  return domain_->speakers().refused() + guarded.refused[static_cast<std::size_t>(rtps::Refusal::kRepeat)];
}

PeersByKeys Participant::peers_by_keys() const { return domain_->peer_keys().count(); }

std::vector<std::string> Participant::take_said() {
  std::vector<std::string> said = domain_->speakers().take_said();
  for (const auto& [process, answer] : domain_->guard().take_new_askers()) {
    const char* const what = answer == rtps::Repeats::Answer::kHasAll
                                 ? "reads what nodes say to each other, and is none: nothing is sent again to it, or "
                                   "kept for it"
                                 : "asks for more to be sent again than it is given";
    said.push_back(fmt::format("process {} {}", text_of(process_of(process)), what));
  }
  if (settings_.keys) {
    for (std::string& text : said) text = SecurityLog::instance().with_name_of_process(std::move(text));
  }
  return said;
}

void Participant::flush_delayed() {
  if (DelayLine* line = domain_->delay_line()) line->flush();
}

}  // namespace aurasim::dds
