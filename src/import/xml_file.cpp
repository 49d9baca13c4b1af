#include "import/xml_file.h"

#include <fmt/format.h>

#include "import/model.h"

namespace aurasim::importing {

const tinyxml2::XMLElement* load_xml(const std::filesystem::path& file, tinyxml2::XMLDocument& document) {
  if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) {
    throw BadModel({fmt::format("{}:{}: it is no XML: {}", file.string(), document.ErrorLineNum(),
                                tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID()))});
  }
  return document.RootElement();
}

}  // namespace aurasim::importing
