#include "render/film.h"

#include <filesystem>
#include <regex>
#include <vector>

#include <rubble/error.h>

#include "io/output_file.h"
#include "platform/program.h"

namespace rubble::render {
namespace {

namespace fs = std::filesystem;

const std::regex kNumber("%0?([0-9]?)d");

class NumberedPictures final : public PictureSink {
 public:
  explicit NumberedPictures(std::string pattern) : pattern_(std::move(pattern)) {}
  void put(const io::Image& image) override {
    std::smatch found;
    std::regex_search(pattern_, found, kNumber);
    std::string number = std::to_string(next_++);
    const std::size_t digits = found[1].length() > 0 ? static_cast<std::size_t>(std::stoi(found[1])) : 0;
    if (number.size() < digits) number.insert(0, digits - number.size(), '0');
    io::writePng(image, found.prefix().str() + number + found.suffix().str());
  }

 private:
  std::string pattern_;
  int next_ = 0;
};

std::vector<std::string> ffmpegArguments(const std::string& file, int width, int height, double fps) {
  const std::string size = std::to_string(width) + "x" + std::to_string(height);
  std::vector<std::string> arguments{"ffmpeg", "-hide_banner", "-loglevel",         "error", "-y",
                                     "-f",     "rawvideo",     "-pixel_format",     "rgb24", "-video_size",
                                     size,     "-framerate",   std::to_string(fps), "-i",    "-"};
  const std::string extension = fs::path(file).extension().string();
  if (extension == ".mp4" || extension == ".mkv" || extension == ".mov") {
    // A file that every player shows, with the colors of the picture named in it.
    for (const char* a : {"-c:v", "libx264", "-preset", "medium", "-crf", "17", "-pix_fmt", "yuv420p", "-vf",
                          "scale=out_color_matrix=bt709:out_range=tv", "-colorspace", "bt709",
                          "-color_primaries", "bt709", "-color_trc", "bt709", "-movflags", "+faststart"})
      arguments.emplace_back(a);
  } else if (extension == ".jpg") {
    // update: one file of that name, which is no pattern for several
    for (const char* a : {"-frames:v", "1", "-update", "1", "-q:v", "4", "-pix_fmt", "yuvj444p"})
      arguments.emplace_back(a);
  } else if (extension == ".gif") {
    for (const char* a :
         {"-filter_complex",
          "[0:v]split[a][b];[a]palettegen=stats_mode=diff[p];[b][p]paletteuse=dither=sierra2_4a"})
      arguments.emplace_back(a);
  }
  // whatever the name begins with or holds, it is that of a file and neither an option nor an address
  arguments.push_back("file:" + file);
  return arguments;
}

class Film final : public PictureSink {
 public:
  Film(std::string file, const std::string& program, int width, int height, double fps)
      : file_(std::move(file)),
        name_(file_),
        width_(width),
        height_(height),
        program_(program, ffmpegArguments(name_.path(), width, height, fps)) {}

  void put(const io::Image& image) override {
    if (image.width != width_ || image.height != height_)
      throw Error(file_, "pictures of one size",
                  std::to_string(image.width) + "x" + std::to_string(image.height));
    if (!program_.write(image.rgb.data(), image.rgb.size())) fail();
  }

  void finish() override {
    if (program_.wait() != 0) fail();
    name_.keep();
  }

 private:
  [[noreturn]] void fail() {
    throw Error(file_, "a film that ffmpeg can write", "its exit status " + std::to_string(program_.wait()));
  }

  std::string file_;
  io::NewFile name_;
  int width_, height_;
  platform::Program program_;
};

/// The last picture alone, through `program` unless that is "".
class OnePicture final : public PictureSink {
 public:
  OnePicture(std::string file, std::string program) : file_(std::move(file)), program_(std::move(program)) {
    // now and not after the run
    const io::NewFile canBeWritten(file_);
  }
  void put(const io::Image& image) override { last_ = image; }
  void finish() override {
    if (last_.width == 0) return;
    if (program_.empty()) return io::writePng(last_, file_);
    Film picture(file_, program_, last_.width, last_.height, 1);
    picture.put(last_);
    picture.finish();
  }

 private:
  std::string file_, program_;
  io::Image last_;
};

std::string needFfmpeg(const std::string& file) {
  const std::string program = ffmpegProgram();
  if (program.empty())
    throw Error(file,
                "the ffmpeg program for a film (Debian, Ubuntu: apt-get install ffmpeg; or write pictures: "
                "frame_%04d.png)",
                "none on PATH");
  return program;
}

}  // namespace

bool isNumbered(const std::string& file) {
  return std::regex_search(file, kNumber) && fs::path(file).extension() == ".png";
}

bool isFilm(const std::string& file) {
  const std::string extension = fs::path(file).extension().string();
  return extension != ".png" && extension != ".jpg";
}

std::string ffmpegProgram() { return platform::findProgram("ffmpeg"); }

std::unique_ptr<PictureSink> pictureFile(const std::string& file) {
  if (isFilm(file)) throw Error(file, "the name of a .png or .jpg file for a picture", "another");
  return std::make_unique<OnePicture>(file, fs::path(file).extension() == ".jpg" ? needFfmpeg(file) : "");
}

std::unique_ptr<PictureSink> pictureSink(const std::string& file, int width, int height,
                                         double framesPerSecond) {
  if (isNumbered(file)) return std::make_unique<NumberedPictures>(file);
  if (!isFilm(file)) return pictureFile(file);
  const std::string extension = fs::path(file).extension().string();
  if (extension != ".mp4" && extension != ".mkv" && extension != ".mov" && extension != ".webm" &&
      extension != ".gif")
    throw Error(
        "--out",
        "a .png or .jpg, numbered pictures (frame_%04d.png) or a film (.mp4, .mkv, .mov, .webm, .gif)", file);
  if (width % 2 != 0 || height % 2 != 0)
    throw Error("--size", "even numbers for a film", std::to_string(width) + "x" + std::to_string(height));
  return std::make_unique<Film>(file, needFfmpeg(file), width, height, framesPerSecond);
}

}  // namespace rubble::render
