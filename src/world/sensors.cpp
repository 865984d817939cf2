#include <rubble/sensors.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "world/worlds_impl.h"

namespace rubble {
namespace {

struct Kind {
  const char* keyword;
  int size;
};
/// In the order of SensorType.
constexpr std::array<Kind, 19> kKinds{{{"acceleration", 3},
                                       {"angular_rate", 3},
                                       {"velocity", 3},
                                       {"position", 3},
                                       {"orientation", 4},
                                       {"x_axis", 3},
                                       {"y_axis", 3},
                                       {"z_axis", 3},
                                       {"linear_velocity", 3},
                                       {"angular_velocity", 3},
                                       {"linear_acceleration", 3},
                                       {"force", 3},
                                       {"torque", 3},
                                       {"touch", 1},
                                       {"range", 1},
                                       {"joint_position", 1},
                                       {"joint_speed", 1},
                                       {"drive_force", 1},
                                       {"time", 1}}};
const Kind& kindOf(SensorType type) { return kKinds.at(static_cast<std::size_t>(type)); }

/// Does it read more than states of bodies?
bool readsTables(const SensorDef& sensor) {
  return sensor.type == SensorType::Touch || sensor.type == SensorType::JointPosition ||
         sensor.type == SensorType::JointSpeed || sensor.type == SensorType::DriveForce ||
         sensor.type == SensorType::Force || sensor.type == SensorType::Torque;
}

bool readsJoint(SensorType type) {
  return type == SensorType::JointPosition || type == SensorType::JointSpeed ||
         type == SensorType::DriveForce || type == SensorType::Force || type == SensorType::Torque;
}

/// Does the ray from `p` along `d` meet a ball of this radius about the origin, with both as the unit of
/// length is there?
bool meetsBall(const Vec3& p, const Vec3& d, double radius) {
  const double along = std::max(-dot(p, d) / lengthSquared(d), 0.);
  return lengthSquared(p + along * d) <= radius * radius;
}

bool meetsBox(const Vec3& p, const Vec3& d, const Vec3& half) {
  double from = 0, to = kHard;
  for (int k = 0; k < 3; ++k) {
    if (d[k] == 0 && std::fabs(p[k]) > half[k]) return false;
    if (d[k] == 0) continue;
    const double a = (-half[k] - p[k]) / d[k], b = (half[k] - p[k]) / d[k];
    from = std::max(from, std::min(a, b)), to = std::min(to, std::max(a, b));
  }
  return from <= to;
}

/// A round bar along z.
bool meetsCylinder(const Vec3& p, const Vec3& d, double radius, double half) {
  const double a = d.x * d.x + d.y * d.y, b = p.x * d.x + p.y * d.y,
               c = p.x * p.x + p.y * p.y - radius * radius;
  double from = 0, to = kHard;
  if (a > 0) {
    const double root = b * b - a * c;
    if (root < 0) return false;
    from = std::max(from, (-b - std::sqrt(root)) / a), to = (-b + std::sqrt(root)) / a;
  } else if (c > 0) {
    return false;
  }
  if (d.z != 0) {
    const double low = (-half - p.z) / d.z, high = (half - p.z) / d.z;
    from = std::max(from, std::min(low, high)), to = std::min(to, std::max(low, high));
  } else if (std::fabs(p.z) > half) {
    return false;
  }
  return from <= to;
}

bool meets(const Shape& volume, const Vec3& p, const Vec3& d) {
  const Vec3 end{0, 0, volume.halfLength};
  switch (volume.type) {
    case ShapeType::Sphere:
      return meetsBall(p, d, volume.radius);
    case ShapeType::Box:
      return meetsBox(p, d, volume.halfExtents);
    case ShapeType::Capsule:
      return meetsCylinder(p, d, volume.radius, volume.halfLength) || meetsBall(p - end, d, volume.radius) ||
             meetsBall(p + end, d, volume.radius);
    default:
      return meetsCylinder(p, d, volume.radius, volume.halfLength);
  }
}

/// A frame on a body, or in the world.
struct Mount {
  BodyId body;
  Vec3 position;
  Quat orientation;
  Vec3 center;  ///< center of mass in the frame of the body [m]
};
struct FrameMotion {
  Vec3 position;
  Quat orientation;
  Vec3 velocity, angularVelocity;
};

FrameMotion motionOf(const World& world, const Mount& mount) {
  if (mount.body == BodyId{}) return {mount.position, mount.orientation, {}, {}};
  const BodyState state = world.state(mount.body);
  const Vec3 at = rotate(state.orientation, mount.position);
  const Vec3 fromCenter = at - rotate(state.orientation, mount.center);
  return {state.position + at, normalize(state.orientation * mount.orientation),
          state.velocity + cross(state.angularVelocity, fromCenter), state.angularVelocity};
}

}  // namespace

const char* keyword(SensorType type) { return kindOf(type).keyword; }
int readingSize(SensorType type) { return kindOf(type).size; }

SensorType sensorType(const std::string& keyword) {
  const auto found = std::ranges::find_if(kKinds, [&](const Kind& kind) { return keyword == kind.keyword; });
  if (found == kKinds.end()) {
    std::string known;
    for (const Kind& kind : kKinds) known += (known.empty() ? "" : ", ") + std::string(kind.keyword);
    throw Error("sensor.type", "one of " + known, "\"" + keyword + "\"");
  }
  return static_cast<SensorType>(found - kKinds.begin());
}

struct Sensors::Impl {
  struct Own {
    Mount at, reference;
    JointId joint;
    Vec3 lastVelocity;  ///< of the frame, in the update before
  };
  /// The sensors in one world.
  struct Site {
    std::vector<Own> own;
    double lastTime = 0;
  };
  std::vector<SensorDef> definitions;
  std::vector<std::size_t> begin{0};  ///< [sensors + 1] first number of each, of those of a world
  bool ofBatch = false;
  int first = 0;  ///< world of a batch
  std::vector<Site> sites;
  std::vector<double> values;

