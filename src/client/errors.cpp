#include <aurasim/errors.h>

namespace aurasim::client {

Error::Error(const std::string& what) : std::runtime_error(what) {}

// Here, so that whoever catches one of these in another library means the same type.
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
