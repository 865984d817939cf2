#include "io/look_table.h"

#include <algorithm>

namespace rubble::io {
namespace {

PictureBody partOf(const LookPart& part, PictureBody body) {
  body.position += rotate(body.orientation, part.position);
  body.orientation = normalize(body.orientation * part.orientation);
  body.shape = part.shape;
  body.color = part.color;
  return body;
}

}  // namespace

LookTable::LookTable(std::vector<Look> looks, std::span<const PictureBody> atStart)
    : looks_(std::move(looks)) {
  for (std::size_t i = 0; i < looks_.size(); ++i) {
    const auto isIts = [&](const PictureBody& body) {
      return !body.deforms && body.key == static_cast<std::uint32_t>(looks_[i].body);
    };
    const auto found = std::ranges::find_if(atStart, isIts);
    if (looks_[i].body >= 0 && found != atStart.end()) known_.push_back({found->key, {found->shape, i}});
  }
  std::ranges::sort(known_, {}, &std::pair<std::uint32_t, Known>::first);
}

std::vector<PictureBody> LookTable::applied(std::span<const PictureBody> bodies) const {
  std::vector<PictureBody> out;
  PictureBody world;
  world.motion = Motion::Static, world.key = kSceneryKey;
  for (const Look& look : looks_)
    for (const LookPart& part : look.parts)
      if (look.body == kWorld) out.push_back(partOf(part, world));
  for (const PictureBody& body : bodies) {
    const auto found = std::ranges::lower_bound(known_, body.key, {},
                                                &std::pair<std::uint32_t, Known>::first);
    const bool isKnown = found != known_.end() && found->first == body.key &&
                         (body.isWheel || sameShape(found->second.shape, body.shape));
    if (!isKnown) {
      // a scene with looks says itself what its machines look like
      if (known_.empty() || body.key < kStandKeys || body.key >= kSoftKeys) out.push_back(body);
      continue;
    }
    for (const LookPart& part : looks_[found->second.look].parts) out.push_back(partOf(part, body));
  }
  return out;
}

}  // namespace rubble::io
