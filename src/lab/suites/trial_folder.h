// A folder for the files of an experiment whose sums are all that is wanted.
#pragma once

#include <filesystem>

namespace aurasim::lab {

/// Makes a new folder, and removes it with all that is in it. Throws std::runtime_error if it cannot be made.
class TrialFolder {
 public:
  TrialFolder();
  ~TrialFolder();
  TrialFolder(const TrialFolder&) = delete;
  TrialFolder& operator=(const TrialFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace aurasim::lab
