#include "physics/packed_contacts.h"

#include <bit>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "physics/contact_cache.h"

namespace aurasim::physics {
namespace {

// First columns of vectors in a row.
constexpr std::size_t kPointOnB = 6, kPointOnA = 9, kNormal = 12, kFirstLateral = 15, kDistance = 21;
constexpr std::size_t kMaskBytes = (core::kContactPointDoubles + 7) / 8;

/// Columns in the order in which they are packed: the normal is expected from the first lateral direction, where the
/// soft step keeps it in the frame of B (soft/kept_contacts.cpp).
constexpr std::array<std::size_t, core::kContactPointDoubles> order() {
  std::array<std::size_t, core::kContactPointDoubles> columns{};
  std::size_t next = 0;
  for (std::size_t i = 0; i < kPointOnB; ++i) columns[next++] = i;
  for (std::size_t i = kFirstLateral; i < kDistance; ++i) columns[next++] = i;
  for (std::size_t i = kPointOnB; i < kFirstLateral; ++i) columns[next++] = i;
  for (std::size_t i = kDistance; i < columns.size(); ++i) columns[next++] = i;
  return columns;
}
constexpr std::array<std::size_t, core::kContactPointDoubles> kOrder = order();

btVector3 vector_at(const ContactRow& row, std::size_t column) {
  return {static_cast<btScalar>(row[column]), static_cast<btScalar>(row[column + 1]),
          static_cast<btScalar>(row[column + 2])};
}

/// The expected value of a column. `row` has the columns before it in kOrder, and all others of the row before.
double expected(const ContactRow& row, std::size_t column, const btCollisionObject& body0,
                const btCollisionObject& body1) {
  const auto of_point = [&](const btCollisionObject& body, std::size_t local) {
    const btVector3 p = vector_at(row, local);
    return body.isStaticObject() ? p : body.getWorldTransform()(p);
  };
  if (column >= kPointOnB && column < kPointOnA) {
    return static_cast<double>(of_point(body1, kLocalPointB)[static_cast<int>(column - kPointOnB)]);
  }
  if (column >= kPointOnA && column < kNormal) {
    return static_cast<double>(of_point(body0, kLocalPointA)[static_cast<int>(column - kPointOnA)]);
  }
  if (column >= kNormal && column < kFirstLateral) {
    const btVector3 in_b = vector_at(row, kFirstLateral);
    const btVector3 normal = body1.isStaticObject() ? in_b : body1.getWorldTransform().getBasis() * in_b;
    return static_cast<double>(normal[static_cast<int>(column - kNormal)]);
  }
  return row[column];
}

/// Appends the octets of a number that are not 0 at its end, and how many there are.
void put_bits(std::uint64_t bits, PackedBytes& to) {
  const int skipped = std::countr_zero(bits) / 8, last = 8 - std::countl_zero(bits) / 8;
  to.push_back(static_cast<std::uint8_t>(skipped << 4 | (last - skipped)));
  for (int i = skipped; i < last; ++i) to.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
}

std::uint64_t take_bits(const std::uint8_t*& from) {
  const int skipped = *from >> 4, count = *from & 15;
  ++from;
  std::uint64_t bits = 0;
  for (int i = 0; i < count; ++i) bits |= std::uint64_t{*from++} << (8 * (skipped + i));
  return bits;
}

}  // namespace

void pack_points(const btPersistentManifold& manifold, PackedBytes& to) {
  ContactRow row{}, wanted;
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    write_point(manifold.getContactPoint(i), wanted.data());
    const std::size_t mask = to.size();
    to.resize(mask + kMaskBytes);
    for (const std::size_t column : kOrder) {
      const double guess = expected(row, column, *manifold.getBody0(), *manifold.getBody1());
      const std::uint64_t difference =
          std::bit_cast<std::uint64_t>(wanted[column]) ^ std::bit_cast<std::uint64_t>(guess);
      row[column] = wanted[column];
      if (difference == 0) continue;
      to[mask + column / 8] |= static_cast<std::uint8_t>(1U << (column % 8));
      put_bits(difference, to);
    }
  }
}

const ContactRow& PackedPoints::next() {
  const std::uint8_t* const mask = bytes_;
  bytes_ += kMaskBytes;
  for (const std::size_t column : kOrder) {
    std::uint64_t bits = std::bit_cast<std::uint64_t>(expected(row_, column, body0_, body1_));
    if ((mask[column / 8] >> (column % 8) & 1) != 0) bits ^= take_bits(bytes_);
    row_[column] = std::bit_cast<double>(bits);
  }
  return row_;
}

}  // namespace aurasim::physics
