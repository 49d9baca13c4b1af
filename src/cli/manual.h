// The manual page, made from the commands themselves.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace aurasim::cli {

/// For `man`, in its macros.
std::string manual_page(const CLI::App& program);

}  // namespace aurasim::cli
