#pragma once
/// Joints as they are authored: a struct for each type (joint_types.h), and joints at a point of the world.
#include <rubble/ids.h>
#include <rubble/joint_types.h>

namespace rubble {

class World;

/// The joint at a world point [m] with the axes of `frame` (world), between its bodyA and bodyB as they are
/// placed in the scene. The constraint error is zero and all angles are 0.
JointDef jointAt(const Scene& scene, JointDef joint, const Vec3& point, const Quat& frame = {});
/// The same between two bodies of a world where they are now (BodyId{}: the world).
JointDef jointAt(const World& world, JointDef joint, BodyId bodyA, BodyId bodyB, const Vec3& point,
                 const Quat& frame = {});

}  // namespace rubble
