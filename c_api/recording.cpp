#include <rubble/c/recording.h>

#include "c_api/handles.h"
#include "c_api/recorded.h"
#include "io/body_reader.h"
#include "io/json_text.h"
#include "io/shape_json.h"

using namespace rubble;
using namespace rubble::c;
using Ordered = nlohmann::ordered_json;

namespace rubble::c {

int frameIndex(io::RecordingReader& reader, std::int64_t index) {
  if (index < 0 || index >= reader.frameCount())
    throw Error("index", "a frame, 0 to " + std::to_string(reader.frameCount() - 1), std::to_string(index));
  return static_cast<int>(index);
}

}  // namespace rubble::c

extern "C" {

rb_status rb_recorder_create(const rb_world* world, const char* file, const char* title, double resolution,
                             rb_recorder** recorder) {
  return guarded([&] {
    const World& recorded = worldOf(world);
    io::requireRecordingName(textOr(file, ""));
    io::RecordingHeader header;
    header.scene = textOr(title, "");
    header.dt = recorded.params().dt;
    header.gravity = recorded.gravity();
    header.appearance = world->appearance;
    header.resolution = resolution > 0 ? resolution
                                       : io::recordingResolution(io::recordedBodies(recorded),
                                                                 io::recordedSofts(recorded));
    need(recorder,
         "recorder") = new rb_recorder{std::make_unique<io::RecordingWriter>(textOr(file, ""), header)};
  });
}

rb_status rb_recorder_write(rb_recorder* recorder, const rb_world* world) {
  return guarded([&] {
    const World& recorded = worldOf(world);
    need(recorder, "recorder")
        .writer->write(io::recordedBodies(recorded), io::recordedFrame(recorded),
                       io::recordedSofts(recorded));
  });
}

rb_status rb_recorder_finish(rb_recorder* recorder) {
  return guarded([&] { need(recorder, "recorder").writer->finish(); });
}

void rb_recorder_destroy(rb_recorder* recorder) { delete recorder; }

rb_status rb_recording_open(const char* file, rb_recording** recording) {
  return guarded(
      [&] { need(recording, "recording") = new rb_recording{io::RecordingReader(textOr(file, ""))}; });
}

void rb_recording_close(rb_recording* recording) { delete recording; }

rb_status rb_recording_info(const rb_recording* recording, const char** json) {
  return guarded([&] {
    const io::RecordingReader& reader = need(recording, "recording").reader;
    const io::RecordingHeader& header = reader.header();
    const Ordered info{{"title", header.scene},
                       {"dt", header.dt},
                       {"gravity", {header.gravity.x, header.gravity.y, header.gravity.z}},
                       {"resolution", header.resolution},
                       {"complete", reader.complete()},
                       {"frames", reader.frameCount()},
                       {"file_bytes", reader.fileBytes()},
                       {"intact_bytes", reader.intactBytes()}};
    need(json, "json") = keepText(info.dump());
  });
}

rb_status rb_recording_frame(rb_recording* recording, int64_t index, rb_frame* frame) {
  return guarded([&] {
    rb_recording& from = need(recording, "recording");
    from.frame = from.reader.frame(frameIndex(from.reader, index));
    from.poses.clear(), from.vertices.clear();
    for (const io::RecordedPose& pose : from.frame.poses) {
      rb_pose& out = from.poses.emplace_back();
      store(pose.position, out.position), store(pose.orientation, out.orientation);
    }
    for (const Vec3& v : from.frame.vertices) from.vertices.insert(from.vertices.end(), {v.x, v.y, v.z});
    need(frame, "frame") = {from.frame.step,      from.frame.time,
                            from.poses.data(),    static_cast<int64_t>(from.poses.size()),
                            from.vertices.data(), static_cast<int64_t>(from.vertices.size() / 3)};
  });
}

rb_status rb_recording_objects(rb_recording* recording, int64_t index, const char** json) {
  return guarded([&] {
    io::RecordingReader& reader = need(recording, "recording").reader;
    const int frame = frameIndex(reader, index);
    Ordered out{{"bodies", Ordered::array()}, {"deformables", Ordered::array()}};
    for (const io::RecordedBody& body : reader.bodies(frame))
      out["bodies"].push_back({{"name", body.name},
                               {"id", idJson(body.id)},
                               {"motion", io::motionNames()[static_cast<std::size_t>(body.motion)]},
                               {"shape", io::shapeJson(body.shape)}});
    for (const io::RecordedSoft& soft : reader.softs(frame))
      out["deformables"].push_back({{"name", soft.name},
                                    {"id", idJson(soft.id)},
                                    {"vertices", soft.vertices},
                                    {"triangles", soft.triangles},
                                    {"segments", soft.segments},
                                    {"radius", soft.radius},
                                    {"spheres", soft.spheres}});
    need(json, "json") = keepText(out.dump());
  });
}
}
