// The errors between a program and a run, as types.
#pragma once

#include <stdexcept>
#include <string>

#define AURASIM_API __attribute__((visibility("default")))

namespace aurasim::client {

/// Base of all errors below.
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

/// No node of this launch file was found in its DDS domain.
class AURASIM_API NoSuchRun : public Error {
 public:
  using Error::Error;
  ~NoSuchRun() override;
};

/// The run in the DDS domain has another launch file or other overrides.
class AURASIM_API RunDiffers : public Error {
 public:
  using Error::Error;
  ~RunDiffers() override;
};

/// The launcher ended before the run had begun. what() holds its output.
class AURASIM_API LaunchFailed : public Error {
 public:
  using Error::Error;
  ~LaunchFailed() override;
};

/// The request was not seen to take effect within the time-out. It may still do so.
class AURASIM_API TimedOut : public Error {
 public:
  using Error::Error;
  ~TimedOut() override;
};

/// The run refuses the request; what() gives the reason.
class AURASIM_API Refused : public Error {
 public:
  using Error::Error;
  ~Refused() override;
};

/// The run has ended, this World was closed, or its agent process has died.
class AURASIM_API Ended : public Error {
 public:
  using Error::Error;
  ~Ended() override;
};

/// The program `aurasim` was not found, or has another version than this library.
class AURASIM_API NoProgram : public Error {
 public:
  using Error::Error;
  ~NoProgram() override;
};

/// A call was cancelled because ConnectOptions::interrupted returned true.
class AURASIM_API Interrupted : public Error {
 public:
  using Error::Error;
  ~Interrupted() override;
};

}  // namespace aurasim::client
