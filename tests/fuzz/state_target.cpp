/// States, arrays and settings of any bits: each call is an Error that changes nothing, or the world stays
/// finite. Snapshots go back and forth between two worlds.
#include <cmath>

#include <rubble/rubble.h>

#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/target.h"

namespace rubble::fuzz {
namespace {

struct Length {
  int commands, steps;
};
constexpr Length kShort{8, 3}, kLong{24, 25};

Scene smallScene() {
  Scene scene;
  scene.bodies.resize(5);
  scene.bodies[0].motion = Motion::Static;
  scene.bodies[0].shape = Shape::plane();
  for (int i = 1; i < 5; ++i) scene.bodies[static_cast<std::size_t>(i)].position = {1.5 * i, 0, .5};
  scene.bodies[2].motion = Motion::Kinematic;
  scene.bodies[3].shape = Shape::sphere(.4);
  scene.joints.resize(1);
  scene.joints[0] = jointAt(scene, JointType::Hinge, 3, 4, {5.2, 0, .5});
  scene.deformables = {tetBox({0, 2, .5}, {1, 1, 1}, {1, 1, 1})};
  return scene;
}

WorldOptions options(bool sleeping) {
  WorldOptions out;
  out.threads = 1;
  out.params.sleeping = sleeping;
  out.params.iterations = 2;  // the last one, and one that is not
  out.timings = false;
  return out;
}

bool isFinite(const Vec3& a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

BodyState anyState(ByteSource& in, BodyState state) {
  if (in.flag()) state.position = in.bitsVector();
  if (in.flag()) state.orientation = in.bitsRotation();
  if (in.flag()) state.velocity = in.bitsVector();
  if (in.flag()) state.angularVelocity = in.bitsVector();
  return state;
}

/// Rows and values of an array that may have the wrong type, length or number of columns.
void scatter(ByteSource& in, World& world) {
  std::vector<std::int32_t> rows;
  std::vector<double> values;
  const int count = in.below(6), columns = 3 + in.below(2);
  for (int i = 0; i < count; ++i) rows.push_back(in.below(8) - 1);
  for (int i = 0; i < count * columns; ++i) values.push_back(in.bits());
  const auto which = static_cast<StateArray>(in.below(7));
  ArrayView rowView = packedArray(rows.data(), count);
  if (in.seldom()) rowView.typestr = "<f4";
  ArrayView valueView = packedArray(values.data(), count, columns);
  if (in.seldom()) valueView.shape[0] = 0;
  world.scatter(which, rowView, valueView);
}

void setVertices(ByteSource& in, World& world) {
  const DeformableId id = world.deformables().front();
  std::vector<Vec3> positions = world.positions(id), velocities = world.velocities(id);
  for (int more = 1 + in.below(4); more > 0; --more) {
    std::vector<Vec3>& list = in.flag() ? positions : velocities;
    list[static_cast<std::size_t>(in.byte()) % list.size()] = in.bitsVector();
  }
  world.setVertices(id, positions, velocities);
}

void query(ByteSource& in, World& world) {
  const Vec3 from = in.bitsVector(), way = in.bitsVector();
  const Quat orientation = in.bitsRotation();
  const double reach = in.bits();
  switch (in.below(4)) {
    case 0:
      world.castRays(std::vector<RayQuery>{{from, way, reach, {}}});
      return;
    case 1:
      world.closestPoints(std::vector<ClosestQuery>{{from, reach, {}}});
      return;
    case 2:
      world.castShapes(std::vector<CastQuery>{{Shape::sphere(.3), from, orientation, way, {}}});
      return;
    default:
      world.overlaps(std::vector<OverlapQuery>{{Shape::box({.3, .2, .1}), from, orientation, {}}});
  }
}

void command(ByteSource& in, World& world, World& other, std::vector<Snapshot>& snapshots) {
  const std::vector<BodyId> bodies = world.bodies();
  const BodyId id = bodies[static_cast<std::size_t>(in.byte()) % bodies.size()];
  const JointId joint = world.joints().front();
  switch (in.below(12)) {
    case 0:
      return world.setState(id, anyState(in, world.state(id)));
    case 1:
      return scatter(in, world);
    case 2:
      return setVertices(in, world);
    case 3:
      return world.applyForceAt(id, in.bitsVector(), {});
    case 4:
      return world.applyImpulse(id, in.bitsVector());
    case 5: {
      const Vec3 position = in.bitsVector();
      return world.setTarget(id, position, in.bitsRotation());
    }
    case 6:
      return world.setGravity(in.bitsVector());
    case 7: {
      const double low = in.bits();
      return world.setLimits(joint, 0, low, in.bits());
    }
    case 8: {
      Params params = world.params();
      const std::vector<ParamField>& fields = paramFields();
      setParam(params, fields[static_cast<std::size_t>(in.byte()) % fields.size()].name, in.bits());
      params.iterations = std::min(params.iterations, 20), params.substeps = std::min(params.substeps, 4);
      return world.setParams(params);
    }
    case 9:
      return query(in, world);
    case 10:
      if (snapshots.size() < 4) snapshots.push_back(world.snapshot());
      return;
    default:
      if (!snapshots.empty())
        other.restore(snapshots[static_cast<std::size_t>(in.byte()) % snapshots.size()]);
  }
}

void stepFinite(World& world) {
  world.step();
  for (const BodyId id : world.bodies()) {
    const BodyState s = world.state(id);
    expect(isFinite(s.position) && isFinite(s.velocity) && isFinite(s.angularVelocity) &&
               std::isfinite(s.orientation.s) && isFinite(s.orientation.v),
           "body " + std::to_string(id.index) + " is not finite");
  }
  for (const Vec3& x : world.positions(world.deformables().front()))
    expect(isFinite(x), "a vertex is not finite");
}

void run(ByteSource in, const Length& most) {
  static const Scene scene = smallScene();
  World worlds[] = {World(scene, options(false)), World(scene, options(true))};
  std::vector<Snapshot> snapshots;
  int steps = most.steps;
  for (int i = 0; i < most.commands && !in.atEnd(); ++i) {
    const int choice = in.below(4);
    World &world = worlds[choice % 2], &other = worlds[1 - choice % 2];
    const std::uint64_t before = world.hash();
    try {
      command(in, world, other, snapshots);
    } catch (const Error& error) {
      expect(world.hash() == before, std::string("an Error changed the world: ") + error.what());
    }
    if (choice > 1 && --steps > 0) stepFinite(world);
  }
  stepFinite(worlds[0]);
}

}  // namespace

/// One program in 32 is long: a claim that fails at random mostly fails early.
void testInput(std::span<const std::uint8_t> bytes) {
  const bool isLong = lotOf(bytes, 32) == 0;
  if (isReplay() || !isLong) run(ByteSource(bytes), kShort);
  if (isReplay() || isLong) run(ByteSource(bytes), kLong);
}

}  // namespace rubble::fuzz
