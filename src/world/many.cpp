// Batched edits of bodies, and state arrays.
#include <cmath>
#include <cstring>
#include <string_view>

#include "cook/checks.h"
#include "world/body_additions.h"

namespace rubble {

namespace {

void sameLength(std::size_t wanted, std::size_t got, const char* path) {
  if (got != wanted)
    throw Error(path, "as many as there are ids, " + std::to_string(wanted), std::to_string(got));
}

int numbersOf(StateArray which) { return which == StateArray::Orientation ? 4 : 3; }

void expect(bool holds, const Path& path, const std::string& expected, const std::string& got) {
  if (!holds) throw Error(path, expected, got);
}

std::string shapeText(std::int64_t rows, std::int64_t columns) {
  std::string text("(");
  text.append(std::to_string(rows)).append(", ").append(std::to_string(columns)).append(")");
  return text;
}
std::string shapeText(const ArrayView& view) { return shapeText(view.shape[0], view.shape[1]); }

double numberAt(const ArrayView& view, std::int64_t row, std::int64_t column) {
  const char* const at = static_cast<const char*>(view.data) + row * view.strides[0] +
                         column * view.strides[1];
  if (view.typestr[2] == '8') return *reinterpret_cast<const double*>(at);
  return static_cast<double>(*reinterpret_cast<const float*>(at));
}

/// Synchronous copies of host arrays.
class HostPoseCopies final : public PoseCopies {
 public:
  explicit HostPoseCopies(Engine& engine) : engine_(engine) {}
  void begin(int buffer) override {
    frames_[buffer][0].take(engine_.array(StateArray::Position));
    frames_[buffer][1].take(engine_.array(StateArray::Orientation));
  }
  bool ready(int) const override { return true; }
  void wait(int) override {}
  ArrayView position(int buffer) const override { return frames_[buffer][0].view; }
  ArrayView orientation(int buffer) const override { return frames_[buffer][1].view; }

 private:
  struct Copy {
    std::vector<std::byte> bytes;
    ArrayView view;
    void take(const ArrayView& from) {
      if (from.device) throw Error("world", "one that is not part of a batch on a device", "one of many");
      bytes.resize(static_cast<std::size_t>(from.shape[0] * from.strides[0]));
      if (!bytes.empty()) std::memcpy(bytes.data(), from.data, bytes.size());
      view = from;
      view.data = bytes.data();
    }
  };
  Engine& engine_;
  Copy frames_[2][2];
};

}  // namespace

std::vector<BodyId> World::addBodies(std::span<const BodyDef> bodies) {
  std::vector<BodyId> ids = withMemory("addBodies", [&] {
    for (std::size_t k = 0; k < bodies.size(); ++k) validate(bodies[k], Path("bodies")[k]);
    return impl_->addBodies(bodies, "bodies");
  });
  impl_->pass(inputs::AddBodies{bodies});
  return ids;
}

std::vector<BodyId> World::Impl::addBodies(std::span<const BodyDef> bodies, const Path& list) {
  BodyAdditions added(registry, *cooked, bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) added.add(bodies[k], list[k]);
  std::vector<BodyId> ids = added.commit(*engine);
  epoch += static_cast<std::int64_t>(bodies.size());
  return ids;
}

void World::removeBodies(std::span<const BodyId> ids) {
  withMemory("removeBodies", [&] { impl_->removeBodies(ids); });
  impl_->pass(inputs::RemoveBodies{ids});
}

void World::setStates(std::span<const BodyId> ids, std::span<const BodyState> states) {
  sameLength(ids.size(), states.size(), "states");
  for (std::size_t k = 0; k < ids.size(); ++k) {
    impl_->requireAlive(ids[k]);
    validate(states[k], Path("states")[k]);
  }
  withMemory("setStates", [&] {
    std::vector<Edit> edits;
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const BodyRecord& body = impl_->registry.bodies[ids[k]];
      if (body.def.motion != Motion::Dynamic) impl_->addWake(edits, ids[k]);
      edits.push_back(SetBodyState{ids[k].index, body.frame.toEngine(states[k])});
    }
    impl_->engine->apply(edits);
  });
  impl_->pass(inputs::SetStates{ids, states});
}

void World::applyForces(std::span<const BodyId> ids, std::span<const Vec3> forces,
                        std::span<const Vec3> torques) {
  sameLength(ids.size(), forces.size(), "forces");
  if (!torques.empty()) sameLength(ids.size(), torques.size(), "torques");
  for (const BodyId id : ids) {
    impl_->requireAlive(id);
    impl_->idle.force.seen |= !impl_->isDynamic(id);
  }
  checks::finite(forces, "forces");
  checks::finite(torques, "torques");
  withMemory("applyForces", [&] {
    std::vector<Edit> edits;
    for (std::size_t k = 0; k < ids.size(); ++k)
      edits.push_back(AddForce{ids[k].index, forces[k], torques.empty() ? Vec3{} : torques[k]});
    impl_->engine->apply(edits);
  });
  impl_->pass(inputs::ApplyForces{ids, forces, torques});
}

