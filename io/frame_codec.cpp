#include "io/frame_codec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cook/size.h"
#include "io/byte_stream.h"

namespace rubble::io {
namespace {

/// Words of 32 bits a body: position x, y, z and the two halves of the quaternion. Vertices have the first
/// three. The words of all bodies and vertices come one kind after the other: x, y, z of bodies, then of
/// vertices, then quaternions.
constexpr std::size_t kPlaceWords = 3, kTurnWords = 2;
std::size_t wordCountOf(std::size_t bodies, std::size_t vertices) {
  return kPlaceWords * (bodies + vertices) + kTurnWords * bodies;
}
constexpr int kQuaternionBits = 20;
constexpr std::uint64_t kQuaternionMask = (1u << kQuaternionBits) - 1;
/// Zero lies in the middle of the range.
constexpr double kQuaternionHalf = (1u << (kQuaternionBits - 1)) - 1;
constexpr double kLargestOffset = 2147483000;

std::uint32_t zigzag(std::int32_t value) {
  return (static_cast<std::uint32_t>(value) << 1) ^ static_cast<std::uint32_t>(value >> 31);
}
std::int32_t unzigzag(std::uint32_t value) {
  return static_cast<std::int32_t>((value >> 1) ^ (~(value & 1u) + 1u));
}

/// Component of a quaternion: s, x, y, z.
double component(const Quat& q, int i) { return i == 0 ? q.s : q.v[i - 1]; }

/// Offset in steps of the resolution, or nothing if it does not fit.
std::optional<std::int32_t> quantize(double offset, double resolution) {
  const double steps = std::round(offset / resolution);
  if (!(std::fabs(steps) < kLargestOffset)) return std::nullopt;
  return static_cast<std::int32_t>(steps);
}

}  // namespace

std::uint64_t packQuaternion(const Quat& q) {
  int largest = 0;
  for (int i = 1; i < 4; ++i)
    if (std::fabs(component(q, i)) > std::fabs(component(q, largest))) largest = i;
  const double sign = component(q, largest) < 0 ? -1 : 1;
  std::uint64_t bits = static_cast<std::uint64_t>(largest);
  for (int i = 0; i < 4; ++i) {
    if (i == largest) continue;
    // The smaller three lie within 1/sqrt 2 of zero, and zero itself is met exactly.
    const double scaled = sign * component(q, i) * std::numbers::sqrt2 * kQuaternionHalf;
    const double whole = std::isfinite(scaled)
                             ? std::clamp(std::round(scaled), -kQuaternionHalf, kQuaternionHalf)
                             : 0;
    bits = bits << kQuaternionBits | static_cast<std::uint64_t>(whole + kQuaternionHalf);
  }
  return bits;
}

Quat unpackQuaternion(std::uint64_t bits) {
  const auto number = [&](int shift) {
    const auto whole = static_cast<double>(bits >> shift & kQuaternionMask) - kQuaternionHalf;
    return whole / (std::numbers::sqrt2 * kQuaternionHalf);
  };
  const double a = number(2 * kQuaternionBits), b = number(kQuaternionBits), c = number(0),
               rest = 1 - a * a - b * b - c * c, d = std::sqrt(std::max(rest, 0.));
  // selections, because jumps on the largest one are not predictable
  const int largest = static_cast<int>(bits >> (3 * kQuaternionBits) & 3u);
  return normalize(Quat{largest == 0 ? d : a,
                        largest == 1   ? d
                        : largest == 0 ? a
                                       : b,
                        largest == 2   ? d
                        : largest == 3 ? c
                                       : b,
                        largest == 3 ? d : c});
}

bool FrameEncoder::add(const RecordedFrame& frame) {
  const std::size_t bodies = frame.poses.size(), places = bodies + frame.vertices.size();
  const bool first = steps_.empty();
  const auto placeOf = [&](std::size_t i) -> const Vec3& {
    return i < bodies ? frame.poses[i].position : frame.vertices[i - bodies];
  };
  std::vector<std::uint32_t> words(wordCountOf(bodies, frame.vertices.size()));
  for (std::size_t i = 0; i < places; ++i) {
    for (int axis = 0; axis < 3 && !first; ++axis) {
      const auto steps = quantize(placeOf(i)[axis] - origins_[i][axis], resolution_);
      if (!steps) return false;
      words[static_cast<std::size_t>(axis) * places + i] = static_cast<std::uint32_t>(*steps);
    }
  }
  for (std::size_t i = 0; i < bodies; ++i) {
    const std::uint64_t turn = packQuaternion(frame.poses[i].orientation);
    words[kPlaceWords * places + i] = static_cast<std::uint32_t>(turn);
    words[kPlaceWords * places + bodies + i] = static_cast<std::uint32_t>(turn >> 32);
  }
  if (first) {
    bodyCount_ = bodies;
    for (std::size_t i = 0; i < places; ++i) origins_.push_back(placeOf(i));
    previous_.assign(words.size(), 0);
  }
  steps_.push_back(frame.step);
  times_.push_back(frame.time);
  const std::size_t begin = planes_.size();
  planes_.resize(begin + 4 * words.size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::uint32_t difference = zigzag(static_cast<std::int32_t>(words[i] - previous_[i]));
    for (std::size_t byte = 0; byte < 4; ++byte)
      planes_[begin + byte * words.size() + i] = static_cast<std::uint8_t>(difference >> (8 * byte));
  }
  previous_ = std::move(words);
  return true;
}

std::vector<std::uint8_t> FrameEncoder::finish() {
  ByteWriter out;
  out.put(static_cast<std::uint32_t>(steps_.size()));
  out.put(static_cast<std::uint32_t>(bodyCount_));
  out.put(static_cast<std::uint32_t>(origins_.size() - bodyCount_));
  for (std::size_t i = 0; i < steps_.size(); ++i) out.put(steps_[i]), out.put(times_[i]);
  for (const Vec3& origin : origins_)
    for (int axis = 0; axis < 3; ++axis) out.put(origin[axis]);
  std::vector<std::uint8_t> content = out.bytes();
  content.insert(content.end(), planes_.begin(), planes_.end());
  *this = FrameEncoder(resolution_);
  return content;
}

std::optional<std::vector<RecordedFrame>> decodeFrames(const std::vector<std::uint8_t>& content,
                                                       std::size_t bodyCount, std::size_t vertexCount,
                                                       double resolution, std::uint32_t version,
                                                       std::vector<RecordedFrame> memory) {
  ByteReader in(content);
  const std::size_t frameCount = in.get<std::uint32_t>();
  const std::size_t bodies = in.get<std::uint32_t>();
  const std::size_t vertices = version > 1 ? in.get<std::uint32_t>() : 0;
  const std::size_t places = bodies + vertices, wordCount = wordCountOf(bodies, vertices);
  constexpr std::size_t kBytesOfTime = 16, kBytesOfOrigin = 24, kBytesOfWord = 4;
  const Size wanted = Size(frameCount) * kBytesOfTime + Size(places) * kBytesOfOrigin +
                      Size(frameCount) * wordCount * kBytesOfWord;
  if (!in.ok() || bodies != bodyCount || vertices != vertexCount || !(wanted == in.left()))
    return std::nullopt;

  std::vector<RecordedFrame> frames = std::move(memory);
  frames.resize(frameCount);
  for (RecordedFrame& frame : frames) {
    frame.step = in.get<std::int64_t>();
    frame.time = in.getDouble();
    frame.poses.resize(bodies);
    frame.vertices.resize(vertices);
  }
  std::vector<Vec3> origins(places);
  for (Vec3& origin : origins)
    for (int axis = 0; axis < 3; ++axis) origin[axis] = in.getDouble();

  std::vector<std::uint32_t> words(wordCount, 0);
  const std::uint8_t* plane = content.data() + (content.size() - in.left());
  for (RecordedFrame& frame : frames) {
    const std::uint8_t *const b0 = plane, *const b1 = b0 + wordCount, *const b2 = b1 + wordCount,
                              *const b3 = b2 + wordCount;
    for (std::size_t i = 0; i < wordCount; ++i) {
      const std::uint32_t difference = b0[i] | std::uint32_t{b1[i]} << 8 | std::uint32_t{b2[i]} << 16 |
                                       std::uint32_t{b3[i]} << 24;
      words[i] += static_cast<std::uint32_t>(unzigzag(difference));
    }
    plane += 4 * wordCount;
    for (std::size_t i = 0; i < places; ++i) {
      Vec3& place = i < bodies ? frame.poses[i].position : frame.vertices[i - bodies];
      for (int axis = 0; axis < 3; ++axis) {
        const auto steps = static_cast<std::int32_t>(words[static_cast<std::size_t>(axis) * places + i]);
        place[axis] = origins[i][axis] + steps * resolution;
      }
    }
    for (std::size_t i = 0; i < bodies; ++i)
      frame.poses[i].orientation = unpackQuaternion(
          words[kPlaceWords * places + i] |
          static_cast<std::uint64_t>(words[kPlaceWords * places + bodies + i]) << 32);
  }
  return frames;
}

}  // namespace rubble::io
