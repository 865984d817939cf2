#pragma once
/// Trajectory files and pictures.
#include <rubble/c/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Begins a trajectory file of a world. `resolution`: positions are rounded to multiples of it [m]; 0: one
/// that no picture shows.
RB_API rb_status rb_recorder_create(const rb_world* world, const char* file, const char* title,
                                    double resolution, rb_recorder** recorder);
/// Adds the present state of a world as a frame.
RB_API rb_status rb_recorder_write(rb_recorder* recorder, const rb_world* world);
/// Writes the last frames and the index.
RB_API rb_status rb_recorder_finish(rb_recorder* recorder);
/// Finishes the file if that has not been done.
RB_API void rb_recorder_destroy(rb_recorder* recorder);

RB_API rb_status rb_recording_open(const char* file, rb_recording** recording);
RB_API void rb_recording_close(rb_recording* recording);
/// "title", "dt", "gravity", "resolution", "complete" and "frames", as a JSON object.
RB_API rb_status rb_recording_info(const rb_recording* recording, const char** json);
RB_API rb_status rb_recording_frame(rb_recording* recording, int64_t index, rb_frame* frame);
/// Bodies and deformable objects of a frame, in the order of its poses and vertices, as a JSON object.
RB_API rb_status rb_recording_objects(rb_recording* recording, int64_t index, const char** json);

/// A painter draws the pictures of one world or recording. `options`: JSON object, or null: "width",
/// "height", "samples", "color_by", "full_value". It is used by the thread that made it. Fails if the build
/// or the machine has no OpenGL.
RB_API rb_status rb_painter_create(const char* options, rb_painter** painter);
RB_API void rb_painter_destroy(rb_painter* painter);
/// Draws a world as it is now. `camera` null: one that shows everything.
RB_API rb_status rb_painter_draw_world(rb_painter* painter, const rb_world* world, const rb_camera* camera,
                                       rb_image* image);
/// Draws a frame of a recording.
RB_API rb_status rb_painter_draw_frame(rb_painter* painter, rb_recording* recording, int64_t index,
                                       const rb_camera* camera, rb_image* image);
/// Writes a picture to a PNG file.
RB_API rb_status rb_write_png(const char* file, const uint8_t* rgb, int32_t width, int32_t height);

#ifdef __cplusplus
}
#endif
