// MJCF, as MuJoCo compiles it: defaults, frames and inertias are its own.
#include <cstring>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "import/inertia.h"
#include "import/mesh_shapes.h"
#include "import/mjcf_joints.h"
#include "import/places.h"
#include "import/read_model.h"
#include "import/xml_file.h"

namespace aurasim::importing {
namespace {

namespace fs = std::filesystem;

constexpr int kMostBodies = 100'000;
constexpr int kMostGeoms = 200'000;
constexpr int kDeepestInclude = 16;

struct MujocoError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// While it exists, an error in MuJoCo throws an exception instead of ending the process, and warnings are kept.
class MujocoGuard {
 public:
  MujocoGuard() : error_(mju_user_error), warning_(mju_user_warning) {
    mju_user_error = [](const char* text) { throw MujocoError(text); };
    mju_user_warning = [](const char* text) { warnings().emplace_back(text); };
    warnings().clear();
  }
  ~MujocoGuard() {
    mju_user_error = error_;
    mju_user_warning = warning_;
  }
  MujocoGuard(const MujocoGuard&) = delete;
  MujocoGuard& operator=(const MujocoGuard&) = delete;

  static std::vector<std::string>& warnings() {
    static std::vector<std::string> texts;
    return texts;
  }

 private:
  void (*error_)(const char*);
  void (*warning_)(const char*);
};

struct FreeModel {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
};
struct FreeData {
  void operator()(mjData* d) const { mj_deleteData(d); }
};

/// Checks, before MuJoCo opens a file, that every file that the model names lies in an allowed folder.
void check_named_files(const fs::path& file, const ReadSettings& settings, int depth) {
  tinyxml2::XMLDocument document;
  std::vector<const tinyxml2::XMLElement*> open = {load_xml(file, document)};
  while (!open.empty()) {
    const tinyxml2::XMLElement* element = open.back();
    open.pop_back();
    if (element == nullptr) continue;
    open.push_back(element->FirstChildElement());
    open.push_back(element->NextSiblingElement());
    for (const char* key : {"file", "meshdir", "texturedir", "assetdir"}) {
      const char* named = element->Attribute(key);
      if (named == nullptr) continue;
      bool allowed = is_within(file.parent_path() / named, file.parent_path());
      for (const fs::path& path : settings.paths) allowed = allowed || is_within(file.parent_path() / named, path);
      if (!allowed)
        throw BadModel(
            {fmt::format("{}:{}: <{}>/{}: '{}' lies outside of the model's folder; --path FOLDER allows another one",
                         file.string(), element->GetLineNum(), element->Name(), key, named)});
    }
    if (std::strcmp(element->Name(), "include") != 0 || element->Attribute("file") == nullptr) continue;
    if (depth == kDeepestInclude)
      throw BadModel({fmt::format("{}: includes deeper than {}", file.string(), kDeepestInclude)});
    const fs::path included = file.parent_path() / element->Attribute("file");
    if (fs::is_regular_file(included)) check_named_files(included, settings, depth + 1);
  }
}

/// Compiles the model. MuJoCo's error message contains the element, as in "Element 'geom', line 5".
std::unique_ptr<mjModel, FreeModel> compile(const fs::path& file) {
  char error[1000] = "";
  std::unique_ptr<mjModel, FreeModel> m(mj_loadXML(file.c_str(), nullptr, error, sizeof error));
  if (m == nullptr) {
    std::string text = error;
    for (char& c : text) c = c == '\n' ? ' ' : c;
    throw BadModel({fmt::format("{}: {}", file.string(), text)});
  }
  if (m->nbody > kMostBodies || m->ngeom > kMostGeoms)
    throw BadModel({fmt::format("{}: it has {} bodies and {} geoms, at most {} and {}", file.string(), m->nbody,
                                m->ngeom, kMostBodies, kMostGeoms)});
  return m;
}

class MjcfReader {
 public:
  MjcfReader(const mjModel& m, const mjData& d) : m_(m), d_(d), link_of_(m.nbody) {}

