// Collects everything that is wrong with a set of files, so that one run reports all of it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace aurasim::config {

/// Place of a value: line and column of a file, from 1, or an override as a whole (line 0).
struct Place {
  std::uint32_t source = 0;  ///< number given by Errors::add_source
  int line = 0;
  int column = 0;
};

class Errors {
 public:
  /// Registers a file or an override, whose name starts every message about it. Returns its number.
  std::uint32_t add_source(std::string name);

  /// Adds an error. `field` is a path such as "regions.count"; empty for the whole file.
  void add(const Place& place, std::string_view field, std::string_view message);

  bool empty() const { return count_ == 0; }

  /// Throws BadConfig if there are errors, with the messages in the order of their places.
  void throw_if_any() const;

 private:
  struct Entry {
    Place place;
    std::string text;
  };

  std::vector<std::string> sources_;
  std::vector<Entry> entries_;
  std::size_t count_ = 0;  ///< number of all errors; entries_ stops growing at a limit
};

/// Quotes a text of a file for a message: control characters are escaped, long texts cut.
std::string in_quotes(std::string_view text);

}  // namespace aurasim::config
