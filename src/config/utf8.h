// Checks which bytes are allowed in a configuration file.
#pragma once

#include <cstddef>
#include <string_view>

namespace aurasim::config {

/// Index of the first byte that is no printable UTF-8 (tab and line ends are fine), or text.size().
std::size_t first_unprintable(std::string_view text);

}  // namespace aurasim::config
