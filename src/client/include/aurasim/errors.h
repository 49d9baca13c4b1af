// What can go wrong between a program and a run, as types.
#pragma once

#include <stdexcept>
#include <string>

#define AURASIM_API __attribute__((visibility("default")))

namespace aurasim::client {

/// Of all that follow.
class AURASIM_API Error : public std::runtime_error {
 public:
  explicit Error(const std::string& what);
  ~Error() override;
};

/// The launch file, its scene, an override or a key is wrong: one message a line, each with file, line and column.
class AURASIM_API BadFile : public Error {
 public:
  using Error::Error;
  ~BadFile() override;
};

/// No node of this launch file was heard in its DDS domain.
class AURASIM_API NoSuchRun : public Error {
 public:
  using Error::Error;
  ~NoSuchRun() override;
};

/// There is a run in the DDS domain, of another launch file or with other overrides.
class AURASIM_API RunDiffers : public Error {
 public:
  using Error::Error;
  ~RunDiffers() override;
};

/// The launcher has ended before the run had begun: its words.
class AURASIM_API LaunchFailed : public Error {
 public:
  using Error::Error;
  ~LaunchFailed() override;
};

/// What was asked for is not done, as far as was seen within the time-out. It may still come.
class AURASIM_API TimedOut : public Error {
 public:
  using Error::Error;
  ~TimedOut() override;
};

/// The run does not do that, and why.
class AURASIM_API Refused : public Error {
 public:
  using Error::Error;
  ~Refused() override;
};

/// The run has ended, this World was closed, or the process that speaks for it has died.
class AURASIM_API Ended : public Error {
 public:
  using Error::Error;
  ~Ended() override;
};

/// The program `aurasim` is not there, or is of another version than this library.
class AURASIM_API NoProgram : public Error {
 public:
  using Error::Error;
  ~NoProgram() override;
};

/// A call was given up because ConnectOptions::interrupted said so.
class AURASIM_API Interrupted : public Error {
 public:
  using Error::Error;
  ~Interrupted() override;
};

}  // namespace aurasim::client
