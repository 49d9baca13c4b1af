#include "node/row_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace aurasim::node {
namespace {

/// False with errno when not all of it could be written.
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

std::string rows_to_keep(const std::filesystem::path& file, const RowFile::Keep& keep) {
  std::string kept;
  std::vector<std::string_view> cells;
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);                        // the header
  while (std::getline(in, line) && !in.eof()) {  // a row without its end may be half a row
    cells.clear();
    for (std::size_t begin = 0; begin <= line.size();) {
      const std::size_t end = std::min(line.find(',', begin), line.size());
      cells.push_back(std::string_view(line).substr(begin, end - begin));
      begin = end + 1;
    }
    if (keep(cells)) kept.append(line).push_back('\n');
  }
  return kept;
}

}  // namespace

RowFile::RowFile(const std::filesystem::path& file, const std::string& header, const Keep& keep)
    : path_(file), buffer_(header) {
  // Whoever is killed meanwhile leaves the old file.
  std::filesystem::path fresh = file;
  if (keep) {
    buffer_ += rows_to_keep(file, keep);
    fresh += ".new";
  }
  file_ = ::open(fresh.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file_ < 0) throw std::runtime_error(cannot_write(fresh));
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
    // A row that is cut off would be read as another one.
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

}  // namespace aurasim::node
