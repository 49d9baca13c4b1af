// The files that come with the program: QoS profiles, launch files and scenes, the page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aurasim::config {

/// The folder that holds `qos` and `launch_configs`: ../share/aurasim of an installed program, else the source tree
/// around the build folder, or that which the program was built from.
std::filesystem::path shipped_folder();

/// The QoS profiles of a launch file that names none and has no `qos` folder beside its own.
std::filesystem::path shipped_profiles();

/// The folder of the built page, which need not be there.
std::filesystem::path shipped_page();

/// A launch file that comes with the program, by its name without ".yaml". Everything else is a path, returned as it
/// is; so is a name that is a file here.
std::string launch_file_named(const std::string& name);

/// Sorted.
std::vector<std::string> shipped_launch_names();

}  // namespace aurasim::config