  Model read(const std::string& name) {
    model_.name = name;
    model_.gravity = mj_vec3(m_.opt.gravity);
    read_bodies();
    for (int body = 1; body < m_.nbody; ++body) {
      if (m_.body_weldid[body] == body) add_mjcf_joints(m_, d_, body, link_of_, model_);
    }
    add_mjcf_equalities(m_, d_, link_of_, model_);
    keep_apart();
    tell_of_rest();
    return std::move(model_);
  }

 private:
  std::string body_name(int body) const { return mjcf_name(m_, mjOBJ_BODY, body, "body"); }

  /// Makes links of bodies. Bodies welded to their parent become one link with it; those welded to the world are
  /// static.
  void read_bodies() {
    for (int body = 0; body < m_.nbody; ++body) {
      const int welded = m_.body_weldid[body];
      if (welded == 0) {
        read_static(body);
      } else if (welded == body) {
        read_body(body);
      } else {
        link_of_[body] = link_of_[welded];
        weld_to(model_.links[*link_of_[welded]], body);
      }
      if (m_.body_mocapid[body] >= 0) model_.lose(element_name("body", body_name(body)), "mocap: it stands still");
    }
  }

  core::Pose X_WBody(int body) const { return {mj_vec3(d_.xpos + 3 * body), mj_quat(d_.xquat + 4 * body)}; }

  void read_static(int body) {
    for (int i = 0; i < m_.body_geomnum[body]; ++i) {
      const int geom = m_.body_geomadr[body] + i;
      Link link{.name = mjcf_name(m_, mjOBJ_GEOM, geom, "geom"), .X_WL = {}, .is_static = true, .collisions = {}};
      if (body != 0) link.name = body_name(body) + "/" + link.name;
      add_geom(geom, X_WBody(body), link);
      if (link.collisions.empty()) continue;
      link.X_WL = link.collisions.front().X_LC;
      link.collisions.front().X_LC = {};
      links_of_geom_[geom] = model_.links.size();
      model_.links.push_back(std::move(link));
    }
  }

  void read_body(int body) {
    Link link{.name = body_name(body), .X_WL = X_WBody(body), .collisions = {}};
    link.mass_kg = m_.body_mass[body];
    link.p_LB = mj_vec3(m_.body_ipos + 3 * body);
    link.I_BL = tensor_of(body);
    add_geoms(body, {}, link);
    link_of_[body] = model_.links.size();
    model_.links.push_back(std::move(link));
  }

  /// Inertia tensor about the body's centre of mass, in the axes of its frame.
  core::Mat3 tensor_of(int body) const {
    const core::Mat3 R = mj_quat(m_.body_iquat + 4 * body).toRotationMatrix();
    return R * core::Mat3(mj_vec3(m_.body_inertia + 3 * body).asDiagonal()) * R.transpose();
  }

  /// Adds to a link the mass, moments (by the parallel axis theorem) and shapes of a body that does not move relative
  /// to it.
  void weld_to(Link& link, int body) {
    const core::Pose X_LBody = inverse(link.X_WL) * X_WBody(body);
    const double mass = m_.body_mass[body], sum = link.mass_kg + mass;
    if (mass > 0) {
      const core::Vec3 p = X_LBody.p_WB + X_LBody.q_WB * mj_vec3(m_.body_ipos + 3 * body);
      const core::Mat3 R = X_LBody.q_WB.toRotationMatrix();
      const core::Vec3 between = p - link.p_LB;
      const double reduced = link.mass_kg * mass / sum;
      link.I_BL += R * tensor_of(body) * R.transpose() +
                   reduced * (between.squaredNorm() * core::Mat3::Identity() - between * between.transpose());
      link.p_LB += mass / sum * between;
      link.mass_kg = sum;
    }
    add_geoms(body, X_LBody, link);
  }

  void add_geoms(int body, const core::Pose& X_LBody, Link& link) {
    for (int i = 0; i < m_.body_geomnum[body]; ++i) add_geom(m_.body_geomadr[body] + i, X_LBody, link);
  }

