/// Recordings as USD: bodies as instances of their shapes, deformable objects as meshes, curves and points
/// with positions that change in time.
#include <bit>
#include <cmath>

#include <rubble/error.h>

#include "convert/out/frames.h"
#include "convert/out/prototypes.h"
#include "convert/out/usd_layer.h"

namespace rubble::convert {
namespace {

/// Half precision, to nearest; |value| below 2.
std::uint16_t toHalf(float value) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value), size = bits & 0x7fffffffu;
  constexpr std::uint32_t kSmallestNormal = 113u << 23;  // 2^-14
  // The last bit of numbers from this one up to twice that is the smallest half.
  constexpr float kRounding = 0.5f;
  const std::uint32_t small = std::bit_cast<std::uint32_t>(std::bit_cast<float>(size) + kRounding) -
                              std::bit_cast<std::uint32_t>(kRounding);
  const std::uint32_t normal = (size + 0xfffu + (size >> 13 & 1u) - (112u << 23)) >> 13;
  return static_cast<std::uint16_t>((bits >> 16 & 0x8000u) | (size < kSmallestNormal ? small : normal));
}

Vec3f narrow(const Vec3& v) { return Vec3f(v); }
template <class T> std::span<const T> spanOf(const std::vector<T>& values) { return values; }

class UsdWriter final : public FrameWriter {
 public:
  UsdWriter(const ExportJob& job, bool asText)
      : job_(job), layer_(asText ? textLayer(job.file) : binaryLayer(job.file)) {
    head_.yUp = upAxis(job.source.header().gravity) == 1;
    head_.rate = 1 / job.source.interval();
    head_.defaultPrim = "scene";
    head_.comment = job.source.header().scene;
    scene_ = layer_->prim(-1, "scene", "Xform");
    if (job.options.camera) addCamera(*job.options.camera);
  }

  void write(const ExportFrame& frame) override {
    const double time = frame.number;
    head_.last = time;
    if (frame.number == 0) {
      begin(frame);
    } else if (frame.newObjects && job_.source.cast().bodiesChange) {
      findRows(frame);
      for (Group* group : {&moving_, &still_}) sampleMembers(*group, frame, time);
    }
    samplePoses(moving_, frame, time);
    std::size_t first = 0;
    std::vector<bool> isThere(softs_.size(), false);
    for (std::size_t k = 0; k < frame.softs.size(); ++k) {
      const auto at = static_cast<std::size_t>(frame.softs[k]);
      isThere[at] = true;
      sampleSoft(softs_[at], frame, frame.looks[k], first, time);
      first += static_cast<std::size_t>(frame.looks[k].vertices);
    }
    if (frame.newObjects)
      for (std::size_t at = 0; at < softs_.size(); ++at)
        if (softs_[at].visibility >= 0)
          layer_->sample(softs_[at].visibility, time, Token{isThere[at] ? "inherited" : "invisible"});
  }

  void finish() override { layer_->finish(head_); }

 private:
  /// An instancer and its attributes.
  struct Group {
    bool moves = false;
    std::vector<std::size_t> rows;  ///< of the frame
    int prim = -1, indices = -1, ids = -1, scales = -1, colors = -1;
    int positions = -1, orientations = -1, fineOrientations = -1, velocities = -1;
  };
  struct Soft {
    int prim = -1, visibility = -1, points = -1, velocities = -1, widths = -1;
    int counts = -1, indices = -1;  ///< of the faces, or counts of the curves
    std::vector<std::array<int, 3>> triangles;
    std::vector<std::array<int, 2>> segments;
  };
  const Cast& cast() const { return job_.source.cast(); }

