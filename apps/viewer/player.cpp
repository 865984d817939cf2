#include "apps/viewer/player.h"

#include <algorithm>
#include <cmath>

namespace rubble::viewer {
namespace {

constexpr std::size_t kRecordsKept = 240;  // steps

std::vector<Checkpoint> snapshotsOf(const std::vector<std::unique_ptr<scenes::Runner>>& runners) {
  std::vector<Checkpoint> out;
  for (const auto& runner : runners) {
    const std::span<const double> activations = runner->actuators().activations();
    out.push_back({runner->world().snapshot(), {activations.begin(), activations.end()}});
  }
  return out;
}

}  // namespace

Player::Player(const SceneOpener& opener, const Request& request, int sides) : request_(request) {
  std::size_t bytes = 0;
  for (int side = 0; side < sides; ++side) {
    OpenedScene opened = opener(request, side);
    opened.job.probes
        .clear();  // probes visit every body in every step, for a verdict that the viewer does not show
    runners_.push_back(std::make_unique<scenes::Runner>(std::move(opened.job), opened.world));
    labels_.push_back(opened.label);
    bytes += runners_.back()->world().memoryBytes();
    if (side > 0) continue;
    title_ = opened.title;
    backend_ = opened.world.backend;
    arguments_ = std::move(opened.arguments);
  }
  reports_.resize(runners_.size());
  history_.begin(snapshotsOf(runners_), bytes);
}

void Player::measure() {
  const StepReport& report = reports_.front();
  StepRecord records;
  records.step = now(), records.totalMs = report.totalMs, records.stages = report.stages;
  if (measureEnergy) {
    const Quality quality = world().quality();
    records.kinetic = quality.kineticEnergy, records.potential = quality.potentialEnergy;
    records.error = std::max(quality.penetration.max, quality.jointGapMax);
  }
  if (records_.size() >= kRecordsKept) records_.erase(records_.begin());
  records_.push_back(std::move(records));
}

bool Player::step() {
  applyDue();
  for (std::size_t side = 0; side < runners_.size(); ++side) reports_[side] = runners_[side]->step();
  history_.reached(now());
  if (history_.wantsCheckpoint(now())) history_.keep(now(), snapshotsOf(runners_));
  measure();
  return true;
}

void Player::restore(std::int64_t step) {
  const auto& [at, worlds] = history_.before(step);
  for (std::size_t side = 0; side < runners_.size(); ++side) {
    runners_[side]->world().restore(worlds[side].world);
    std::ranges::copy(worlds[side].activations, runners_[side]->actuators().activations().begin());
  }
  history_.rewound(at);
  records_.clear();
}

void Player::seek(std::int64_t step) {
  const std::int64_t wanted = std::clamp<std::int64_t>(step, 0, last());
  if (wanted < now() || history_.before(wanted).first > now()) restore(wanted);
  while (now() < wanted) this->step();
  // Inputs after the last step of a branch.
  if (now() == last()) applyDue();
}

void Player::choose(int branch) {
  if (branch == history_.current() || branch < 0 || branch >= static_cast<int>(history_.branches().size()))
    return;
  history_.choose(branch);
  restore(last());
  seek(last());
}

void Player::applyDue() {
  while (const Input* input = history_.due(now()))
    for (const auto& runner : runners_) input->apply(runner->world());
}

void Player::apply(const std::string& what, std::function<void(World&)> change, bool replaces) {
  for (const auto& runner : runners_) change(runner->world());
  history_.add({now(), what, std::move(change)}, replaces);
}

void Player::changeParams(const std::string& what, std::function<void(Params&)> change) {
  apply(
      what,
      [change](World& world) {
        Params params = world.params();
        change(params);
        world.setParams(params);
      },
      true);
}

std::optional<BodyId> Player::bodyWithKey(std::uint32_t key) const {
  for (const BodyId id : runners_.front()->world().bodies())
    if (static_cast<std::uint32_t>(id.index) == key) return id;
  return std::nullopt;
}

std::vector<IterationError> iterationErrors(World& world) {
  const auto places = [&] {
    std::vector<Vec3> out;
    for (const BodyId id : world.bodies()) out.push_back(world.state(id).position);
    for (const DeformableId id : world.deformables())
      for (const Vec3& p : world.positions(id)) out.push_back(p);
    return out;
  };
  const Snapshot present = world.snapshot();
  const Params params = world.params();
  std::vector<IterationError> errors;
  std::vector<Vec3> before;
  for (int iterations = 1; iterations <= params.iterations; ++iterations) {
    Params fewer = params;
    fewer.iterations = iterations;
    world.setParams(fewer);
    world.step();
    const Quality quality = world.quality();
    IterationError& error = errors.emplace_back();
    error.error = std::max(quality.penetration.max, quality.jointGapMax);
    std::vector<Vec3> now = places();
    for (std::size_t i = 0; i < before.size(); ++i)
      error.change = std::max(error.change, length(now[i] - before[i]));
    before = std::move(now);
    world.restore(present);
  }
  return errors;
}

}  // namespace rubble::viewer
