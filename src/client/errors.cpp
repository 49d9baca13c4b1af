#include <aurasim/errors.h>

namespace aurasim::client {

Error::Error(const std::string& what) : std::runtime_error(what) {}

// Defined in this file so that other libraries that catch these errors mean the same type.
Error::~Error() = default;
BadFile::~BadFile() = default;
NoSuchRun::~NoSuchRun() = default;
RunDiffers::~RunDiffers() = default;
LaunchFailed::~LaunchFailed() = default;
TimedOut::~TimedOut() = default;
Refused::~Refused() = default;
Ended::~Ended() = default;
NoProgram::~NoProgram() = default;
Interrupted::~Interrupted() = default;

}  // namespace aurasim::client
