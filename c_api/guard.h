#pragma once
/// The border between C++ and C: exceptions become status codes, texts stay alive, structs are converted.
#include <rubble/c/types.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include <rubble/rubble.h>

#include "io/scene_json.h"

namespace rubble::c {

/// Records the exception that is being handled as the last error of this thread.
rb_status currentFailure() noexcept;
/// Throws Error whose message lists all faults, and whose path is that of the first one.
[[noreturn]] void throwFaults(const std::vector<io::Fault>& faults, const std::string& file);
/// Keeps a text alive until the next call of this thread that returns one.
const char* keepText(std::string text);

/// Runs `f` and returns RB_OK, or the status of what it throws.
template <class F> rb_status guarded(F&& f) noexcept {
  try {
    f();
    return RB_OK;
  } catch (...) {
    return currentFailure();
  }
}

/// The object behind a pointer that must not be null.
template <class T> T& need(T* pointer, const char* what) {
  if (!pointer) throw Error(what, "a pointer", "null");
  return *pointer;
}
/// A text that may be null.
inline std::string textOr(const char* text, const char* usual) { return text ? text : usual; }

inline BodyId idOf(rb_body_id id) { return {id.index, id.generation}; }
inline ShapeId idOf(rb_shape_id id) { return {id.index, id.generation}; }
inline JointId idOf(rb_joint_id id) { return {id.index, id.generation}; }
inline DeformableId idOf(rb_deformable_id id) { return {id.index, id.generation}; }
inline AttachmentId idOf(rb_attachment_id id) { return {id.index, id.generation}; }
inline rb_body_id idOf(BodyId id) { return {id.index, id.generation}; }
inline rb_shape_id idOf(ShapeId id) { return {id.index, id.generation}; }
inline rb_joint_id idOf(JointId id) { return {id.index, id.generation}; }
inline rb_deformable_id idOf(DeformableId id) { return {id.index, id.generation}; }
inline rb_attachment_id idOf(AttachmentId id) { return {id.index, id.generation}; }

inline Vec3 vec(const double* v) {
  need(v, "a vector");
  return {v[0], v[1], v[2]};
}
inline Quat quat(const double* q) {
  need(q, "an orientation");
  return {q[0], q[1], q[2], q[3]};
}
inline void store(const Vec3& from, double* to) { to[0] = from.x, to[1] = from.y, to[2] = from.z; }
inline void store(const Quat& from, double* to) { to[0] = from.s, store(from.v, to + 1); }

/// Calls f on each element of an array of C structs.
template <class In, class F> auto mapped(const In* in, std::int64_t count, F&& f) {
  std::vector<decltype(f(*in))> out;
  if (count < 0) throw Error("count", "a number of at least 0", std::to_string(count));
  if (count > 0) need(in, "an array");
  out.reserve(static_cast<std::size_t>(count));
  for (const In& each : std::span(in, static_cast<std::size_t>(count))) out.push_back(f(each));
  return out;
}
inline std::vector<BodyId> idsOf(const rb_body_id* ids, std::int64_t count) {
  return mapped(ids, count, [](rb_body_id id) { return idOf(id); });
}
/// Vectors from an array with 3 numbers for each.
std::vector<Vec3> vectorsOf(const double* numbers, std::int64_t count);
/// Writes vectors to an array with room for `count` of them. Throws Error if there are more.
void storeAll(const std::vector<Vec3>& from, double* to, std::int64_t count);

/// Hands out a list that stays in `kept`.
template <class T> void give(std::vector<T>& kept, const T** list, std::int64_t* count) {
  need(list, "list") = kept.data();
  need(count, "count") = static_cast<std::int64_t>(kept.size());
}

/// The same for ids.
template <class T, class Id>
void giveIds(std::vector<T>& kept, const std::vector<Id>& ids, const T** list, std::int64_t* count) {
  kept.clear();
  for (const Id id : ids) kept.push_back(idOf(id));
  give(kept, list, count);
}

/// Throws Error unless it is one of rb_state_array.
StateArray stateArrayOf(std::int32_t which);
/// The same for rb_joint_array, rb_sensor_array and rb_vertex_array.
JointArray jointArrayOf(std::int32_t which);
SensorArray sensorArrayOf(std::int32_t which);
VertexArray vertexArrayOf(std::int32_t which);

QueryFilter filterOf(const rb_query_filter& filter);
RayQuery queryOf(const rb_ray& ray);
RayArrays raysOf(const rb_ray_arrays& rays);
rb_ray_hit_arrays toC(const RayHitArrays& hits);
/// A RayHit, CastHit, OverlapHit or ClosestHit.
template <class Hit> rb_hit toC(const Hit& hit) {
  rb_hit out{};
  if constexpr (requires { hit.hit; })
    out.hit = hit.hit;
  else
    out.hit = 1;
  out.body = idOf(hit.body), out.object = idOf(hit.object);
  out.part = hit.part, out.triangle = hit.triangle;
  out.user_data = hit.userData, out.shape_user_data = hit.shapeUserData;
  if constexpr (requires { hit.distance; }) out.distance = hit.distance;
  if constexpr (requires { hit.fraction; }) out.distance = hit.fraction;
  if constexpr (requires { hit.position; }) store(hit.position, out.position);
  if constexpr (requires { hit.normal; }) store(hit.normal, out.normal);
  return out;
}
rb_mass toC(const MassProperties& mass);
rb_body_state toC(const BodyState& state);
BodyState fromC(const rb_body_state& state);
rb_joint_state toC(const JointState& state);
rb_contact_point toC(const ContactPoint& point);
rb_array toC(const ArrayView& view);
ArrayView fromC(const rb_array& array);
rb_step_report toC(const StepReport& report);

}  // namespace rubble::c
