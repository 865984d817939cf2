#include "apps/cli/file_probe.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace rubble::cli {
namespace {

struct BodyMetric {
  NamedMetric name;
  std::function<double(const World&, const BodyDef& start, const BodyState& now)> measure;
};

Vec3 upOf(const World& world) { return normalize(-world.gravity(), {0, 0, 1}); }

/// Angle of the rotation between two orientations [rad].
double angleBetween(const Quat& a, const Quat& b) {
  const Quat turn = conjugate(a) * b;
  return 2 * std::atan2(length(turn.v), std::fabs(turn.s));
}

const std::vector<BodyMetric>& bodyTable() {
  static const std::vector<BodyMetric> table{
      {{"x_m", "position along x [m]"},
       [](const World&, const BodyDef&, const BodyState& now) { return now.position.x; }},
      {{"y_m", "position along y [m]"},
       [](const World&, const BodyDef&, const BodyState& now) { return now.position.y; }},
      {{"z_m", "position along z [m]"},
       [](const World&, const BodyDef&, const BodyState& now) { return now.position.z; }},
      {{"height_m", "position against gravity, from the origin [m]"},
       [](const World& world, const BodyDef&, const BodyState& now) {
         return dot(upOf(world), now.position);
       }},
      {{"drop_m", "how far down from its start [m]"},
       [](const World& world, const BodyDef& start, const BodyState& now) {
         return dot(upOf(world), start.position - now.position);
       }},
      {{"moved_m", "distance from its start [m]"},
       [](const World&, const BodyDef& start, const BodyState& now) {
         return length(now.position - start.position);
       }},
      {{"turned_deg", "angle from its orientation at the start [degrees]"},
       [](const World&, const BodyDef& start, const BodyState& now) {
         return angleBetween(start.orientation, now.orientation) * 180 / std::numbers::pi;
       }},
      {{"speed_m_s", "speed of its center [m/s]"},
       [](const World&, const BodyDef&, const BodyState& now) { return length(now.velocity); }},
      {{"spin_rad_s", "angular speed [rad/s]"},
       [](const World&, const BodyDef&, const BodyState& now) { return length(now.angularVelocity); }},
  };
  return table;
}

struct JointMetric {
  NamedMetric name;
  std::function<double(const JointState&)> measure;
};

const std::vector<JointMetric>& jointTable() {
  static const std::vector<JointMetric> table{
      {{"gap_m", "distance of its anchors [m]"}, [](const JointState& joint) { return joint.gap; }},
      {{"angle_deg", "fixed: deviation from its orientation [degrees]"},
       [](const JointState& joint) { return joint.angle * 180 / std::numbers::pi; }},
      {{"force_n", "force that it carries [N]"}, [](const JointState& joint) { return length(joint.force); }},
      {{"torque_n_m", "torque of its orientation rows [N m]"},
       [](const JointState& joint) { return length(joint.torque); }},
      {{"broken", "1 if it broke"}, [](const JointState& joint) { return joint.broken ? 1. : 0.; }},
  };
  return table;
}

template <class Table> std::vector<NamedMetric> namesOf(const Table& table) {
  std::vector<NamedMetric> names;
  names.reserve(table.size());
  for (const auto& entry : table) names.push_back(entry.name);
  return names;
}

template <class Table>
auto findIn(const Table& table, const std::string& quantity) -> decltype(&table.front()) {
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const auto& entry) { return quantity == entry.name.quantity; });
  return found == table.end() ? nullptr : &*found;
}

/// "name.quantity" at its last dot; both empty if there is none.
struct Split {
  std::string name, quantity;
  explicit Split(const std::string& metric) {
    const std::size_t dot = metric.rfind('.');
    if (dot == std::string::npos) return;
    name = metric.substr(0, dot);
    quantity = metric.substr(dot + 1);
  }
};

/// What the probes of scene files measure of the whole scene: before a smash (or at the end), and after it
/// with "smash_" in front.
constexpr const char* kQuality[] = {"penetration_mean_m", "penetration_p99_m", "penetration_max_m",
                                    "joint_gap_mean_m",   "joint_gap_max_m",   "kinetic_energy_j",
                                    "max_speed_m_s",      "quarantined",       "broken_joints"};
