#include "io/picture_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include <rubble/error.h>

namespace rubble::io {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Places of bodies and deformable objects in the lists of a world: objects follow bodies.
class Places {
 public:
  explicit Places(const World& world) : bodies_(world.bodies()), objects_(world.deformables()) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) ofBody_[bodies_[i]] = static_cast<int>(i);
    for (std::size_t i = 0; i < objects_.size(); ++i)
      ofObject_[objects_[i]] = static_cast<int>(bodies_.size() + i);
  }
  const std::vector<BodyId>& bodies() const { return bodies_; }
  const std::vector<DeformableId>& objects() const { return objects_; }
  std::size_t size() const { return bodies_.size() + objects_.size(); }
  /// -1: the world, or none.
  int of(const BodyId& id) const { return found(ofBody_, id); }
  int of(const DeformableId& id) const { return found(ofObject_, id); }

 private:
  template <class Map, class Id> static int found(const Map& map, const Id& id) {
    const auto it = map.find(id);
    return it == map.end() ? -1 : it->second;
  }
  std::vector<BodyId> bodies_;
  std::vector<DeformableId> objects_;
  std::unordered_map<BodyId, int> ofBody_;
  std::unordered_map<DeformableId, int> ofObject_;
};

/// visit(place, place, error) for everything that joins two of them: contacts that touch, joints and
/// attachments that hold.
template <class Visit> void forEachLink(const World& world, const Places& places, Visit&& visit) {
  for (const ContactPoint& c : world.contacts())
    if (c.depth > 0 || lengthSquared(c.force) > 0)
      visit(places.of(c.a), places.of(c.b), std::max(0., c.depth));
  for (const VertexContact& c : world.vertexContacts())
    visit(places.of(c.object), std::max(places.of(c.body), places.of(c.otherObject)), std::max(0., c.depth));
  for (const JointId id : world.joints()) {
    const JointState state = world.state(id);
    const auto [a, b] = world.bodiesOf(id);
    if (!state.broken) visit(places.of(a), places.of(b), state.gap);
  }
  for (const AttachmentId id : world.attachments()) {
    const JointState state = world.state(id);
    const World::AttachmentEnds ends = world.endsOf(id);
    if (!state.broken)
      visit(places.of(ends.object), std::max(places.of(ends.body), places.of(ends.otherObject)), state.gap);
  }
}

/// Lowest place of each island; -1: alone.
std::vector<int> islands(const World& world, const Places& places) {
  std::vector<int> root(places.size());
  std::iota(root.begin(), root.end(), 0);
  std::vector<char> joined(places.size(), 0);
  const auto find = [&](int i) {
    while (root[static_cast<std::size_t>(i)] != i)
      i = root[static_cast<std::size_t>(i)] = root[static_cast<std::size_t>(
          root[static_cast<std::size_t>(i)])];
    return i;
  };
  const auto moves = [&](int i) {
    return i >= 0 &&
           (static_cast<std::size_t>(i) >= places.bodies().size() ||
            world.definition(places.bodies()[static_cast<std::size_t>(i)]).motion == Motion::Dynamic);
  };
  forEachLink(world, places, [&](int a, int b, double) {
    for (const int i : {a, b})
      if (moves(i)) joined[static_cast<std::size_t>(i)] = 1;
    if (!moves(a) || !moves(b)) return;
    const int x = find(a), y = find(b);
    root[static_cast<std::size_t>(std::max(x, y))] = std::min(x, y);
  });
  for (std::size_t i = 0; i < root.size(); ++i) root[i] = find(static_cast<int>(i));
  for (std::size_t i = 0; i < root.size(); ++i)
    if (!joined[i]) root[i] = -1;
  return root;
}

std::vector<double> errors(const World& world, const Places& places) {
  std::vector<double> out(places.size(), 0);
  forEachLink(world, places, [&](int a, int b, double error) {
    for (const int i : {a, b})
      if (i >= 0) out[static_cast<std::size_t>(i)] = std::max(out[static_cast<std::size_t>(i)], error);
  });
  return out;
}

std::vector<double> materials(const World& world, const Places& places) {
  std::vector<Material> known;
  std::vector<double> out;
  const auto add = [&](const Material& material) {
    const auto at = std::ranges::find(known, material);
    out.push_back(static_cast<double>(at - known.begin()));
    if (at == known.end()) known.push_back(material);
  };
  for (const BodyId id : places.bodies()) add(world.definition(id).material);
  for (const DeformableId id : places.objects()) add(common(world.definition(id)).material);
  return out;
}

/// Of bodies, then of objects as a whole.
std::vector<double> placeValues(const World& world, const Places& places, ColorBy by) {
  if (by == ColorBy::Material) return materials(world, places);
  if (by == ColorBy::Error) return errors(world, places);
  const std::vector<int> found = islands(world, places);
  return {found.begin(), found.end()};
}

double valueOf(const SolverState& state, ColorBy by) {
  return by == ColorBy::Color ? state.color : by == ColorBy::Multiplier ? state.multiplier : state.stiffness;
}

