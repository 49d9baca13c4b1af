#include "overseer/page_files.h"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>

#include "overseer/http_rules.h"

namespace aurasim::overseer {
namespace {

constexpr std::size_t kWorthIt = 1024;    // bytes; a smaller answer fits into one packet anyway
constexpr int kGzipFormat = 15 + 16;      // zlib's value for the largest window and a header of gzip
constexpr std::size_t kMostKept = 1'000;  // most files that are kept; a page has fewer

std::string whole_file(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return std::move(text).str();
}

/// True for types that compression makes smaller. Pictures and fonts are compressed already.
bool is_text(std::string_view type) {
  return type.starts_with("text/") || type.starts_with("application/json") || type.starts_with("image/svg") ||
         type.starts_with("application/wasm") || type.starts_with("model/gltf+json");
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

bool takes_gzip(std::string_view accept_encoding) {
  while (!accept_encoding.empty()) {
    const std::string_view item = accept_encoding.substr(0, accept_encoding.find(','));
    accept_encoding.remove_prefix(std::min(accept_encoding.size(), item.size() + 1));
    const std::string_view name = trimmed(item.substr(0, item.find(';')));
    if (name != "gzip" && name != "*") continue;
    const auto weight = item.find("q=");
    return weight == std::string_view::npos || item.find_first_of("123456789", weight) != std::string_view::npos;
  }
  return false;
}

std::string gzip(std::string_view bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzipFormat, 9, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string packed(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib reads it only
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int ended = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (ended != Z_STREAM_END) throw std::logic_error("zlib's bound was too small");
  return packed;
}

const PageFiles::Kept& PageFiles::read(const std::filesystem::path& file, std::string_view type) {
  std::error_code ignored;
  const auto written = std::filesystem::last_write_time(file, ignored);
  const auto size = std::filesystem::file_size(file, ignored);
  if (kept_.size() > kMostKept) kept_.clear();
  Kept& kept = kept_[file];
  if (kept.plain && kept.written == written && kept.size == size) return kept;
  std::string bytes = whole_file(file);
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()));
  kept = {written, size, fmt::format("{:08x}-{:x}", sum, bytes.size()), nullptr, nullptr};
  if (is_text(type) && bytes.size() >= kWorthIt) kept.gzip = std::make_shared<const std::string>(gzip(bytes));
  kept.plain = std::make_shared<const std::string>(std::move(bytes));
  return kept;
}

std::optional<FileAnswer> PageFiles::get(std::string_view target, const FileRequest& request) {
  const auto file = file_for(folder_, target);
  if (!file) return std::nullopt;
  const std::string_view type = mime_type(*file);
  const Kept& kept = read(*file, type);
  FileAnswer answer;
  answer.content_type = type;
  answer.is_gzip = request.takes_gzip && kept.gzip;
  answer.etag = fmt::format("\"{}{}\"", kept.etag, answer.is_gzip ? "-gz" : "");
  if (request.etag != answer.etag) answer.bytes = answer.is_gzip ? kept.gzip : kept.plain;
  return answer;
}

}  // namespace aurasim::overseer