constexpr const char* kStack[] = {"top_drop_m", "top_drop_peak_m", "max_drift_m", "bricks_lost", "lowest_m"};
constexpr const char* kSmash[] = {"moved_ratio", "lowest_m", "top_drop_m"};

class NamedProbe final : public scenes::Probe {
 public:
  explicit NamedProbe(std::vector<std::string> metrics) : names_(std::move(metrics)) {}

  void finish(const World& world, scenes::Metrics& metrics) override {
    for (const std::string& metric : names_) {
      const Split split(metric);
      // A removed body has no metric; its claim is then reported as "not measured".
      if (const BodyMetric* body = findIn(bodyTable(), split.quantity)) {
        for (const BodyId id : world.bodies())
          if (world.definition(id).name == split.name)
            metrics[metric] = body->measure(world, world.definition(id), world.state(id));
      } else if (const JointMetric* joint = findIn(jointTable(), split.quantity)) {
        metrics[metric] = joint->measure(world.state(world.findJoint(split.name)));
      }
    }
  }

 private:
  std::vector<std::string> names_;
};

bool hasBody(const Scene& scene, const std::string& name) {
  const auto named = [&](const BodyDef& body) { return body.name == name; };
  if (std::any_of(scene.bodies.begin(), scene.bodies.end(), named)) return true;
  return std::any_of(scene.events.begin(), scene.events.end(), [&](const Event& event) {
    return std::any_of(event.add.begin(), event.add.end(), named);
  });
}

bool hasJoint(const Scene& scene, const std::string& name) {
  return std::any_of(scene.joints.begin(), scene.joints.end(),
                     [&](const JointDef& joint) { return joint.name == name; });
}

std::vector<std::string> quantities(const std::vector<NamedMetric>& metrics) {
  std::vector<std::string> names;
  names.reserve(metrics.size());
  for (const NamedMetric& metric : metrics) names.emplace_back(metric.quantity);
  return names;
}

}  // namespace

const std::vector<NamedMetric>& bodyMetrics() {
  static const std::vector<NamedMetric> names = namesOf(bodyTable());
  return names;
}

const std::vector<NamedMetric>& jointMetrics() {
  static const std::vector<NamedMetric> names = namesOf(jointTable());
  return names;
}

std::vector<std::string> sceneMetrics(bool smashes) {
  std::vector<std::string> names(std::begin(kQuality), std::end(kQuality));
  names.insert(names.end(), std::begin(kStack), std::end(kStack));
  if (!smashes) return names;
  for (const char* name : kQuality) names.push_back(std::string("smash_") + name);
  for (const char* name : kSmash) names.push_back(std::string("smash_") + name);
  return names;
}

std::unique_ptr<scenes::Probe> namedProbe(const std::vector<io::FileClaim>& claims) {
  std::vector<std::string> metrics;
  for (const io::FileClaim& claim : claims)
    if (claim.metric.find('.') != std::string::npos) metrics.push_back(claim.metric);
  return std::make_unique<NamedProbe>(std::move(metrics));
}

std::string metricFault(const io::SceneFile& file, const std::string& metric) {
  const Split split(metric);
  if (split.quantity.empty()) {
    const std::vector<std::string> known = sceneMetrics(file.smashStep >= 0);
    if (std::find(known.begin(), known.end(), metric) != known.end()) return "";
    return fmt::format("expected one of {}, or NAME.QUANTITY of a body or joint, got \"{}\"",
                       fmt::join(known, ", "), metric);
  }
  if (findIn(bodyTable(), split.quantity))
    return hasBody(file.scene, split.name)
               ? ""
               : fmt::format("expected the name of a body before the dot, got \"{}\"", split.name);
  if (findIn(jointTable(), split.quantity))
    return hasJoint(file.scene, split.name)
               ? ""
               : fmt::format("expected the name of a joint before the dot, got \"{}\"", split.name);
  return fmt::format("expected one of {} (bodies) or {} (joints) after the dot, got \"{}\"",
                     fmt::join(quantities(bodyMetrics()), ", "), fmt::join(quantities(jointMetrics()), ", "),
                     split.quantity);
}

}  // namespace rubble::cli