void World::applyImpulses(std::span<const BodyId> ids, std::span<const Vec3> impulses) {
  sameLength(ids.size(), impulses.size(), "impulses");
  checks::finite(impulses, "impulses");
  withMemory("applyImpulses", [&] {
    std::vector<Edit> edits;
    for (std::size_t k = 0; k < ids.size(); ++k) {
      impl_->requireAlive(ids[k]);
      const BodyRecord& body = impl_->registry.bodies[ids[k]];
      if (body.def.motion != Motion::Dynamic) {
        impl_->idle.force.seen = true;
        continue;
      }
      edits.push_back(AddVelocity{ids[k].index, impulses[k] / body.mass.mass});
    }
    impl_->engine->apply(edits);
  });
  impl_->pass(inputs::ApplyImpulses{ids, impulses});
}

ArrayView World::array(StateArray which) const {
  checks::enumeration(which, StateArray::Torque, "array");
  return withMemory("array", [&] {
    impl_->flush();
    ArrayView view = impl_->engine->array(which);
    view.epoch = impl_->epoch;
    return view;
  });
}

std::int64_t World::epoch() const { return impl_->epoch; }

namespace {

/// Throws Error unless `values` can be written to rows of `numbers` numbers.
void checkRows(int numbers, const ArrayView& rows, const ArrayView& values) {
  const std::string_view rowType = rows.typestr, type = values.typestr;
  expect(rowType == "<i4", "rows.typestr", "<i4", rows.typestr);
  expect(rows.shape[0] >= 0 && rows.shape[1] == 1, "rows.shape", "(n, 1)", shapeText(rows));
  expect(type == "<f4" || type == "<f8", "values.typestr", "<f4 or <f8", values.typestr);
  expect(values.shape[0] == rows.shape[0] && values.shape[1] == numbers, "values.shape",
         shapeText(rows.shape[0], numbers), shapeText(values));
  if (rows.shape[0] == 0) return;
  expect(rows.data && values.data, "rows, values", "memory", "none");
  expect(rows.device == values.device, "rows, values", "both on the host or both on the device",
         "one of each");
  if (values.device) return;
  for (std::int64_t k = 0; k < values.shape[0]; ++k) {
    const Path list("values");
    for (int j = 0; j < numbers; ++j)
      checks::finite(numberAt(values, k, j), list[static_cast<std::size_t>(k)]);
  }
}

}  // namespace

void checkScatter(StateArray which, const ArrayView& rows, const ArrayView& values) {
  checks::enumeration(which, StateArray::Torque, "array");
  checkRows(numbersOf(which), rows, values);
  if (which != StateArray::Orientation || values.device) return;
  for (std::int64_t k = 0; k < values.shape[0]; ++k) {
    const Path list("values");
    checks::rotation(
        {numberAt(values, k, 0), {numberAt(values, k, 1), numberAt(values, k, 2), numberAt(values, k, 3)}},
        list[static_cast<std::size_t>(k)]);
  }
}

void checkScatter(JointArray which, const ArrayView& rows, const ArrayView& values) {
  checks::enumeration(which, JointArray::AppliedForce, "array");
  expect(which >= JointArray::TargetPosition, "array", "an array that can be written", "another");
  checkRows(1, rows, values);
}

void World::scatter(StateArray which, const ArrayView& rows, const ArrayView& values) {
  withMemory("scatter", [&] {
    checkScatter(which, rows, values);
    if (rows.shape[0] == 0) return;
    impl_->flush();
    const bool onDevice = impl_->engine->poseCopies() != nullptr;
    expect(onDevice || !values.device, "values", "host memory", "memory of a device");
    impl_->engine->scatter(which, rows, values);
  });
  if (rows.shape[0] == 0) return;
  impl_->pass(inputs::Scatter{which, rows, values});
}

PoseCopies& World::Impl::poseCopies() {
  if (PoseCopies* own = engine->poseCopies()) return *own;
  if (!poses.host) poses.host = std::make_unique<HostPoseCopies>(*engine);
  return *poses.host;
}

void World::beginPoses() {
  PoseRing& ring = impl_->poses;
  if (ring.begun - ring.taken >= 2)
    throw Error("beginPoses", "at most two copies under way: take one", "a third");
  const int buffer = static_cast<int>(ring.begun % 2);
  withMemory("beginPoses", [&] {
    impl_->flush();
    impl_->poseCopies().begin(buffer);
  });
  ring.frames[buffer] = {impl_->registry.step, impl_->registry.time};
  ++ring.begun;
}

bool World::posesReady() const {
  const PoseRing& ring = impl_->poses;
  return ring.begun > ring.taken && impl_->poseCopies().ready(static_cast<int>(ring.taken % 2));
}

PoseFrame World::takePoses() {
  PoseRing& ring = impl_->poses;
  if (ring.begun == ring.taken) throw Error("takePoses", "a copy that beginPoses() began", "none");
  const int buffer = static_cast<int>(ring.taken % 2);
  PoseCopies& copies = impl_->poseCopies();
  copies.wait(buffer);
  ++ring.taken;
  return {ring.frames[buffer].step, ring.frames[buffer].time, copies.position(buffer),
          copies.orientation(buffer)};
}

void World::reserve(const std::string& kind, int count) {
  // tables grow by half, and their elements are counted in int
  constexpr int kMost = 1 << 28;
  if (count < 0 || count > kMost)
    throw Error("count", "a number from 0 to " + std::to_string(kMost), std::to_string(count));
  if (!withMemory("reserve", [&] { return impl_->engine->reserve(kind, count); }))
    throw Error("kind",
                "pairs, activePairs, manifolds, rollers, bounceRows, incidences, colors, aggregates, slices, "
                "boundary, pointPairs, pointIncidences, nearFeatures, freeIslands or columnNodes",
                "\"" + kind + "\"");
}

}  // namespace rubble
