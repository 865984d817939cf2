#include "convert/assemble.h"
#include "convert/names.h"

namespace rubble::convert {
namespace {

std::string nameOf(const Link& link) {
  std::string name;
  for (const Dof& dof : link.dofs)
    if (!dof.name.empty()) name += (name.empty() ? "" : "+") + dof.name;
  return name.empty() ? link.name + "_joint" : name;
}

class JointBuilder {
 public:
  JointBuilder(const Model& model, Layout& layout, Scene& scene, Report& report)
      : model_(model), layout_(layout), scene_(scene), report_(report) {
    layout_.jointOf.assign(model.links.size(), -1);
  }

  void build() {
    for (std::size_t i = 0; i < model_.links.size(); ++i)
      if (!model_.links[i].dofs.empty()) addTree(i);
    for (const Loop& loop : model_.loops) addLoop(loop);
    for (const Coupling& coupling : model_.couplings) addCoupling(coupling);
    for (const FreeJoint& joint : model_.joints) addFree(joint);
    for (const Tendon& tendon : model_.tendons) {
      double zero = 0;
      auto joint = tendonOf(model_, layout_, scene_, tendon, zero, report_);
      const int index = joint ? static_cast<int>(scene_.joints.size()) : -1;
      layout_.axisOfTendon.push_back({index, 0, 1, zero});
      if (joint) add(std::move(*joint), tendon.place, "tendon", tendon.name);
    }
  }

 private:
  void addTree(std::size_t i) {
    const Link& link = model_.links[i];
    auto [joint, childIsA, axes] = jointOf(link, poseInBody(layout_, link.parent) * link.pose, report_);
    const int child = bodyIndex(layout_, static_cast<int>(i)), parent = bodyIndex(layout_, link.parent);
    joint.bodyA = childIsA ? child : parent, joint.bodyB = childIsA ? parent : child;
    joint.name = names_.unique(nameOf(link));
    joint.collide = model_.parentsCollide;
    layout_.jointOf[i] = static_cast<int>(scene_.joints.size());
    for (std::size_t k = 0; k < axes.size(); ++k)
      if (const TreeJoint::Axis& own = axes[k]; own.axis >= 0)
        layout_.axisOf[{static_cast<int>(i), static_cast<int>(k)}] = {
            layout_.jointOf[i], own.axis, own.sign, link.dofs[k].reference - own.sign * own.shift};
    for (const Dof& dof : link.dofs)
      report_.converted(dof.place, "joint" + inQuotes(dof.name), keyword(joint.type) + inQuotes(joint.name));
    scene_.joints.push_back(std::move(joint));
  }

  bool isDynamic(int body) const {
    return body != kWorld && scene_.bodies[static_cast<std::size_t>(body)].motion == Motion::Dynamic;
  }

  /// For the reduced mass of the bodies, and for their mean moments of inertia.
  void soften(JointDef& joint, const Softness& soft) const {
    double mass = 0, moment = 0;  // inverse
    for (const int body : {joint.bodyA, joint.bodyB}) {
      if (!isDynamic(body)) continue;
      const BodyDef& own = scene_.bodies[static_cast<std::size_t>(body)];
      const MassProperties of = massProperties(own.shape, 1);
      const Vec3 i = of.inertia * (*own.mass / of.mass);
      mass += 1 / *own.mass, moment += 3 / (i.x + i.y + i.z);
    }
    joint.stiffness = soft.stiffness / mass, joint.damping = soft.damping(1 / mass);
    if (joint.type != JointType::Fixed) return;
    joint.angularStiffness = soft.stiffness / moment, joint.angularDamping = soft.damping(1 / moment);
  }

  void addLoop(const Loop& loop) {
    JointDef joint;
    joint.type = loop.keepsOrientation ? JointType::Fixed : JointType::Ball;
    joint.bodyA = bodyIndex(layout_, loop.linkA), joint.bodyB = bodyIndex(layout_, loop.linkB);
    const std::string what = (loop.keepsOrientation ? "weld" : "connect") + inQuotes(loop.name);
    if (joint.bodyA == joint.bodyB || (!isDynamic(joint.bodyA) && !isDynamic(joint.bodyB))) {
      report_.note(Effect::None, loop.place, what, "its bodies do not move relative to one another");
      return;
    }
    const Pose a = poseInBody(layout_, loop.linkA), b = poseInBody(layout_, loop.linkB);
    joint.anchorA = a * loop.anchorA, joint.anchorB = b * loop.anchorB;
    joint.orientationAtoB = normalize(b.q * loop.orientationAtoB * conjugate(a.q));
    if (loop.soft) soften(joint, *loop.soft);
    joint.name = names_.unique(loop.name.empty() ? "loop" : loop.name);
    joint.collide = true;
    report_.converted(loop.place, what, keyword(joint.type) + inQuotes(joint.name));
    scene_.joints.push_back(std::move(joint));
  }

