// A file of rows that survives a full disk: it holds whole rows only, and after the first failed write it writes
// nothing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace aurasim::records {

class RowFile {
 public:
  /// Selects the rows of an existing file that are kept: those of states up to `last`.
  struct Keep {
    std::uint64_t last = 0;
    /// Returns the state that a row belongs to, from its cells. Rows are in the order of their states, except that some
    /// come late (kLatest).
    std::function<std::uint64_t(std::span<const std::string_view> cells)> state_of;
  };
  /// Number of states by which a row may come late.
  static constexpr std::uint64_t kLatest = 3600;

  /// Creates a file with one header line. With `keep` it keeps the rows of an existing file that `keep` selects. A long
  /// file is neither read nor held as a whole. Throws std::runtime_error when the file cannot be created.
  RowFile(const std::filesystem::path& file, const std::string& header, const std::optional<Keep>& keep = {});
  ~RowFile();
  RowFile(const RowFile&) = delete;
  RowFile& operator=(const RowFile&) = delete;

  /// Adds one row; `row` includes the newline. The row is written with the next flush, or when kBuffered bytes have
  /// gathered.
  void add(std::string_view row) {
    buffer_ += row;
    if (buffer_.size() > kBuffered) flush();
  }

  /// Writes the buffered rows. False when a write has failed, now or earlier; after a failure nothing more is written.
  bool flush();
  /// True if another process has begun a file under the same name, so that nobody will read this one.
  bool is_replaced() const;
  /// Why a write failed, as text for users. Empty while no write has failed.
  const std::string& failure() const { return failure_; }

 private:
  static constexpr std::size_t kBuffered = 64 * 1024;  // bytes

  std::filesystem::path path_;
  int file_ = -1;
  std::string buffer_;
  std::int64_t whole_ = 0;  ///< length of the file that holds whole rows, in bytes
  std::string failure_;
};

/// Writes `text` into a file whose blocks reserve() has kept. False when that fails.
bool overwrite(const std::filesystem::path& file, const std::string& text);
/// Writes `text` followed by blanks, `bytes` in all, so that overwrite() has room even on a full disk. Throws
/// std::runtime_error when the file cannot be written.
void reserve(const std::filesystem::path& file, const std::string& text, std::size_t bytes);

}  // namespace aurasim::records
