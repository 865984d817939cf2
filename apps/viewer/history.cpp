#include "apps/viewer/history.h"

#include <algorithm>

namespace rubble::viewer {
namespace {

/// What the snapshots of a branch may take [bytes], and how many are useful.
constexpr std::size_t kMostBytes = std::size_t{512} << 20;
constexpr std::size_t kMinCheckpoints = 4, kMaxCheckpoints = 160;
constexpr std::int64_t kFirstSpacing = 5;  // steps

}  // namespace

void History::begin(std::vector<Checkpoint> start, std::size_t bytes) {
  maxCheckpoints_ = std::clamp(kMostBytes / std::max<std::size_t>(1, bytes), kMinCheckpoints,
                               kMaxCheckpoints);
  spacing_ = kFirstSpacing;
  current_ = 0;
  done_ = 0;
  branches_.assign(1, {"main", -1, 0, 0, {}, {}});
  own().checkpoints[0] = std::move(start);
}

void History::choose(int branch) {
  current_ = branch;
  done_ = 0;
}

const Input* History::due(std::int64_t step) {
  const std::vector<Input>& inputs = own().inputs;
  if (done_ >= inputs.size() || inputs[done_].step > step) return nullptr;
  return &inputs[done_++];
}

void History::fork(std::int64_t step) {
  Branch branch = own();
  branch.name = "branch " + std::to_string(branches_.size());
  branch.parent = current_;
  branch.begins = branch.last = step;
  branch.inputs.resize(done_);
  branch.checkpoints.erase(branch.checkpoints.upper_bound(step), branch.checkpoints.end());
  branches_.push_back(std::move(branch));
  current_ = static_cast<int>(branches_.size()) - 1;
}

void History::add(Input input, bool replaces) {
  if (input.step < own().last || done_ < own().inputs.size()) fork(input.step);
  std::vector<Input>& inputs = own().inputs;
  if (replaces && !inputs.empty() && inputs.back().step == input.step && inputs.back().what == input.what)
    inputs.pop_back();
  inputs.push_back(std::move(input));
  done_ = inputs.size();
}

bool History::wantsCheckpoint(std::int64_t step) const {
  return step % spacing_ == 0 && !branch().checkpoints.contains(step);
}

void History::keep(std::int64_t step, std::vector<Checkpoint> worlds) {
  auto& checkpoints = own().checkpoints;
  checkpoints[step] = std::move(worlds);
  while (checkpoints.size() > maxCheckpoints_) {
    spacing_ *= 2;
    std::erase_if(checkpoints, [&](const auto& checkpoint) { return checkpoint.first % spacing_ != 0; });
  }
}

const std::pair<const std::int64_t, std::vector<Checkpoint>>& History::before(std::int64_t step) const {
  return *std::prev(branch().checkpoints.upper_bound(step));
}

void History::rewound(std::int64_t step) {
  const std::vector<Input>& inputs = own().inputs;
  done_ = 0;
  while (done_ < inputs.size() && inputs[done_].step < step) ++done_;
}

}  // namespace rubble::viewer
