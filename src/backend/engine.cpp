#include "backend/engine.h"

#include <cstring>

namespace rubble {

RayHitArrays Engine::castRays(const EngineRays&) { throw Error("rays", "host memory", "memory of a device"); }

std::uint64_t hashOf(Engine& engine) { return hashOf(engine.snapshot()->bytes()); }

std::uint64_t hashOf(std::span<const std::byte> state) {
  // FNV-1a over 64-bit words
  std::uint64_t h = 0xcbf29ce484222325ull;
  std::size_t i = 0;
  for (; i + 8 <= state.size(); i += 8) {
    std::uint64_t word;
    std::memcpy(&word, state.data() + i, 8);
    h = (h ^ word) * 0x100000001b3ull;
    h ^= h >> 32;
  }
  for (; i < state.size(); ++i) h = (h ^ static_cast<std::uint64_t>(state[i])) * 0x100000001b3ull;
  return h;
}

}  // namespace rubble
