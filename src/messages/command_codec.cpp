#include "messages/command_codec.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "aurasim.h"
#include "messages/columns.h"
#include "messages/header_check.h"

namespace aurasim::messages {

using core::Ask;
using core::BodyId;
using core::StaticId;
using core::value_of;
using core::Vec3;

namespace {

constexpr std::uint8_t kNoShape = 0;
constexpr std::uint8_t kFirstMeshShape = 5;
constexpr std::size_t kMostPoints = 1'000'000;
constexpr std::size_t kMostText = 256;

std::vector<double> numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
std::vector<double> numbers(const core::Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }

struct PutShape {
  wire::Command& out;
  void operator()(const core::Sphere& s) const { out.size({s.radius}); }
  void operator()(const core::Box& s) const { out.size(numbers(s.half_extents)); }
  void operator()(const core::Capsule& s) const { out.size({s.radius, s.height}); }
  void operator()(const core::Cylinder& s) const { out.size({s.radius, s.height}); }
  void operator()(const core::MeshRef& s) const { out.mesh(s.hash); }
};

void put_shape(const core::ClientShape& shape, wire::Command& out) {
  const auto* mesh = std::get_if<core::MeshRef>(&shape);
  const auto kind = mesh ? kFirstMeshShape + static_cast<std::size_t>(mesh->use) : shape.index() + 1;
  out.shape(static_cast<std::uint8_t>(kind));
  std::visit(PutShape{out}, shape);
}

struct Put {
  wire::Command& out;

  void operator()(const core::NewBody& a) const {
    out.name(a.prototype);
    if (a.shape) put_shape(*a.shape, out);
    out.mass_kg(a.mass_kg);
    put_pose(a.pose);
    out.v(numbers(a.v_WB));
    out.w(numbers(a.w_WB));
  }
  void operator()(const core::NewStatic& a) const {
    put_shape(a.shape, out);
    put_pose(a.pose);
  }
  void operator()(const core::RemoveBody& a) const { out.subject(core::ref_of(a.id)); }
  void operator()(const core::RemoveStatic& a) const { out.subject(value_of(a.id)); }
  void operator()(const core::Impulse& a) const {
    out.subject(core::ref_of(a.id));
    out.v(numbers(a.J_W));
    if (a.p_W) out.p(numbers(*a.p_W));
  }
  void operator()(const core::SetVelocity& a) const {
    out.subject(core::ref_of(a.id));
    out.v(numbers(a.v_WB));
    if (a.w_WB) out.w(numbers(*a.w_WB));
  }
  void operator()(const core::SetRate& a) const { out.rate(a.rate); }
  void operator()(const core::Repartition& a) const {
    for (const core::Rectangle& r : a.boxes) out.boxes().insert(out.boxes().end(), {r.x0, r.y0, r.x1, r.y1});
  }
  void operator()(const core::ChangeScene& a) const { out.name(a.name); }
  void operator()(const core::Save& a) const { out.name(a.file); }
  void operator()(const core::Load& a) const { out.name(a.file); }
  void operator()(const core::SendStatic& a) const {
    out.subject(value_of(a.id));
    put_pose(a.to);
    out.duration_s(a.duration_s);
  }
  void operator()(const core::Ray& a) const {
    out.p(numbers(a.from_W));
    out.v(numbers(a.to_W));
    fill(out.regions(), a.regions, [](core::RegionId region) { return value_of(region); });
  }

 private:
  void put_pose(const core::Pose& pose) const {
    out.p(numbers(pose.p_WB));
    out.q(numbers(pose.q_WB));
  }
};

/// Reads the members of a command whose numbers have been checked.
class Get {
 public:
  explicit Get(const wire::Command& in) : in_(in) {}

  std::optional<Ask> ask() const {
    const BodyId body{static_cast<std::uint64_t>(in_.subject())};
    switch (in_.kind()) {
      case 0:
        return new_body();
      case 1:
        return has_pose() && shape() ? std::optional<Ask>(core::NewStatic{*shape(), pose()}) : std::nullopt;
      case 2:
        return core::RemoveBody{body};
      case 3:
        return names_a_static() ? std::optional<Ask>(core::RemoveStatic{fixed()}) : std::nullopt;
      case 4:
        return is_vector(in_.v()) ? std::optional<Ask>(core::Impulse{body, vector_at(in_.v(), 0), maybe(in_.p())})
                                  : std::nullopt;
      case 5:
        return is_vector(in_.v()) ? std::optional<Ask>(core::SetVelocity{body, vector_at(in_.v(), 0), maybe(in_.w())})
                                  : std::nullopt;
      case 6:
        return in_.rate() > 0 ? std::optional<Ask>(core::SetRate{in_.rate()}) : std::nullopt;
      case 7:
        return regions();
      case 8:
        return core::ChangeScene{in_.name().to_string()};
      case 9:
        return ray();
      case 10:
        return core::Save{in_.name().to_string()};
      case 11:
        return core::Load{in_.name().to_string()};
      case 12:
        return names_a_static() && has_pose() ? std::optional<Ask>(core::SendStatic{fixed(), pose(), in_.duration_s()})
                                              : std::nullopt;
      default:
        return {};
    }
  }

