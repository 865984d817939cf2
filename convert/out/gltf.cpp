/// Recordings as binary glTF 2.0: a node for each body, with tracks of translation and rotation.
#include <cmath>
#include <fstream>
#include <map>

#include <rubble/error.h>
#include <nlohmann/json.hpp>

#include "convert/out/frames.h"
#include "convert/out/prototypes.h"
#include "convert/out/scratch.h"
#include "io/byte_stream.h"
#include "io/output_file.h"

namespace rubble::convert {
namespace {

using Json = nlohmann::ordered_json;
using Vec3f = Vec3T<float>;
using Quat4f = std::array<float, 4>;  // x, y, z, scalar

/// Programs that read glTF keep an object for each node.
constexpr std::size_t kMostMoving = 10000;
/// Frames that are held before they are written.
constexpr std::size_t kBlock = 64;
/// Levels of each channel of a color; colors of one level share a material.
constexpr int kColorLevels = 32;

enum Component { kUnsignedInt = 5125, kFloat = 5126 };

class GltfWriter final : public FrameWriter {
 public:
  explicit GltfWriter(const ExportJob& job) : job_(job), out_(job.file), rest_(job.file) {
    for (std::size_t i = 0; i < cast().bodies.size(); ++i)
      if (cast().bodies[i].motion != Motion::Static) trackOf_.emplace(static_cast<int>(i), trackOf_.size());
    if (trackOf_.size() > kMostMoving)
      throw Error(job.file,
                  "at most " + std::to_string(kMostMoving) + " moving bodies, for glTF has a node for each" +
                      " and cannot animate instances; .usdc holds any number",
                  std::to_string(trackOf_.size()));
    if (!cast().softs.empty())
      job_.notes.push_back(std::to_string(cast().softs.size()) +
                           " deformable objects are left out: glTF has no meshes that deform freely");
    tracks_.resize(trackOf_.size());
    restFile_.open(rest_.path(), std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc);
  }

  void write(const ExportFrame& frame) override {
    times_.push_back(static_cast<float>(frame.number * job_.source.interval()));
    std::vector<bool> isThere(tracks_.size(), false);
    for (std::size_t row = 0; row < frame.bodies.size(); ++row) {
      const int i = frame.bodies[row];
      const io::RecordedPose& pose = frame.recorded->poses[row];
      if (!nodes_.contains(i))
        nodes_[i] = {narrow(pose.position), narrow(pose.orientation),
                     job_.colorOf(cast().bodies[static_cast<std::size_t>(i)], pose)};
      const auto found = trackOf_.find(i);
      if (found == trackOf_.end()) continue;
      Track& track = tracks_[found->second];
      isThere[found->second] = true;
      track.places.resize(times_.size() - 1 - written_, narrow(pose.position));
      track.turns.resize(times_.size() - 1 - written_, narrow(pose.orientation));
      track.places.push_back(narrow(pose.position));
      Quat4f turn = narrow(pose.orientation);
      // Along the shorter arc from the frame before.
      const Quat4f& last = track.lastTurn;
      if (turn[0] * last[0] + turn[1] * last[1] + turn[2] * last[2] + turn[3] * last[3] < 0)
        for (float& x : turn) x = -x;
      track.turns.push_back(track.lastTurn = turn);
      track.lastPlace = track.places.back();
    }
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      Track& track = tracks_[t];
      track.places.resize(times_.size() - written_, track.lastPlace);
      track.turns.resize(times_.size() - written_, track.lastTurn);
      if (track.shown.empty() || track.shown.back().second != isThere[t])
        track.shown.emplace_back(times_.back(), isThere[t]);
    }
    if (times_.size() - written_ >= kBlock) flush();
  }

