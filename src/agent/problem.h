// Why a request of a client is not fulfilled: the types of aurasim/errors.h, by name.
#pragma once

#include <stdexcept>
#include <string>

namespace aurasim::agent {

enum class Kind { kBadFile, kNoSuchRun, kRunDiffers, kLaunchFailed, kTimedOut, kRefused, kEnded, kNoProgram };

class Problem : public std::runtime_error {
 public:
  Problem(Kind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

/// The kind's name in answers to the client library.
inline const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::kBadFile:
      return "bad_file";
    case Kind::kNoSuchRun:
      return "no_such_run";
    case Kind::kRunDiffers:
      return "run_differs";
    case Kind::kLaunchFailed:
      return "launch_failed";
    case Kind::kTimedOut:
      return "timed_out";
    case Kind::kRefused:
      return "refused";
    case Kind::kEnded:
      return "ended";
    case Kind::kNoProgram:
      return "no_program";
  }
  return "refused";
}

/// The client has gone, or has given the request up.
class Abandoned : public std::runtime_error {
 public:
  Abandoned() : std::runtime_error("given up") {}
};

}  // namespace aurasim::agent
