// Reads columns of numbers from the body of an agent's answer.
#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include <aurasim/errors.h>

namespace aurasim::client {

/// Takes columns from the front of the remaining bytes. `bytes` must outlive it.
class Columns {
 public:
  Columns(const std::string& bytes, std::size_t rows) : bytes_(&bytes) { set_rows(rows); }

  /// Returns a reader of the remaining columns, of `rows` rows each. Throws Error if there cannot be so many.
  Columns with_rows(std::size_t rows) const {
    Columns rest = *this;
    rest.set_rows(rows);
    return rest;
  }

  /// Takes the next column. Throws Error if it does not fit.
  template <class T>
  void take(std::vector<T>& column, std::size_t width = 1) {
    const std::size_t size = rows_ * width * sizeof(T);
    if (size > bytes_->size() - at_) throw Error("the agent's answer is shorter than it says");
    column.resize(rows_ * width);
    if (size > 0) std::memcpy(column.data(), bytes_->data() + at_, size);
    at_ += size;
  }

 private:
  void set_rows(std::size_t rows) {
    if (rows > bytes_->size()) throw Error("the agent's answer is shorter than it says");
    rows_ = rows;
  }

  const std::string* bytes_;
  std::size_t rows_ = 0;
  std::size_t at_ = 0;
};

}  // namespace aurasim::client
