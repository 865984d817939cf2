#include "io/frame_codec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

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

inline Quat unpack(std::uint64_t bits) {
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

Quat unpackQuaternion(std::uint64_t bits) { return unpack(bits); }

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

bool FrameDecoder::start(std::vector<std::uint8_t> content, std::size_t bodyCount, std::size_t vertexCount,
                         double resolution, std::uint32_t version) {
  content_ = std::move(content), resolution_ = resolution, decoded_ = 0;
  ByteReader in(content_);
  const std::size_t frameCount = in.get<std::uint32_t>();
  const std::size_t bodies = in.get<std::uint32_t>();
  const std::size_t vertices = version > 1 ? in.get<std::uint32_t>() : 0;
  const std::size_t places = bodies + vertices, wordCount = wordCountOf(bodies, vertices);
  constexpr std::size_t kBytesOfTime = 16, kBytesOfOrigin = 24, kBytesOfWord = 4;
  const Size wanted = Size(frameCount) * kBytesOfTime + Size(places) * kBytesOfOrigin +
                      Size(frameCount) * wordCount * kBytesOfWord;
  if (!in.ok() || bodies != bodyCount || vertices != vertexCount || !(wanted == in.left())) return false;

  frames_.resize(frameCount);
  for (std::shared_ptr<RecordedFrame>& frame : frames_) {
    if (!frame || frame.use_count() > 1) frame = std::make_shared<RecordedFrame>();
    frame->step = in.get<std::int64_t>();
    frame->time = in.getDouble();
    frame->poses.resize(bodies);
    frame->vertices.resize(vertices);
  }
  origins_.resize(places);
  for (Vec3& origin : origins_)
    for (int axis = 0; axis < 3; ++axis) origin[axis] = in.getDouble();
  words_.assign(wordCount, 0);
  planes_ = content_.size() - in.left();
  return true;
}

const std::shared_ptr<RecordedFrame>& FrameDecoder::frame(std::size_t index) {
  for (; decoded_ <= index; ++decoded_) decode(*frames_[decoded_]);
  return frames_[index];
}

void FrameDecoder::decode(RecordedFrame& frame) {
  const std::size_t bodies = frame.poses.size(), places = origins_.size(), count = words_.size();
  const std::uint8_t* const bytes = content_.data() + planes_ + decoded_ * 4 * count;
  const auto advance = [&](std::size_t begin, std::size_t end) {
    std::uint32_t* const words = words_.data();
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t difference = bytes[i] | std::uint32_t{bytes[count + i]} << 8 |
                                       std::uint32_t{bytes[2 * count + i]} << 16 |
                                       std::uint32_t{bytes[3 * count + i]} << 24;
      words[i] += static_cast<std::uint32_t>(unzigzag(difference));
    }
  };
  const auto placeAt = [&](std::size_t i) {
    Vec3 place;
    for (std::size_t axis = 0; axis < 3; ++axis)
      place[static_cast<int>(axis)] = origins_[i][static_cast<int>(axis)] +
                                      static_cast<std::int32_t>(words_[axis * places + i]) * resolution_;
    return place;
  };
  // The words of a block stay in the cache between the two uses.
  constexpr std::size_t kBlock = 1024;
  for (std::size_t begin = 0; begin < places; begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, places), endOfBodies = std::min(end, bodies);
    for (std::size_t axis = 0; axis < kPlaceWords; ++axis)
      advance(axis * places + begin, axis * places + end);
    for (std::size_t i = std::max(begin, bodies); i < end; ++i) frame.vertices[i - bodies] = placeAt(i);
    if (begin >= endOfBodies) continue;
    const std::size_t low = kPlaceWords * places, high = low + bodies;
    advance(low + begin, low + endOfBodies), advance(high + begin, high + endOfBodies);
    for (std::size_t i = begin; i < endOfBodies; ++i)
      frame.poses[i] = {placeAt(i), unpack(words_[low + i] | std::uint64_t{words_[high + i]} << 32)};
  }
}

}  // namespace rubble::io