  Surface surface_of(int geom) const {
    const mjtNum* friction = m_.geom_friction + 3 * geom;
    const int dimensions = m_.geom_condim[geom];
    return {.friction = dimensions >= 3 ? friction[0] : 0,
            .rolling_friction_m = dimensions >= 6 ? friction[2] : 0,
            .spinning_friction_m = dimensions >= 4 ? friction[1] : 0,
            .restitution = 0};
  }

  void add_geom(int geom, const core::Pose& X_LBody, Link& link) {
    const std::string name = mjcf_name(m_, mjOBJ_GEOM, geom, "geom"), element = element_name("geom", name);
    if (m_.geom_contype[geom] == 0 && m_.geom_conaffinity[geom] == 0)
      return model_.note(element, "it touches nothing: how it looks");
    const std::optional<Geometry> geometry = geometry_of(geom, element, link.is_static);
    if (!geometry) return;
    const core::Pose X_BodyC{mj_vec3(m_.geom_pos + 3 * geom), mj_quat(m_.geom_quat + 4 * geom)};
    link.collisions.push_back({name, *geometry, X_LBody * X_BodyC, surface_of(geom)});
    if (m_.geom_margin[geom] != 0) model_.lose(element, "margin");
  }

  std::optional<Geometry> geometry_of(int geom, const std::string& element, bool is_static) {
    const core::Vec3 size = mj_vec3(m_.geom_size + 3 * geom);
    switch (m_.geom_type[geom]) {
      case mjGEOM_SPHERE:
        return core::Sphere{size.x()};
      case mjGEOM_CAPSULE:
        return core::Capsule{size.x(), 2 * size.y()};
      case mjGEOM_CYLINDER:
        return core::Cylinder{size.x(), 2 * size.y()};
      case mjGEOM_BOX:
        return core::Box{size};
      case mjGEOM_ELLIPSOID: {
        core::ConvexHull hull = ellipsoid_hull(size);
        model_.lose(element,
                    fmt::format("an ellipsoid: the hull of {} of its points stands for it", hull.points.size()));
        return hull;
      }
      case mjGEOM_MESH:
        return mesh_hull(m_.geom_dataid[geom], element);
      case mjGEOM_PLANE:
        if (is_static) return core::Plane{};
        model_.lose(element, "a plane that moves: it is left out");
        return std::nullopt;
      case mjGEOM_HFIELD:
        model_.lose(element, "a height field: it is left out");
        return std::nullopt;
      default:
        model_.lose(element, "a shape of another kind: it is left out");
        return std::nullopt;
    }
  }

  /// Returns the hull of a mesh, because MuJoCo, too, collides with the hull.
  Geometry mesh_hull(int mesh, const std::string& element) {
    core::TriangleMesh points;
    for (int v = 0; v < m_.mesh_vertnum[mesh]; ++v) {
      const float* p = m_.mesh_vert + 3 * (m_.mesh_vertadr[mesh] + v);
      points.points.emplace_back(p[0], p[1], p[2]);
    }
    const std::size_t all = points.points.size();
    core::ConvexHull hull = hull_of_points(points);
    if (hull.points.size() < all)
      model_.lose(element,
                  fmt::format("its mesh: a hull of {} of its {} points stands for it", hull.points.size(), all));
    return hull;
  }

  bool is_filtered(int geom1, int geom2) const {
    return (m_.geom_contype[geom1] & m_.geom_conaffinity[geom2]) == 0 &&
           (m_.geom_contype[geom2] & m_.geom_conaffinity[geom1]) == 0;
  }

  /// Keeps pairs apart that the file excludes, or whose bits let them pass through each other. Parent and child are
  /// joined and so kept apart anyway; in MuJoCo this holds unless the parent is static.
  void keep_apart() {
    for (int e = 0; e < m_.nexclude; ++e) exclude(m_.exclude_signature[e]);
    std::vector<std::vector<int>> geoms(model_.links.size());
    for (int geom = 0; geom < m_.ngeom; ++geom) {
      const bool touches = m_.geom_contype[geom] != 0 || m_.geom_conaffinity[geom] != 0;
      if (const auto link = link_of_[m_.geom_bodyid[geom]]; link && touches) geoms[*link].push_back(geom);
      if (const auto fixed = links_of_geom_.find(geom); fixed != links_of_geom_.end())
        geoms[fixed->second].push_back(geom);
    }
    for (std::size_t b = 0; b < geoms.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) filter_pair(a, b, geoms);
    }
    if (m_.npair > 0) model_.lose("contact/pair", "surfaces of single pairs of geoms");
  }

