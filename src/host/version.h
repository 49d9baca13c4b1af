// Version and commit of this program.
#pragma once

#include <string>

namespace aurasim::host {

/// The commit, with "-dirty" when sources were changed after it; "unknown" outside a repository.
std::string commit();

/// "aurasim VERSION (COMMIT)".
std::string version_and_commit();

/// Version, commit, build type, compiler, in one line.
std::string version_text();

}  // namespace aurasim::host