  void addCamera(const ExportCamera& camera) {
    Vec3 up;
    up[upAxis(job_.source.header().gravity)] = 1;
    const Vec3 back = normalize(camera.eye - camera.target), right = normalize(cross(up, back), {1, 0, 0}),
               top = cross(back, right);
    const Vec3& e = camera.eye;
    const int prim = layer_->prim(scene_, "camera", "Camera");
    const Matrix4 pose{right.x, right.y, right.z, 0, top.x, top.y, top.z, 0,
                       back.x,  back.y,  back.z,  0, e.x,   e.y,   e.z,   1};
    // A film of 24 mm height, in tenths of a unit.
    constexpr float kFilm = 24, kAspect = 16.f / 9;
    layer_->set(layer_->attribute(prim, "float", "focalLength"),
                static_cast<float>(kFilm / 2 / std::tan(camera.fieldOfView / 2)));
    layer_->set(layer_->attribute(prim, "float", "horizontalAperture"), kFilm * kAspect);
    layer_->set(layer_->attribute(prim, "float", "verticalAperture"), kFilm);
    const auto distance = static_cast<float>(length(camera.eye - camera.target));
    layer_->set(layer_->attribute(prim, "float2", "clippingRange"),
                std::array<float, 2>{distance / 1000, distance * 100});
    layer_->set(layer_->attribute(prim, "matrix4d", "xformOp:transform"), pose);
    const std::vector<Token> order{{"xformOp:transform"}};
    layer_->set(layer_->attribute(prim, "token[]", "xformOpOrder", "", true), spanOf(order));
  }

  /// Everything that the first frame decides: prims, prototypes, and what does not change.
  void begin(const ExportFrame& frame) {
    Vec3 low = frame.recorded->poses.empty() ? Vec3{} : frame.recorded->poses[0].position, high = low;
    for (const io::RecordedPose& pose : frame.recorded->poses)
      for (int axis = 0; axis < 3; ++axis)
        low[axis] = std::min(low[axis], pose.position[axis]),
        high[axis] = std::max(high[axis], pose.position[axis]);
    constexpr double kLeast = 10;
    planeSize_ = std::max(kLeast, 2 * length(high - low));
    isMoving_.reserve(cast().bodies.size());
    for (const io::RecordedBody& body : cast().bodies) isMoving_.push_back(body.motion != Motion::Static);
    colors_.resize(cast().bodies.size());
    knowsColor_.resize(cast().bodies.size());
    moving_.moves = true;
    findRows(frame);
    makeGroup(moving_, "moving"), makeGroup(still_, "still");
    for (const io::RecordedSoft& soft : cast().softs) addSoft(soft);
    for (Group* group : {&moving_, &still_}) {
      if (cast().bodiesChange)
        sampleMembers(*group, frame, 0);
      else
        setMembers(*group, frame);
    }
  }

  void makeGroup(Group& group, const std::string& name) {
    ShapeNumbers prototypes;
    std::vector<int> targets;
    int folder = -1;
    prototype_.resize(cast().bodies.size(), -1), scale_.resize(cast().bodies.size());
    for (std::size_t i = 0; i < cast().bodies.size(); ++i) {
      if (isMoving_[i] != group.moves) continue;
      if (group.prim < 0) {
        group.prim = layer_->prim(scene_, name, "PointInstancer");
        folder = layer_->prim(group.prim, "prototypes", "Scope");
      }
      const Prototype prototype = prototypeOf(cast().bodies[i].shape);
      const auto [number, isNew] = prototypes.of(prototype.shape);
      if (isNew) {
        const std::string kind = keyword(prototype.shape.type);
        targets.push_back(addShape(folder, kind + "_" + std::to_string(number), prototype.shape));
      }
      prototype_[i] = number, scale_[i] = narrow(prototype.scale);
    }
    if (group.prim < 0) return;
    layer_->relate(group.prim, "prototypes", targets);
    const auto attribute = [&](const char* type, const char* what, const char* each = "") {
      return layer_->attribute(group.prim, type, what, each);
    };
    group.indices = attribute("int[]", "protoIndices");
    group.ids = attribute("int64[]", "ids");
    group.scales = attribute("float3[]", "scales");
    group.colors = attribute("color3f[]", "primvars:displayColor", "varying");
    group.positions = attribute("point3f[]", "positions");
    group.orientations = attribute("quath[]", "orientations");
    group.fineOrientations = attribute("quatf[]", "orientationsf");
    if (group.moves) group.velocities = attribute("vector3f[]", "velocities");
  }

