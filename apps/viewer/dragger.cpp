#include "apps/viewer/dragger.h"

#include <cmath>
#include <numbers>

namespace rubble::viewer {
namespace {

/// The grip holds like a critically damped spring of this frequency [Hz], with this many times the weight of
/// what it holds at most.
constexpr double kGripFrequency = 3, kStrength = 50, kGravity = 9.81;
constexpr double kGripBall = .1;  ///< radius over the distance to the next vertex [1]
constexpr double kBallSize = 2, kBallDensity = 4000,
                 kBallSpeed = 25;  // of a body's half size [1], [kg/m3], [m/s]
constexpr double kBoxHeight = 4;   ///< over its half size, above what it falls onto

BodyId add(Player& player, const char* what, BodyDef body) {
  body.name += " " + std::to_string(player.nextNumber());
  const auto made = std::make_shared<BodyId>();
  player.apply(what, [made, body](World& world) { *made = world.addBody(body); });
  return *made;
}

double nearestNeighbor(const std::vector<Vec3>& points, std::size_t of) {
  double nearest = 1e30;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (i != of) nearest = std::min(nearest, length(points[i] - points[of]));
  return nearest;
}

}  // namespace

bool Dragger::take(Player& player, BodyId body, const Vec3& point) {
  release(player);
  if (player.world().definition(body).motion != Motion::Dynamic) return false;
  const double mass = player.world().massOf(body).mass;
  const auto grip = std::make_shared<Grip>();
  player.apply("drag", [grip, body, point, mass](World& world) {
    grip->joint = world.addDragJoint(body, point, kStrength * mass * kGravity, kGripFrequency);
  });
  held_ = Held{grip, body};
  return true;
}

bool Dragger::take(Player& player, DeformableId object, int vertex) {
  release(player);
  const auto v = static_cast<std::size_t>(vertex);
  const std::vector<double> masses = player.world().masses(object);
  if (masses[v] == 0) return false;
  const std::vector<Vec3> points = player.world().positions(object);
  double mass = 0;
  for (const double m : masses) mass += m;
  BodyDef ball;
  ball.motion = Motion::Kinematic;
  ball.shape = Shape::sphere(std::max(1e-4, kGripBall * nearestNeighbor(points, v)));
  ball.position = points[v];
  ball.filter.layers = ball.filter.mask = 0;
  AttachmentDef attachment;
  attachment.vertices = {vertex};
  attachment.anchor = Vec3{};
  const double rate = 2 * std::numbers::pi * kGripFrequency;
  attachment.stiffness = mass * rate * rate;
  const auto grip = std::make_shared<Grip>();
  player.apply("drag vertex", [grip, object, ball, attachment](World& world) {
    grip->ball = world.addBody(ball);
    world.addAttachment(attachment, object, grip->ball);
  });
  held_ = Held{grip, std::nullopt};
  return true;
}

void Dragger::pull(Player& player, const Vec3& point) {
  if (!held_) return;
  const std::shared_ptr<Grip> grip = held_->grip;
  if (held_->body) {
    if (!player.world().alive(grip->joint)) return forget();
    player.apply(
        "pull", [grip, point](World& world) { world.setDragTarget(grip->joint, point); }, true);
  } else {
    if (!player.world().alive(grip->ball)) return forget();
    player.apply(
        "pull", [grip, point](World& world) { world.setTarget(grip->ball, point, {}); }, true);
  }
}

void Dragger::release(Player& player) {
  if (!held_) return;
  const std::shared_ptr<Grip> grip = held_->grip;
  const bool isJoint = held_->body.has_value();
  if (isJoint ? player.world().alive(grip->joint) : player.world().alive(grip->ball)) {
    player.apply("release", [grip, isJoint](World& world) {
      if (isJoint)
        world.removeJoint(grip->joint);
      else
        world.removeBody(grip->ball);
    });
  }
  held_.reset();
}

BodyId shoot(Player& player, const Vec3& from, const Vec3& direction, double bodySize) {
  BodyDef ball;
  ball.name = "shot";
  ball.shape = Shape::sphere(kBallSize * bodySize);
  ball.density = kBallDensity;
  ball.position = from;
  ball.velocity = direction * kBallSpeed;
  return add(player, "shoot", ball);
}

BodyId dropBox(Player& player, const Vec3& onto, double bodySize) {
  BodyDef box;
  box.name = "dropped";
  box.shape = Shape::box({bodySize, bodySize, bodySize});
  box.position = onto - normalize(player.gravity(), {0, 0, -1}) * (kBoxHeight * bodySize);
  return add(player, "drop", box);
}

}  // namespace rubble::viewer
