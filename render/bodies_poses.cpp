/// Where bodies are: their poses on the way to the GPU, and the bounds that follow from them.
#include <algorithm>
#include <cmath>

#include <rubble/error.h>

#include "platform/threads.h"
#include "render/bodies.h"

namespace rubble::render {
namespace {

/// Bodies that the bounds are taken from.
constexpr std::size_t kCoreSample = 4096;

bool finite(const Pose& p) { return std::isfinite(p.x + p.y + p.z + p.qx + p.qy + p.qz + p.qs); }

/// Values within [low, high] without the outermost half percent at either end where those lie far out.
void coreOf(std::vector<float>& values, float& low, float& high) {
  const auto at = [&](std::size_t rank) { return values.begin() + static_cast<std::ptrdiff_t>(rank); };
  const auto ends = std::minmax_element(values.begin(), values.end());
  const float lowest = *ends.first, highest = *ends.second;
  // Picked and not sorted: this is done in every frame.
  const std::size_t cut = values.size() / 200, fromTop = values.size() - 1 - cut;
  std::nth_element(values.begin(), at(cut), values.end());
  low = values[cut];
  std::nth_element(at(cut), at(fromTop), values.end());
  high = values[fromTop];
  constexpr float kFar = 2.5f;
  if (highest - lowest <= kFar * (high - low)) low = lowest, high = highest;
}

}  // namespace

void Bodies::setPoses(std::span<const Pose> poses) {
  if (poses.size() != slotOfBody_.size())
    throw Error("poses", std::to_string(slotOfBody_.size()) + " of them, one a body",
                std::to_string(poses.size()));
  const std::size_t slots = bodyInSlot_.size() + surfaceLooks_.size();
  if (slots == 0) return;
  for (const std::uint32_t slot : planes_) poses_[slot] = poses[static_cast<std::size_t>(bodyInSlot_[slot])];
  forEachRange(chunks_.size(), 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c) {
      Chunk& chunk = chunks_[c];
      chunk.bounds = {};
      const std::size_t end = chunk.firstSlot + chunkBodies(chunk.geometry);
      for (std::size_t slot = chunk.firstSlot; slot < end; ++slot) {
        if (bodyInSlot_[slot] < 0) continue;
        const Pose& pose = poses[static_cast<std::size_t>(bodyInSlot_[slot])];
        if (!finite(pose)) {
          poses_[slot] = kNoPose;
          continue;
        }
        poses_[slot] = pose;
        const Vec3f center{pose.x, pose.y, pose.z}, room{radii_[slot], radii_[slot], radii_[slot]};
        chunk.bounds.add(center - room);
        chunk.bounds.add(center + room);
      }
    }
  });
  auto* out = static_cast<Pose*>(poseTable_.buffer().map(slots * sizeof(Pose)));
  std::copy(poses_.begin(), poses_.end(), out);
  std::fill(out + poses_.size(), out + slots, Pose{});
  poseTable_.buffer().unmap();
  updateCore();
}

void Bodies::setSources(std::span<const PoseSource> sources, PoseFeed& feed) {
  std::vector<PoseSource> bySlot(bodyInSlot_.size() + surfaceLooks_.size());
  for (std::size_t slot = 0; slot < bodyInSlot_.size(); ++slot) {
    if (bodyInSlot_[slot] < 0) continue;
    bySlot[slot] = sources[static_cast<std::size_t>(bodyInSlot_[slot])];
    bySlot[slot].radius = radii_[slot];
  }
  std::vector<SlotRange> ranges;
  for (const Chunk& chunk : chunks_)
    ranges.push_back({chunk.firstSlot, static_cast<std::uint32_t>(chunkBodies(chunk.geometry))});
  for (const std::uint32_t slot : planes_) ranges.push_back({slot, 1});
  feed.setSlots(bySlot, ranges);
  fedBounds_.resize(ranges.size());
}

void Bodies::setPoses(PoseFeed& feed, const PoseArrays& arrays) {
  gl::Buffer& buffer = poseTable_.buffer();
  buffer.reserve((bodyInSlot_.size() + surfaceLooks_.size()) * sizeof(Pose));
  feed.fill(buffer.id(), buffer.storage(), arrays, fedBounds_);
  for (std::size_t i = 0; i < chunks_.size(); ++i) chunks_[i].bounds = fedBounds_[i];
  // Of chunks, which are as near to the truth as their bodies are to one another.
  std::vector<float> lows[3], highs[3];
  for (const Chunk& chunk : chunks_) {
    if (chunk.bounds.empty()) continue;
    for (int axis = 0; axis < 3; ++axis) {
      lows[axis].push_back(chunk.bounds.low[axis]);
      highs[axis].push_back(chunk.bounds.high[axis]);
    }
  }
  setCore(lows, highs);
}

void Bodies::updateCore() {
  std::vector<float> lows[3], highs[3];
  const std::size_t stride = std::max<std::size_t>(1, bodyInSlot_.size() / kCoreSample);
  for (std::size_t slot = 0; slot<bodyInSlot_.size(); slot += radii_[slot]> 0 ? stride : 1) {
    if (radii_[slot] == 0 || poses_[slot].x == kNoPose.x) continue;
    const float center[3] = {poses_[slot].x, poses_[slot].y, poses_[slot].z};
    for (int axis = 0; axis < 3; ++axis) {
      lows[axis].push_back(center[axis] - radii_[slot]);
      highs[axis].push_back(center[axis] + radii_[slot]);
    }
  }
  setCore(lows, highs);
}

void Bodies::setCore(std::vector<float> (&lows)[3], std::vector<float> (&highs)[3]) {
  core_ = {};
  if (lows[0].empty()) return;
  forEachTask(6, [&](std::size_t i) {
    const int axis = static_cast<int>(i) / 2;
    float unused = 0;
    if (i % 2 == 0)
      coreOf(lows[axis], core_.low[axis], unused);
    else
      coreOf(highs[axis], unused, core_.high[axis]);
  });
}

float Bodies::nearestTo(const Vec3f& point, const std::vector<HalfSpace>& visible) const {
  float nearest = 1e30f;
  for (const Chunk& chunk : chunks_)
    if (!chunk.bounds.empty() && touches(chunk.bounds, visible))
      nearest = std::min(nearest, distanceTo(chunk.bounds, point));
  for (const std::uint32_t slot : planes_) {
    const Pose& p = poses_[slot];
    const Vec3f normal = rotate(QuatT<float>{p.qs, p.qx, p.qy, p.qz}, Vec3f{0, 0, 1});
    nearest = std::min(nearest, std::fabs(dot(point - Vec3f{p.x, p.y, p.z}, normal)));
  }
  return nearest;
}

}  // namespace rubble::render
