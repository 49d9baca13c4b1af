// The part of soft/kernel.h that finds the farthest points of hulls, and bounds their gaps.
#pragma once

#include "physics/soft/kernel_vectors.h"

namespace aurasim::physics::soft {
namespace {

template <class Number>
struct Vectors;
template <>
struct Vectors<double> {
  using Values __attribute__((vector_size(32))) = double;
  using Places __attribute__((vector_size(32))) = long long;
};
template <>
struct Vectors<float> {
  using Values __attribute__((vector_size(32))) = float;
  using Places __attribute__((vector_size(32))) = int;
};

/// By lane: distance and index of the farthest point so far.
template <class Number>
struct Farthest {
  typename Vectors<Number>::Values far;
  typename Vectors<Number>::Places place;
};
template <class Number>
AURASIM_INLINE Farthest<Number> farther(const Farthest<Number>& a, const Farthest<Number>& b) {
  const auto is_b = (b.far > a.far) | ((b.far == a.far) & (b.place < a.place));
  return {is_b ? b.far : a.far, is_b ? b.place : a.place};
}

/// The place of the farthest of all lanes.
template <class Number>
AURASIM_INLINE std::size_t first_of(Farthest<Number> all) {
  using Places = typename Vectors<Number>::Places;
  constexpr int kAtOnce = sizeof(Places) / sizeof(Number);
  for (int apart = kAtOnce / 2; apart > 0; apart /= 2) {
    Places other;
    for (int i = 0; i < kAtOnce; ++i) other[i] = i ^ apart;
    all = farther(all, {__builtin_shuffle(all.far, other), __builtin_shuffle(all.place, other)});
  }
  return static_cast<std::size_t>(all.place[0]);
}

/// As many numbers as are looked at once.
template <class Number>
AURASIM_INLINE typename Vectors<Number>::Values load(const Number* from) {
  typename Vectors<Number>::Values to;
  __builtin_memcpy(&to, from, sizeof to);
  return to;
}

/// The products of the points from number `i` on with a direction.
template <class Number>
AURASIM_INLINE typename Vectors<Number>::Values products_at(const Number* x, const Number* y, const Number* z,
                                                            std::size_t i, const Number (&along)[3]) {
  return load(x + i) * along[0] + load(y + i) * along[1] + load(z + i) * along[2];
}

template <class Number>
std::size_t farthest(const Number* x, const Number* y, const Number* z, std::size_t count, const Number (&along)[3]) {
  using Values = typename Vectors<Number>::Values;
  using Places = typename Vectors<Number>::Places;
  constexpr int kAtOnce = sizeof(Values) / sizeof(Number);
  const auto look = [&](std::size_t i, const Places& place) {
    return Farthest<Number>{products_at(x, y, z, i, along), place};
  };
  Places place;
  for (int i = 0; i < kAtOnce; ++i) place[i] = i;
  Farthest<Number> even = look(0, place), odd = look(kAtOnce, place + kAtOnce);
  for (std::size_t i = 2 * kAtOnce; i < count; i += 2 * kAtOnce) {
    place += 2 * kAtOnce;
    const Farthest<Number> next = look(i, place), after = look(i + kAtOnce, place + kAtOnce);
    const Places next_is = next.far > even.far, after_is = after.far > odd.far;
    even = {next_is ? next.far : even.far, next_is ? next.place : even.place};
    odd = {after_is ? after.far : odd.far, after_is ? after.place : odd.place};
  }
  return first_of(farther(even, odd));
}

/// See Kernel::reach.
void reach(const double* x, const double* y, const double* z, std::size_t count, const double (&along)[3],
           double (&ends)[2]) {
  using Values = Vectors<double>::Values;
  constexpr int kAtOnce = sizeof(Values) / sizeof(double);
  Values low = products_at(x, y, z, 0, along), high = low;
  for (std::size_t i = kAtOnce; i < count; i += kAtOnce) {
    const Values next = products_at(x, y, z, i, along);
    low = next < low ? next : low;
    high = next > high ? next : high;
  }
  ends[0] = low[0], ends[1] = high[0];
  for (int i = 1; i < kAtOnce; ++i) {
    ends[0] = low[i] < ends[0] ? low[i] : ends[0];
    ends[1] = high[i] > ends[1] ? high[i] : ends[1];
  }
}

/// See Kernel::tighten.
std::size_t tighten(const double* x, const double* y, const double* z, std::size_t count, const double (&along)[3],
                    double* products, double* bounds) {
  using Values = Vectors<double>::Values;
  constexpr int kAtOnce = sizeof(Values) / sizeof(double);
  Vectors<double>::Places place;
  for (int i = 0; i < kAtOnce; ++i) place[i] = i;
  Farthest<double> highest{};
  for (std::size_t i = 0; i < count; i += kAtOnce, place += kAtOnce) {
    const Values product = products_at(x, y, z, i, along);
    const Values before = load(bounds + i), bound = product < before ? product : before;
    __builtin_memcpy(products + i, &product, sizeof product);
    __builtin_memcpy(bounds + i, &bound, sizeof bound);
    const Vectors<double>::Places is = i == 0 ? bound == bound : bound > highest.far;
    highest = {is ? bound : highest.far, is ? place : highest.place};
  }
  return first_of(highest);
}

}  // namespace
}  // namespace aurasim::physics::soft