 private:
  static bool is_vector(const std::vector<double>& v) { return v.size() == 3; }
  bool names_a_static() const { return in_.subject() <= 0xffff'ffff; }
  StaticId fixed() const { return StaticId{static_cast<std::uint32_t>(in_.subject())}; }
  static std::optional<Vec3> maybe(const std::vector<double>& v) {
    return is_vector(v) ? std::optional(vector_at(v, 0)) : std::nullopt;
  }
  Vec3 or_zero(const std::vector<double>& v) const { return maybe(v).value_or(Vec3::Zero()); }
  bool has_pose() const { return is_vector(in_.p()) && (in_.q().empty() || in_.q().size() == 4); }
  core::Pose pose() const {
    core::Pose pose{vector_at(in_.p(), 0), core::Quat::Identity()};
    if (in_.q().size() == 4) pose.q_WB = core::Quat(in_.q()[0], in_.q()[1], in_.q()[2], in_.q()[3]).normalized();
    return pose;
  }

  std::optional<core::ClientShape> shape() const {
    const std::vector<double>& size = in_.size();
    if (!std::ranges::all_of(size, [](double x) { return x > 0; })) return {};
    if (in_.shape() == 1 && size.size() == 1) return core::Sphere{size[0]};
    if (in_.shape() == 2 && size.size() == 3) return core::Box{vector_at(size, 0)};
    if (in_.shape() == 3 && size.size() == 2) return core::Capsule{size[0], size[1]};
    if (in_.shape() == 4 && size.size() == 2) return core::Cylinder{size[0], size[1]};
    if (in_.shape() < kFirstMeshShape || in_.shape() > kFirstMeshShape + 2) return {};
    return core::MeshRef{in_.mesh(), static_cast<core::MeshUse>(in_.shape() - kFirstMeshShape)};
  }

  std::optional<Ask> new_body() const {
    if (!has_pose()) return {};
    core::NewBody body;
    body.prototype = in_.name().to_string();
    body.shape = shape();
    if (in_.shape() != kNoShape && (!body.shape || !(in_.mass_kg() > 0))) return {};
    body.mass_kg = in_.mass_kg();
    body.pose = pose();
    body.v_WB = or_zero(in_.v());
    body.w_WB = or_zero(in_.w());
    return body;
  }

  std::optional<Ask> regions() const {
    const std::vector<double>& x = in_.boxes();
    if (x.empty() || x.size() % 4 != 0) return {};
    core::Repartition ask;
    for (std::size_t i = 0; i < x.size(); i += 4) {
      ask.boxes.push_back({x[i], x[i + 1], x[i + 2], x[i + 3]});
      if (!(x[i] < x[i + 2]) || !(x[i + 1] < x[i + 3])) return {};
    }
    return ask;
  }

  std::optional<Ask> ray() const {
    if (!is_vector(in_.p()) || !is_vector(in_.v())) return {};
    core::Ray ray{vector_at(in_.p(), 0), vector_at(in_.v(), 0), {}};
    fill(ray.regions, in_.regions(), [](std::uint32_t region) { return core::RegionId{region}; });
    return ray;
  }

  const wire::Command& in_;
};

bool numbers_are_finite(const wire::Command& in) {
  return all_finite(in.size()) && all_finite(in.p()) && all_finite(in.q()) && all_finite(in.v()) &&
         all_finite(in.w()) && std::isfinite(in.mass_kg()) && std::isfinite(in.rate()) &&
         std::isfinite(in.duration_s());
}

bool is_rotation(const std::vector<double>& q) {
  if (q.size() != 4) return q.empty();
  return std::abs(std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) - 1) <= kRotationTolerance;
}

}  // namespace

void encode(const core::Command& command, std::uint64_t sender, std::uint64_t map_version, wire::Command& out) {
  out = wire::Command();
  out.sender(sender);
  out.version(kProtocolVersion);
  out.stamp(command.at_step);
  out.map_version(map_version);
  out.request(command.request);
  out.kind(static_cast<std::uint8_t>(command.ask.index()));
  std::visit(Put{out}, command.ask);
}

Decoded<core::Command> decode(const wire::Command& in, const Expected& expected) {
  Expected any_generation = expected;
  any_generation.generation.reset();
  if (in.map_version() == 0) any_generation.map_version.reset();
  if (const auto error = check_header(in, any_generation)) return *error;
  if (std::max({in.boxes().size(), in.regions().size(), in.size().size()}) > kMaxRows) return WireError::kTooLarge;
  if (!numbers_are_finite(in)) return WireError::kNotFinite;
  if (!is_rotation(in.q())) return WireError::kRotation;
  if (in.stamp() < 0 || in.subject() < 0) return WireError::kRange;
  const std::optional<Ask> ask = Get(in).ask();
  if (!ask) return WireError::kRange;
  return core::Command{in.request(), in.stamp(), *ask};
}

void encode(const core::CommandReply& reply, std::uint64_t map_version, wire::CommandReply& out) {
  out = wire::CommandReply();
  out.source(value_of(reply.source));
  out.version(kProtocolVersion);
  out.stamp(reply.at_step);
  out.map_version(map_version);
  out.request(reply.request);
  out.outcome(static_cast<std::uint8_t>(reply.outcome));
  out.text(reply.text.substr(0, kMostText));
  out.has_object(reply.object.has_value());
  out.object(reply.object.value_or(0));
  if (reply.outcome == core::Outcome::kSeen && reply.object) {
    out.p(numbers(reply.p_W));
    out.normal(numbers(reply.normal_W));
  }
  out.distance_m(reply.distance_m);
}

Decoded<core::CommandReply> decode(const wire::CommandReply& in, const Expected& expected) {
  Expected any = expected;
  any.map_version.reset();  // the map may change with a command
  if (const auto error = check_header(in, any)) return *error;
  if (const auto error = check_source(in, any)) return *error;
  if (in.outcome() > static_cast<std::uint8_t>(core::Outcome::kSeen)) return WireError::kEnum;
  if (!all_finite(in.p()) || !all_finite(in.normal()) || !std::isfinite(in.distance_m())) return WireError::kNotFinite;
  core::CommandReply reply;
  reply.source = static_cast<core::RegionId>(in.source());
  reply.request = in.request();
  reply.outcome = static_cast<core::Outcome>(in.outcome());
  reply.at_step = in.stamp();
  reply.text = in.text().to_string();
  if (in.has_object()) reply.object = in.object();
  if (in.p().size() == 3) reply.p_W = vector_at(in.p(), 0);
  if (in.normal().size() == 3) reply.normal_W = vector_at(in.normal(), 0);
  reply.distance_m = in.distance_m();
  return reply;
}

void encode(const NamedMesh& mesh, wire::MeshShape& out) {
  out = wire::MeshShape();
  out.hash(mesh.hash);
  out.version(kProtocolVersion);
  out.stamp(mesh.is_told_again ? 1 : 0);
  fill_wide<3>(out.points(), mesh.mesh.points, [](const Vec3& p, double* to) { put_vector(p, to); });
  for (const auto& triangle : mesh.mesh.triangles) {
    out.triangles().insert(out.triangles().end(), triangle.begin(), triangle.end());
  }
}

Decoded<NamedMesh> decode(const wire::MeshShape& in, const Expected&) {
  if (const auto error = check_header(in, {})) return *error;
  if (in.points().size() > 3 * kMostPoints || in.triangles().size() > 6 * kMostPoints) return WireError::kTooLarge;
  if (in.points().empty() || in.points().size() % 3 != 0 || in.triangles().empty() || in.triangles().size() % 3 != 0) {
    return WireError::kLength;
  }
  if (!all_finite(in.points())) return WireError::kNotFinite;
  if (!all_below(in.triangles(), static_cast<std::uint32_t>(in.points().size() / 3))) return WireError::kRange;
  NamedMesh named;
  named.hash = in.hash();
  named.is_told_again = in.stamp() != 0;
  for (std::size_t i = 0; i < in.points().size() / 3; ++i) named.mesh.points.push_back(vector_at(in.points(), i));
  for (std::size_t i = 0; i < in.triangles().size(); i += 3) {
    named.mesh.triangles.push_back({in.triangles()[i], in.triangles()[i + 1], in.triangles()[i + 2]});
  }
  return named;
}

}  // namespace aurasim::messages
