#pragma once
/// Trajectory files: positions of all bodies and of the vertices of all deformable objects in every frame,
/// compressed. A file can be read from any frame on, and also after a run that was killed. A file is a
/// sequence of chunks, each with a checksum. HEAD describes the run, LOOK its appearance, if it has one. BODY
/// has the bodies and deformable objects of the frames that follow. FRAM has up to 32 frames. INDX at the end
/// lists the FRAM chunks, and a footer points to it. A file without an index is read by walking over its
/// chunks; a truncated last chunk is ignored. Files of version 1 have no deformable objects.
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <rubble/appearance.h>
#include <rubble/scene.h>
#include <rubble/world.h>

#include "io/picture_poses.h"

namespace rubble {
class Transport;
}

namespace rubble::io {

struct RecordingHeader {
  std::string scene;           ///< title of the run
  double dt = 1.0 / 60;        ///< time between two steps [s]
  Vec3 gravity;                ///< [m/s2]
  double resolution = 1e-5;    ///< positions are rounded to multiples of this from where a chunk of frames
                               ///< begins [m]
  Appearance appearance = {};  ///< with bodies by the index of their BodyId
};

struct RecordedBody {
  std::string name;
  Shape shape;
  Motion motion = Motion::Dynamic;
  BodyId id;

  friend bool operator==(const RecordedBody& a, const RecordedBody& b);
};

/// What is drawn of a deformable object. Triangles that tear and springs that break are gone.
struct RecordedSoft {
  std::string name;
  DeformableId id;
  int vertices = 0;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 2>> segments;
  double radius = 0;     ///< of segments and spheres [m]
  bool spheres = false;  ///< a ball at each vertex
  bool solid = false;    ///< its triangles are seen from outside only

  friend bool operator==(const RecordedSoft&, const RecordedSoft&) = default;
};

struct RecordedPose {
  Vec3 position;     ///< world [m], within half a resolution
  Quat orientation;  ///< body -> world, within 2e-6
};

struct RecordedFrame {
  std::int64_t step = 0;            ///< steps taken before this frame
  double time = 0;                  ///< [s]
  std::vector<RecordedPose> poses;  ///< in the order of the bodies
  std::vector<Vec3> vertices =
      {};  ///< of all deformable objects, one after the other; world [m], within half a resolution
};

class RecordingReader;
/// Bodies and deformable objects of a frame as they are drawn; speeds come from the frame before, or from the
/// one after the first.
std::vector<PictureBody> pictureBodies(RecordingReader& recording, int frameIndex);
/// How much of an incomplete recording is there, "120 frames (2.00 s) in 3.41 of 3.50 MB"; "" for a complete
/// one.
std::string remainder(RecordingReader& recording);
/// Throws Error unless the name ends in ".rubble", which is what readers know a recording by.
void requireRecordingName(const std::string& file);
/// The first frame that was taken after so many steps or more; the last one if there is none.
int frameAfter(RecordingReader& recording, std::int64_t steps);

/// The bodies, deformable objects and poses of a world as it is now.
std::vector<RecordedBody> recordedBodies(const World& world);
std::vector<RecordedSoft> recordedSofts(const World& world);
RecordedFrame recordedFrame(const World& world);
/// The same of poses and vertices alone, with the sources of World::epoch().
RecordedFrame recordedFrame(World& world, std::span<const PoseSource> sources);
/// A resolution that no picture shows: 2^-16 of the smallest dimension of a body, 2^-8 of the radius of a
/// deformable object [m].
double recordingResolution(const std::vector<RecordedBody>& bodies,
                           const std::vector<RecordedSoft>& softs = {});

/// What packs the frames of a recording. The bytes of the file do not depend on it.
struct RecordingOptions {
  int threads = 0;  ///< 0: one per core
  /// Between processes that have the same frames, and make the same calls in the same order: each packs its
  /// part of a chunk, and the first one writes the file. It must outlive the writer. Null: this process
  /// alone.
  Transport* transport = nullptr;
};

/// Writes a trajectory frame by frame. What was flushed survives whatever happens to the process. If one of
/// several processes fails, the others throw Error, too, which names its rank.
class RecordingWriter {
 public:
  /// Throws Error if the file cannot be written.
  RecordingWriter(const std::string& file, const RecordingHeader& header,
                  const RecordingOptions& options = {});
  /// Finishes the file of a single process; a failure is silent here, so call finish() where it matters.
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// `bodies` and `frame.poses` have one order and size, and `frame.vertices` are those of `softs`. The
  /// tables are written again only when they have changed.
  void write(const std::vector<RecordedBody>& bodies, const RecordedFrame& frame,
             const std::vector<RecordedSoft>& softs = {});
  /// Writes the last frames and the index. Throws Error if anything could not be written.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads a trajectory. Every call throws Error, with the file and the byte, on data that are not what was
/// written.
class RecordingReader {
 public:
  explicit RecordingReader(const std::string& file);
  ~RecordingReader();
  RecordingReader(RecordingReader&&) noexcept;
  RecordingReader& operator=(RecordingReader&&) noexcept;

  const RecordingHeader& header() const;
  /// False if the writer did not come to its end: the frames are those that had been written by then.
  bool complete() const;
  /// Size of the file, and of its part up to the end of the last whole chunk [bytes].
  std::uint64_t fileBytes() const;
  std::uint64_t intactBytes() const;
  int frameCount() const;
  RecordedFrame frame(int index);
  /// The same without a copy. It does not change while it is held.
  std::shared_ptr<const RecordedFrame> share(int index);
  /// The tables of a frame, without a look at its poses. Valid until the next call.
  const std::vector<RecordedBody>& bodies(int frameIndex);
  const std::vector<RecordedSoft>& softs(int frameIndex);
  /// Frames from which on bodies() or softs() differ from those of the frame before, in order; the first is
  /// 0.
  std::vector<int> changes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rubble::io