  explicit Impl(std::vector<SensorDef> sensors) : definitions(std::move(sensors)) {
    for (const SensorDef& sensor : definitions)
      begin.push_back(begin.back() + static_cast<std::size_t>(readingSize(sensor.type)));
  }
  void add(const World& world);
  /// Of a sensor in a site.
  double* valuesAt(std::size_t site, std::size_t sensor) {
    return values.data() + site * begin.back() + begin[sensor];
  }
  /// Reads everything but ranges, and appends the rays of these.
  void measure(const World& world, std::size_t site, std::vector<RayQuery>& rays);
  void measure(const World& world, const SensorDef& sensor, Own& state, double dt,
               std::optional<std::vector<ContactPoint>>& contacts, double* out) const;
  /// Writes the readings of ranges, in the order of their rays.
  void finish(std::size_t site, std::span<const RayHit> hits);
  Vec3 jointLoad(const World& world, const Own& state, const FrameMotion& at, bool turns) const;
};

void Sensors::Impl::add(const World& world) {
  const std::vector<BodyId> bodies = world.bodies();
  const std::vector<JointId> joints = world.joints();
  Site site{{}, world.time()};
  for (std::size_t i = 0; i < definitions.size(); ++i) {
    const SensorDef& sensor = definitions[i];
    const std::string path = "sensors[" + std::to_string(i) + "].";
    const auto bodyAt = [&](int index, const char* key) {
      if (index < kWorld || index >= static_cast<int>(bodies.size()))
        throw Error(path + key, "one of " + std::to_string(bodies.size()) + " bodies, or -1",
                    std::to_string(index));
      return index < 0 ? BodyId{} : bodies[static_cast<std::size_t>(index)];
    };
    const auto mountOf = [&](BodyId body, const Vec3& position, const Quat& orientation) {
      Mount out{body, position, orientation, {}};
      if (body != BodyId{} && world.definition(body).motion == Motion::Dynamic)
        out.center = massProperties(world.definition(body).shape, 1).center;
      return out;
    };
    Own own{
        mountOf(bodyAt(sensor.body, "body"), sensor.position, sensor.orientation),
        mountOf(bodyAt(sensor.reference, "reference"), sensor.referencePosition, sensor.referenceOrientation),
        {},
        {}};
    if (readsJoint(sensor.type)) {
      if (sensor.joint < 0 || sensor.joint >= static_cast<int>(joints.size()))
        throw Error(path + "joint", "one of " + std::to_string(joints.size()) + " joints",
                    std::to_string(sensor.joint));
      own.joint = joints[static_cast<std::size_t>(sensor.joint)];
      const auto axes = static_cast<int>(world.state(own.joint).axes.size());
      const bool readsAxis = sensor.type != SensorType::Force && sensor.type != SensorType::Torque;
      if (readsAxis && (sensor.axis < 0 || sensor.axis >= axes))
        throw Error(path + "axis", "one of " + std::to_string(axes) + " axes", std::to_string(sensor.axis));
    }
    own.lastVelocity = motionOf(world, own.at).velocity;
    site.own.push_back(std::move(own));
  }
  sites.push_back(std::move(site));
  values.resize(sites.size() * begin.back());
}

Sensors::Sensors(std::vector<SensorDef> sensors, const World& world)
    : impl_(std::make_unique<Impl>(std::move(sensors))) {
  impl_->add(world);
}

Sensors::Sensors(std::vector<SensorDef> sensors, const Worlds& worlds, int first, int count)
    : impl_(std::make_unique<Impl>(std::move(sensors))) {
  count = worldsFrom(first, count, worlds.count());
  impl_->ofBatch = true, impl_->first = first;
  for (int k = 0; k < count; ++k) impl_->add(worlds[first + k]);
}

Sensors::~Sensors() = default;
Sensors::Sensors(Sensors&&) noexcept = default;
Sensors& Sensors::operator=(Sensors&&) noexcept = default;

const std::vector<SensorDef>& Sensors::definitions() const { return impl_->definitions; }
int Sensors::worlds() const { return static_cast<int>(impl_->sites.size()); }
std::size_t Sensors::width() const { return impl_->begin.back(); }
std::span<const double> Sensors::values() const { return impl_->values; }
std::span<const double> Sensors::values(std::size_t sensor, int world) const {
  if (world < 0 || world >= worlds())
    throw Error("world", "a number below " + std::to_string(worlds()), std::to_string(world));
  return std::span<const double>(impl_->values)
      .subspan(static_cast<std::size_t>(world) * width() + impl_->begin.at(sensor),
               static_cast<std::size_t>(readingSize(impl_->definitions.at(sensor).type)));
}

void Sensors::update(World& world) {
  if (impl_->ofBatch) throw Error("sensors", "those of a world", "those of a batch");
  std::vector<RayQuery> rays;
  impl_->measure(world, 0, rays);
  impl_->finish(0, world.castRays(rays));
}

void Sensors::update(Worlds& worlds, std::span<const char> active) {
  Impl& own = *impl_;
  if (!own.ofBatch) throw Error("sensors", "those of a batch", "those of a world");
  const int all = worlds.count();
  if (own.first + this->worlds() > all)
    throw Error("worlds", "those that the sensors were made for", std::to_string(all) + " worlds");
  if (!active.empty() && static_cast<int>(active.size()) != all)
    throw Error("active", "one element per world, " + std::to_string(all), std::to_string(active.size()));
  Worlds::Impl& batches = *worlds.impl_;
  std::vector<std::vector<int>> chosen(batches.batches.size());
  for (int w = own.first; w < own.first + this->worlds(); ++w)
    if (active.empty() || active[static_cast<std::size_t>(w)] != 0)
      chosen[static_cast<std::size_t>(w / batches.perBatch)].push_back(w);
  const bool tables = std::ranges::any_of(own.definitions, readsTables);
  std::vector<std::vector<RayQuery>> rays(own.sites.size());
  batches.forEachBatch([&](std::size_t batch) {
    if (chosen[batch].empty()) return;
    batches.flush(batch);
    // from a device once for all worlds
    if (tables) batches.batches[batch]->engine().read(Fetch::All, -1);
    for (const int w : chosen[batch]) {
      const auto site = static_cast<std::size_t>(w - own.first);
      own.measure(batches.worlds[static_cast<std::size_t>(w)], site, rays[site]);
    }
  });
  std::vector<Worlds::WorldRay> asked;
  for (std::size_t site = 0; site < rays.size(); ++site)
    for (const RayQuery& ray : rays[site]) asked.push_back({own.first + static_cast<int>(site), ray});
  if (asked.empty()) return;
  const std::vector<RayHit> hits = worlds.castRays(asked);
  std::span<const RayHit> left = hits;
  for (std::size_t site = 0; site < rays.size(); ++site) {
    own.finish(site, left.first(rays[site].size()));
    left = left.subspan(rays[site].size());
  }
}

void Sensors::Impl::measure(const World& world, std::size_t site, std::vector<RayQuery>& rays) {
  Site& here = sites[site];
  const double dt = world.time() - here.lastTime;
  std::optional<std::vector<ContactPoint>> contacts;
  for (std::size_t i = 0; i < definitions.size(); ++i) {
    const SensorDef& sensor = definitions[i];
    if (sensor.type == SensorType::Range) {
      const FrameMotion at = motionOf(world, here.own[i].at);
      RayQuery& ray = rays.emplace_back();
      ray.origin = at.position, ray.direction = rotate(at.orientation, Vec3{0, 0, 1});
      ray.filter.ignore = here.own[i].at.body;
      continue;
    }
    double* const out = valuesAt(site, i);
    measure(world, sensor, here.own[i], dt, contacts, out);
    for (int k = 0; sensor.cutoff > 0 && k < readingSize(sensor.type); ++k)
      out[k] = std::clamp(out[k], -sensor.cutoff, sensor.cutoff);
  }
  here.lastTime = world.time();
}

void Sensors::Impl::finish(std::size_t site, std::span<const RayHit> hits) {
  for (std::size_t i = 0, next = 0; next < hits.size(); ++i) {
    const SensorDef& sensor = definitions[i];
    if (sensor.type != SensorType::Range) continue;
    const RayHit& hit = hits[next++];
    const double distance = hit.hit ? hit.distance : -1;
    *valuesAt(site, i) = sensor.cutoff > 0 ? std::clamp(distance, -sensor.cutoff, sensor.cutoff) : distance;
  }
}

Vec3 Sensors::Impl::jointLoad(const World& world, const Own& state, const FrameMotion& at, bool turns) const {
  const JointState joint = world.state(state.joint);
  const std::array<BodyId, 2> bodies = world.bodiesOf(state.joint);
  const JointDef& definition = world.definition(state.joint);
  const Vec3 anchor = motionOf(world, {bodies[1], definition.anchorB, {}, {}}).position;
  // the joint's force is on B
  const double sign = bodies[1] == state.at.body ? 1 : -1;
  const Vec3 load = turns ? joint.torque + cross(anchor - at.position, joint.force) : joint.force;
  return sign * rotateInverse(at.orientation, load);
}

void Sensors::Impl::measure(const World& world, const SensorDef& sensor, Own& state, double dt,
                            std::optional<std::vector<ContactPoint>>& contacts, double* out) const {
  const auto put = [&](const Vec3& v) { out[0] = v.x, out[1] = v.y, out[2] = v.z; };
  const auto axis = [&] { return world.state(state.joint).axes[static_cast<std::size_t>(sensor.axis)]; };
  const FrameMotion at = motionOf(world, state.at);
  const FrameMotion ref = motionOf(world, state.reference);
  const auto inReference = [&](const Vec3& v) { return rotateInverse(ref.orientation, v); };
  const Vec3 acceleration = dt > 0 ? (at.velocity - state.lastVelocity) / dt - world.gravity() : Vec3{};
  switch (sensor.type) {
    case SensorType::Acceleration:
      put(rotateInverse(at.orientation, acceleration));
      break;
    case SensorType::LinearAcceleration:
      put(acceleration);
      break;
    case SensorType::AngularRate:
      put(rotateInverse(at.orientation, at.angularVelocity));
      break;
    case SensorType::Velocity:
      put(rotateInverse(at.orientation, at.velocity));
      break;
    case SensorType::Position:
      put(inReference(at.position - ref.position));
      break;
    case SensorType::Orientation: {
      const Quat q = normalize(conjugate(ref.orientation) * at.orientation);
      out[0] = q.s, out[1] = q.v.x, out[2] = q.v.y, out[3] = q.v.z;
      break;
    }
    case SensorType::XAxis:
    case SensorType::YAxis:
    case SensorType::ZAxis: {
      Vec3 unit;
      unit[static_cast<int>(sensor.type) - static_cast<int>(SensorType::XAxis)] = 1;
      put(inReference(rotate(at.orientation, unit)));
      break;
    }
    case SensorType::LinearVelocity:
      put(inReference(at.velocity - ref.velocity - cross(ref.angularVelocity, at.position - ref.position)));
      break;
    case SensorType::AngularVelocity:
      put(inReference(at.angularVelocity - ref.angularVelocity));
      break;
    case SensorType::Force:
    case SensorType::Torque:
      put(jointLoad(world, state, at, sensor.type == SensorType::Torque));
      break;
    case SensorType::Touch: {
      double sum = 0;
      if (!contacts) contacts = world.contacts();
      if (state.at.body != BodyId{})
        for (const ContactPoint& point : *contacts) {
          if (point.a != state.at.body && point.b != state.at.body) continue;
          // the normal points from A to B, the ray out of this body
          const Vec3 outward = (point.b == state.at.body ? -1. : 1.) * point.normal;
          if (meets(sensor.volume, rotateInverse(at.orientation, point.position - at.position),
                    rotateInverse(at.orientation, outward)))
            sum += std::fabs(dot(point.force, point.normal));
        }
      out[0] = sum;
      break;
    }
    case SensorType::Range:  // by finish()
      break;
    case SensorType::JointPosition:
      out[0] = sensor.scale * axis().position + sensor.offset;
      break;
    case SensorType::JointSpeed:
      out[0] = sensor.scale * axis().speed + sensor.offset;
      break;
    case SensorType::DriveForce: {
      const double
          motor = world.definition(state.joint).axes[static_cast<std::size_t>(sensor.axis)].motorForce;
      out[0] = sensor.scale * (axis().driveForce + motor) + sensor.offset;
      break;
    }
    case SensorType::Time:
      out[0] = world.time();
      break;
  }
  state.lastVelocity = at.velocity;
}

}  // namespace rubble