  int addShape(int parent, const std::string& name, const Shape& shape) {
    const Surface surface = surfaceOf(shape, planeSize_);
    const int prim = layer_->prim(parent, name, "Mesh");
    std::vector<Vec3f> points;
    for (const Vec3& x : surface.points) points.push_back(narrow(x));
    std::vector<int> counts(surface.triangles.size(), 3), corners;
    for (const auto& t : surface.triangles) corners.insert(corners.end(), t.begin(), t.end());
    layer_->set(layer_->attribute(prim, "point3f[]", "points"), spanOf(points));
    layer_->set(layer_->attribute(prim, "int[]", "faceVertexCounts"), spanOf(counts));
    layer_->set(layer_->attribute(prim, "int[]", "faceVertexIndices"), spanOf(corners));
    layer_->set(layer_->attribute(prim, "token", "subdivisionScheme", "", true), Token{"none"});
    return prim;
  }

  void findRows(const ExportFrame& frame) {
    moving_.rows.clear(), still_.rows.clear();
    for (std::size_t row = 0; row < frame.bodies.size(); ++row)
      (isMoving_[static_cast<std::size_t>(frame.bodies[row])] ? moving_ : still_).rows.push_back(row);
  }

  /// What belongs to each instance and does not move: given to `put` by attribute.
  template <class Put> void eachMember(const Group& group, const ExportFrame& frame, const Put& put) {
    std::vector<int> indices;
    std::vector<std::int64_t> ids;
    std::vector<Vec3f> scales, colors;
    for (const std::size_t row : group.rows) {
      const auto i = static_cast<std::size_t>(frame.bodies[row]);
      if (!knowsColor_[i]) {
        colors_[i] = narrow(job_.colorOf(cast().bodies[i], frame.recorded->poses[row]));
        knowsColor_[i] = true;
      }
      indices.push_back(prototype_[i]), ids.push_back(frame.bodies[row]);
      scales.push_back(scale_[i]), colors.push_back(colors_[i]);
    }
    put(group.indices, spanOf(indices)), put(group.ids, spanOf(ids));
    put(group.scales, spanOf(scales)), put(group.colors, spanOf(colors));
  }
  void setMembers(const Group& group, const ExportFrame& frame) {
    if (group.prim < 0) return;
    const auto put = [&](int attribute, const UsdValue& value) { layer_->set(attribute, value); };
    eachMember(group, frame, put);
    if (!group.moves) putPoses(group, frame, put);
  }
  void sampleMembers(const Group& group, const ExportFrame& frame, double time) {
    if (group.prim < 0) return;
    const auto put = [&](int attribute, const UsdValue& value) { layer_->sample(attribute, time, value); };
    eachMember(group, frame, put);
    if (!group.moves) putPoses(group, frame, put);
  }
  void samplePoses(const Group& group, const ExportFrame& frame, double time) {
    if (group.prim < 0) return;
    putPoses(group, frame,
             [&](int attribute, const UsdValue& value) { layer_->sample(attribute, time, value); });
  }

