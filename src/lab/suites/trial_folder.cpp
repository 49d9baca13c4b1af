#include "lab/suites/trial_folder.h"

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <system_error>

namespace aurasim::lab {

TrialFolder::TrialFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "aurasim-lab-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder like " + name);
  path_ = name;
}

TrialFolder::~TrialFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace aurasim::lab
