#include "apps/viewer/player.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubble::viewer {
namespace {

constexpr int kMostStepsAFrame = 4;
constexpr std::size_t kTimesKept = 240;
/// The grip holds a body as a spring of this frequency would [Hz].
constexpr double kGripFrequency = 3;
constexpr double kBallSize = 2, kBallDensity = 4000, kBallSpeed = 25;  // of a body's half size [1], [kg/m3], [m/s]

}  // namespace

void Player::open(const std::string& scene) {
  Opened opened = opener_(scene);
  auto runner = std::make_unique<scenes::Runner>(std::move(opened.job), opened.world);
  runner_ = std::move(runner);
  scene_ = scene;
  title_ = opened.title;
  report_ = {};
  stepTimes_.clear();
  due_ = 0;
  held_.reset();
  gripJoint_.reset();
}

void Player::step() {
  report_ = runner_->step();
  stepTimes_.push_back(static_cast<float>(report_.totalMs));
  if (stepTimes_.size() > kTimesKept) stepTimes_.erase(stepTimes_.begin());
  if (held_ && !world().alive(*held_)) release();
}

void Player::play(double seconds) {
  if (paused) return;
  const double dt = world().params().dt;
  due_ = std::min(due_ + seconds * speed, kMostStepsAFrame * dt);
  for (; due_ >= dt; due_ -= dt) step();
}

std::optional<BodyId> Player::bodyWithKey(std::uint32_t key) const {
  for (const BodyId id : runner_->world().bodies())
    if (static_cast<std::uint32_t>(id.index) == key) return id;
  return std::nullopt;
}

BodyId Player::shoot(const Vec3& from, const Vec3& direction, double bodySize) {
  BodyDef ball;
  ball.name = "shot";
  ball.shape = Shape::sphere(kBallSize * bodySize);
  ball.density = kBallDensity;
  ball.position = from;
  ball.velocity = direction * kBallSpeed;
  return world().add(ball);
}

bool Player::grab(BodyId body, const Vec3& point) {
  release();
  if (world().definition(body).motion != Motion::Dynamic) return false;
  const BodyState state = world().state(body);
  const double rate = 2 * std::numbers::pi * kGripFrequency;
  grip_ = {};
  grip_.anchorA = rotateInverse(state.orientation, point - state.position);
  grip_.stiffness = world().massOf(body).mass * rate * rate;
  held_ = body;
  pull(point);
  return true;
}

void Player::pull(const Vec3& point) {
  if (!held_) return;
  if (gripJoint_ && world().alive(*gripJoint_)) world().remove(*gripJoint_);
  grip_.anchorB = point;
  gripJoint_ = world().addJoint(grip_, *held_, BodyId{});
}

void Player::release() {
  if (gripJoint_ && world().alive(*gripJoint_)) world().remove(*gripJoint_);
  gripJoint_.reset();
  held_.reset();
}

}  // namespace rubble::viewer
