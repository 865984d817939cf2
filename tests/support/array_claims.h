#pragma once
/// Claims of the arrays of joints and sensors, on any backend. `copy(view)` gives the numbers of a view, row
/// after row.
#include <functional>
#include <vector>

#include "tests/support/worlds_claims.h"

namespace rubble::test {

using CopyView = std::function<std::vector<double>(const ArrayView&)>;

/// Numbers of a view in host memory.
inline std::vector<double> copyOfHost(const ArrayView& view) {
  std::vector<double> out;
  for (std::int64_t row = 0; row < view.shape[0]; ++row)
    for (std::int64_t k = 0; k < view.shape[1]; ++k) {
      const char* const at = static_cast<const char*>(view.data) + row * view.strides[0] +
                             k * view.strides[1];
      out.push_back(view.typestr[2] == '8' ? *reinterpret_cast<const double*>(at)
                                           : static_cast<double>(*reinterpret_cast<const float*>(at)));
    }
  return out;
}

/// Rows and values in host memory as views.
struct HostRows {
  std::vector<int> rows;
  std::vector<double> values;
  ArrayView rowView() const { return packedArray(rows.data(), std::ssize(rows)); }
  ArrayView valueView() const { return packedArray(values.data(), std::ssize(rows)); }
};

/// Equal up to the round-off of single precision.
inline void expectClose(double a, double b, const std::string& what, double scale = 1) {
  EXPECT_NEAR(a, b, 2e-5 * std::max({scale, std::fabs(a), std::fabs(b)})) << what;
}

/// The arrays of a world tell what its joints and bodies tell one by one. `asDefined`: nothing wrote targets.
inline void expectArraysOfWorld(const World& world, const CopyView& copy, bool asDefined = true) {
  const std::vector<World::Axis> axes = world.axes();
  const std::vector<double> position = copy(world.array(JointArray::Position)),
                            speed = copy(world.array(JointArray::Speed)),
                            drive = copy(world.array(JointArray::DriveForce)),
                            limit = copy(world.array(JointArray::LimitForce)),
                            lower = copy(world.array(JointArray::LowerLimit)),
                            upper = copy(world.array(JointArray::UpperLimit)),
                            target = copy(world.array(JointArray::TargetSpeed));
  ASSERT_EQ(position.size(), axes.size());
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const JointAxisState state = world.state(axes[k].joint).axes[static_cast<std::size_t>(axes[k].axis)];
    const JointAxis& own = world.definition(axes[k].joint).axes[static_cast<std::size_t>(axes[k].axis)];
    expectClose(position[k], state.position, "position");
    expectClose(speed[k], state.speed, "speed");
    expectClose(drive[k], state.driveForce, "drive force");
    expectClose(limit[k], state.limitForce, "limit force");
    if (world.definition(axes[k].joint).type != JointType::Hinge) continue;
    if (own.min > -kFree) expectClose(lower[k], own.min, "lower limit");
    if (own.max < kFree) expectClose(upper[k], own.max, "upper limit");
    if (asDefined) expectClose(target[k], own.targetSpeed, "target speed");
  }
  const std::vector<double> force = copy(world.array(SensorArray::JointForce)),
                            torque = copy(world.array(SensorArray::JointTorque));
  const std::vector<JointId> joints = world.joints();
  ASSERT_EQ(force.size(), 3 * joints.size());
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const JointState state = world.state(joints[k]);
    for (int i = 0; i < 3; ++i) {
      expectClose(force[3 * k + static_cast<std::size_t>(i)], state.force[i], "joint force", 10);
      expectClose(torque[3 * k + static_cast<std::size_t>(i)], state.torque[i], "joint torque", 10);
    }
  }
  const std::vector<double> contact = copy(world.array(SensorArray::ContactForce)),
                            touch = copy(world.array(SensorArray::Touch)),
                            rate = copy(world.array(SensorArray::AngularRate)),
                            orientation = copy(world.array(StateArray::Orientation)),
                            spin = copy(world.array(StateArray::AngularVelocity));
  std::vector<Vec3> sums(touch.size());
  std::vector<double> normals(touch.size(), 0);
  for (const ContactPoint& c : world.contacts()) {
    sums[static_cast<std::size_t>(c.a.index)] -= c.force,
        sums[static_cast<std::size_t>(c.b.index)] += c.force;
    for (const BodyId id : {c.a, c.b}) normals[static_cast<std::size_t>(id.index)] += dot(c.normal, c.force);
  }
  std::vector<std::array<BodyId, 2>> pairs;
  for (const BodyId a : world.bodies())
    for (const BodyId b : world.bodies())
      if (a != b) pairs.push_back({a, b});
  const std::vector<double> between = copy(world.contactForces(pairs));
  std::vector<Vec3> sumsOfPairs(touch.size());
  for (std::size_t k = 0; k < pairs.size(); ++k)
    sumsOfPairs[static_cast<std::size_t>(pairs[k][1].index)] += Vec3{between[3 * k], between[3 * k + 1],
                                                                     between[3 * k + 2]};
  for (const BodyId id : world.bodies()) {
    for (int i = 0; i < 3; ++i)
      expectClose(sumsOfPairs[static_cast<std::size_t>(id.index)][i],
                  sums[static_cast<std::size_t>(id.index)][i], "contact force of pairs", 10);
    const auto row = static_cast<std::size_t>(id.index);
    for (int i = 0; i < 3; ++i)
      expectClose(contact[3 * row + static_cast<std::size_t>(i)], sums[row][i], "contact force", 10);
    expectClose(touch[row], normals[row], "touch", 10);
    const Quat q{orientation[4 * row],
                 {orientation[4 * row + 1], orientation[4 * row + 2], orientation[4 * row + 3]}};
    const Vec3 w = rotateInverse(q, Vec3{spin[3 * row], spin[3 * row + 1], spin[3 * row + 2]});
    for (int i = 0; i < 3; ++i)
      expectClose(rate[3 * row + static_cast<std::size_t>(i)], w[i], "angular rate");
  }
}

