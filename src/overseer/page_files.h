// Serves the files of the built page. Each is compressed once for all requests.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace aurasim::overseer {

/// The requesting browser's abilities, and the version of the file that it already has.
struct FileRequest {
  bool takes_gzip = false;
  std::string etag;  ///< ETag of its copy; empty: it has none
};

struct FileAnswer {
  std::string content_type;
  std::string etag;
  bool is_gzip = false;
  std::shared_ptr<const std::string> bytes;  ///< content; null: its copy is up to date
};

/// Used by one thread.
class PageFiles {
 public:
  explicit PageFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Returns the answer; nothing: there is no such file (http_rules.h). Reads a file again when it has changed.
  std::optional<FileAnswer> get(std::string_view target, const FileRequest& request);

 private:
  struct Kept {
    std::filesystem::file_time_type written;
    std::uintmax_t size = 0;
    std::string etag;
    std::shared_ptr<const std::string> plain;
    std::shared_ptr<const std::string> gzip;  ///< compressed content; null: compression does not pay
  };
  const Kept& read(const std::filesystem::path& file, std::string_view type);

  std::filesystem::path folder_;
  std::map<std::filesystem::path, Kept> kept_;
};

/// True when HTTP's Accept-Encoding names gzip and does not forbid it.
bool takes_gzip(std::string_view accept_encoding);

/// Compresses `bytes` as gzip (RFC 1952).
std::string gzip(std::string_view bytes);

}  // namespace aurasim::overseer
