// Reads XML files, for our own code that looks into them besides the formats' libraries.
#pragma once

#include <filesystem>

#include <tinyxml2.h>

namespace aurasim::importing {

/// Loads a file and returns its outermost element; null if there is none. Throws BadModel, with the line, if it is no
/// XML.
const tinyxml2::XMLElement* load_xml(const std::filesystem::path& file, tinyxml2::XMLDocument& document);

}  // namespace aurasim::importing
