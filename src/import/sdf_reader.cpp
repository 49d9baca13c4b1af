// Reads SDF, and URDF as sdformat converts it to SDF.
#include <fmt/format.h>
#include <sdf/sdf.hh>

#include "import/inertia.h"
#include "import/read_model.h"
#include "import/sdf_frames.h"
#include "import/sdf_includes.h"
#include "import/sdf_joints.h"
#include "import/sdf_shapes.h"
#include "import/urdf_check.h"

namespace aurasim::importing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostLinks = 100'000;

std::string message_of(const sdf::Error& error, const fs::path& file) {
  std::string text = error.FilePath().value_or(file.string());
  if (text.starts_with("<")) text = file.string();  // sdformat's placeholder "<data-string>"
  if (error.LineNumber()) text += fmt::format(":{}", *error.LineNumber());
  if (error.XmlPath()) text += fmt::format(": {}", *error.XmlPath());
  return text + ": " + error.Message();
}

sdf::ParserConfig parser_config(const fs::path& file, const ReadSettings& settings, sdf::EnforcementPolicy warnings) {
  sdf::ParserConfig config;
  config.SetWarningsPolicy(warnings);
  config.SetUnrecognizedElementsPolicy(warnings);
  config.SetDeprecatedElementsPolicy(sdf::EnforcementPolicy::LOG);
  const fs::path folder = file.parent_path();
  config.SetFindCallback([folder, paths = settings.paths](const std::string& uri) -> std::string {
    const fs::path found = included_file(uri, folder, paths);
    return found.filename() == "model.sdf" ? found.parent_path().string() : found.string();
  });
  return config;
}

class SdfReader {
 public:
  SdfReader(const fs::path& file, const ReadSettings& settings) : file_(file), paths_(settings.paths) {
    paths_.push_back(file.parent_path().empty() ? "." : file.parent_path());
  }

  Model read(const sdf::Root& root) {
    if (const sdf::Model* model = root.Model()) {
      model_.name = model->Name();
      read_root_model(*model, "", 0);
    } else if (root.WorldCount() > 0) {
      read_world(*root.WorldByIndex(0));
      for (std::uint64_t i = 1; i < root.WorldCount(); ++i)
        model_.lose(element_name("world", root.WorldByIndex(i)->Name()), "a second world: it is left out");
    }
    keep_apart();
    return std::move(model_);
  }

 private:
  void read_world(const sdf::World& world) {
    model_.name = world.Name();
    model_.gravity = vec3_of(world.Gravity());
    for (std::uint64_t i = 0; i < world.ModelCount(); ++i) {
      const sdf::Model& model = *world.ModelByIndex(i);
      read_root_model(model, model.Name() + "::", i);
    }
    for (std::uint64_t i = 0; i < world.LightCount(); ++i)
      model_.note(element_name("light", world.LightByIndex(i)->Name()), "a light");
    for (std::uint64_t i = 0; i < world.ActorCount(); ++i)
      model_.lose(element_name("actor", world.ActorByIndex(i)->Name()), "an actor: it is left out");
    if (vec3_of(world.WindLinearVelocity()).norm() > 0) model_.lose(element_name("world", world.Name()), "wind");
  }

  void read_root_model(const sdf::Model& model, const std::string& prefix, std::size_t root) {
    ignition::math::Pose3d X_WM;
    // A model alone in its file has no frame around it.
    if (!model.SemanticPose().Resolve(X_WM).empty()) X_WM = model.RawPose();
    read_sdf_model({model, pose_of(X_WM), prefix, model.Static(), root});
  }

  void read_sdf_model(const SdfScope& scope) {
    for (std::uint64_t i = 0; i < scope.model.LinkCount(); ++i) read_link(*scope.model.LinkByIndex(i), scope);
    for (std::uint64_t i = 0; i < scope.model.ModelCount(); ++i) {
      const sdf::Model& inner = *scope.model.ModelByIndex(i);
      const std::string prefix = scope.prefix + inner.Name() + "::";
      const core::Pose X_MN = resolved(inner.SemanticPose(), "__model__", element_name("model", prefix));
      read_sdf_model({inner, scope.X_WM * X_MN, prefix, scope.is_static || inner.Static(), scope.root});
    }
    for (std::uint64_t i = 0; i < scope.model.JointCount(); ++i)
      add_sdf_joint(*scope.model.JointByIndex(i), scope, links_, model_);
    note_plugins(scope);
  }

  void note_plugins(const SdfScope& scope) {
    const sdf::ElementPtr element = scope.model.Element();
    if (!element || !element->HasElement("plugin")) return;
    for (sdf::ElementPtr plugin = element->GetElement("plugin"); plugin; plugin = plugin->GetNextElement("plugin"))
      model_.note(element_name("plugin", plugin->Get<std::string>("name")), "a plugin: a program of another simulator");
  }

  void read_link(const sdf::Link& sdf_link, const SdfScope& scope) {
    if (model_.links.size() >= kMostLinks)
      throw BadModel({fmt::format("{}: more than {} links", file_.string(), kMostLinks)});
    Link link;
    link.name = scope.prefix + sdf_link.Name();
    const std::string element = element_name("link", link.name);
    link.is_static = scope.is_static;
    link.X_WL = scope.X_WM * resolved(sdf_link.SemanticPose(), "__model__", element);
    if (!link.is_static) read_inertial(sdf_link, element, link);
    for (std::uint64_t i = 0; i < sdf_link.CollisionCount(); ++i)
      add_sdf_collision(*sdf_link.CollisionByIndex(i), folder_of(sdf_link), paths_, element, link, model_);
    tell_of_rest(sdf_link, element, link.is_static);
    links_[link.name] = model_.links.size();
    self_collides_.push_back(scope.model.SelfCollide());
    root_of_.push_back(scope.root);
    model_.links.push_back(std::move(link));
  }

