#include "import/sdf_includes.h"

#include <algorithm>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "import/model.h"
#include "import/places.h"

namespace aurasim::importing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDeepestSdfInclude = 16;
constexpr std::size_t kMostIncludes = 10'000;

class IncludeCheck {
 public:
  explicit IncludeCheck(std::vector<fs::path> paths) : paths_(std::move(paths)) {}

  void follow(const fs::path& file) {
    if (std::ranges::find(open_, file) != open_.end())
      throw BadModel({fmt::format("{}: <include>: it includes itself", file.string())});
    if (open_.size() == kDeepestSdfInclude || ++count_ > kMostIncludes)
      throw BadModel({fmt::format("{}: <include>: more than {} deep, or {} in all", file.string(), kDeepestSdfInclude,
                                  kMostIncludes)});
    tinyxml2::XMLDocument document;
    if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) return;  // sdformat reports the error
    open_.push_back(file);
    if (document.RootElement() != nullptr) look_into(*document.RootElement(), file.parent_path());
    open_.pop_back();
  }

 private:
  void look_into(const tinyxml2::XMLElement& element, const fs::path& folder) {
    for (auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      const tinyxml2::XMLElement* uri = child->FirstChildElement("uri");
      if (std::string_view(child->Name()) == "include" && uri != nullptr && uri->GetText() != nullptr) {
        const fs::path named = included_file(uri->GetText(), folder, paths_);
        if (!named.empty()) follow(named);
      } else {
        look_into(*child, folder);
      }
    }
  }

  std::vector<fs::path> paths_;
  std::vector<fs::path> open_;  ///< chain of includes from the first file to the present one
  std::size_t count_ = 0;
};

}  // namespace

fs::path included_file(const std::string& uri, const fs::path& folder, const std::vector<fs::path>& paths) {
  for (const std::string& name : {uri, uri + "/model.sdf"}) {
    const auto found = find_named_file(name, folder, paths);
    if (const auto* path = std::get_if<fs::path>(&found)) return *path;
  }
  return {};
}

void check_sdf_includes(const fs::path& file, const std::vector<fs::path>& paths) {
  std::vector<fs::path> all = paths;
  all.push_back(file.parent_path().empty() ? "." : file.parent_path());
  IncludeCheck(std::move(all)).follow(fs::weakly_canonical(file));
}

}  // namespace aurasim::importing
