#include "vehicle.h"
#include "math/portable.h"

#include <algorithm>
#include <cmath>

namespace rubble::scenes {

int RaycastVehicle::drive(World& world, const Controls& controls) const {
  const BodyState state = world.state(chassis_);
  const MassProperties mass = world.massOf(chassis_);
  const Vec3 up = rotate(state.orientation, Vec3{0, 0, 1});
  const Vec3 center = state.position + rotate(state.orientation, mass.center);
  std::vector<RayQuery> rays;
  for (const WheelDef& wheel : wheels_) {
    RayQuery& ray = rays.emplace_back();
    ray.origin = state.position + rotate(state.orientation, wheel.mount);
    ray.direction = -up;
    ray.maxDistance = wheel.travel + wheel.radius;
    ray.filter.ignore = chassis_;
  }
  const std::vector<RayHit> hits = world.castRays(rays);
  const auto touching = static_cast<int>(std::ranges::count_if(hits, &RayHit::hit));
  const auto driven = std::max<std::ptrdiff_t>(1, std::ranges::count_if(wheels_, &WheelDef::drives));
  for (std::size_t k = 0; k < wheels_.size(); ++k) {
    const WheelDef& wheel = wheels_[k];
    const RayHit& hit = hits[k];
    const Quat turned = state.orientation *
                        fromAxisAngle(Vec3{0, 0, 1}, wheel.steers ? controls.steering : 0.);
    const double length = hit.hit ? hit.distance - wheel.radius : wheel.travel;
    if (!shown_.empty()) {
      // the axle is the z axis of a cylinder
      const Quat axle = turned * fromAxisAngle(Vec3{1, 0, 0}, portable::acos(0.));
      world.setTarget(shown_[k], rays[k].origin - up * length, axle);
    }
    if (!hit.hit) continue;
    BodyState ground;
    if (world.definition(hit.body).motion != Motion::Static) ground = world.state(hit.body);
    const auto speedAt = [&](const BodyState& of, const Vec3& origin) {
      return of.velocity + cross(of.angularVelocity, hit.position - origin);
    };
    const Vec3 slip = speedAt(state, center) - speedAt(ground, ground.position);
    const double load = std::max(0.,
                                 wheel.stiffness * (wheel.travel - length) - wheel.damping * dot(slip, up));
    const Vec3 side = normalize(cross(hit.normal, rotate(turned, Vec3{1, 0, 0})));
    const Vec3 forward = cross(side, hit.normal);
    // the share of the mass that this wheel can stop in a step
    const double stop = mass.mass / (touching * world.params().dt), rolling = dot(slip, forward);
    const double brake = std::min(controls.brake / static_cast<double>(wheels_.size()),
                                  std::fabs(rolling) * stop);
    const double along = (wheel.drives ? controls.force / static_cast<double>(driven) : 0) -
                         std::copysign(brake, rolling);
    const Vec3 wanted = forward * along - side * (dot(slip, side) * stop / 2);
    const double most = wheel.friction * load, size = rubble::length(wanted);
    const Vec3 force = up * load + (size > most ? wanted * (most / size) : wanted);
    world.applyForceAt(chassis_, force, hit.position);
    if (world.definition(hit.body).motion == Motion::Dynamic)
      world.applyForceAt(hit.body, -force, hit.position);
  }
  return touching;
}

}  // namespace rubble::scenes