  /// Folder of the file that contains the link, because a model may be included from another folder.
  fs::path folder_of(const sdf::Link& link) const {
    const fs::path named = link.Element() ? link.Element()->FilePath() : "";
    return fs::is_regular_file(named) ? named.parent_path() : file_.parent_path();
  }

  void read_inertial(const sdf::Link& sdf_link, const std::string& element, Link& link) {
    const ignition::math::Inertiald& inertial = sdf_link.Inertial();
    link.mass_kg = inertial.MassMatrix().Mass();
    const core::Pose X_LI = pose_of(inertial.Pose());
    const ignition::math::Matrix3d moi = inertial.MassMatrix().Moi();
    core::Mat3 tensor_I;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) tensor_I(row, column) = moi(row, column);
    }
    const core::Mat3 R_LI = X_LI.q_WB.toRotationMatrix();
    link.p_LB = X_LI.p_WB;
    link.I_BL = R_LI * tensor_I * R_LI.transpose();
    const core::Vec3 moments = principal_inertia(link.I_BL).moments;
    if (!(link.mass_kg > 0))
      throw BadModel(
          {fmt::format("{}: {}/inertial/mass: found {}, allowed: above 0", file_.string(), element, link.mass_kg)});
    if (!is_physical(moments))
      throw BadModel({fmt::format("{}: {}/inertial/inertia: no body has the moments {}, {} and {}", file_.string(),
                                  element, moments.x(), moments.y(), moments.z())});
  }

  void tell_of_rest(const sdf::Link& link, const std::string& element, bool is_static) {
    for (std::uint64_t i = 0; i < link.VisualCount(); ++i)
      model_.note(element + "/" + element_name("visual", link.VisualByIndex(i)->Name()), "how it looks");
    for (std::uint64_t i = 0; i < link.SensorCount(); ++i)
      model_.note(element + "/" + element_name("sensor", link.SensorByIndex(i)->Name()), "a sensor");
    for (std::uint64_t i = 0; i < link.LightCount(); ++i)
      model_.note(element + "/" + element_name("light", link.LightByIndex(i)->Name()), "a light");
    const sdf::ElementPtr xml = link.Element();
    if (!xml || is_static) return;
    if (xml->HasElement("gravity") && !xml->Get<bool>("gravity")) model_.lose(element, "gravity: false");
    if (xml->HasElement("kinematic") && xml->Get<bool>("kinematic")) model_.lose(element, "kinematic: true");
    if (xml->HasElement("velocity_decay")) model_.lose(element, "velocity_decay");
  }

  /// Keeps links of one model apart unless their models have self_collide.
  void keep_apart() {
    for (std::size_t b = 0; b < model_.links.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        const bool one_model = root_of_[a] == root_of_[b] && !model_.links[a].is_static && !model_.links[b].is_static;
        if (!one_model || (self_collides_[a] && self_collides_[b])) continue;
        if (model_.apart.size() == kMostPairsApart)
          return model_.lose(element_name("model", model_.name),
                             fmt::format("self_collide: false, for more than {} pairs of links", kMostPairsApart));
        model_.apart.emplace_back(a, b);
      }
    }
  }

  fs::path file_;
  std::vector<fs::path> paths_;  ///< further folders in which named files may lie
  Model model_;
  std::map<std::string, std::size_t> links_;
  std::vector<bool> self_collides_;
  std::vector<std::size_t> root_of_;
};

/// Adds notes for sdformat's warnings: elements and attributes that it does not know.
void note_warnings(const fs::path& file, const ReadSettings& settings, Model& model) {
  sdf::Root root;
  for (const sdf::Error& error : root.Load(file.string(), parser_config(file, settings, sdf::EnforcementPolicy::ERR)))
    model.note(error.XmlPath().value_or(file.filename().string()), error.Message());
}

Model load(const fs::path& file, const ReadSettings& settings, bool is_urdf) {
  sdf::Console::Instance()->SetQuiet(true);
  sdf::Root root;
  const sdf::Errors errors = root.Load(file.string(), parser_config(file, settings, sdf::EnforcementPolicy::LOG));
  if (!errors.empty()) {
    std::vector<std::string> texts;
    for (const sdf::Error& error : errors) texts.push_back(message_of(error, file));
    throw BadModel(std::move(texts));
  }
  Model model = SdfReader(file, settings).read(root);
  if (!is_urdf) note_warnings(file, settings, model);
  return model;
}

Model load_guarded(const fs::path& file, const ReadSettings& settings, bool is_urdf) {
  try {
    return load(file, settings, is_urdf);
  } catch (const BadModel& bad) {
    std::vector<std::string> texts = bad.errors();
    for (std::string& text : texts) {
      if (!text.starts_with("/") && text.find(file.string()) == std::string::npos) text = file.string() + ": " + text;
    }
    throw BadModel(std::move(texts));
  } catch (const std::exception& error) {
    throw BadModel({fmt::format("{}: sdformat: {}", file.string(), error.what())});
  }
}

}  // namespace

Model read_sdf(const fs::path& file, const ReadSettings& settings) {
  check_sdf_includes(file, settings.paths);
  return load_guarded(file, settings, false);
}

Model read_urdf(const fs::path& file, const ReadSettings& settings) {
  check_urdf(file);
  Model model = load_guarded(file, settings, true);
  tell_of_urdf(file, model);
  return model;
}

}  // namespace aurasim::importing