  void exclude(int signature) {
    const auto a = link_of_[(signature >> 16) - 1], b = link_of_[(signature & 0xffff) - 1];
    if (a && b) return model_.apart.emplace_back(*a, *b), void();
    model_.lose("contact/exclude", "a pair of which one does not move: in a scene they collide");
  }

  void filter_pair(std::size_t a, std::size_t b, const std::vector<std::vector<int>>& geoms) {
    std::size_t filtered = 0, all = 0;
    for (const int geom1 : geoms[a]) {
      for (const int geom2 : geoms[b]) {
        ++all;
        if (is_filtered(geom1, geom2)) ++filtered;
      }
    }
    if (filtered == 0) return;
    const bool both_move = !model_.links[a].is_static && !model_.links[b].is_static;
    if (filtered == all && both_move && model_.apart.size() < kMostPairsApart)
      return model_.apart.emplace_back(a, b), void();
    if (model_.links[a].is_static && model_.links[b].is_static) return;
    model_.lose(fmt::format("{} and {}", element_name("body", model_.links[a].name),
                            element_name("body", model_.links[b].name)),
                "contype and conaffinity let some of their geoms pass through each other; in a scene they collide");
  }

  void tell_of_rest() {
    const auto tell = [this](int count, int type, const char* kind, const char* what, bool matters) {
      for (int i = 0; i < count; ++i) {
        const std::string element = element_name(kind, mjcf_name(m_, type, i, kind));
        matters ? model_.lose(element, what) : model_.note(element, what);
      }
    };
    tell(m_.ntendon, mjOBJ_TENDON, "tendon", "a tendon", true);
    tell(m_.nskin, mjOBJ_SKIN, "skin", "how it looks", false);
    tell(m_.nsensor, mjOBJ_SENSOR, "sensor", "a sensor", false);
    tell(m_.ncam, mjOBJ_CAMERA, "camera", "a camera", false);
    tell(m_.nlight, mjOBJ_LIGHT, "light", "a light", false);
    tell(m_.nsite, mjOBJ_SITE, "site", "a frame", false);
    tell(m_.nkey, mjOBJ_KEY, "key", "another pose than the one of rest", false);
    for (int a = 0; a < m_.nu; ++a) {
      const bool on_joint = m_.actuator_trntype[a] == mjTRN_JOINT || m_.actuator_trntype[a] == mjTRN_JOINTINPARENT;
      if (!on_joint)
        model_.lose(element_name("actuator", mjcf_name(m_, mjOBJ_ACTUATOR, a, "actuator")),
                    "an actuator of something else than a joint");
    }
    if (m_.opt.density != 0 || m_.opt.viscosity != 0) model_.lose("option", "density and viscosity of a medium");
    if (mj_vec3(m_.opt.wind).norm() > 0) model_.lose("option/wind", "wind");
    for (const std::string& text : MujocoGuard::warnings()) model_.note("mujoco", text);
  }

  const mjModel& m_;
  const mjData& d_;
  LinkOfBody link_of_;
  std::map<int, std::size_t> links_of_geom_;  ///< links of static geoms
  Model model_;
};

}  // namespace

Model read_mjcf(const fs::path& file, const ReadSettings& settings) {
  check_named_files(file, settings, 0);
  const MujocoGuard guard;
  try {
    const auto m = compile(file);
    const std::unique_ptr<mjData, FreeData> d(mj_makeData(m.get()));
    if (d == nullptr) throw BadModel({fmt::format("{}: MuJoCo has no memory for it", file.string())});
    mj_kinematics(m.get(), d.get());
    return MjcfReader(*m, *d).read(m->names[0] != '\0' ? m->names : file.stem().string());
  } catch (const MujocoError& error) {
    throw BadModel({fmt::format("{}: MuJoCo: {}", file.string(), error.what())});
  }
}

}  // namespace aurasim::importing