  void add(JointDef joint, const Place& place, const std::string& kind, const std::string& name) {
    joint.name = names_.unique(name.empty() ? kind : name);
    report_.converted(place, kind + inQuotes(name), keyword(joint.type) + inQuotes(joint.name));
    scene_.joints.push_back(std::move(joint));
  }

  void addFree(const FreeJoint& from) {
    JointDef joint = from.joint;
    joint.bodyA = bodyIndex(layout_, from.linkA), joint.bodyB = bodyIndex(layout_, from.linkB);
    const std::string what = "joint" + inQuotes(joint.name);
    if (joint.bodyA == joint.bodyB || (!isDynamic(joint.bodyA) && !isDynamic(joint.bodyB)))
      return report_.note(Effect::None, from.place, what, "its bodies do not move relative to one another");
    const Pose a = poseInBody(layout_, from.linkA), b = poseInBody(layout_, from.linkB);
    joint.anchorA = a * joint.anchorA, joint.anchorB = b * joint.anchorB;
    joint.frameA = normalize(a.q * joint.frameA), joint.frameB = normalize(b.q * joint.frameB);
    joint.orientationAtoB = normalize(joint.frameB * conjugate(joint.frameA));
    if (auto* const tendon = std::any_cast<TendonFields>(&joint.own))
      for (std::size_t i = 0; i < tendon->path.size(); i += 5) {
        double* const point = &tendon->path[i];
        const Vec3 at = (point[0] == 0 ? a : b) * Vec3{point[1], point[2], point[3]};
        for (int k = 0; k < 3; ++k) point[1 + k] = at[k];
      }
    add(std::move(joint), from.place, "joint", from.joint.name);
  }

  void addCoupling(const Coupling& coupling) {
    const auto single = [&](const std::pair<int, int>& dof) {
      const auto link = static_cast<std::size_t>(dof.first);
      return model_.links[link].dofs.size() == 1 ? layout_.jointOf[link] : -1;
    };
    const int a = single(coupling.dofA), b = single(coupling.dofB);
    if (!isReadable(model_, layout_, scene_, coupling.dofA) ||
        !isReadable(model_, layout_, scene_, coupling.dofB))
      report_.note(Effect::Approximate, coupling.place, "coupling" + inQuotes(coupling.name), kSeveralJoints);
    const auto type = [&](int joint) {
      return joint < 0 ? JointType::SixDof : scene_.joints[static_cast<std::size_t>(joint)].type;
    };
    const auto start = [&](const std::pair<int, int>& dof) {
      return model_.links[static_cast<std::size_t>(dof.first)].dofs.front().start;
    };
    const double ratio = coupling.terms[1];
    const bool isLinear = coupling.terms[2] == 0 && coupling.terms[3] == 0 && coupling.terms[4] == 0;
    const bool hingeA = type(a) == JointType::Hinge, hingeB = type(b) == JointType::Hinge;
    JointDef joint;
    if (a < 0 || b < 0 || !isLinear || ratio == 0 || !(hingeA || hingeB)) {
      auto found = cam(model_, layout_, scene_, coupling, report_);
      if (!found) return;
      joint = std::move(*found);
    } else {
      joint = hingeA && hingeB ? gearBetween(scene_, a, b, -ratio)
              : hingeA         ? rackBetween(scene_, a, b, 1 / ratio)
                               : rackBetween(scene_, b, a, ratio);
      // gears and racks measure from the beginning: theta_A - ratio theta_B, theta_A / ratio - travel_B,
      // ratio theta_B - travel_A
      const double left = coupling.terms[0] + ratio * start(coupling.dofB) - start(coupling.dofA);
      joint.axes[0].min = joint.axes[0].max = hingeA && hingeB ? left : hingeA ? left / ratio : -left;
    }
    if (coupling.stiffness < kHard) {
      // of the error of A, in the unit of the joint
      const double unit = a >= 0 && b >= 0 && joint.type == JointType::Rack && hingeA ? ratio : 1;
      joint.axes[0].limitStiffness = coupling.stiffness * unit * unit;
      joint.axes[0].limitDamping = coupling.damping * unit * unit;
    }
    add(std::move(joint), coupling.place, "coupling", coupling.name);
  }

  const Model& model_;
  Layout& layout_;
  Scene& scene_;
  Report& report_;
  Names names_;
};

}  // namespace

void addJoints(const Model& model, Layout& layout, Scene& scene, Report& report) {
  JointBuilder(model, layout, scene, report).build();
}

}  // namespace rubble::convert
