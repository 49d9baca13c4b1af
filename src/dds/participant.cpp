#include "dds/participant.h"

#include "dds/domain.h"

namespace aurasim::dds {

Participant::Participant(const Settings& settings)
    : settings_(settings), domain_(std::make_unique<Domain>(settings_)) {}

Participant::~Participant() = default;

void Participant::progress() { domain_->pulse().progress(); }

bool Participant::outlived_its_lease() const { return domain_->pulse().longest_stall() > domain_->lease(); }

}  // namespace aurasim::dds
