#pragma once
/// How large and heavy the moving things of a world are, kept while they come and go: a step after an edit must not look at all of them.
#include <map>

#include <rubble/scene.h>

#include "forces/soft_model.h"
#include "world/shape_frame.h"

namespace rubble {

struct BodyRecord {
  BodyDef def;
  MassProperties mass;
  ShapeFrame frame;  ///< of the engine in that of the author
  double radius;     ///< of the bounding sphere about the centre of mass [m]
};

/// How many there are of each number.
class Tally {
 public:
  /// `change` more of them, or fewer.
  void count(double number, int change) {
    const auto place = counts_.try_emplace(number, 0).first;
    if ((place->second += change) == 0) counts_.erase(place);
    all_ += change;
  }
  bool empty() const { return all_ == 0; }
  double largest() const { return empty() ? 0 : counts_.rbegin()->first; }
  /// Of an even number of them the upper one. Not of none.
  double median() const {
    auto place = counts_.begin();
    for (int before = place->second; before <= all_ / 2; before += place->second) ++place;
    return place->first;
  }

 private:
  std::map<double, int> counts_;
  int all_ = 0;
};

struct Sizes {
  Tally radius;      ///< bounding radii of dynamic bodies, and of objects and particles that move as bodies do [m]

  void count(const BodyRecord& body, int change) {
    if (body.def.motion != Motion::Dynamic) return;
    radius.count(body.radius, change);
  }
  void count(const SoftModel& model, int change) {
    if (isLump(model)) radius.count(model.size / 2, change);
    else if (hasNoElements(model))
      for (const SoftModel::Vertex& v : model.vertices) radius.count(v.radius, change);
  }
};

}  // namespace rubble
