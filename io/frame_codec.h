#pragma once
/// Frames of a trajectory to bytes and back: positions in steps of a resolution and quaternions in 62 bits, each less the one before,
/// low bytes apart from high ones, so that what rests costs next to nothing once compressed.
#include <cstdint>
#include <optional>
#include <vector>

#include "io/recording.h"

namespace rubble::io {

/// A unit quaternion in 62 bits: which component is the largest, and the three others in 20 bits each.
std::uint64_t packQuaternion(const Quat& q);
Quat unpackQuaternion(std::uint64_t bits);

/// Collects frames of one set of bodies into the content of a chunk.
class FrameEncoder {
 public:
  explicit FrameEncoder(double resolution) : resolution_(resolution) {}

  int frameCount() const { return static_cast<int>(steps_.size()); }
  std::size_t bodyCount() const { return origins_.size(); }
  /// False, and nothing is taken, if a position lies too far from where the chunk begins: it needs a new chunk.
  bool add(const RecordedFrame& frame);
  /// The content of the chunk; the encoder is empty again.
  std::vector<std::uint8_t> finish();

 private:
  double resolution_;
  std::vector<std::int64_t> steps_;
  std::vector<double> times_;
  std::vector<Vec3> origins_;            ///< positions of the first frame, exact
  std::vector<std::uint32_t> previous_;  ///< words of the frame before
  std::vector<std::uint8_t> planes_;     ///< differences, byte by byte
};

/// Frames of a chunk; nothing if the bytes are not what an encoder makes for that many bodies.
std::optional<std::vector<RecordedFrame>> decodeFrames(const std::vector<std::uint8_t>& content, std::size_t bodyCount, double resolution);

}  // namespace rubble::io
