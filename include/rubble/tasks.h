#pragma once
#include <functional>

namespace rubble {

/// A scheduler of the host, which runs the loops of a world in place of the threads of the library. Results
/// have the same bits for any number of parts, in any order and on any threads.
struct TaskSystem {
  using Task = void (*)(void* context, int part);
  /// Parts of a loop, at least 1: as many as there are threads, or a small multiple.
  int parts = 1;
  /// Calls task(context, k) once for each k from 0 to count - 1 and returns when all calls have returned. It
  /// is called on the thread that calls the world. Tasks do not throw, do not wait for each other, and start
  /// no tasks. Empty: the library uses threads of its own.
  std::function<void(int count, Task task, void* context)> run = {};
};

}  // namespace rubble
