#include "io/frame_codec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cook/size.h"
#include "io/byte_stream.h"
#include "platform/threads.h"

namespace rubble::io {
namespace {

/// Words of 32 bits a body: position x, y, z and the two halves of the quaternion. Vertices have the first
/// three. The words of all bodies and vertices come one kind after the other: x, y, z of bodies, then of
/// vertices, then quaternions.
constexpr std::size_t kPlaceWords = 3, kTurnWords = 2;
constexpr std::size_t kBytesOfCounts = 12, kBytesOfTime = 16, kBytesOfOrigin = 24, kBytesOfWord = 4;
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

namespace {

const Vec3& placeOf(const RecordedFrame& frame, std::size_t i) {
  const std::size_t bodies = frame.poses.size();
  return i < bodies ? frame.poses[i].position : frame.vertices[i - bodies];
}

}  // namespace

bool FrameEncoder::add(const RecordedFrame& frame) {
  if (!frames_.empty()) {
    const double most = kLargestOffset * resolution_;
    for (std::size_t i = 0; i < places(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        if (!(std::fabs(placeOf(frame, i)[axis] - placeOf(frames_.front(), i)[axis]) < most)) return false;
  }
  frames_.push_back(frame);
  return true;
}

std::size_t FrameEncoder::headSize() const {
  return kBytesOfCounts + frames_.size() * kBytesOfTime + places() * kBytesOfOrigin;
}
std::size_t FrameEncoder::frameSize() const {
  return kBytesOfWord * wordCountOf(bodies(), places() - bodies());
}
std::size_t FrameEncoder::contentSize() const { return headSize() + frames_.size() * frameSize(); }

std::vector<std::uint8_t> FrameEncoder::content(std::size_t begin, std::size_t end) const {
  ByteWriter out;
  out.put(static_cast<std::uint32_t>(frames_.size()));
  out.put(static_cast<std::uint32_t>(bodies()));
  out.put(static_cast<std::uint32_t>(places() - bodies()));
  for (const RecordedFrame& frame : frames_) out.put(frame.step), out.put(frame.time);
  for (std::size_t i = 0; i < places(); ++i)
    for (int axis = 0; axis < 3; ++axis) out.put(placeOf(frames_.front(), i)[axis]);
  std::vector<std::uint8_t> bytes = out.bytes();
  const std::size_t head = bytes.size(), size = frameSize();
  bytes.resize(contentSize());
  if (end <= std::max(begin, head)) return bytes;
  const std::size_t first = begin > head ? (begin - head) / size : 0, last = (end - head + size - 1) / size;
  // the words of a block stay in the cache from frame to frame
  constexpr std::size_t kBlock = 2048;
  forEachTask((places() + kBlock - 1) / kBlock, [&](std::size_t k) {
    encode(first, last, k * kBlock, std::min((k + 1) * kBlock, places()), bytes.data() + head);
  });
  return bytes;
}

void FrameEncoder::encode(std::size_t firstFrame, std::size_t endFrame, std::size_t begin, std::size_t end,
                          std::uint8_t* bytes) const {
  const std::size_t all = places(), turned = bodies(), endOfBodies = std::min(end, turned),
                    count = wordCountOf(turned, all - turned);
  std::vector<std::uint32_t> previous((kPlaceWords + kTurnWords) * (end - begin), 0);
  for (std::size_t f = firstFrame > 0 ? firstFrame - 1 : 0; f < endFrame; ++f) {
    const RecordedFrame& frame = frames_[f];
    std::uint8_t* const to = bytes + f * frameSize();
    auto before = previous.begin();
    const auto put = [&](std::size_t word, std::uint32_t value) {
      const std::uint32_t difference = zigzag(static_cast<std::int32_t>(value - *before));
      *before++ = value;
      if (f < firstFrame) return;
      for (std::size_t byte = 0; byte < kBytesOfWord; ++byte)
        to[byte * count + word] = static_cast<std::uint8_t>(difference >> (8 * byte));
    };
    for (std::size_t axis = 0; axis < kPlaceWords; ++axis)
      for (std::size_t i = begin; i < end; ++i) {
        const int a = static_cast<int>(axis);
        const double offset = placeOf(frame, i)[a] - placeOf(frames_.front(), i)[a];
        // a first position may be infinite
        const double steps = f == 0 ? 0 : std::round(offset / resolution_);
        put(axis * all + i, static_cast<std::uint32_t>(static_cast<std::int32_t>(steps)));
      }
    for (std::size_t i = begin; i < endOfBodies; ++i) {
      const std::uint64_t turn = packQuaternion(frame.poses[i].orientation);
      put(kPlaceWords * all + i, static_cast<std::uint32_t>(turn));
      put(kPlaceWords * all + turned + i, static_cast<std::uint32_t>(turn >> 32));
    }
  }
}

bool FrameDecoder::start(std::vector<std::uint8_t> content, std::size_t bodyCount, std::size_t vertexCount,
                         double resolution, std::uint32_t version) {
  content_ = std::move(content), resolution_ = resolution, decoded_ = 0;
  ByteReader in(content_);
  const std::size_t frameCount = in.get<std::uint32_t>();
  const std::size_t bodies = in.get<std::uint32_t>();
  const std::size_t vertices = version > 1 ? in.get<std::uint32_t>() : 0;
  const std::size_t places = bodies + vertices, wordCount = wordCountOf(bodies, vertices);
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
