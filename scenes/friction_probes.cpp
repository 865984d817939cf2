#include "friction_probes.h"

#include <algorithm>
#include <cmath>

#include "build.h"
#include "probe_parts.h"

namespace rubble::scenes {
namespace {

class StopProbe final : public Probe {
 public:
  StopProbe(const Scene& scene, std::vector<Slider> sliders)
      : gravity_(length(scene.gravity)), sliders_(std::move(sliders)) {}

  void start(const World& world) override {
    for (const Slider& slider : sliders_) first_.push_back(world.state(world.findBody(slider.body)));
  }

  void finish(const World& world, Metrics& metrics) override {
    const double h = world.params().dt / world.params().substeps;
    double low = 0, high = 0;
    for (std::size_t i = 0; i < sliders_.size(); ++i) {
      const double speed = first_[i].velocity.x;
      const double mu = sliders_[i].friction;
      const double exact = speed * speed / (2 * mu * gravity_) - speed * h / 2;
      const double way = world.state(world.findBody(sliders_[i].body)).position.x - first_[i].position.x;
      double& error = mu <= 1 ? low : high;
      error = std::max(error, std::fabs(way / exact - 1));
    }
    metrics["stop_distance_error"] = low;
    metrics["stop_distance_error_high"] = high;
  }

 private:
  double gravity_;
  std::vector<Slider> sliders_;
  std::vector<BodyState> first_;
};

class RampProbe final : public Probe {
 public:
  RampProbe(std::vector<RampBox> boxes, double hold, double settled)
      : boxes_(std::move(boxes)), hold_(hold), settled_(settled) {}

  void start(const World& world) override { first_ = middle_ = positions(world); }

  void afterStep(const World& world, const StepReport&) override {
    if (settledSeen_ || !reached(world, settled_)) return;
    settledSeen_ = true;
    middle_ = positions(world);
  }

  void finish(const World& world, Metrics& metrics) override {
    const std::vector<Vec3> last = positions(world);
    int wrong = 0;
    double error = 0, creep = 0;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      const bool slid = length(last[i] - first_[i]) > hold_;
      const bool shouldSlide = boxes_[i].ratio < 1;
      if (slid != shouldSlide) {
        ++wrong;
        error = std::max(error, std::fabs(boxes_[i].ratio - 1));
      }
      if (!shouldSlide) creep = std::max(creep, length(last[i] - middle_[i]));
    }
    metrics["slides_wrong"] = wrong;
    metrics["threshold_error"] = error;
    metrics["creep_max_m"] = creep;
  }

 private:
  std::vector<Vec3> positions(const World& world) const {
    std::vector<Vec3> result;
    for (const RampBox& box : boxes_) result.push_back(world.state(world.findBody(box.body)).position);
    return result;
  }

  std::vector<RampBox> boxes_;
  double hold_, settled_;
  bool settledSeen_ = false;
  std::vector<Vec3> first_, middle_;
};

class SpeedProbe final : public BodyProbe {
 public:
  SpeedProbe(const std::string& body, const Vec3& direction, double reference)
      : BodyProbe(body), direction_(direction), reference_(reference) {}
  void finish(const World& world, Metrics& metrics) override {
    metrics["final_speed_ratio"] = dot(state(world).velocity, direction_) / reference_;
  }

 private:
  Vec3 direction_;
  double reference_;
};

class SlipProbe final : public BodyProbe {
 public:
  SlipProbe(const Scene& scene, const std::string& body, double reference)
      : BodyProbe(body), up_(upOf(scene)), reference_(reference) {}
  void finish(const World& world, Metrics& metrics) override {
    const BodyState now = state(world);
    const Vec3 touching = now.velocity -
                          world.definition(id()).shape.radius * cross(now.angularVelocity, up_);
    metrics["final_slip_ratio"] = length(touching - dot(touching, up_) * up_) / reference_;
  }

 private:
  Vec3 up_;
  double reference_;
};

class TravelProbe final : public BodyProbe {
 public:
  TravelProbe(const std::string& body, const Vec3& direction) : BodyProbe(body), direction_(direction) {}
  void finish(const World& world, Metrics& metrics) override {
    metrics["travel_m"] = dot(state(world).position - first().position, direction_);
  }

 private:
  Vec3 direction_;
};

}  // namespace

std::unique_ptr<Probe> stopProbe(const Scene& scene, const std::vector<Slider>& sliders) {
  return std::make_unique<StopProbe>(scene, sliders);
}

std::unique_ptr<Probe> rampProbe(const std::vector<RampBox>& boxes, double hold, double settled) {
  return std::make_unique<RampProbe>(boxes, hold, settled);
}

std::unique_ptr<Probe> speedProbe(const std::string& body, const Vec3& direction, double reference) {
  return std::make_unique<SpeedProbe>(body, direction, reference);
}

std::unique_ptr<Probe> slipProbe(const Scene& scene, const std::string& body, double reference) {
  return std::make_unique<SlipProbe>(scene, body, reference);
}

std::unique_ptr<Probe> travelProbe(const std::string& body, const Vec3& direction) {
  return std::make_unique<TravelProbe>(body, direction);
}

}  // namespace rubble::scenes
