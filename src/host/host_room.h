// Limits of what one host can run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace aurasim::host {

/// Number of processes of one DDS domain that find ports on one host. Fast DDS 2.9 tries 100 pairs of ports, from 7411
/// + 250 * domain up.
std::size_t participants_that_fit(int domain);

/// Why `regions` nodes cannot run on one host beside the launcher, a viewer and one command. Nothing if they can.
std::optional<std::string> problem_with_regions(std::size_t regions, int domain);

/// Warning that regions have to share processors. Nothing if each has its own.
std::optional<std::string> warning_of_turns(std::size_t regions, unsigned processors);

/// Why no process can listen at this address and port. Nothing if it works, or if the port is only taken, because then
/// another port can be used.
std::optional<std::string> problem_with_listening(const std::string& address, std::uint16_t port);

}  // namespace aurasim::host
