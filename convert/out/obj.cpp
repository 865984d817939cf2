/// Recordings as Wavefront OBJ: a file for each frame, everything in world coordinates.
#include <cctype>
#include <charconv>
#include <filesystem>

#include <rubble/error.h>

#include "convert/out/frames.h"
#include "convert/out/prototypes.h"
#include "io/output_file.h"

namespace rubble::convert {
namespace {

struct NumberPlace {
  std::size_t begin = 0, end = std::string::npos, width = 0;
};
NumberPlace findNumber(const std::string& name) {
  for (std::size_t at = name.find('%'); at != std::string::npos; at = name.find('%', at + 1)) {
    std::size_t end = at + 1, width = 0;
    constexpr std::size_t kWidest = 9;
    for (; end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) && width <= kWidest;
         ++end)
      width = 10 * width + static_cast<std::size_t>(name[end] - '0');
    if (end < name.size() && name[end] == 'd') return {at, end + 1, width};
  }
  return {};
}

/// The name with the number in place of "%04d" or "%d"; the name itself if it has neither.
std::string numberedFile(const std::string& name, int number) {
  const auto [begin, end, width] = findNumber(name);
  if (end == std::string::npos) return name;
  std::string digits = std::to_string(number);
  digits.insert(0, width > digits.size() ? width - digits.size() : 0, '0');
  return name.substr(0, begin) + digits + name.substr(end);
}

class ObjWriter final : public FrameWriter {
 public:
  explicit ObjWriter(const ExportJob& job) : cast_(job.source.cast()), name_(job.file) {
    for (const io::RecordedBody& body : cast_.bodies) hasPlane_ |= body.shape.type == ShapeType::Plane;
    if (hasPlane_) job.notes.emplace_back("planes, which have no end, are left out");
    for (const io::RecordedSoft& soft : cast_.softs)
      if (soft.spheres) {
        job.notes.emplace_back("particles are points without a size");
        break;
      }
    if (!job.options.resume || !isNumbered(name_)) return;
    while (kept_ < job.source.count() && std::filesystem::exists(numberedFile(name_, kept_))) ++kept_;
  }
  int kept() const override { return kept_; }

  void write(const ExportFrame& frame) override {
    io::OutputFile out(numberedFile(name_, frame.number));
    std::size_t next = 1;  // vertices count from 1
    std::string text = "# " + std::to_string(frame.recorded->time) + " s\n";
    for (std::size_t row = 0; row < frame.bodies.size(); ++row) {
      const auto i = static_cast<std::size_t>(frame.bodies[row]);
      const Surface& surface = surfaceOfBody(i);
      if (surface.points.empty()) continue;
      text += "o " + cast_.bodyNames[i] + '\n';
      const io::RecordedPose& pose = frame.recorded->poses[row];
      for (const Vec3& x : surface.points) addVertex(text, pose.position + rotate(pose.orientation, x));
      for (const auto& t : surface.triangles) addIndices(text, 'f', t, next);
      next += surface.points.size();
      flush(text, out);
    }
    std::size_t first = 0;
    for (std::size_t k = 0; k < frame.softs.size(); ++k) {
      const io::RecordedSoft& look = frame.looks[k];
      const auto count = static_cast<std::size_t>(look.vertices);
      text += "o " + cast_.softNames[static_cast<std::size_t>(frame.softs[k])] + '\n';
      for (std::size_t v = 0; v < count; ++v) addVertex(text, frame.recorded->vertices[first + v]);
      for (const auto& t : look.triangles) addIndices(text, 'f', t, next);
      for (const auto& s : look.segments) addIndices(text, 'l', s, next);
      if (look.spheres)
        for (int v = 0; v < look.vertices; ++v) addIndices(text, 'p', std::array{v}, next);
      first += count, next += count;
      flush(text, out);
    }
    out.stream() << text;
    out.finish();
  }
  void finish() override {}

 private:
  static void flush(std::string& text, io::OutputFile& out) {
    constexpr std::size_t kBuffer = 1 << 16;
    if (text.size() < kBuffer) return;
    out.stream() << text;
    text.clear();
  }
  static void addVertex(std::string& text, const Vec3& x) {
    text += 'v';
    for (int axis = 0; axis < 3; ++axis) {
      char number[32];
      text += ' ';
      text.append(number, std::to_chars(number, number + sizeof number, static_cast<float>(x[axis])).ptr);
    }
    text += '\n';
  }
  template <std::size_t N>
  static void addIndices(std::string& text, char kind, const std::array<int, N>& corners, std::size_t first) {
    text += kind;
    for (const int corner : corners) text += ' ' + std::to_string(first + static_cast<std::size_t>(corner));
    text += '\n';
  }

  const Surface& surfaceOfBody(std::size_t body) {
    const Shape& shape = cast_.bodies[body].shape;
    const auto [number, isNew] = numbers_.of(shape);
    if (isNew) surfaces_.push_back(shape.type == ShapeType::Plane ? Surface() : surfaceOf(shape, 0));
    return surfaces_[static_cast<std::size_t>(number)];
  }

  const Cast& cast_;
  std::string name_;
  ShapeNumbers numbers_;
  std::vector<Surface> surfaces_;
  bool hasPlane_ = false;
  int kept_ = 0;
};

}  // namespace

bool isNumbered(const std::string& file) { return findNumber(file).end != std::string::npos; }

std::unique_ptr<FrameWriter> objWriter(const ExportJob& job) { return std::make_unique<ObjWriter>(job); }

}  // namespace rubble::convert
