#include "records/row_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "records/csv.h"

namespace aurasim::records {
namespace {

/// Writes all of `text`. False, with errno set, when not all of it could be written.
bool write_all(int file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(file, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

std::string cannot_write(const std::filesystem::path& file) {
  return fmt::format("cannot write {}: {}", file.string(), std::strerror(errno));
}

std::uint64_t state_of(const std::string& row, const RowFile::Keep& keep) {
  thread_local std::vector<std::string_view> cells;
  split_cells(row, cells);
  return keep.state_of(cells);
}

/// A lower bound, in bytes, of the beginning of the file whose rows all stay; it includes the header.
std::int64_t bytes_that_stay(std::ifstream& in, std::int64_t size, const RowFile::Keep& keep) {
  std::string line;
  if (!std::getline(in, line) || in.eof()) return 0;
  const std::int64_t rows = in.tellg();
  for (std::int64_t tail = 64 * 1024; tail < size - rows; tail *= 4) {
    in.seekg(size - tail);
    std::getline(in, line);  // the rest of a row
    const std::int64_t at = in.tellg();
    const bool is_row = std::getline(in, line) && !in.eof();
    if (is_row && state_of(line, keep) + RowFile::kLatest <= keep.last) return at;
    in.clear();
  }
  return rows;
}

/// Copies the beginning of `file` that stays as it is into `fresh`. Returns the other rows that stay.
std::string copy_what_stays(const std::filesystem::path& file, const std::filesystem::path& fresh,
                            const std::string& header, const RowFile::Keep& keep) {
  std::ifstream in(file, std::ios::binary);
  std::error_code none;
  const auto size = in ? static_cast<std::int64_t>(std::filesystem::file_size(file, none)) : 0;
  const std::int64_t stay = size > 0 ? bytes_that_stay(in, size, keep) : 0;
  if (stay == 0) {
    std::filesystem::remove(fresh, none);
    return header;
  }
  std::filesystem::copy_file(file, fresh, std::filesystem::copy_options::overwrite_existing);
  std::filesystem::resize_file(fresh, static_cast<std::uintmax_t>(stay));
  std::string rest;
  in.clear();
  in.seekg(stay);
  for (std::string line; std::getline(in, line) && !in.eof();) {  // a row without its end may be half a row
    if (state_of(line, keep) <= keep.last) rest.append(line).push_back('\n');
  }
  return rest;
}

}  // namespace

RowFile::RowFile(const std::filesystem::path& file, const std::string& header, const std::optional<Keep>& keep)
    : path_(file), buffer_(header) {
  // The new file gets its name only when complete, so a process that is killed meanwhile leaves the old file.
  std::filesystem::path fresh = file;
  if (keep) {
    fresh += ".new";
    buffer_ = copy_what_stays(file, fresh, header, *keep);
  }
  file_ = ::open(fresh.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | (keep ? O_APPEND : O_TRUNC), 0644);
  if (file_ < 0) throw std::runtime_error(cannot_write(fresh));
  whole_ = ::lseek(file_, 0, SEEK_END);
  if (flush() && (!keep || ::rename(fresh.c_str(), file.c_str()) == 0)) return;
  const std::string why = failure_.empty() ? cannot_write(file) : failure_;
  ::close(file_);
  throw std::runtime_error(why);
}

RowFile::~RowFile() {
  flush();
  ::close(file_);
}

bool RowFile::flush() {
  if (!failure_.empty()) return false;
  if (write_all(file_, buffer_)) {
    whole_ += static_cast<std::int64_t>(buffer_.size());
  } else {
    failure_ = cannot_write(path_);
    // Cuts the file after its last whole row, because a row that is cut off would be read as another row.
    if (::ftruncate(file_, whole_) != 0) failure_ += " (and its last row may be cut off)";
  }
  buffer_.clear();
  return failure_.empty();
}

bool RowFile::is_replaced() const {
  struct ::stat status = {};
  return ::fstat(file_, &status) == 0 && status.st_nlink == 0;
}

bool overwrite(const std::filesystem::path& file, const std::string& text) {
  const int out = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  if (out < 0) return false;
  const bool done = write_all(out, text) && ::ftruncate(out, static_cast<::off_t>(text.size())) == 0;
  return ::close(out) == 0 && done;
}

void reserve(const std::filesystem::path& file, const std::string& text, std::size_t bytes) {
  std::string padded = text;
  if (padded.size() < bytes) padded.append(bytes - padded.size(), ' ');
  padded += '\n';
  const int out = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  const bool done = out >= 0 && write_all(out, padded);
  if (!done) {
    const std::string why = cannot_write(file);
    if (out >= 0) ::close(out);
    throw std::runtime_error(why);
  }
  ::close(out);
}

}  // namespace aurasim::records
