// The files that come with the program: QoS profiles, launch files and scenes, the page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aurasim::config {

/// The folder that holds `qos` and `launch_configs`: ../share/aurasim of an installed program, else the source tree
/// around the build folder, or that which the program was built from.
std::filesystem::path shipped_folder();

/// QoS profiles for a launch file that names none and has no `qos` folder beside its own.
std::filesystem::path shipped_profiles();

/// The folder of the built page, which need not be there.
std::filesystem::path shipped_page();

/// Path of a shipped launch file, by its name without ".yaml". Anything else is a path and returned unchanged; so is a
/// name that is also a file in the current folder.
std::string launch_file_named(const std::string& name);

/// Names of the shipped launch files, sorted.
std::vector<std::string> shipped_launch_names();

}  // namespace aurasim::config
