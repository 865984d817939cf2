#include "character.h"
#include "math/portable.h"

#include <algorithm>
#include <cmath>

namespace rubble::scenes {

/// One call of move().
struct Character::Moving {
  World& world;
  const BodyId body;
  const CharacterSettings& settings;
  const Vec3 up;
  const double dt;

  CastHit cast(const Vec3& from, const Vec3& move) const {
    CastQuery query{world.definition(body).shape, from, world.state(body).orientation, move, {}};
    query.filter.ignore = body;
    return world.castShapes({&query, 1}).front();
  }
  bool walkable(const Vec3& normal) const { return dot(normal, up) >= portable::cos(settings.maxSlope); }
  /// Is it something to stand on? At the edge of a step the surface beside the edge counts.
  bool carries(const CastHit& hit) const {
    if (!hit.hit || walkable(hit.normal)) return hit.hit;
    const Vec3 inward = normalize(level(hit.normal), Vec3{}) * -settings.skin;
    RayQuery ray{hit.position + inward + up * (3 * settings.skin), -up, 6 * settings.skin, {}};
    ray.filter.ignore = body;
    const RayHit surface = world.castRay(ray);
    return surface.hit && walkable(surface.normal);
  }
  Vec3 level(const Vec3& v) const { return v - up * dot(v, up); }

  /// What lies below, no further than `reach` [m] from the skin.
  CastHit below(const Vec3& from, double reach) const { return cast(from, up * -(reach + settings.skin)); }
  Vec3 downTo(const CastHit& hit, const Vec3& from, double reach) const {
    return from - up * std::max(0., hit.fraction * (reach + settings.skin) - settings.skin);
  }

  void push(const CastHit& hit, const Vec3& way) const {
    if (world.definition(hit.body).motion != Motion::Dynamic) return;
    world.applyForceAt(hit.body, normalize(way) * settings.pushForce, hit.position);
  }

  /// Moves as far as nothing is in the way, and along what is.
  Vec3 slide(Vec3 at, Vec3 way, bool pushes) const {
    const Vec3 wanted = way;
    for (int turn = 0; turn < 4 && dot(way, wanted) > 0; ++turn) {
      const double wayLength = length(way);
      const CastHit hit = cast(at, way * (1 + settings.skin / wayLength));
      if (!hit.hit) return at + way;
      const double free = std::clamp(hit.fraction * (wayLength + settings.skin) - settings.skin, 0.,
                                     wayLength);
      at += way * (free / wayLength);
      if (pushes) push(hit, way);
      Vec3 normal = hit.normal;
      // a slope that is too steep is a wall
      if (!walkable(normal) && dot(normal, up) > 0) normal = normalize(level(normal), normal);
      way = way * (1 - free / wayLength);
      way -= normal * std::min(0., dot(way, normal));
    }
    return at;
  }

  /// Along the ground, over a step if one is in the way.
  Vec3 walk(const Vec3& at, const Vec3& way) const {
    const Vec3 direct = slide(at, way, true);
    const double progress = dot(direct - at, way);
    if (progress > .99 * lengthSquared(way)) return direct;
    const Vec3 above = slide(at, up * settings.stepHeight, false), over = slide(above, way, false);
    const CastHit step = below(over, settings.stepHeight);
    const bool climbs = carries(step) && dot(over - above, way) > progress;
    return climbs ? downTo(step, over, settings.stepHeight) : direct;
  }
};

bool Character::stands(World& world) const {
  const Moving moving{world, body_, settings_, normalize(-world.gravity(), {0, 0, 1}), world.params().dt};
  const CastHit ground = moving.below(world.state(body_).position, settings_.skin);
  return moving.carries(ground);
}

void Character::move(World& world, const Vec3& walk, double jumpSpeed) const {
  const Vec3 up = normalize(-world.gravity(), {0, 0, 1});
  const double dt = world.params().dt;
  const Moving moving{world, body_, settings_, up, dt};
  const BodyState now = world.state(body_);
  const CastHit ground = moving.below(now.position, settings_.skin);
  const double rising = dot(now.velocity, up);
  // on its way up from a jump it has left the ground, which is still near
  const bool stood = moving.carries(ground) && rising * dt < settings_.stepHeight / 4;
  const double rise = stood ? jumpSpeed : rising - length(world.gravity()) * dt;
  Vec3 way = moving.level(walk) * dt, at = now.position;
  if (stood) {
    // what it stands on carries it
    const BodyState floor = world.state(ground.body);
    way += (floor.velocity + cross(floor.angularVelocity, ground.position - floor.position)) * dt;
  }
  if (lengthSquared(way) > 0) at = stood ? moving.walk(at, way) : moving.slide(at, way, true);
  if (stood && jumpSpeed <= 0) {
    // downhill and down steps it stays on the ground
    const CastHit floor = moving.below(at, settings_.stepHeight);
    if (moving.carries(floor)) at = moving.downTo(floor, at, settings_.stepHeight);
  } else if (rise != 0) {
    at = moving.slide(at, up * (rise * dt), false);
  }
  world.setTarget(body_, at, now.orientation);
}

}  // namespace rubble::scenes
