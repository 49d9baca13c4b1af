// The files of the built page, compressed once for all who ask.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace aurasim::overseer {

/// What the asking side can do and has.
struct FileRequest {
  bool takes_gzip = false;
  std::string etag;  ///< of what it has; empty: nothing
};

struct FileAnswer {
  std::string content_type;
  std::string etag;
  bool is_gzip = false;
  std::shared_ptr<const std::string> bytes;  ///< null: it has them already
};

/// Used by one thread.
class PageFiles {
 public:
  explicit PageFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Nothing: there is no such file (http_rules.h). Reads a file again when it has changed.
  std::optional<FileAnswer> get(std::string_view target, const FileRequest& request);

 private:
  struct Kept {
    std::filesystem::file_time_type written;
    std::uintmax_t size = 0;
    std::string etag;
    std::shared_ptr<const std::string> plain;
    std::shared_ptr<const std::string> gzip;  ///< null: not worth it
  };
  const Kept& read(const std::filesystem::path& file, std::string_view type);

  std::filesystem::path folder_;
  std::map<std::filesystem::path, Kept> kept_;
};

/// As HTTP's Accept-Encoding says it: gzip is named and not forbidden.
bool takes_gzip(std::string_view accept_encoding);

/// RFC 1952, by zlib.
std::string gzip(std::string_view bytes);

}  // namespace aurasim::overseer
