// XML files, where our own code looks into them beside the fields' libraries.
#pragma once

#include <filesystem>

#include <tinyxml2.h>

namespace aurasim::importing {

/// The outermost element; null if there is none. Throws BadModel, with the line, for what is no XML.
const tinyxml2::XMLElement* load_xml(const std::filesystem::path& file, tinyxml2::XMLDocument& document);

}  // namespace aurasim::importing
