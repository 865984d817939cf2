// Saves a game in the middle, goes on, loads it, and comes to the same end, bit for bit.
#include <rubble/rubble.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

namespace {

void save(const rubble::World& world, const char* file) {
  const std::vector<std::byte> bytes = world.snapshot().bytes();
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}

void load(rubble::World& world, const char* file) {
  std::ifstream in(file, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
  world.restore(rubble::Snapshot::fromBytes(std::as_bytes(std::span(bytes))));
}

rubble::Scene heap() {
  rubble::Scene scene;
  scene.bodies.emplace_back();
  scene.bodies[0].motion = rubble::Motion::Static;
  scene.bodies[0].shape = rubble::Shape::plane();
  for (int i = 0; i < 60; ++i) {
    rubble::BodyDef body;
    body.shape = i % 2 ? rubble::Shape::box({0.3, 0.2, 0.2}) : rubble::Shape::sphere(0.25);
    body.position = {0.1 * (i % 5), 0.13 * (i % 3), 0.5 + 0.5 * i};
    scene.bodies.push_back(body);
  }
  return scene;
}

}  // namespace

int main() {
  rubble::World world(heap());
  for (int step = 0; step < 60; ++step) world.step();
  save(world, "heap.save");
  for (int step = 0; step < 60; ++step) world.step();
  const std::uint64_t end = world.hash();

  // another world, as after a new start of the program
  rubble::World again{rubble::Scene{}};
  load(again, "heap.save");
  for (int step = 0; step < 60; ++step) again.step();
  std::printf("%s\n", again.hash() == end ? "the same bits" : "other bits");

  // files of another version, or damaged ones, are refused
  std::ofstream("heap.save", std::ios::binary) << "something else";
  try {
    load(again, "heap.save");
    return 1;
  } catch (const rubble::Error& error) {
    std::printf("%s\n", error.what());
  }
  std::remove("heap.save");
  return again.hash() == end ? 0 : 1;
}
