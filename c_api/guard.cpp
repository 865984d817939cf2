#include "c_api/guard.h"

#include <new>

#include <rubble/c/scene.h>

#include "io/definition_json.h"

namespace rubble::c {
namespace {

struct LastError {
  std::string message, path, expected, found;
  rb_error plain{RB_OK, "", "", "", ""};

  /// Where there is no memory for texts.
  rb_status setOutOfMemory() noexcept {
    plain = {RB_OUT_OF_MEMORY, "out of memory", "", "", ""};
    return RB_OUT_OF_MEMORY;
  }

  rb_status set(rb_status status, const char* text, const Error* error = nullptr) {
    message = text;
    path = error ? error->path() : "";
    expected = error ? error->expected() : "";
    found = error ? error->found() : "";
    plain = {status, message.c_str(), path.c_str(), expected.c_str(), found.c_str()};
    return status;
  }
};

LastError& lastError() {
  static thread_local LastError error;
  return error;
}

/// Several faults at once: the parts are those of the first one.
class Faults : public Error {
 public:
  Faults(const Error& first, std::string all) : Error(first), all_(std::move(all)) {}
  const char* what() const noexcept override { return all_.c_str(); }

 private:
  std::string all_;
};

}  // namespace

rb_status currentFailure() noexcept {
  try {
    try {
      throw;
    } catch (const OutOfMemory& error) {
      return lastError().set(RB_OUT_OF_MEMORY, error.what(), &error);
    } catch (const Error& error) {
      return lastError().set(RB_INVALID, error.what(), &error);
    } catch (const std::bad_alloc&) {
      return lastError().setOutOfMemory();
    } catch (const std::exception& error) {
      return lastError().set(RB_FAILED, error.what());
    } catch (...) {
      return lastError().set(RB_FAILED, "unknown failure");
    }
  } catch (...) {
    return lastError().setOutOfMemory();
  }
}

void throwFaults(const std::vector<io::Fault>& faults, const std::string& file) {
  const Error first = io::errorOf(faults.front());
  if (faults.size() == 1 && file.empty()) throw first;
  throw Faults(first, io::faultText(file.empty() ? "scene" : file, faults));
}

const char* keepText(std::string text) {
  static thread_local std::string kept;
  kept = std::move(text);
  return kept.c_str();
}

std::vector<Vec3> vectorsOf(const double* numbers, std::int64_t count) {
  std::vector<Vec3> out;
  if (count < 0) throw Error("count", "a number of at least 0", std::to_string(count));
  if (count > 0) need(numbers, "an array");
  out.reserve(static_cast<std::size_t>(count));
  for (std::int64_t k = 0; k < count; ++k) out.push_back(vec(numbers + 3 * k));
  return out;
}

void storeAll(const std::vector<Vec3>& from, double* to, std::int64_t count) {
  if (static_cast<std::int64_t>(from.size()) > count)
    throw Error("count", "room for " + std::to_string(from.size()) + " vectors", std::to_string(count));
  if (!from.empty()) need(to, "an array");
  for (const Vec3& each : from) store(each, to), to += 3;
}

StateArray stateArrayOf(std::int32_t which) {
  if (which < RB_POSITION || which > RB_TORQUE)
    throw Error("which", "a state array, 0 to 5", std::to_string(which));
  return static_cast<StateArray>(which);
}

JointArray jointArrayOf(std::int32_t which) {
  if (which < RB_JOINT_POSITION || which > RB_JOINT_APPLIED_FORCE)
    throw Error("which", "a joint array, 0 to 9", std::to_string(which));
  return static_cast<JointArray>(which);
}

VertexArray vertexArrayOf(std::int32_t which) {
  if (which < RB_VERTEX_POSITION || which > RB_VERTEX_VELOCITY)
    throw Error("which", "a vertex array, 0 or 1", std::to_string(which));
  return static_cast<VertexArray>(which);
}

SensorArray sensorArrayOf(std::int32_t which) {
  if (which < RB_SENSOR_CONTACT_FORCE || which > RB_SENSOR_JOINT_TORQUE)
    throw Error("which", "a sensor array, 0 to 5", std::to_string(which));
  return static_cast<SensorArray>(which);
}

QueryFilter filterOf(const rb_query_filter& filter) {
  return {filter.layers,           filter.mask,
          filter.sensors != 0,     idOf(filter.ignore),
          filter.deformables != 0, idOf(filter.ignore_object)};
}

RayQuery queryOf(const rb_ray& ray) {
  return {vec(ray.origin), vec(ray.direction), ray.max_distance, filterOf(ray.filter)};
}

RayArrays raysOf(const rb_ray_arrays& rays) {
  return {fromC(rays.origins), fromC(rays.directions), rays.max_distance, filterOf(rays.filter)};
}
rb_ray_hit_arrays toC(const RayHitArrays& hits) {
  return {toC(hits.distances), toC(hits.bodies), toC(hits.normals)};
}

rb_mass toC(const MassProperties& mass) {
  rb_mass out{};
  out.mass = mass.mass;
  store(mass.inertia, out.inertia), store(mass.center, out.center), store(mass.axes, out.axes);
  return out;
}

rb_body_state toC(const BodyState& state) {
  rb_body_state out{};
  store(state.position, out.position), store(state.orientation, out.orientation);
  store(state.velocity, out.velocity), store(state.angularVelocity, out.angular_velocity);
  return out;
}

BodyState fromC(const rb_body_state& state) {
  return {vec(state.position), quat(state.orientation), vec(state.velocity), vec(state.angular_velocity)};
}

rb_joint_state toC(const JointState& state) {
  rb_joint_state out{};
  out.gap = state.gap, out.angle = state.angle, out.broken = state.broken;
  store(state.force, out.force), store(state.torque, out.torque);
  out.axis_count = static_cast<std::int32_t>(std::min(state.axes.size(), std::size(out.axes)));
  for (std::int32_t k = 0; k < out.axis_count; ++k) {
    const JointAxisState& axis = state.axes[static_cast<std::size_t>(k)];
    out.axes[k] = {axis.position,   axis.speed,         axis.limitForce,
                   axis.driveForce, axis.frictionForce, axis.motorForce};
  }
  return out;
}

rb_contact_point toC(const ContactPoint& point) {
  rb_contact_point out{};
  out.a = idOf(point.a), out.b = idOf(point.b), out.depth = point.depth;
  out.part_a = point.partA, out.part_b = point.partB;
  store(point.position, out.position), store(point.normal, out.normal), store(point.force, out.force);
  return out;
}

rb_array toC(const ArrayView& view) {
  return {view.data,
          {view.shape[0], view.shape[1]},
          {view.strides[0], view.strides[1]},
          view.typestr,
          view.device,
          std::uint64_t{view.stream},
          view.epoch};
}

ArrayView fromC(const rb_array& array) {
  ArrayView out;
  out.data = array.data;
  std::copy_n(array.shape, 2, out.shape), std::copy_n(array.strides, 2, out.strides);
  out.typestr = array.typestr ? array.typestr : "";
  out.device = array.device != 0;
  out.stream = static_cast<std::uintptr_t>(array.stream);
  out.epoch = array.epoch;
  return out;
}

rb_step_report toC(const StepReport& report) {
  rb_step_report out{};
  out.step = report.step;
  out.bodies = report.bodies, out.pairs = report.pairs;
  out.manifolds = report.manifolds, out.contacts = report.contacts;
  out.vertices = report.vertices, out.vertex_contacts = report.vertexContacts;
  out.colors = report.colors, out.clashes = report.clashes;
  out.broken_joints = report.brokenJoints, out.sleeping_bodies = report.sleepingBodies;
  out.stopped_bodies = report.stoppedBodies, out.quarantined = report.quarantined;
  out.failed_solves = report.failedSolves, out.restarts = report.restarts;
  out.sorted = report.sorted;
  out.unfinished_motion = report.unfinishedMotion, out.total_ms = report.totalMs;
  return out;
}

}  // namespace rubble::c

extern "C" {

int32_t rb_api_version(void) { return RB_API_VERSION; }
const rb_error* rb_last_error(void) { return &rubble::c::lastError().plain; }
}
