#include "render/film.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <regex>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <rubble/error.h>

#include "io/output_file.h"

extern char** environ;

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
      : file_(std::move(file)), name_(file_), width_(width), height_(height) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw Error(file_, "a pipe to ffmpeg", std::strerror(errno));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    std::vector<std::string> arguments = ffmpegArguments(name_.path(), width, height, fps);
    std::vector<char*> raw;
    for (std::string& argument : arguments) raw.push_back(argument.data());
    raw.push_back(nullptr);
    const int failed = posix_spawn(&child_, program.c_str(), &actions, nullptr, raw.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    pipe_ = ends[1];
    if (failed != 0) throw Error(program, "a program that starts", std::strerror(failed));
  }

  ~Film() override { wait(); }

  void put(const io::Image& image) override {
    if (image.width != width_ || image.height != height_)
      throw Error(file_, "pictures of one size",
                  std::to_string(image.width) + "x" + std::to_string(image.height));
    // Without this a broken pipe would end this program.
    const auto before = std::signal(SIGPIPE, SIG_IGN);
    std::size_t sent = 0;
    while (sent < image.rgb.size()) {
      const ssize_t now = write(pipe_, image.rgb.data() + sent, image.rgb.size() - sent);
      if (now < 0 && errno == EINTR) continue;
      if (now <= 0) break;
      sent += static_cast<std::size_t>(now);
    }
    std::signal(SIGPIPE, before);
    if (sent < image.rgb.size()) throw Error(file_, "a film that ffmpeg can write", failure());
  }

  void finish() override {
    const int status = wait();
    if (status != 0)
      throw Error(file_, "a film that ffmpeg can write", "its exit status " + std::to_string(status));
    name_.keep();
  }

 private:
  std::string failure() { return "its exit status " + std::to_string(wait()); }

  /// Closes the film and gives the exit status of the program.
  int wait() {
    if (child_ <= 0) return status_;
    close(pipe_);
    int raw = 0;
    while (waitpid(child_, &raw, 0) < 0 && errno == EINTR) {
    }
    child_ = 0;
    return status_ = WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
  }

  std::string file_;
  io::NewFile name_;
  int width_, height_;
  pid_t child_ = 0;
  int pipe_ = -1;
  int status_ = 0;
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

std::string ffmpegProgram() {
  const char* path = std::getenv("PATH");
  std::string folders = path ? path : "";
  while (!folders.empty()) {
    const std::size_t end = folders.find(':');
    const fs::path candidate = fs::path(folders.substr(0, end)) / "ffmpeg";
    if (access(candidate.c_str(), X_OK) == 0) return candidate.string();
    folders = end == std::string::npos ? "" : folders.substr(end + 1);
  }
  return "";
}

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
