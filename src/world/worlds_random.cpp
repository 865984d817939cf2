/// Random numbers of worlds: hashes, so that no draw depends on another.
#include <cmath>

#include "cook/checks.h"
#include "world/worlds_impl.h"

namespace rubble {

namespace {

constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15u;

/// The finalizer of SplitMix64.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
  x = (x ^ x >> 27) * 0x94D049BB133111EBu;
  return x ^ x >> 31;
}
/// A seed of a part of what has another seed.
std::uint64_t seedOfPart(std::uint64_t seed, std::uint64_t part) {
  return mixed((seed + kGolden) ^ mixed(part + kGolden));
}

}  // namespace

RandomState Worlds::Impl::firstRandomState(std::uint64_t seed, int world) {
  return {seedOfPart(seed, static_cast<std::uint64_t>(world))};
}

void Worlds::setSeed(std::uint64_t seed) {
  impl_->seed = seed;
  for (int w = 0; w < count(); ++w)
    impl_->random[static_cast<std::size_t>(w)] = Impl::firstRandomState(seed, w);
}

void Worlds::setSeed(std::uint64_t seed, std::span<const int> worlds) {
  for (const int w : worlds) impl_->requireWorld(w);
  for (const int w : worlds) impl_->random[static_cast<std::size_t>(w)] = Impl::firstRandomState(seed, w);
}

RandomState Worlds::randomState(int world) const {
  impl_->requireWorld(world);
  return impl_->random[static_cast<std::size_t>(world)];
}

void Worlds::setRandomState(int world, const RandomState& state) {
  impl_->requireWorld(world);
  if (state.episode < 0)
    throw Error("state.episode", "a number of at least 0", std::to_string(state.episode));
  if (state.drawn < 0) throw Error("state.drawn", "a number of at least 0", std::to_string(state.drawn));
  impl_->random[static_cast<std::size_t>(world)] = state;
}

std::vector<double> Worlds::uniform(std::span<const int> worlds, int count, double low, double high) {
  impl_->requireDistinct(worlds);
  if (count < 0) throw Error("count", "a number of at least 0", std::to_string(count));
  checks::finite(low, "low");
  if (!(low <= high) || !std::isfinite(high - low))
    throw Error("high", "a finite number of at least low, " + checks::text(low), checks::text(high));
  std::vector<double> out;
  out.reserve(worlds.size() * static_cast<std::size_t>(count));
  for (const int w : worlds) {
    RandomState& state = impl_->random[static_cast<std::size_t>(w)];
    const std::uint64_t seed = seedOfPart(state.seed, static_cast<std::uint64_t>(state.episode));
    for (int k = 0; k < count; ++k) {
      const std::uint64_t bits = mixed(seed + kGolden * static_cast<std::uint64_t>(++state.drawn));
      out.push_back(low + (high - low) * (static_cast<double>(bits >> 11) * 0x1p-53));
    }
  }
  return out;
}

}  // namespace rubble
