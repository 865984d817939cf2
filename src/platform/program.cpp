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

namespace {

/// Keeps a write to a broken pipe from ending this program. Signals and handlers of its host stay as they
/// are.
class WithoutPipeSignal {
 public:
  WithoutPipeSignal() {
    sigemptyset(&pipe_), sigaddset(&pipe_, SIGPIPE);
    wasPending_ = isPending();
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~WithoutPipeSignal() {
    const int error = errno;
    int signal = 0;
    if (!wasPending_ && isPending()) sigwait(&pipe_, &signal);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    errno = error;
  }
  WithoutPipeSignal(const WithoutPipeSignal&) = delete;
  WithoutPipeSignal& operator=(const WithoutPipeSignal&) = delete;

 private:
  static bool isPending() {
    sigset_t pending;
    return sigpending(&pending) == 0 && sigismember(&pending, SIGPIPE) == 1;
  }

  sigset_t pipe_, before_;
  bool wasPending_;
};

}  // namespace

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
  std::vector<char*> raw;
  for (std::string& argument : arguments) raw.push_back(argument.data());
  raw.push_back(nullptr);
  int ends[2];
  if (pipe(ends) != 0) throw Error(program, "a pipe to it", std::strerror(errno));
  for (const int end : ends) fcntl(end, F_SETFD, FD_CLOEXEC);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  const int failed = posix_spawn(&child_, program.c_str(), &actions, nullptr, raw.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  pipe_ = ends[1];
  if (failed == 0) return;
  close(pipe_);
  throw Error(program, "a program that starts", std::strerror(failed));
}

bool Program::write(const void* bytes, std::size_t count) {
  const WithoutPipeSignal whole;
  const char* at = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t now = ::write(pipe_, at, count);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) break;
    at += now, count -= static_cast<std::size_t>(now);
  }
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
