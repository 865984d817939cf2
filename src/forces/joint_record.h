#pragma once
/// A joint between World and the tables: what its definition becomes, in double precision. Host only.
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

#include <rubble/scene.h>

namespace rubble {

/// Mode of rows with one stiffness: off, held, friction relative to the start of the step, or held as a point
/// in the steps that the joint chooses.
enum class GroupMode { Off, Hold, Friction, Point };

/// Rows with a common stiffness and force bound.
struct EngineGroup {
  using Mode = GroupMode;
  Mode mode = Mode::Hold;
  double stiffness = kHard, damping = 0, bound = kHard;
};

/// Constants of a joint type beyond its placement: a struct of numbers that its header declares.
class JointConstants {
 public:
  template <class T> void set(const T& constants) {
    static_assert(std::is_trivially_copyable_v<T>);
    values_.resize(sizeof(T));
    std::memcpy(values_.data(), &constants, sizeof(T));
  }
  /// The defaults of T if nothing was set.
  template <class T> T get() const {
    T constants{};
    if (values_.size() == sizeof(T)) std::memcpy(static_cast<void*>(&constants), values_.data(), sizeof(T));
    return constants;
  }
  std::vector<std::byte>& bytes() { return values_; }

 private:
  std::vector<std::byte> values_;
};

/// A joint between body slots (kWorld: the world). Groups and axes are those of its parts, in their order.
struct EngineJoint {
  int type = 0;  ///< index into JointTypes
  int a = kWorld, b = kWorld;
  int frameBodyA = kWorld, frameBodyB = kWorld;  ///< frame bodies of the axes
  bool alive = false;
  bool isRigid = true;  ///< rigidly connects its bodies (joint trees, aggregates, ccd islands)
  Vec3 anchorA, anchorB;
  Quat frameA, frameB, aToB;
  JointConstants constants;
  std::vector<EngineGroup> groups;
  std::vector<JointAxis> axes;
  double breakForce = kUnbreakable, breakTorque = kUnbreakable;
  int turned = 0;  ///< six-dof: authored axis (i + turned) % 3 is axis i here
};

/// A body of a joint at the time when the joint is made. The world has the identity pose and no mass.
struct JointBodyState {
  Vec3 position;
  Quat orientation;
  MassProperties mass;

  Vec3 center = {};  ///< of mass, in the authored frame [m]
  Quat axes = {};    ///< engine frame -> authored frame

  Vec3 point(const Vec3& local) const;  ///< in the world [m]
  /// A point of the authored frame in the engine frame, which `position` and `orientation` are of.
  Vec3 inEngineFrame(const Vec3& authored) const { return rotateInverse(axes, authored - center); }
};
struct JointBodies {
  JointBodyState a, b;
  JointBodyState frameBodyA = {}, frameBodyB = {};
};

}  // namespace rubble