  void finish() override {
    flush();
    makeScene();
    std::uint64_t trackBytes = 0;
    const std::uint64_t places = sizeof(Vec3f) * times_.size(), turns = sizeof(Quat4f) * times_.size();
    trackBytes = tracks_.size() * (places + turns);
    const std::uint64_t all = bin_.size() + trackBytes;
    json_["buffers"] = Json::array({{{"byteLength", all}}});
    std::string text = json_.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    constexpr std::uint64_t kHeads = 12 + 8 + 8, kMost = 0xffffffff;
    const std::uint64_t size = kHeads + text.size() + all;
    if (size > kMost)
      throw Error(job_.file, "at most 4 GiB; .usdc holds more", std::to_string(size >> 20) + " MiB");
    io::ByteWriter head;
    head.put(std::uint32_t{0x46546c67}), head.put(std::uint32_t{2}),
        head.put(static_cast<std::uint32_t>(size));
    head.put(static_cast<std::uint32_t>(text.size())), head.put(std::uint32_t{0x4e4f534a});
    put(head.bytes().data(), head.bytes().size());
    put(text.data(), text.size());
    io::ByteWriter binHead;
    binHead.put(static_cast<std::uint32_t>(all)), binHead.put(std::uint32_t{0x004e4942});
    put(binHead.bytes().data(), binHead.bytes().size());
    put(bin_.data(), bin_.size());
    copyTracks<Vec3f>(0), copyTracks<Quat4f>(sizeof(Vec3f));
    out_.finish();
  }

 private:
  struct Node {
    Vec3f place;
    Quat4f turn;
    Vec3 color;
  };
  struct Track {
    std::vector<Vec3f> places;  ///< since the last flush
    std::vector<Quat4f> turns;
    Vec3f lastPlace;
    Quat4f lastTurn{0, 0, 0, 1};
    std::vector<std::pair<float, bool>> shown;  ///< time from which it is there, or not [s]
  };
  struct Block {
    std::uint64_t offset;
    std::size_t frames;
  };

  const Cast& cast() const { return job_.source.cast(); }
  static Vec3f narrow(const Vec3& v) { return Vec3f(v); }
  static Quat4f narrow(const Quat& q) {
    return {static_cast<float>(q.v.x), static_cast<float>(q.v.y), static_cast<float>(q.v.z),
            static_cast<float>(q.s)};
  }
  void put(const void* data, std::size_t bytes) {
    out_.stream().write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
  }

  /// Puts the frames that are held into a block: places of each track, then turns of each track.
  void flush() {
    const std::size_t frames = times_.size() - written_;
    if (frames == 0) return;
    blocks_.push_back({static_cast<std::uint64_t>(restFile_.tellp()), frames});
    for (Track& track : tracks_) {
      restFile_.write(reinterpret_cast<const char*>(track.places.data()),
                      static_cast<std::streamsize>(frames * sizeof(Vec3f)));
      track.places.clear();
    }
    for (Track& track : tracks_) {
      restFile_.write(reinterpret_cast<const char*>(track.turns.data()),
                      static_cast<std::streamsize>(frames * sizeof(Quat4f)));
      track.turns.clear();
    }
    written_ = times_.size();
  }

  /// All frames of the first track, of the second one, and so on. `before`: bytes per frame and track in
  /// front of these values in a block.
  template <class T> void copyTracks(std::size_t before) {
    std::vector<T> values;
    for (std::size_t t = 0; t < tracks_.size(); ++t)
      for (const Block& block : blocks_) {
        values.resize(block.frames);
        const std::size_t start = (before * tracks_.size() + t * sizeof(T)) * block.frames;
        restFile_.seekg(static_cast<std::streamoff>(block.offset + start));
        restFile_.read(reinterpret_cast<char*>(values.data()),
                       static_cast<std::streamsize>(block.frames * sizeof(T)));
        put(values.data(), values.size() * sizeof(T));
      }
    if (!restFile_) out_.stream().setstate(std::ios::failbit);
  }

  int view(std::uint64_t offset, std::uint64_t bytes) {
    json_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
    return static_cast<int>(json_["bufferViews"].size()) - 1;
  }
  int accessor(int view, std::uint64_t offset, Component component, const char* type, std::size_t count) {
    json_["accessors"].push_back({{"bufferView", view},
                                  {"byteOffset", offset},
                                  {"componentType", component},
                                  {"count", count},
                                  {"type", type}});
    return static_cast<int>(json_["accessors"].size()) - 1;
  }
  /// An accessor of values that are in memory.
  template <class T> int accessorOf(const std::vector<T>& values, Component component, const char* type) {
    const std::uint64_t offset = bin_.size(), bytes = values.size() * sizeof(T);
    bin_.resize(offset + bytes);
    std::memcpy(bin_.data() + offset, values.data(), bytes);
    return accessor(view(offset, bytes), 0, component, type, values.size());
  }

