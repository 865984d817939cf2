#pragma once
/// Codec of trajectory frames. Positions of bodies and vertices are stored in steps of a resolution,
/// quaternions in 62 bits. Each number is the difference from the previous frame, and low bytes are stored
/// apart from high ones, so that bodies at rest compress to almost nothing.
#include <cstdint>
#include <memory>
#include <vector>

#include "io/recording.h"

namespace rubble::io {

/// A unit quaternion in 62 bits: which component is the largest, and the three others in 20 bits each.
std::uint64_t packQuaternion(const Quat& q);
Quat unpackQuaternion(std::uint64_t bits);

/// Collects frames of one set of bodies and vertices, and makes the content of a chunk of them.
class FrameEncoder {
 public:
  explicit FrameEncoder(double resolution) : resolution_(resolution) {}

  int frameCount() const { return static_cast<int>(frames_.size()); }
  /// False, and nothing is taken, if a position lies too far from where the chunk begins: it needs a new
  /// chunk.
  bool add(const RecordedFrame& frame);
  /// Takes back the last add().
  void takeBack() { frames_.pop_back(); }
  /// Size of the content of the chunk [bytes].
  std::size_t contentSize() const;
  /// The content, made on the threads of the caller. Only its bytes from `begin` to `end` - 1 are needed: the
  /// others are as they should be, or zero.
  std::vector<std::uint8_t> content(std::size_t begin, std::size_t end) const;
  std::vector<std::uint8_t> content() const { return content(0, contentSize()); }
  /// The encoder is empty again.
  void clear() { frames_.clear(); }

 private:
  std::size_t bodies() const { return frames_.empty() ? 0 : frames_.front().poses.size(); }
  std::size_t places() const { return frames_.empty() ? 0 : bodies() + frames_.front().vertices.size(); }
  /// Size of what comes before the frames, and of a frame [bytes].
  std::size_t headSize() const;
  std::size_t frameSize() const;
  /// Writes the words of places `begin` to `end` - 1 of some frames. `bytes`: where the first frame lies.
  void encode(std::size_t firstFrame, std::size_t endFrame, std::size_t begin, std::size_t end,
              std::uint8_t* bytes) const;

  double resolution_;
  std::vector<RecordedFrame> frames_;
};

/// Reads the frames of a chunk, each of them when it is asked for first. Memory is used again for the next
/// chunk.
class FrameDecoder {
 public:
  /// Takes the content of a chunk of a file of that version. False if it is not what an encoder makes for
  /// that many bodies and vertices; frames are not there then.
  bool start(std::vector<std::uint8_t> content, std::size_t bodyCount, std::size_t vertexCount,
             double resolution, std::uint32_t version);
  std::size_t frameCount() const { return frames_.size(); }
  /// One of frameCount() frames. It does not change while it is held.
  const std::shared_ptr<RecordedFrame>& frame(std::size_t index);
  /// The memory of the content, which is not needed any more.
  std::vector<std::uint8_t> takeContent() { return std::move(content_); }

 private:
  void decode(RecordedFrame& frame);

  std::vector<std::uint8_t> content_;
  std::size_t planes_ = 0;  ///< where the differences begin in it
  double resolution_ = 1;
  std::vector<std::shared_ptr<RecordedFrame>> frames_;
  std::size_t decoded_ = 0;           ///< of these
  std::vector<Vec3> origins_;         ///< of bodies, then of vertices
  std::vector<std::uint32_t> words_;  ///< of the frame that was decoded last
};

}  // namespace rubble::io
