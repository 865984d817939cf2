#pragma once
/// Frames of a recording as exporters read them.
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "convert/out/export.h"

namespace rubble::convert {

/// A body, or a drawn part of one.
struct CastBody : io::RecordedBody {
  std::optional<Vec3> color = {};  ///< as PictureBody
};

/// All bodies and deformable objects of a recording, in the order in which they appear first.
struct Cast {
  std::vector<CastBody> bodies;
  std::vector<io::RecordedSoft> softs;
  std::vector<std::size_t> firstVertices;         ///< of each deformable object among the vertices of all
  std::size_t vertexCount = 0;                    ///< of all deformable objects
  bool bodiesChange = false;                      ///< do bodies come or go within the frames?
  std::vector<std::string> bodyNames, softNames;  ///< their own, or "body_12"; no two are equal
};

/// A frame. The rows of bodies and vertices are those of the recording.
struct ExportFrame {
  int number = 0;           ///< among those that are exported, from 0
  bool newObjects = false;  ///< the first frame, or one whose objects differ from those of the frame before
  std::shared_ptr<const io::RecordedFrame> recorded = {};  ///< a pose for each row, vertices of `softs`
  std::vector<int> bodies = {};                            ///< of each row, in Cast::bodies
  std::vector<int> softs = {};                             ///< in Cast::softs
  std::vector<io::RecordedSoft> looks = {};  ///< of `softs`, with the triangles and segments that are left

  /// What velocities are measured from: another frame, and one over the time since it; 0: they are zero
  /// [1/s].
  std::shared_ptr<const io::RecordedFrame> last = {};
  double bodyRate = 0, vertexRate = 0;
  std::vector<int> lastRows = {};  ///< of each row, in `last`; -1: its velocity is zero. Empty: the same rows

  /// Of the origin of the body of a row [m/s].
  Vec3 velocity(std::size_t row) const {
    const std::size_t before = lastRows.empty() ? row : static_cast<std::size_t>(lastRows[row]);
    if (bodyRate == 0 || before >= last->poses.size()) return {};
    return (recorded->poses[row].position - last->poses[before].position) * bodyRate;
  }
  /// Of a vertex [m/s].
  Vec3 vertexVelocity(std::size_t vertex) const {
    if (vertexRate == 0) return {};
    return (recorded->vertices[vertex] - last->vertices[vertex]) * vertexRate;
  }
};

/// Reads frames from first to last. Velocities are those since the recorded frame before; in the first frame
/// of the recording those until the next one. Bodies that just appeared have none.
class FrameSource {
 public:
  /// `withLooks`: bodies are the parts that are drawn of them. Throws Error for frames that the recording
  /// lacks.
  FrameSource(io::RecordingReader& recording, const ExportOptions& options, bool withLooks);

  const Cast& cast() const { return cast_; }
  const io::RecordingHeader& header() const { return recording_.header(); }
  int count() const { return count_; }
  /// Time from one frame to the next [s].
  double interval() const { return interval_; }
  /// Reads a frame into one that is not needed any more.
  void read(int number, ExportFrame& out);

 private:
  /// A part that is drawn: the row of its body in the recording, and its pose there.
  struct Piece {
    int row = -1;                    ///< -1: the world
    const LookPart* part = nullptr;  ///< null: the body as it is
  };
  struct Rows {
    std::vector<int> bodies, softs;
    std::vector<Piece> pieces;  ///< of `bodies`; empty: bodies as they are
  };
  void findLooks(bool withLooks);
  Rows bodyRows(const std::vector<io::RecordedBody>& bodies);
  /// A frame with a pose for each of its rows.
  std::shared_ptr<const io::RecordedFrame> frameOf(int index);
  const Rows& rowsOf(int index);
  /// The frame that velocities of another one are measured from.
  int neighborOf(int index) const;
  /// Velocities of a frame since `last_`, of which the rows are those of `before`.
  void measure(const Rows& before, const Rows& rows, ExportFrame& out) const;

  io::RecordingReader& recording_;
  int from_, every_, count_;
  double interval_ = 0;
  Cast cast_;
  using Id = std::pair<std::int32_t, std::uint32_t>;
  std::map<Id, const Look*> looks_;             ///< of bodies
  std::vector<const Look*> scenery_;            ///< of the world
  std::map<Id, std::vector<int>> bodyNumbers_;  ///< in Cast::bodies
  std::set<std::string> names_;                 ///< of these
  std::vector<int> changes_;
  std::vector<Rows> rows_;                         ///< of the tables that begin at each of `changes_`
  int lastIndex_ = -1;                             ///< of `last_`; -1: none
  std::shared_ptr<const io::RecordedFrame> last_;  ///< the frame that was read last, or a neighbor
};

/// Writes one format. Frames come in order.
class FrameWriter {
 public:
  virtual ~FrameWriter() = default;
  /// Frames at the start that are there already; the first to come is the next one.
  virtual int kept() const { return 0; }
  virtual void write(const ExportFrame& frame) = 0;
  virtual void finish() = 0;
};

/// What a writer is made with.
struct ExportJob {
  std::string file;
  const ExportOptions& options;
  const FrameSource& source;
  std::vector<std::string>& notes;

  Vec3 colorOf(const CastBody& body, const io::RecordedPose& pose) const;
  Vec3 colorOf(const io::RecordedSoft& soft) const;
};

std::unique_ptr<FrameWriter> usdWriter(const ExportJob& job, bool asText);
std::unique_ptr<FrameWriter> gltfWriter(const ExportJob& job);
std::unique_ptr<FrameWriter> objWriter(const ExportJob& job);
std::unique_ptr<FrameWriter> csvWriter(const ExportJob& job);
std::unique_ptr<FrameWriter> npzWriter(const ExportJob& job);

/// Does the name have a place for the number of a frame, "%d" or "%04d"?
bool isNumbered(const std::string& file);

/// The axis that gravity points along most, 1 (y) or 2 (z); 2 without gravity. Up is against it.
int upAxis(const Vec3& gravity);

/// The surface of a shape in its frame, triangles counter-clockwise from outside. Vertices at one place are
/// one. A plane is a square with a half edge of `planeSize` [m].
struct Surface {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
};
Surface surfaceOf(const Shape& shape, double planeSize);

}  // namespace rubble::convert
