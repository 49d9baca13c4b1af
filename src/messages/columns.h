// Arrays of structs as columns of numbers, and the checks that columns from the wire need.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "core/body_state.h"
#include "messages/wire_error.h"

namespace aurasim::messages {

/// column[i] = of(rows[i]). Keeps the column's memory.
template <class Number, class Row, class Of>
void fill(std::vector<Number>& column, const std::vector<Row>& rows, Of of) {
  column.resize(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    column[i] = of(rows[i]);
  }
}

/// Like fill, for columns with `width` numbers per row: `put(row, out)` writes them.
template <std::size_t width, class Number, class Row, class Put>
void fill_wide(std::vector<Number>& column, const std::vector<Row>& rows, Put put) {
  column.resize(rows.size() * width);
  Number* out = column.data();
  for (const Row& row : rows) {
    put(row, out);
    out += width;
  }
}

inline void put_vector(const core::Vec3& v, double* out) {
  out[0] = v.x();
  out[1] = v.y();
  out[2] = v.z();
}

inline core::Vec3 vector_at(const std::vector<double>& column, std::size_t i) {
  return core::Vec3(column[3 * i], column[3 * i + 1], column[3 * i + 2]);
}

/// True when the column has neither NaN nor infinity. Branch-free, so that it vectorizes.
inline bool all_finite(const std::vector<double>& column) {
  constexpr std::uint64_t kExponent = 0x7ff0'0000'0000'0000U;
  std::uint64_t bad = 0;
  for (const double x : column) {
    bad |= static_cast<std::uint64_t>((std::bit_cast<std::uint64_t>(x) & kExponent) == kExponent);
  }
  return bad == 0;
}

inline bool all_finite(const std::vector<float>& column) {
  constexpr std::uint32_t kExponent = 0x7f80'0000U;
  std::uint32_t bad = 0;
  for (const float x : column) {
    bad |= static_cast<std::uint32_t>((std::bit_cast<std::uint32_t>(x) & kExponent) == kExponent);
  }
  return bad == 0;
}

/// True when |x| <= bound for every x. The result is meaningless for NaN; call all_finite first.
template <class Number>
bool all_within(const std::vector<Number>& column, double bound) {
  return std::ranges::all_of(column, [bound](Number x) { return std::abs(static_cast<double>(x)) <= bound; });
}

template <class Number>
bool none_negative(const std::vector<Number>& column) {
  return std::ranges::all_of(column, [](Number x) { return x >= 0; });
}

inline bool all_below(const std::vector<std::uint32_t>& column, std::uint32_t bound) {
  return std::ranges::all_of(column, [bound](std::uint32_t x) { return x < bound; });
}

inline bool strictly_ascending(const std::vector<std::uint64_t>& ids) {
  return std::ranges::adjacent_find(ids, std::greater_equal<>{}) == ids.end();
}

/// True when every entry is a valid body id. Ids must also fit into a signed integer, because references to bodies are
/// signed.
inline bool all_body_ids(const std::vector<std::uint64_t>& column) {
  return std::ranges::all_of(column, [](std::uint64_t x) {
    return x <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  });
}

/// True when all quaternions (4 numbers each) have length 1, within kRotationTolerance.
template <class Number>
bool unit_quaternions(const std::vector<Number>& q) {
  for (std::size_t i = 0; i < q.size(); i += 4) {
    const double w = q[i], x = q[i + 1], y = q[i + 2], z = q[i + 3];
    const double squared = w * w + x * x + y * y + z * z;
    if (!(std::abs(std::sqrt(squared) - 1) <= kRotationTolerance)) {
      return false;
    }
  }
  return true;
}

/// All columns of `rows` rows; each argument is a pair {column size, entries per row}.
struct Width {
  std::size_t size = 0;
  std::size_t per_row = 1;
};
inline bool same_rows(std::size_t rows, std::initializer_list<Width> columns) {
  return std::ranges::all_of(columns, [rows](const Width& column) { return column.size == rows * column.per_row; });
}

}  // namespace aurasim::messages