  /// Mesh of a shape in a color, made at its first use.
  int meshOf(const Shape& shape, const Vec3& color) {
    const auto [number, isNew] = shapes_.of(shape);
    if (isNew) {
      const Surface surface = surfaceOf(shape, kPlaneSize);
      std::vector<Vec3f> points;
      std::vector<std::uint32_t> corners;
      Vec3f low = narrow(surface.points[0]), high = low;
      for (const Vec3& x : surface.points) {
        points.push_back(narrow(x));
        for (int k = 0; k < 3; ++k)
          low[k] = std::min(low[k], points.back()[k]), high[k] = std::max(high[k], points.back()[k]);
      }
      for (const auto& t : surface.triangles)
        for (const int corner : t) corners.push_back(static_cast<std::uint32_t>(corner));
      const int at = accessorOf(points, kFloat, "VEC3");
      json_["accessors"].back()["min"] = {low.x, low.y, low.z};
      json_["accessors"].back()["max"] = {high.x, high.y, high.z};
      geometry_.push_back({at, accessorOf(corners, kUnsignedInt, "SCALAR")});
    }
    const auto level = [&](double c) { return static_cast<int>(std::lround(c * (kColorLevels - 1))); };
    const std::array<int, 3> levels{level(color.x), level(color.y), level(color.z)};
    const auto [material, isNewMaterial] = materials_.try_emplace(levels,
                                                                  static_cast<int>(materials_.size()));
    if (isNewMaterial) {
      const auto share = [&](std::size_t k) { return levels[k] / (kColorLevels - 1.0); };
      json_["materials"].push_back(
          {{"pbrMetallicRoughness",
            {{"baseColorFactor", {share(0), share(1), share(2), 1}}, {"metallicFactor", 0}}}});
    }
    const auto [mesh, isNewMesh] = meshes_.try_emplace({number, material->second},
                                                       static_cast<int>(meshes_.size()));
    if (isNewMesh) {
      const auto& [points, corners] = geometry_[static_cast<std::size_t>(number)];
      json_["meshes"].push_back({{"primitives", Json::array({{{"attributes", {{"POSITION", points}}},
                                                              {"indices", corners},
                                                              {"material", material->second}}})}});
    }
    return mesh->second;
  }

  void makeScene() {
    json_ = {{"asset", {{"version", "2.0"}, {"generator", "Rubble"}}}, {"scene", 0}};
    json_["scenes"] = Json::array({{{"name", job_.source.header().scene}, {"nodes", {0}}}});
    json_["nodes"] = Json::array({{{"name", "scene"}, {"children", Json::array()}}});
    // Up is y in glTF.
    const double half = std::sqrt(0.5);
    if (upAxis(job_.source.header().gravity) == 2) json_["nodes"][0]["rotation"] = {-half, 0, 0, half};
    const int times = accessorOf(times_, kFloat, "SCALAR");
    json_["accessors"].back()["min"] = {times_.front()}, json_["accessors"].back()["max"] = {times_.back()};
    Json channels = Json::array(), samplers = Json::array();
    std::vector<std::pair<std::size_t, int>> animated;  // track and node
    for (const auto& [body, node] : nodes_) {
      const io::RecordedBody& from = cast().bodies[static_cast<std::size_t>(body)];
      const Prototype prototype = prototypeOf(from.shape);
      const int number = addNode({{"name", cast().bodyNames[static_cast<std::size_t>(body)]},
                                  {"mesh", meshOf(prototype.shape, node.color)},
                                  {"translation", {node.place.x, node.place.y, node.place.z}},
                                  {"rotation", node.turn}});
      const Vec3 s = prototype.scale;
      if (!(s == Vec3{1, 1, 1})) json_["nodes"].back()["scale"] = {s.x, s.y, s.z};
      if (const auto track = trackOf_.find(body); track != trackOf_.end()) {
        animated.emplace_back(track->second, number);
        addShown(tracks_[track->second], number, narrow(s), channels, samplers);
      }
    }
    if (job_.options.camera) addCamera(*job_.options.camera);
    if (animated.empty()) return;
    const std::uint64_t count = times_.size(), places = sizeof(Vec3f) * count, turns = sizeof(Quat4f) * count;
    const int placeView = view(bin_.size(), tracks_.size() * places);
    const int turnView = view(bin_.size() + tracks_.size() * places, tracks_.size() * turns);
    const auto channel = [&](int node, const char* path, int values, const char* way, int at) {
      channels.push_back({{"sampler", samplers.size()}, {"target", {{"node", node}, {"path", path}}}});
      samplers.push_back({{"input", at}, {"output", values}, {"interpolation", way}});
    };
    for (const auto& [track, node] : animated) {
      channel(node, "translation", accessor(placeView, track * places, kFloat, "VEC3", count), "LINEAR",
              times);
      channel(node, "rotation", accessor(turnView, track * turns, kFloat, "VEC4", count), "LINEAR", times);
    }
    json_["animations"] = Json::array(
        {{{"name", "recording"}, {"channels", channels}, {"samplers", samplers}}});
  }