/// Arrays of many worlds are those of each world alone, with the same bits, and writes act on the rows that
/// they name.
inline void expectArraysOfWorlds(const RandomWorlds& random, const WorldOptions& options, int count,
                                 const CopyView& copy) {
  Worlds worlds(options);
  for (int w = 0; w < count; ++w) worlds.add(random.scene(w));
  const auto drive = [&](Worlds& of, int first, int number) {
    HostRows given;
    const int axes = static_cast<int>(of[first].axes().size());
    for (int k = 0; k < axes; ++k)
      given.rows.push_back(of.firstAxis(first) + k), given.values.push_back(0.1 * (number + 1) - 0.05 * k);
    for (const JointArray which :
         {JointArray::AppliedForce, JointArray::TargetSpeed, JointArray::TargetPosition})
      of.scatter(which, given.rowView(), given.valueView());
  };
  for (int w = 0; w < count; ++w) drive(worlds, w, w);
  worlds.step(20);
  for (const JointArray which : {JointArray::Position, JointArray::Speed, JointArray::DriveForce,
                                 JointArray::TargetPosition, JointArray::TargetSpeed}) {
    const std::vector<double> all = copy(worlds.array(which));
    std::size_t next = 0;
    for (int w = 0; w < count; ++w) {
      Worlds one(options);
      one.add(random.scene(w));
      drive(one, 0, w);
      one.step(20);
      const std::vector<double> own = copy(one.array(which));
      ASSERT_LE(next + own.size(), all.size());
      EXPECT_EQ(std::vector<double>(all.begin() + static_cast<std::ptrdiff_t>(next),
                                    all.begin() + static_cast<std::ptrdiff_t>(next + own.size())),
                own)
          << "world " << w << ", array " << static_cast<int>(which);
      EXPECT_EQ(copy(worlds[w].array(which)), own);
      next += own.size();
    }
    EXPECT_EQ(next, all.size());
  }
  for (int w = 0; w < count; ++w) expectArraysOfWorld(worlds[w], copy, false);
}

/// Vertices of many worlds, which differ in their deformable objects: those of each world alone, with the
/// same bits, in the rows that firstVertex() names.
inline void expectVertexArrays(const WorldOptions& options, int count, const CopyView& copy) {
  const auto sceneOf = [](int w) {
    Scene scene = emptyScene({0, 0, -10});
    scene.bodies.push_back(ground());
    if (w % 3 != 1)
      scene.deformables.emplace_back(clothSheet({-1, -1, 0.05}, {2, 0, 0}, {0, 2, 0.1 * w}, 2, 2));
    if (w % 2 != 0) scene.deformables.emplace_back(straightCable({0, 0, 1}, {1, 0, 1 + 0.1 * w}, 4));
    return scene;
  };
  const auto play = [](Worlds& worlds, int world) {
    worlds.step(5);
    worlds[world].addDeformable(tetBox({3, 3, 0.1}, {1, 1, 1}, {1, 1, 1}));
    worlds.step(5);
  };
  Worlds worlds(options);
  for (int w = 0; w < count; ++w) worlds.add(sceneOf(w));
  play(worlds, count / 2);
  std::int64_t rows = 0;
  for (int w = 0; w < count; ++w) {
    EXPECT_EQ(worlds.firstVertex(w), rows) << "world " << w;
    for (const DeformableId id : worlds[w].deformables()) rows += worlds[w].vertexCount(id);
  }
  for (const VertexArray which : {VertexArray::Position, VertexArray::Velocity}) {
    const ArrayView view = worlds.array(which);
    EXPECT_EQ(view.shape[0], rows);
    EXPECT_EQ(view.shape[1], 3);
    const std::vector<double> all = copy(view);
    for (int w = 0; w < count; ++w) {
      Worlds one(options);
      one.add(sceneOf(w));
      w == count / 2 ? play(one, 0) : void(one.step(10));
      const std::vector<double> own = copy(one.array(which));
      const auto first = all.begin() + 3 * worlds.firstVertex(w);
      EXPECT_EQ(std::vector<double>(first, first + static_cast<std::ptrdiff_t>(own.size())), own)
          << "world " << w;
      EXPECT_EQ(copy(worlds[w].array(which)), own);
      for (const DeformableId id : worlds[w].deformables()) {
        const std::vector<Vec3> listed = which == VertexArray::Position ? worlds[w].positions(id)
                                                                        : worlds[w].velocities(id);
        for (std::size_t v = 0; v < listed.size(); ++v)
          for (int i = 0; i < 3; ++i)
            EXPECT_EQ(listed[v][i], own[3 * (static_cast<std::size_t>(worlds[w].firstVertex(id)) + v) +
                                        static_cast<std::size_t>(i)]);
      }
    }
  }
}

