#include "convert/out/frames.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <rubble/error.h>

#include <rubble/mesh.h>

namespace rubble::convert {
namespace {

constexpr Vec3 kGray{0.5, 0.5, 0.5};
/// Sides of a circle.
constexpr int kSegments = 24;

std::string uniqueName(std::string name, const std::string& kind, int index, std::set<std::string>& taken) {
  if (name.empty()) name = kind + "_" + std::to_string(index);
  std::string unique = name;
  for (int k = 2; !taken.insert(unique).second; ++k) unique = name + "_" + std::to_string(k);
  return unique;
}

}  // namespace

void FrameSource::findLooks(bool withLooks) {
  const std::vector<Look>& looks = recording_.header().appearance.looks;
  if (!withLooks || looks.empty()) return;
  for (const Look& look : looks) {
    if (look.body == kWorld) scenery_.push_back(&look);
    for (const io::RecordedBody& body : recording_.bodies(0))
      if (body.id.index == look.body) looks_[{body.id.index, body.id.generation}] = &look;
  }
}

FrameSource::Rows FrameSource::bodyRows(const std::vector<io::RecordedBody>& bodies) {
  Rows rows;
  const auto add = [&](const Id& id, int row, const io::RecordedBody& body, const Look* look) {
    const auto [at, isNew] = bodyNumbers_.try_emplace(id);
    for (std::size_t k = 0; k < (look ? look->parts.size() : 1); ++k) {
      const LookPart* const part = look ? &look->parts[k] : nullptr;
      if (isNew) {
        at->second.push_back(static_cast<int>(cast_.bodies.size()));
        CastBody& added = cast_.bodies.emplace_back(CastBody{body});
        if (part) added.shape = part->shape, added.color = part->color;
        cast_.bodyNames.push_back(uniqueName(body.name, "body", body.id.index, names_));
      }
      rows.bodies.push_back(at->second[k]);
      if (!looks_.empty() || !scenery_.empty()) rows.pieces.push_back({row, part});
    }
  };
  for (std::size_t k = 0; k < scenery_.size(); ++k) {
    const Id none{-1, static_cast<std::uint32_t>(k)};
    add(none, -1, {"scenery", {}, Motion::Static, {}}, scenery_[k]);
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Id id{bodies[i].id.index, bodies[i].id.generation};
    const auto look = looks_.find(id);
    add(id, static_cast<int>(i), bodies[i], look == looks_.end() ? nullptr : look->second);
  }
  return rows;
}

std::shared_ptr<const io::RecordedFrame> FrameSource::frameOf(int index) {
  std::shared_ptr<const io::RecordedFrame> frame = recording_.share(index);
  const std::vector<Piece>& pieces = rowsOf(index).pieces;
  if (pieces.empty()) return frame;
  const auto pieced = std::make_shared<io::RecordedFrame>();
  pieced->step = frame->step, pieced->time = frame->time, pieced->vertices = frame->vertices;
  for (const Piece& piece : pieces) {
    const io::RecordedPose body = piece.row < 0 ? io::RecordedPose{}
                                                : frame->poses[static_cast<std::size_t>(piece.row)];
    pieced->poses.push_back(body);
    if (!piece.part) continue;
    io::RecordedPose& pose = pieced->poses.back();
    pose.position += rotate(body.orientation, piece.part->position);
    pose.orientation = normalize(body.orientation * piece.part->orientation);
  }
  return pieced;
}

FrameSource::FrameSource(io::RecordingReader& recording, const ExportOptions& options, bool withLooks)
    : recording_(recording), from_(options.from), every_(options.every), changes_(recording.changes()) {
  const int last = options.to < 0 ? recording.frameCount() - 1 : options.to;
  if (every_ < 1) throw Error("--every", "a number of frames above 0", std::to_string(every_));
  if (from_ < 0 || from_ > last || last >= recording.frameCount())
    throw Error("--from, --to", "frames 0 to " + std::to_string(recording.frameCount() - 1),
                std::to_string(from_) + " to " + std::to_string(last));
  count_ = (last - from_) / every_ + 1;
  const int next = std::min(from_ + every_, recording.frameCount() - 1);
  interval_ = recording.frame(next).time - recording.frame(from_).time;
  if (!(interval_ > 0)) interval_ = recording.header().dt;

  findLooks(withLooks);
  std::map<Id, int> softNumber;
  std::set<std::string> softNames;
  std::vector<std::size_t> used;
  for (std::size_t k = 0; k < changes_.size(); ++k) {
    Rows& rows = rows_.emplace_back();
    if (changes_[k] > last) break;
    if (k + 1 < changes_.size() && changes_[k + 1] <= from_) continue;
    rows = bodyRows(recording.bodies(changes_[k]));
    for (const io::RecordedSoft& soft : recording.softs(changes_[k])) {
      const auto [at, isNew] = softNumber.try_emplace({soft.id.index, soft.id.generation},
                                                      static_cast<int>(cast_.softs.size()));
      if (isNew) {
        cast_.firstVertices.push_back(cast_.vertexCount);
        cast_.vertexCount += static_cast<std::size_t>(soft.vertices);
        cast_.softs.push_back(soft);
        cast_.softNames.push_back(uniqueName(soft.name, "deformable", soft.id.index, softNames));
      }
      rows.softs.push_back(at->second);
    }
    used.push_back(k);
  }
  for (const std::size_t k : used)
    cast_.bodiesChange = cast_.bodiesChange || rows_[k].bodies.size() != cast_.bodies.size();
}

const FrameSource::Rows& FrameSource::rowsOf(int index) {
  const auto next = std::upper_bound(changes_.begin(), changes_.end(), index);
  return rows_[static_cast<std::size_t>(next - changes_.begin()) - 1];
}

int FrameSource::neighborOf(int index) const {
  return index > 0 ? index - 1 : std::min(1, recording_.frameCount() - 1);
}

void FrameSource::read(int number, ExportFrame& out) {
  const int index = from_ + number * every_, other = neighborOf(index);
  const Rows& rows = rowsOf(index);
  // Frames that are read one by one have their neighbor.
  if (lastIndex_ != other) last_ = frameOf(other);
  out.recorded = frameOf(index);
  out.number = number;
  out.newObjects = number == 0 || &rows != &rowsOf(index - every_);
  out.bodies = rows.bodies, out.softs = rows.softs;
  measure(rowsOf(other), rows, out);
  last_ = out.recorded, lastIndex_ = index;
  if (!rows.softs.empty()) out.looks = recording_.softs(index);
}

void FrameSource::measure(const Rows& before, const Rows& rows, ExportFrame& out) const {
  const double apart = out.recorded->time - last_->time;
  // Rows are made for the exported frames alone.
  const bool hasRows = !before.bodies.empty() || !before.softs.empty();
  const bool sameVertices = before.softs == rows.softs &&
                            last_->vertices.size() == out.recorded->vertices.size();
  out.last = last_;
  out.bodyRate = apart == 0 || !hasRows ? 0 : 1 / apart;
  out.vertexRate = sameVertices ? out.bodyRate : 0;
  out.lastRows.clear();
  if (&before == &rows || before.bodies == rows.bodies) return;
  std::vector<int> rowOf(cast_.bodies.size(), -1);
  for (std::size_t i = 0; i < before.bodies.size(); ++i)
    rowOf[static_cast<std::size_t>(before.bodies[i])] = static_cast<int>(i);
  for (const int body : rows.bodies) out.lastRows.push_back(rowOf[static_cast<std::size_t>(body)]);
}

Vec3 ExportJob::colorOf(const CastBody& body, const io::RecordedPose& pose) const {
  if (!options.color) return kGray;
  io::PictureBody drawn{
      body.shape, pose.position, pose.orientation, 0, static_cast<std::uint32_t>(body.id.index), body.motion};
  drawn.color = body.color;
  return options.color(drawn);
}

Vec3 ExportJob::colorOf(const io::RecordedSoft& soft) const {
  if (!options.color) return kGray;
  io::PictureBody drawn;
  drawn.deforms = true;
  drawn.key = io::kSoftKeys | (static_cast<std::uint32_t>(soft.id.index) << io::kSoftKeyBits);
  return options.color(drawn);
}

int upAxis(const Vec3& gravity) { return std::fabs(gravity.y) > std::fabs(gravity.z) ? 1 : 2; }

Surface surfaceOf(const Shape& shape, double planeSize) {
  Surface out;
  if (shape.type == ShapeType::Plane) {
    const double h = planeSize;
    out.points = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
    out.triangles = {{0, 1, 2}, {0, 2, 3}};
    return out;
  }
  const ShapeMesh mesh = shapeMesh(shape, kSegments);
  std::map<std::array<double, 3>, int> numbers;
  std::vector<int> numberOf;
  for (const Vec3& x : mesh.points) {
    const auto [at, isNew] = numbers.try_emplace({x.x + 0.0, x.y + 0.0, x.z + 0.0},
                                                 static_cast<int>(out.points.size()));
    if (isNew) out.points.push_back(x);
    numberOf.push_back(at->second);
  }
  for (const std::array<int, 3>& t : mesh.triangles) {
    std::array<int, 3> own;
    for (std::size_t k = 0; k < 3; ++k) own[k] = numberOf[static_cast<std::size_t>(t[k])];
    if (own[0] != own[1] && own[1] != own[2] && own[2] != own[0]) out.triangles.push_back(own);
  }
  return out;
}

}  // namespace rubble::convert
