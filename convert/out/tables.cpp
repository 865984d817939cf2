/// Recordings as tables: CSV and NumPy (.npz).
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include <rubble/error.h>

#include "convert/out/frames.h"
#include "convert/out/scratch.h"
#include "io/byte_stream.h"
#include "io/crc32.h"
#include "io/output_file.h"

namespace rubble::convert {
namespace {

constexpr const char* kColumns = "frame,step,time,object,vertex,x,y,z,qw,qx,qy,qz,vx,vy,vz\n";

template <class T> void addNumber(std::string& out, T value) {
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

class CsvWriter final : public FrameWriter {
 public:
  explicit CsvWriter(const ExportJob& job) : cast_(job.source.cast()), file_(job.file) {
    if (job.options.resume && std::filesystem::exists(job.file)) keepWholeFrames(job);
    out_.open(job.file, std::ios::binary | (kept_ > 0 ? std::ios::app : std::ios::trunc));
    if (kept_ == 0) out_ << kColumns;
    if (!out_) throw Error(job.file, "a file that can be written", "none");
  }
  int kept() const override { return kept_; }

  void write(const ExportFrame& frame) override {
    std::string text;
    const auto begin = [&](const std::string& object) {
      addNumber(text, frame.number), text += ',', addNumber(text, frame.recorded->step), text += ',';
      addNumber(text, frame.recorded->time), text += ',', addName(text, object), text += ',';
    };
    const auto add = [&](const Vec3& v) {
      for (int axis = 0; axis < 3; ++axis) text += ',', addNumber(text, static_cast<float>(v[axis]));
    };
    for (std::size_t row = 0; row < frame.bodies.size(); ++row) {
      begin(cast_.bodyNames[static_cast<std::size_t>(frame.bodies[row])]);
      const io::RecordedPose& pose = frame.recorded->poses[row];
      for (int axis = 0; axis < 3; ++axis) text += ',', addNumber(text, pose.position[axis]);
      const Quat& q = pose.orientation;
      text += ',', addNumber(text, static_cast<float>(q.s)), add(q.v), add(frame.velocity(row));
      text += '\n';
    }
    std::size_t first = 0;
    for (std::size_t k = 0; k < frame.softs.size(); ++k)
      for (int v = 0; v < frame.looks[k].vertices; ++v, ++first) {
        begin(cast_.softNames[static_cast<std::size_t>(frame.softs[k])]);
        addNumber(text, v);
        for (int axis = 0; axis < 3; ++axis)
          text += ',', addNumber(text, frame.recorded->vertices[first][axis]);
        text += ",,,,", add(frame.vertexVelocity(first)), text += '\n';
      }
    if (!out_.write(text.data(), static_cast<std::streamsize>(text.size())).flush())
      throw Error(file_, "to be written in full", "a disk that is full");
  }
  void finish() override {
    out_.close();
    if (!out_) throw Error(file_, "to be written in full", "a disk that is full");
  }

 private:
  static void addName(std::string& out, const std::string& name) {
    if (name.find_first_of(",\"\n\r") == std::string::npos) {
      out += name;
      return;
    }
    out += '"';
    for (const char c : name) out += c, out += c == '"' ? "\"" : "";
    out += '"';
  }

  /// Cuts the file off where its last frame begins, which may not be whole.
  void keepWholeFrames(const ExportJob& job) {
    std::ifstream in(job.file, std::ios::binary);
    std::string line;
    std::getline(in, line);
    if (line + "\n" != kColumns) return;
    std::uintmax_t at = line.size() + 1, begin = at;
    for (int frame = -1; std::getline(in, line) && !in.eof(); at += line.size() + 1) {
      int number = -1;
      std::from_chars(line.data(), line.data() + line.size(), number);
      if (number != frame) frame = number, begin = at;
      kept_ = frame;
    }
    in.close();
    if (kept_ <= 0 || kept_ >= job.source.count()) {
      kept_ = 0;
      return;
    }
    std::filesystem::resize_file(job.file, begin);
  }

  const Cast& cast_;
  std::string file_;
  std::ofstream out_;
  int kept_ = 0;
};

/// A member of an archive that grows with each frame, on the disk until the archive is written.
class Member {
 public:
  Member(const std::string& file, std::string name, std::string type, std::vector<std::size_t> shape)
      : name_(std::move(name)), part_(file), out_(part_.path(), std::ios::binary) {
    std::string tuple;
    for (const std::size_t n : shape) tuple += std::to_string(n) + ", ";
    std::string head = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + tuple + "), }";
    constexpr std::size_t kFixed = 10, kAlign = 64;
    head.append((kAlign - (kFixed + head.size() + 1) % kAlign) % kAlign, ' ');
    head += '\n';
    io::ByteWriter size;
    size.put(static_cast<std::uint16_t>(head.size()));
    add("\x93NUMPY\x01", 7), add("\0", 1);
    add(reinterpret_cast<const char*>(size.bytes().data()), 2);
    add(head.data(), head.size());
  }
  void add(const char* data, std::size_t bytes) {
    out_.write(data, static_cast<std::streamsize>(bytes));
    crc_ = io::crc32(data, bytes, crc_);
    size_ += bytes;
  }
  template <class T> void add(const std::vector<T>& values) {
    add(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }

  /// Local entry of the archive, at `offset`; returns its size.
  std::uint64_t copyTo(std::ostream& out, std::uint64_t offset) {
    offset_ = offset;
    out_.close();
    io::ByteWriter head;
    head.put(kLocal), putCommon(head);
    head.put(static_cast<std::uint16_t>(name_.size())), head.put(std::uint16_t{20});
    const std::vector<std::uint8_t> extra = sizesExtra(false);
    write(out, head.bytes());
    out << name_;
    write(out, extra);
    std::ifstream in(part_.path(), std::ios::binary);
    // not `out << in.rdbuf()`, which says nothing of a write that fails after the first
    std::vector<char> piece(1 << 16);
    std::uint64_t copied = 0;
    while (out && in.read(piece.data(), std::ssize(piece)).gcount() > 0) {
      out.write(piece.data(), in.gcount());
      copied += static_cast<std::uint64_t>(in.gcount());
    }
    if (!out_ || copied != size_) out.setstate(std::ios::failbit);
    return head.bytes().size() + name_.size() + extra.size() + size_;
  }
  /// Entry of the directory; returns its size.
  std::uint64_t listIn(std::ostream& out) const {
    io::ByteWriter head;
    head.put(kCentral), head.put(kVersion), putCommon(head);
    head.put(static_cast<std::uint16_t>(name_.size())), head.put(std::uint16_t{28});
    head.put(std::uint16_t{0}), head.put(std::uint16_t{0}), head.put(std::uint16_t{0});
    head.put(std::uint32_t{0}), head.put(kElsewhere);
    const std::vector<std::uint8_t> extra = sizesExtra(true);
    write(out, head.bytes());
    out << name_;
    write(out, extra);
    return head.bytes().size() + name_.size() + extra.size();
  }
  static void write(std::ostream& out, const std::vector<std::uint8_t>& bytes) {
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }

  static constexpr std::uint32_t kLocal = 0x04034b50, kCentral = 0x02014b50, kElsewhere = 0xffffffff;
  static constexpr std::uint16_t kVersion = 45;  // with sizes of 64 bits

 private:
  /// Version to 32-bit sizes, which say that those of 64 bits follow.
  void putCommon(io::ByteWriter& head) const {
    constexpr std::uint16_t kFirstDay = 1 << 5 | 1;  // 1 January 1980
    head.put(kVersion), head.put(std::uint16_t{0}), head.put(std::uint16_t{0});
    head.put(std::uint16_t{0}), head.put(kFirstDay);
    head.put(static_cast<std::uint32_t>(crc_)), head.put(kElsewhere), head.put(kElsewhere);
  }
  std::vector<std::uint8_t> sizesExtra(bool withOffset) const {
    io::ByteWriter extra;
    extra.put(std::uint16_t{1}), extra.put(static_cast<std::uint16_t>(withOffset ? 24 : 16));
    extra.put(size_), extra.put(size_);
    if (withOffset) extra.put(offset_);
    return extra.bytes();
  }

  std::string name_;
  ScratchFile part_;
  std::ofstream out_;
  std::uint32_t crc_ = 0;
  std::uint64_t size_ = 0, offset_ = 0;
};

/// Rows are those of the cast; a body that is not there is NaN.
class NpzWriter final : public FrameWriter {
 public:
  explicit NpzWriter(const ExportJob& job) : cast_(job.source.cast()), out_(job.file) {
    const auto frames = static_cast<std::size_t>(job.source.count());
    const std::size_t bodies = cast_.bodies.size(), vertices = cast_.vertexCount;
    const auto member = [&](const char* name, const char* type, const std::vector<std::size_t>& shape) {
      members_.push_back(std::make_unique<Member>(job.file, std::string(name) + ".npy", type, shape));
      return members_.back().get();
    };
    addNames("names", cast_.bodyNames, job), addNames("deformables", cast_.softNames, job);
    std::vector<std::int64_t> firsts(cast_.firstVertices.begin(), cast_.firstVertices.end());
    firsts.push_back(static_cast<std::int64_t>(vertices));
    member("first_vertices", "<i8", {firsts.size()})->add(firsts);
    step_ = member("step", "<i8", {frames}), time_ = member("time", "<f8", {frames});
    positions_ = member("positions", "<f8", {frames, bodies, 3});
    orientations_ = member("orientations", "<f4", {frames, bodies, 4});
    velocities_ = member("velocities", "<f4", {frames, bodies, 3});
    vertices_ = member("vertices", "<f8", {frames, vertices, 3});
    vertexVelocities_ = member("vertex_velocities", "<f4", {frames, vertices, 3});
  }

  void write(const ExportFrame& frame) override {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    constexpr float kNoneF = std::numeric_limits<float>::quiet_NaN();
    step_->add(std::vector{frame.recorded->step}), time_->add(std::vector{frame.recorded->time});
    std::vector<Vec3> places(cast_.bodies.size(), {kNone, kNone, kNone});
    std::vector<Vec3T<float>> speeds(cast_.bodies.size(), {kNoneF, kNoneF, kNoneF});
    std::vector<std::array<float, 4>> turns(cast_.bodies.size(), {kNoneF, kNoneF, kNoneF, kNoneF});
    for (std::size_t row = 0; row < frame.bodies.size(); ++row) {
      const auto i = static_cast<std::size_t>(frame.bodies[row]);
      const Quat& q = frame.recorded->poses[row].orientation;
      places[i] = frame.recorded->poses[row].position, speeds[i] = Vec3T<float>(frame.velocity(row));
      turns[i] = {static_cast<float>(q.s), static_cast<float>(q.v.x), static_cast<float>(q.v.y),
                  static_cast<float>(q.v.z)};
    }
    positions_->add(places), orientations_->add(turns), velocities_->add(speeds);
    places.assign(cast_.vertexCount, {kNone, kNone, kNone});
    speeds.assign(cast_.vertexCount, {kNoneF, kNoneF, kNoneF});
    std::size_t from = 0;
    for (std::size_t k = 0; k < frame.softs.size(); ++k) {
      std::size_t to = cast_.firstVertices[static_cast<std::size_t>(frame.softs[k])];
      for (int v = 0; v < frame.looks[k].vertices; ++v, ++from, ++to)
        places[to] = frame.recorded->vertices[from], speeds[to] = Vec3T<float>(frame.vertexVelocity(from));
    }
    vertices_->add(places), vertexVelocities_->add(speeds);
  }

  void finish() override {
    std::ostream& out = out_.stream();
    std::uint64_t at = 0, listed = 0;
    for (const auto& member : members_) at += member->copyTo(out, at);
    for (const auto& member : members_) listed += member->listIn(out);
    const auto count = static_cast<std::uint64_t>(members_.size());
    io::ByteWriter end;
    end.put(std::uint32_t{0x06064b50}), end.put(std::uint64_t{44});
    end.put(Member::kVersion), end.put(Member::kVersion), end.put(std::uint32_t{0}),
        end.put(std::uint32_t{0});
    end.put(count), end.put(count), end.put(listed), end.put(at);
    end.put(std::uint32_t{0x07064b50}), end.put(std::uint32_t{0}), end.put(at + listed);
    end.put(std::uint32_t{1});
    end.put(std::uint32_t{0x06054b50}), end.put(std::uint16_t{0}), end.put(std::uint16_t{0});
    end.put(static_cast<std::uint16_t>(count)), end.put(static_cast<std::uint16_t>(count));
    end.put(Member::kElsewhere), end.put(Member::kElsewhere), end.put(std::uint16_t{0});
    Member::write(out, end.bytes());
    out_.finish();
  }

 private:
  /// Fixed-width bytes of UTF-8, which NumPy reads as bytes.
  void addNames(const char* name, const std::vector<std::string>& names, const ExportJob& job) {
    std::size_t width = 1;
    for (const std::string& one : names) width = std::max(width, one.size());
    members_.push_back(std::make_unique<Member>(job.file, std::string(name) + ".npy",
                                                "|S" + std::to_string(width), std::vector{names.size()}));
    for (std::string one : names) {
      one.resize(width, '\0');
      members_.back()->add(one.data(), one.size());
    }
  }

  const Cast& cast_;
  io::OutputFile out_;
  std::vector<std::unique_ptr<Member>> members_;
  Member *step_, *time_, *positions_, *orientations_, *velocities_, *vertices_, *vertexVelocities_;
};

}  // namespace

std::unique_ptr<FrameWriter> csvWriter(const ExportJob& job) { return std::make_unique<CsvWriter>(job); }
std::unique_ptr<FrameWriter> npzWriter(const ExportJob& job) { return std::make_unique<NpzWriter>(job); }

}  // namespace rubble::convert
