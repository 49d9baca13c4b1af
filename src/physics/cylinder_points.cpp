#include "physics/cylinder_points.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace aurasim::physics {
namespace {

/// Cylinders whose axis has a larger product with the normal stand on a cap.
constexpr btScalar kStands = btScalar(0.7);
/// Where the heights of a cap differ by less than this share of the margin, its points are at fixed places of the rim.
constexpr btScalar kLevel = btScalar(1) / 40;
/// Two ends of a line count as one point if they are nearer to each other than this share of the radius.
constexpr btScalar kTwoEnds = btScalar(0.25);
constexpr btScalar kDiagonal = btScalar(0.70710678118654752440);

// Names of points of the cylinder. Those of the upper cap are `kUpper` higher.
constexpr std::int32_t kRim = 1;      // 8 fixed places
constexpr std::int32_t kTilted = 9;   // 8 places, of which the first is the lowest
constexpr std::int32_t kEnters = 17;  // the rim crosses a side of the face
constexpr std::int32_t kLeaves = 18;
constexpr std::int32_t kCap = 19;   // a corner of the face below the cap
constexpr std::int32_t kEnd = 20;   // the line of the barrel, at an end of the cylinder
constexpr std::int32_t kLine = 21;  // the same where it crosses a side
constexpr std::int32_t kUpper = 32;

/// The plane through a side of a face, along the normal of the contact.
struct SidePlane {
  btVector3 out;  ///< of length 1, away from the face
  btScalar offset;

  btScalar beyond(const btVector3& p) const { return out.dot(p) - offset; }
};

class OnFace {
 public:
  OnFace(const Cylinder& cylinder, const FlatOutline& face, const btVector3& up, btScalar margin_m,
         std::vector<HullPoint>& found)
      : cylinder_(cylinder), face_(face), up_(up), margin_(margin_m), found_(found) {}

  void find() {
    const btScalar along = up_.dot(cylinder_.axis);
    const btVector3 aside = up_ - cylinder_.axis * along;
    if (btFabs(along) > kStands) {
      stand(/*upper=*/along < 0, aside);
    } else {
      lie(aside / aside.length());
    }
  }

 private:
  SidePlane side(std::size_t i) const {
    const btVector3 &from = face_.corners[i], &to = face_.corners[i + 1 < face_.corners.size() ? i + 1 : 0];
    const btVector3 out = (to - from).cross(up_).normalized();
    return {out, out.dot(from)};
  }
  bool is_over(const btVector3& p) const {
    for (std::size_t i = 0; i < face_.corners.size(); ++i) {
      if (side(i).beyond(p) > 0) return false;
    }
    return true;
  }
  void add(const btVector3& on_cylinder, ContactFeatures features) {
    const btScalar gap = face_.above(on_cylinder, up_);
    if (gap <= margin_) found_.push_back({on_cylinder, on_cylinder - up_ * gap, double{gap}, features});
  }

  /// `aside`: the part of `up_` across the axis.
  void stand(bool upper, const btVector3& aside) {
    const btVector3 cap = cylinder_.cap(upper);
    const std::int32_t more = upper ? kUpper : 0;
    const btScalar slope = aside.length();
    const bool is_level = slope * cylinder_.radius <= kLevel * margin_;
    const btVector3 x = is_level ? cylinder_.first : aside / -slope;
    const btVector3 y = is_level ? cylinder_.second : cylinder_.axis.cross(x);
    const btVector3 around[] = {x,  (x + y) * kDiagonal,  y,  (y - x) * kDiagonal,
                                -x, (x + y) * -kDiagonal, -y, (x - y) * kDiagonal};
    std::array<bool, 8> over = {};
    const auto place = [&](std::size_t i) { return cap + around[i] * cylinder_.radius; };
    for (std::size_t i = 0; i < over.size(); i += 2) over[i] = is_over(place(i));
    const bool is_whole = over[0] && over[2] && over[4] && over[6];
    for (std::size_t i = 0; i < over.size(); ++i) {
      if (i % 2 == 1 && (is_whole || !is_over(place(i)))) continue;
      if (i % 2 == 0 && !over[i]) continue;
      add(place(i), {(is_level ? kRim : kTilted) + static_cast<std::int32_t>(i) + more, face_.face_name});
    }
    if (is_whole) return;
    for (std::size_t i = 0; i < face_.corners.size(); ++i) {
      cross_rim(cap, i, more);
      const btVector3& corner = face_.corners[i];
      const btVector3 on_cap = corner + up_ * (cylinder_.axis.dot(cap - corner) / cylinder_.axis.dot(up_));
      if ((on_cap - cap).length2() < cylinder_.radius * cylinder_.radius)
        add(on_cap, {kCap + more, face_.corner_names[i]});
    }
  }

