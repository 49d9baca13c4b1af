// A file of rows that survives a full disk: what it holds are whole rows, and the first failed write is the last.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace aurasim::node {

class RowFile {
 public:
  /// Which rows of a file stay: those of states up to `last`.
  struct Keep {
    std::uint64_t last = 0;
    /// Which state a row is of, by its cells. Rows are in the order of their states, but for some that came late.
    std::function<std::uint64_t(std::span<const std::string_view> cells)> state_of;
  };
  /// A row does not come later than this many states after its own.
  static constexpr std::uint64_t kLatest = 3600;

  /// An empty file with one header line; with `keep` those rows that are there already and are to stay. A long file is
  /// neither read nor held as a whole. Throws std::runtime_error when there can be none.
  RowFile(const std::filesystem::path& file, const std::string& header, const std::optional<Keep>& keep = {});
  ~RowFile();
  RowFile(const RowFile&) = delete;
  RowFile& operator=(const RowFile&) = delete;

  /// One row, newline included. It reaches the disk with the next flush, or when many have come together.
  template <class... Values>
  void add(fmt::format_string<Values...> row, Values&&... values) {
    fmt::format_to(std::back_inserter(buffer_), row, std::forward<Values>(values)...);
    if (buffer_.size() > kBuffered) flush();
  }

  /// False when a write has failed, now or earlier; then nothing is written any more.
  bool flush();
  /// Another process has begun a file in its place: nobody will read this one.
  bool is_replaced() const;
  /// Why it failed, for people; empty while it has not.
  const std::string& failure() const { return failure_; }

 private:
  static constexpr std::size_t kBuffered = 64 * 1024;  // bytes

  std::filesystem::path path_;
  int file_ = -1;
  std::string buffer_;
  std::int64_t whole_ = 0;  ///< bytes that hold whole rows
  std::string failure_;
};

/// Writes a file of which `reserve` has kept the blocks. False when that fails.
bool overwrite(const std::filesystem::path& file, const std::string& text);
/// A file of `text` and enough blanks after it that `overwrite` has room on a disk that is full by then. Throws
/// std::runtime_error when there can be none.
void reserve(const std::filesystem::path& file, const std::string& text, std::size_t bytes);

}  // namespace aurasim::node