  int addNode(Json node) {
    const int number = static_cast<int>(json_["nodes"].size());
    json_["nodes"].push_back(std::move(node));
    json_["nodes"][0]["children"].push_back(number);
    return number;
  }

  /// A body that is not there has the size 0.
  void addShown(const Track& track, int node, const Vec3f& size, Json& channels, Json& samplers) {
    if (track.shown.size() == 1 && track.shown[0].second) return;
    std::vector<float> at;
    std::vector<Vec3f> sizes;
    for (const auto& [time, isThere] : track.shown)
      at.push_back(time), sizes.push_back(isThere ? size : Vec3f());
    const int input = accessorOf(at, kFloat, "SCALAR");
    json_["accessors"].back()["min"] = {at.front()}, json_["accessors"].back()["max"] = {at.back()};
    channels.push_back({{"sampler", samplers.size()}, {"target", {{"node", node}, {"path", "scale"}}}});
    samplers.push_back(
        {{"input", input}, {"output", accessorOf(sizes, kFloat, "VEC3")}, {"interpolation", "STEP"}});
  }

  void addCamera(const ExportCamera& camera) {
    Vec3 up;
    up[upAxis(job_.source.header().gravity)] = 1;
    const Vec3 z = normalize(camera.eye - camera.target), x = normalize(cross(up, z), {1, 0, 0}),
               y = cross(z, x), e = camera.eye;
    const double distance = length(camera.eye - camera.target);
    json_["cameras"] = Json::array(
        {{{"type", "perspective"},
          {"perspective",
           {{"yfov", camera.fieldOfView}, {"znear", distance / 1000}, {"zfar", distance * 100}}}}});
    addNode({{"name", "camera"},
             {"camera", 0},
             {"matrix", {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, e.x, e.y, e.z, 1}}});
  }

  /// Half edge of squares that stand for planes [m].
  static constexpr double kPlaneSize = 100;

  ExportJob job_;
  io::OutputFile out_;
  ScratchFile rest_;
  std::fstream restFile_;
  std::vector<Block> blocks_;
  std::size_t written_ = 0;  ///< frames that are in blocks
  std::vector<float> times_;
  std::map<int, std::size_t> trackOf_;  ///< of moving bodies of the cast
  std::vector<Track> tracks_;
  std::map<int, Node> nodes_;  ///< of bodies of the cast, as they appear
  Json json_;
  std::vector<std::uint8_t> bin_;  ///< everything but tracks
  ShapeNumbers shapes_;
  std::vector<std::pair<int, int>> geometry_;  ///< accessors of points and corners of each shape
  std::map<std::array<int, 3>, int> materials_;
  std::map<std::pair<int, int>, int> meshes_;
};

}  // namespace

std::unique_ptr<FrameWriter> gltfWriter(const ExportJob& job) { return std::make_unique<GltfWriter>(job); }

}  // namespace rubble::convert