  /// Where the rim crosses a side: b cos + c sin = a.
  void cross_rim(const btVector3& cap, std::size_t i, std::int32_t more) {
    const SidePlane of = side(i);
    const btScalar a = -of.beyond(cap), b = of.out.dot(cylinder_.first) * cylinder_.radius,
                   c = of.out.dot(cylinder_.second) * cylinder_.radius;
    const btScalar most2 = b * b + c * c;
    if (!(a * a < most2)) return;
    const btScalar half = btSqrt(most2 - a * a);
    for (const btScalar sign : {btScalar(-1), btScalar(1)}) {
      const btScalar cosine = (a * b - sign * c * half) / most2, sine = (a * c + sign * b * half) / most2;
      const btVector3 p = cap + (cylinder_.first * cosine + cylinder_.second * sine) * cylinder_.radius;
      if (is_over_but(p, i)) add(p, {(sign < 0 ? kEnters : kLeaves) + more, face_.side_names[i]});
    }
  }
  bool is_over_but(const btVector3& p, std::size_t left_out) const {
    for (std::size_t i = 0; i < face_.corners.size(); ++i) {
      if (i != left_out && side(i).beyond(p) > 0) return false;
    }
    return true;
  }

  /// `aside`: direction of length 1 across the axis, away from the face.
  void lie(const btVector3& aside) {
    const btVector3 middle = cylinder_.centre - aside * cylinder_.radius;
    struct End {
      btScalar t;
      ContactFeatures features;
    };
    End low = {-cylinder_.half_height, {kEnd, face_.face_name}};
    End high = {cylinder_.half_height, {kEnd + kUpper, face_.face_name}};
    for (std::size_t i = 0; i < face_.corners.size(); ++i) {
      const SidePlane of = side(i);
      const btScalar slope = of.out.dot(cylinder_.axis), beyond = of.beyond(middle);
      const btScalar there = -beyond / slope;
      if (slope > 0 && there < high.t) high = {there, {kLine + kUpper, face_.side_names[i]}};
      if (slope < 0 && there > low.t) low = {there, {kLine, face_.side_names[i]}};
      if (slope == 0 && beyond > 0) return;
    }
    if (!(low.t <= high.t)) return;
    const auto at = [&](const End& end) { return middle + cylinder_.axis * end.t; };
    const bool is_one = high.t - low.t < kTwoEnds * cylinder_.radius;
    const bool low_is_deeper = face_.above(at(low), up_) <= face_.above(at(high), up_);
    if (!is_one || low_is_deeper) add(at(low), low.features);
    if (!is_one || !low_is_deeper) add(at(high), high.features);
  }

  const Cylinder& cylinder_;
  const FlatOutline& face_;
  const btVector3& up_;
  const btScalar margin_;
  std::vector<HullPoint>& found_;
};

}  // namespace

btScalar Cylinder::reach(const btVector3& direction) const {
  const btScalar along = btFabs(direction.dot(axis));
  return half_height * along + radius * btSqrt(std::max(btScalar(0), 1 - along * along));
}

void cylinder_points(const Cylinder& cylinder, const FlatOutline& face, const btVector3& up, double margin_m,
                     std::vector<HullPoint>& found) {
  found.clear();
  OnFace(cylinder, face, up, static_cast<btScalar>(margin_m), found).find();
}

}  // namespace aurasim::physics
