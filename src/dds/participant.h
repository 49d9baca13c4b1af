// One DDS participant per process: profiles, types, topics, discovery and the proof of life. Everything else in this
// folder borrows it and must be destroyed before it.
#pragma once

#include <memory>

#include "dds/settings.h"

namespace aurasim::dds {

class Domain;  // domain.h, with Fast DDS behind it

class Participant {
 public:
  /// Joins the domain. Throws DdsError with the file and the profile that is missing or wrong.
  explicit Participant(const Settings& settings);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// Says that the owner is not stuck. Transports and buses call it on every use; call it in a longer computation.
  /// Any thread.
  void progress();

  const Settings& settings() const { return settings_; }
  Domain& domain() { return *domain_; }

 private:
  Settings settings_;
  std::unique_ptr<Domain> domain_;
};

}  // namespace aurasim::dds
