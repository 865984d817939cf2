#include "soft_probes.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "build.h"

namespace rubble::scenes {
namespace {

class EndProbe : public Probe {
 public:
  explicit EndProbe(std::vector<Measure> measures) : measures_(std::move(measures)) {}
  void finish(const World& world, Metrics& metrics) override {
    for (const Measure& m : measures_) metrics[m.name] = m.of(world);
  }

 private:
  std::vector<Measure> measures_;
};

class RunningProbe : public Probe {
 public:
  RunningProbe(double from, bool peak, std::vector<Measure> measures)
      : from_(from), peak_(peak), measures_(std::move(measures)), values_(measures_.size(), 0) {}
  void afterStep(const World& world, const StepReport&) override {
    if (world.time() < from_) return;
    ++count_;
    for (std::size_t i = 0; i < measures_.size(); ++i) {
      const double value = measures_[i].of(world);
      if (!peak_)
        values_[i] += value;
      else if (count_ == 1 || !(value <= values_[i]))
        values_[i] = value;
    }
  }
  void finish(const World&, Metrics& metrics) override {
    if (count_ == 0) return;
    for (std::size_t i = 0; i < measures_.size(); ++i)
      metrics[measures_[i].name] = peak_ ? values_[i] : values_[i] / count_;
  }

 private:
  double from_;
  bool peak_;
  std::vector<Measure> measures_;
  std::vector<double> values_;
  int count_ = 0;
};

Vec3 upIn(const World& world) { return normalize(-world.gravity(), Vec3{0, 0, 1}); }

}  // namespace

std::unique_ptr<Probe> endProbe(std::vector<Measure> measures) {
  return std::make_unique<EndProbe>(std::move(measures));
}
std::unique_ptr<Probe> peakProbe(double from, std::vector<Measure> measures) {
  return std::make_unique<RunningProbe>(from, true, std::move(measures));
}
std::unique_ptr<Probe> meanProbe(double from, std::vector<Measure> measures) {
  return std::make_unique<RunningProbe>(from, false, std::move(measures));
}

double largestStretch(const World& world, int object) {
  const World::Surface now = world.surface(world.deformableAt(object));
  const std::vector<Vec3>& rest = common(world.definition(now.id)).vertices;
  double largest = 0;
  const auto edge = [&](int a, int b) {
    const auto i = std::size_t(a), j = std::size_t(b);
    largest = std::max(largest, length(now.vertices[i] - now.vertices[j]) / length(rest[i] - rest[j]));
  };
  for (const auto& t : now.triangles) edge(t[0], t[1]), edge(t[1], t[2]), edge(t[2], t[0]);
  for (const auto& s : now.segments) edge(s[0], s[1]);
  return largest;
}

double lowestVertex(const World& world) {
  const Vec3 up = upIn(world);
  double lowest = kNoBound;
  for (const DeformableId id : world.deformables())
    for (const Vec3& x : world.positions(id)) lowest = std::min(lowest, dot(up, x));
  return lowest;
}

double cellsBelow(const World& world, int object, double share) {
  const DeformableId id = world.deformableAt(object);
  const TetSolidDef& def = std::get<TetSolidDef>(world.definition(id));
  const std::vector<Vec3> now = world.positions(id);
  const auto volume = [](const std::vector<Vec3>& x, const std::array<int, 4>& t) {
    const Vec3& a = x[std::size_t(t[0])];
    return dot(x[std::size_t(t[1])] - a, cross(x[std::size_t(t[2])] - a, x[std::size_t(t[3])] - a));
  };
  return double(std::count_if(def.tetrahedra.begin(), def.tetrahedra.end(), [&](const auto& t) {
    return !(volume(now, t) > share * volume(def.vertices, t));
  }));
}
double volumeInside(const World& world, int object) {
  const World::Surface s = world.surface(world.deformableAt(object));
  double sum = 0;
  for (const auto& t : s.triangles) {
    const auto at = [&](std::size_t k) { return s.vertices[std::size_t(t[k])] - s.vertices[0]; };
    sum += dot(at(0), cross(at(1), at(2))) / 6;
  }
  return sum;
}

double crushedCells(const World& world, int object) { return cellsBelow(world, object, .5); }

Vec3 meanOf(const World& world, int object, const std::vector<int>& vertices) {
  const std::vector<Vec3> x = world.positions(world.deformableAt(object));
  Vec3 sum;
  for (const int v : vertices) sum += x[std::size_t(v)];
  return sum / double(vertices.size());
}

double liftOfVertices(const World& world) {
  double lift = 0;
  for (const VertexContact& c : world.vertexContacts())
    if (c.body.index >= 0) lift -= dot(upIn(world), c.force);
  return lift;
}

double motion(const World& world) { return world.quality().kineticEnergy; }

namespace {

/// Height of the sheet under (or over) a point; a number below all others beside the sheet.
double heightOfSheet(const World::Surface& sheet, double x, double y) {
  for (const auto& t : sheet.triangles) {
    const Vec3 &a = sheet.vertices[static_cast<std::size_t>(t[0])],
               &b = sheet.vertices[static_cast<std::size_t>(t[1])],
               &c = sheet.vertices[static_cast<std::size_t>(t[2])];
    const auto side = [&](const Vec3& p, const Vec3& q) {
      return (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
    };
    const double wa = side(b, c), wb = side(c, a), wc = side(a, b), sum = wa + wb + wc;
    if (sum != 0 && wa / sum >= 0 && wb / sum >= 0 && wc / sum >= 0)
      return (wa * a.z + wb * b.z + wc * c.z) / sum;
  }
  return -std::numeric_limits<double>::infinity();
}

}  // namespace

double bodiesBelow(const World& world, int object) {
  const World::Surface sheet = world.surface(world.deformableAt(object));
  double below = 0;
  for (const BodyId id : world.bodies()) {
    if (world.definition(id).motion != Motion::Dynamic) continue;
    const Vec3 p = world.state(id).position;
    const double height = heightOfSheet(sheet, p.x, p.y);
    below += !(height > -std::numeric_limits<double>::infinity() && p.z > height);
  }
  return below;
}

ClothDef heldSheet(double side, double height, int cells) {
  ClothDef sheet = clothSheet({-side / 2, -side / 2, height}, {side, 0, 0}, {0, side, 0}, cells, cells);
  sheet.name = "sheet";
  sheet.thickness = 4e-3;
  sheet.youngsModulus = 2e6;
  sheet.density = 400;
  sheet.fixed = verticesWhere(
      sheet, [=](const Vec3& x) { return std::max(std::fabs(x.x), std::fabs(x.y)) > .4995 * side; });
  return sheet;
}

std::vector<int> verticesWhere(const DeformableDef& object, const std::function<bool(const Vec3&)>& inside) {
  std::vector<int> out;
  for (std::size_t i = 0; i < object.vertices.size(); ++i)
    if (inside(object.vertices[i])) out.push_back(int(i));
  return out;
}

}  // namespace rubble::scenes