/// A force along an axis does what the same forces on both bodies do.
inline void expectForcesAlongAxes(const WorldOptions& options) {
  Scene scene = emptyScene({0, 0, -10});
  scene.bodies.push_back(body(Shape::box({0.2, 0.1, 0.1}), {0, 0, 0}));
  scene.bodies.push_back(body(Shape::box({0.1, 0.1, 0.3}), {0, 0, 0.3}));
  scene.joints.push_back(jointAt(scene, JointType::Slider, 0, kWorld, {0, 0, 0}));
  scene.joints.push_back(jointAt(scene, JointType::Hinge, 1, 0, {0, 0, 0}));
  Worlds worlds(options);
  worlds.addCopies(scene, 2);
  const std::vector<World::Axis> axes = worlds[0].axes();
  ASSERT_EQ(axes.size(), 2u);
  const Vec3 x{1, 0, 0};  // of both frames
  for (int k = 0; k < 25; ++k) {
    const HostRows given{{worlds.firstAxis(0), worlds.firstAxis(0) + 1}, {3, 0.5}};
    worlds.scatter(JointArray::AppliedForce, given.rowView(), given.valueView());
    World& other = worlds[1];
    other.applyForce(other.bodyAt(0), 3 * x);
    other.applyTorque(other.bodyAt(1), 0.5 * x), other.applyTorque(other.bodyAt(0), -0.5 * x);
    worlds.step();
  }
  for (int b = 0; b < 2; ++b) {
    const BodyState one = worlds[0].state(worlds[0].bodyAt(b)), two = worlds[1].state(worlds[1].bodyAt(b));
    EXPECT_LT(length(one.position - two.position), 1e-4);
    EXPECT_LT(length(one.angularVelocity - two.angularVelocity), 1e-3);
  }
  EXPECT_GT(worlds[0].state(axes[0].joint).axes[0].position, 0.005);
}

/// An accelerometer at rest shows gravity upward, one in free fall nothing.
inline void expectAccelerations(const WorldOptions& options, const CopyView& copy) {
  Scene scene = emptyScene({0, 0, -9.81});
  scene.bodies.push_back(ground());
  scene.bodies.push_back(body(Shape::box({0.5, 0.5, 0.5}), {0, 0, 0.5}));
  scene.bodies.push_back(body(Shape::sphere(0.1), {3, 0, 50}));
  World world(scene, options);
  run(world, 60);
  const std::vector<double> a = copy(world.array(SensorArray::Acceleration));
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(a[static_cast<std::size_t>(3 + i)], i == 2 ? 9.81 : 0, 0.02);
    EXPECT_NEAR(a[static_cast<std::size_t>(6 + i)], 0, 0.01);
  }
  EXPECT_NEAR(copy(world.array(SensorArray::Touch))[1], 9.81 * world.massOf(world.bodyAt(1)).mass, 0.1);
}

/// Rays in many worlds hit what those of each world hit.
inline void expectRays(const RandomWorlds& content, const WorldOptions& options, int count) {
  Worlds worlds(options);
  for (int w = 0; w < count; ++w) worlds.add(content.scene(w));
  worlds.step(5);
  Random random(3);
  std::vector<Worlds::WorldRay> rays;
  for (int k = 0; k < 40 * count; ++k)
    rays.push_back({random.below(count), {random.vector(3), random.direction(), 10., {}}});
  const std::vector<RayHit> hits = worlds.castRays(rays);
  int found = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const RayHit own = worlds[rays[k].world].castRays({{rays[k].ray}})[0];
    EXPECT_EQ(hits[k].hit, own.hit);
    EXPECT_EQ(hits[k].body, own.body);
    EXPECT_EQ(hits[k].position, own.position);
    found += own.hit;
  }
  EXPECT_GT(found, count);
}

}  // namespace rubble::test