struct Edge {
  int a, b;
  double length;  ///< at rest [m]
};
std::vector<Edge> edgesOf(const World& world, DeformableId id) {
  const Deformable& def = world.definition(id);
  const std::vector<Vec3>& rest = common(def).vertices;
  std::vector<Edge> edges;
  const auto add = [&](int a, int b, double length = -1) {
    edges.push_back({a, b,
                     length >= 0 ? length
                                 : rubble::length(rest[static_cast<std::size_t>(a)] -
                                                  rest[static_cast<std::size_t>(b)])});
  };
  if (const auto* solid = std::get_if<TetSolidDef>(&def)) {
    for (const auto& t : solid->tetrahedra)
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j) add(t[i], t[j]);
  } else if (const auto* net = std::get_if<NetDef>(&def)) {
    for (const NetDef::Edge& e : net->edges) add(e.a, e.b, e.restLength);
  } else {
    const World::Surface surface = world.surface(id);
    for (const auto& t : surface.triangles)
      for (std::size_t i = 0; i < 3; ++i) add(t[i], t[(i + 1) % 3]);
    for (const auto& s : surface.segments) add(s[0], s[1]);
  }
  return edges;
}

std::vector<float> strains(const World& world, DeformableId id) {
  const std::vector<Vec3> x = world.positions(id);
  std::vector<float> out(x.size(), 0);
  for (const Edge& e : edgesOf(world, id)) {
    if (!(e.length > 0)) continue;
    const auto a = static_cast<std::size_t>(e.a), b = static_cast<std::size_t>(e.b);
    const auto strain = static_cast<float>(std::fabs(length(x[a] - x[b]) / e.length - 1));
    out[a] = std::max(out[a], strain), out[b] = std::max(out[b], strain);
  }
  return out;
}

std::vector<float> ofVertices(const World& world, DeformableId id, ColorBy by) {
  std::vector<float> out;
  if (by == ColorBy::Strain) return strains(world, id);
  if (by == ColorBy::Speed)
    for (const Vec3& v : world.velocities(id)) out.push_back(static_cast<float>(length(v)));
  else
    for (const SolverState& state : world.solverStates(id))
      out.push_back(static_cast<float>(valueOf(state, by)));
  return out;
}

bool isOfPlaces(ColorBy by) {
  return by == ColorBy::Material || by == ColorBy::Island || by == ColorBy::Error;
}

}  // namespace

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all = {
      {ColorBy::Body, "body", "1", "each body has its own color", true},
      {ColorBy::Material, "material", "1", "bodies of one material are alike", true},
      {ColorBy::Speed, "speed", "m/s", "of centers and vertices", false},
      {ColorBy::Island, "island", "1", "what hangs together over touching contacts and joints", true},
      {ColorBy::Color, "color", "1", "what the solver moves at the same time", true},
      {ColorBy::Error, "error", "m", "largest penetration or gap of a joint", false},
      {ColorBy::Multiplier, "multiplier", "N", "largest |lambda| of the rows on a body", false},
      {ColorBy::Stiffness, "stiffness", "N/m", "largest k of the rows on a body", false},
      {ColorBy::Strain, "strain", "1",
       "largest change of length of an edge at a vertex, over its length at rest", false},
  };
  return all;
}

const Quantity& quantity(ColorBy by) { return quantities()[static_cast<std::size_t>(by)]; }

ColorBy colorByNamed(const std::string& key) {
  std::string known;
  for (const Quantity& q : quantities()) {
    if (q.key == key) return q.by;
    known += (known.empty() ? "" : ", ") + std::string(q.key);
  }
  throw Error("color by", "one of " + known, key);
}

bool knownWithoutWorld(ColorBy by) { return by == ColorBy::Body || by == ColorBy::Speed; }

std::vector<double> bodyValues(const World& world, ColorBy by) {
  if (by == ColorBy::Body || by == ColorBy::Speed) return {};
  if (by == ColorBy::Strain) return std::vector<double>(world.bodies().size(), kNone);
  std::vector<double> out;
  if (isOfPlaces(by)) {
    const Places places(world);
    out = placeValues(world, places, by);
    out.resize(places.bodies().size());
    return out;
  }
  for (const SolverState& state : world.solverStates()) out.push_back(valueOf(state, by));
  return out;
}

std::vector<std::vector<float>> vertexValues(const World& world, ColorBy by) {
  const std::vector<DeformableId> objects = world.deformables();
  std::vector<std::vector<float>> out(objects.size());
  if (by == ColorBy::Body || objects.empty()) return out;
  if (isOfPlaces(by)) {
    const Places places(world);
    const std::vector<double> values = placeValues(world, places, by);
    for (std::size_t i = 0; i < objects.size(); ++i)
      out[i].assign(static_cast<std::size_t>(world.vertexCount(objects[i])),
                    static_cast<float>(values[places.bodies().size() + i]));
    return out;
  }
  for (std::size_t i = 0; i < objects.size(); ++i) out[i] = ofVertices(world, objects[i], by);
  return out;
}

double shownValue(const PictureBody& body, ColorBy by) {
  return by == ColorBy::Speed && !body.deforms ? body.speed : body.value;
}

double largestValue(std::span<const PictureBody> bodies, ColorBy by) {
  double largest = 0;
  for (const PictureBody& body : bodies) {
    if (body.motion == Motion::Static) continue;
    const double value = shownValue(body, by);
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  return largest;
}

}  // namespace rubble::io
