#pragma once
/// Sinks of the pictures of a run: one file, numbered files, or a film.
#include <memory>
#include <string>

#include "io/picture.h"

namespace rubble::render {

class PictureSink {
 public:
  virtual ~PictureSink() = default;
  /// Pictures of one sink have one size.
  virtual void put(const io::Image& image) = 0;
  /// Finishes the files. Throws Error if not all of them could be written.
  virtual void finish() {}
};

/// A .png or .jpg (by the ffmpeg program) that keeps the last picture. Throws Error for another name, and
/// if the file cannot be written.
std::unique_ptr<PictureSink> pictureFile(const std::string& file);
/// By the name: "frame_%04d.png" numbers pictures from 0, another .png or .jpg is a pictureFile, everything
/// else is a film that the ffmpeg program writes (.mp4, .mkv, .webm, .gif). Throws Error for a film if that
/// program is missing or the size is odd.
std::unique_ptr<PictureSink> pictureSink(const std::string& file, int width, int height,
                                         double framesPerSecond);

/// Will this file be a film?
bool isFilm(const std::string& file);
/// Does this name stand for numbered files?
bool isNumbered(const std::string& file);
/// The ffmpeg program on PATH, or "".
std::string ffmpegProgram();

}  // namespace rubble::render
