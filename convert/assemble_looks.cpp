/// From the drawn shapes of links to looks of bodies.
#include "convert/assemble.h"
#include "io/picture.h"

namespace rubble::convert {
namespace {

bool collides(const Geom& geom) { return geom.contact.any(); }

class LookBuilder {
 public:
  LookBuilder(const Model& model, const Layout& layout) : model_(model), layout_(layout) {}

  std::vector<Look> build() {
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      if (layout_.root[i] == static_cast<int>(i)) addMoving(i);
      if (layout_.root[i] < 0) addStatic(i);
    }
    if (!scenery_.parts.empty()) looks_.push_back(std::move(scenery_));
    return std::move(looks_);
  }

 private:
  static LookPart partOf(const DrawnShape& drawn, const Pose& pose) {
    return {drawn.shape, pose.p, pose.q, drawn.color};
  }
  static bool shows(const DrawnShape& drawn, const Link& link) {
    return !drawn.color && drawn.geom >= 0 &&
           io::sameShape(drawn.shape, link.geoms[static_cast<std::size_t>(drawn.geom)].shape);
  }

  /// One look of all links of a body, unless it is the shape of the body.
  void addMoving(std::size_t root) {
    Look look{layout_.bodyOf[root], {}};
    std::size_t colliding = 0, all = 0, shown = 0;
    for (const int member : layout_.members[root]) {
      const Link& link = model_.links[static_cast<std::size_t>(member)];
      const Pose& pose = layout_.inRoot[static_cast<std::size_t>(member)];
      for (const Geom& geom : link.geoms) ++all, colliding += collides(geom);
      for (const DrawnShape& drawn : link.drawn) {
        look.parts.push_back(partOf(drawn, pose * drawn.pose));
        const bool inShape = drawn.geom >= 0 && collides(link.geoms[static_cast<std::size_t>(drawn.geom)]);
        shown += shows(drawn, link) && (inShape || colliding == 0);
      }
    }
    const bool isShape = shown == look.parts.size() && shown == (colliding > 0 ? colliding : all);
    if (!look.parts.empty() && !isShape) looks_.push_back(std::move(look));
  }

  /// Geoms that are bodies have their looks; what collides with nothing is scenery.
  void addStatic(std::size_t i) {
    const Link& link = model_.links[i];
    if (link.drawn.empty()) return;
    std::vector<Look> own;
    std::vector<std::size_t> lookOf(link.geoms.size());
    for (std::size_t g = 0; g < link.geoms.size(); ++g) {
      if (!collides(link.geoms[g])) continue;
      lookOf[g] = own.size();
      own.push_back({layout_.staticOf[i][own.size()], {}});
    }
    std::vector<bool> isPlain(own.size());
    for (const DrawnShape& drawn : link.drawn) {
      const auto g = static_cast<std::size_t>(drawn.geom);
      if (drawn.geom < 0 || !collides(link.geoms[g])) {
        scenery_.parts.push_back(partOf(drawn, layout_.inWorld[i] * drawn.pose));
        continue;
      }
      own[lookOf[g]].parts.push_back(partOf(drawn, inverse(link.geoms[g].pose) * drawn.pose));
      isPlain[lookOf[g]] = shows(drawn, link);
    }
    for (std::size_t k = 0; k < own.size(); ++k)
      if (!isPlain[k]) looks_.push_back(std::move(own[k]));
  }

  const Model& model_;
  const Layout& layout_;
  std::vector<Look> looks_;
  Look scenery_;
};

}  // namespace

std::vector<Look> looksOf(const Model& model, const Layout& layout) {
  return LookBuilder(model, layout).build();
}

}  // namespace rubble::convert
