// What one host has room for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace aurasim::cli {

/// Processes of one DDS domain that find ports on one host: Fast DDS 2.9 tries 100 pairs, from 7411 + 250 domain up.
std::size_t participants_that_fit(int domain);

/// Why so many regions cannot run on one host, beside the launcher, a viewer and one command; nothing when they can.
std::optional<std::string> problem_with_regions(std::size_t regions, int domain);

/// One line about regions that have to take turns; nothing when each has a processor.
std::optional<std::string> warning_of_turns(std::size_t regions, unsigned processors);

/// Why nobody can listen there; nothing when it works, or when somebody else does, since then there are other ports.
std::optional<std::string> problem_with_listening(const std::string& address, std::uint16_t port);

}  // namespace aurasim::cli
