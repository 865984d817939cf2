#include "platform/program.h"

#include <rubble/error.h>

#if !defined(_WIN32)
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;
#endif

namespace rubble::platform {

#if defined(_WIN32)

std::string findProgram(const std::string&) { return ""; }
Program::Program(const std::string& program, std::vector<std::string>) {
  throw Error(program, "a system on which this build starts programs", "Windows");
}
bool Program::write(const void*, std::size_t) { return false; }
int Program::wait() { return status_; }

#else

std::string findProgram(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::string folders = path ? path : "";
  while (!folders.empty()) {
    const std::size_t end = folders.find(':');
    const std::string candidate = folders.substr(0, end) + "/" + name;
    if (access(candidate.c_str(), X_OK) == 0) return candidate;
    folders = end == std::string::npos ? "" : folders.substr(end + 1);
  }
  return "";
}

Program::Program(const std::string& program, std::vector<std::string> arguments) {
  int ends[2];
  if (pipe(ends) != 0) throw Error(program, "a pipe to it", std::strerror(errno));
  for (const int end : ends) fcntl(end, F_SETFD, FD_CLOEXEC);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  std::vector<char*> raw;
  for (std::string& argument : arguments) raw.push_back(argument.data());
  raw.push_back(nullptr);
  const int failed = posix_spawn(&child_, program.c_str(), &actions, nullptr, raw.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  pipe_ = ends[1];
  if (failed == 0) return;
  close(pipe_);
  throw Error(program, "a program that starts", std::strerror(failed));
}

bool Program::write(const void* bytes, std::size_t count) {
  // Without this a broken pipe would end this program.
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  const char* at = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t now = ::write(pipe_, at, count);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) break;
    at += now, count -= static_cast<std::size_t>(now);
  }
  std::signal(SIGPIPE, before);
  return count == 0;
}

int Program::wait() {
  if (child_ <= 0) return status_;
  close(pipe_);
  int raw = 0;
  while (waitpid(child_, &raw, 0) < 0 && errno == EINTR) {
  }
  child_ = 0;
  return status_ = WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
}

#endif

}  // namespace rubble::platform
