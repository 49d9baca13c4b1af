#include "dds/participant.h"

#include "dds/domain.h"

namespace aurasim::dds {

Participant::Participant(const Settings& settings)
    : settings_(settings), domain_(std::make_unique<Domain>(settings_)) {}

Participant::~Participant() = default;

void Participant::progress() { domain_->liveliness().progress(); }

bool Participant::outlived_its_lease() const { return domain_->liveliness().longest_stall() > domain_->lease(); }

bool Participant::stays_on_this_host() const { return domain_->loopback_only(); }

std::optional<Participant::ImpairmentReport> Participant::impairment() const {
  const DelayLine* line = domain_->delay_line();
  if (line == nullptr) return std::nullopt;
  return ImpairmentReport{line->impairment(), line->counters()};
}

std::uint64_t Participant::refused_of_strangers() const { return domain_->speakers().refused(); }

std::vector<std::string> Participant::take_said() { return domain_->speakers().take_said(); }

void Participant::flush_delayed() {
  if (DelayLine* line = domain_->delay_line()) line->flush();
}

}  // namespace aurasim::dds