  template <class Put> void putPoses(const Group& group, const ExportFrame& frame, const Put& put) {
    const std::size_t count = group.rows.size();
    positions_.resize(count), velocities_.resize(count), orientations_.resize(count), halfs_.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      const io::RecordedPose& pose = frame.recorded->poses[group.rows[k]];
      const Vec3& v = pose.orientation.v;
      const Quat4f q{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z),
                     static_cast<float>(pose.orientation.s)};
      positions_[k] = narrow(pose.position), orientations_[k] = q;
      velocities_[k] = narrow(frame.velocity(group.rows[k]));
      halfs_[k] = {toHalf(q[0]), toHalf(q[1]), toHalf(q[2]), toHalf(q[3])};
    }
    put(group.positions, spanOf(positions_));
    put(group.orientations, spanOf(halfs_));
    put(group.fineOrientations, spanOf(orientations_));
    if (group.moves) put(group.velocities, spanOf(velocities_));
  }

  void addSoft(const io::RecordedSoft& soft) {
    const auto index = static_cast<std::size_t>(softs_.size());
    Soft& out = softs_.emplace_back();
    const std::string type = soft.spheres ? "Points" : soft.triangles.empty() ? "BasisCurves" : "Mesh";
    out.prim = layer_->prim(scene_, layer_->freeName(scene_, cast().softNames[index]), type);
    const auto attribute = [&](const char* kind, const char* name) {
      return layer_->attribute(out.prim, kind, name);
    };
    out.visibility = attribute("token", "visibility");
    out.points = attribute("point3f[]", "points");
    out.velocities = attribute("vector3f[]", "velocities");
    const std::vector<Vec3f> color{narrow(job_.colorOf(soft))};
    layer_->set(layer_->attribute(out.prim, "color3f[]", "primvars:displayColor", "constant"), spanOf(color));
    if (type == "Mesh") {
      out.counts = attribute("int[]", "faceVertexCounts");
      out.indices = attribute("int[]", "faceVertexIndices");
      layer_->set(layer_->attribute(out.prim, "token", "subdivisionScheme", "", true), Token{"none"});
      layer_->set(layer_->attribute(out.prim, "bool", "doubleSided", "", true), !soft.solid);
    } else {
      const std::vector<float> width{static_cast<float>(2 * soft.radius)};
      layer_->set(layer_->attribute(out.prim, "float[]", "widths", "constant"), spanOf(width));
    }
    if (type == "BasisCurves") {
      out.counts = attribute("int[]", "curveVertexCounts");
      layer_->set(layer_->attribute(out.prim, "token", "type", "", true), Token{"linear"});
    }
  }

  void sampleSoft(Soft& soft, const ExportFrame& frame, const io::RecordedSoft& look, std::size_t first,
                  double time) {
    positions_.clear(), velocities_.clear();
    const auto add = [&](std::size_t vertex) {
      positions_.push_back(narrow(frame.recorded->vertices[first + vertex]));
      velocities_.push_back(narrow(frame.vertexVelocity(first + vertex)));
    };
    if (soft.counts >= 0 && soft.indices < 0) {
      // A curve for each segment.
      for (const auto& segment : look.segments)
        for (const int vertex : segment) add(static_cast<std::size_t>(vertex));
    } else {
      for (std::size_t v = 0; v < static_cast<std::size_t>(look.vertices); ++v) add(v);
    }
    layer_->sample(soft.points, time, spanOf(positions_));
    layer_->sample(soft.velocities, time, spanOf(velocities_));
    if (!frame.newObjects) return;
    if (soft.indices >= 0 && (soft.triangles.empty() || soft.triangles != look.triangles)) {
      std::vector<int> counts(look.triangles.size(), 3), corners;
      for (const auto& t : look.triangles) corners.insert(corners.end(), t.begin(), t.end());
      layer_->sample(soft.counts, time, spanOf(counts));
      layer_->sample(soft.indices, time, spanOf(corners));
      soft.triangles = look.triangles;
    } else if (soft.counts >= 0 && soft.indices < 0 && soft.segments != look.segments) {
      const std::vector<int> counts(look.segments.size(), 2);
      layer_->sample(soft.counts, time, spanOf(counts));
      soft.segments = look.segments;
    }
  }

  ExportJob job_;
  std::unique_ptr<UsdLayer> layer_;
  UsdHead head_;
  int scene_ = -1;
  double planeSize_ = 1;  ///< half edge of squares that stand for planes [m]
  Group moving_, still_;
  std::vector<bool> isMoving_, knowsColor_;  ///< of the cast
  std::vector<int> prototype_;               ///< of the cast: number within the group
  std::vector<Vec3f> scale_, colors_;
  std::vector<Soft> softs_;
  std::vector<Vec3f> positions_, velocities_;  ///< of the frame at hand
  std::vector<Quat4f> orientations_;
  std::vector<Quat4h> halfs_;
};

}  // namespace

std::unique_ptr<FrameWriter> usdWriter(const ExportJob& job, bool asText) {
  return std::make_unique<UsdWriter>(job, asText);
}

}  // namespace rubble::convert
