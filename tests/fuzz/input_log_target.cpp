/// Logs of inputs. A replay ends with an Error that has a line, or it is faithful: the log of the replay
/// replays to the same bits, and is written again with the same bytes. An Error changes nothing: the other
/// lines replay without its line.
///
/// The input is the text of a log, or chooses and changes lines of a log that has every call. Hashes of
/// worlds that the engine has not seen are unknown, so these logs name no tables. That of their replay has
/// all hashes.
#include <fstream>
#include <iterator>
#include <sstream>

#include <nlohmann/json.hpp>

#include <rubble/rubble.h>

#include "io/input_log.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/scratch_file.h"
#include "tests/fuzz/target.h"

namespace rubble::fuzz {
namespace {

using Ordered = nlohmann::ordered_json;

constexpr int kMostLines = 24, kMostSteps = 4, kMostErrors = 3;
constexpr int kMostIterations = 8, kMostSubsteps = 3;
constexpr std::size_t kMostBodies = 48;

std::string contentOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::vector<std::string> linesOf(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}
const std::string& scratch(int which) {
  static const ScratchFile files[] = {ScratchFile(".inputs"), ScratchFile(".first"), ScratchFile(".second")};
  return files[which].path;
}

Scene smallScene() {
  Scene scene;
  scene.bodies.resize(4);
  scene.bodies[0].motion = Motion::Static;
  scene.bodies[0].shape = Shape::plane();
  for (int i = 1; i < 4; ++i) scene.bodies[static_cast<std::size_t>(i)].position = {1.2 * i, 0, .5};
  scene.bodies[2].shape = Shape::sphere(.4);
  scene.bodies[3].name = "named";
  scene.joints = {jointAt(scene, JointType::Hinge, 2, 3, {3, 0, .5})};
  scene.deformables = {clothSheet({0, 2, .2}, {1, 0, 0}, {0, 1, 0}, 1, 1)};
  return scene;
}

/// Every call that changes a world.
void changeInEveryWay(World& world) {
  const std::vector<BodyId> ids = world.bodies();
  const DeformableId cloth = world.deformableAt(0);
  BodyDef pusher;
  pusher.motion = Motion::Kinematic;
  pusher.position = {-1, 0, .5};
  const BodyId kinematic = world.addBody(pusher);
  world.setTarget(kinematic, {-.9, 0, .5}, {});
  world.step();
  const Snapshot snapshot = world.snapshot();
  world.setCollide(ids[1], ids[2], false);
  world.setState(ids[1], {{1.2, 0, .7}, {}, {1, 0, 0}, {0, 1, 0}});
  world.applyForceAt(ids[2], {0, 0, 9}, {.1, 0, 0});
  world.applyImpulse(ids[3], {1, 2, 3});
  world.wake(ids[3]);
  world.sortBodies();
  world.setShape(ids[1],
                 Shape::compound({{Shape::sphere(.2), {.1, 0, 0}, {}}, {Shape::box({.1, .2, .1}), {}, {}}}));
  world.setMaterialPair({"ice", "snow", 0.1, {}, .5});
  world.removeMaterialPair("snow", "ice");
  world.setGravity({0, .1, -9});
  world.setParams(world.params());
  const JointId drag = world.addDragJoint(ids[1], {1.2, 0, 1}, 50);
  world.setDragTarget(drag, {1, 1, 2});
  const DeformableId cable = world.addDeformable(straightCable({4, 0, 1}, {5, 0, 1}, 2));
  AttachmentDef tie;
  tie.vertices = {0};
  const AttachmentId attachment = world.addAttachment(tie, cable, ids[3]);
  world.addAttachment(tie, cloth, {});
  world.applyVertexForce(cloth, 3, {0, 0, 1});
  world.setVertices(cloth, world.positions(cloth), world.velocities(cloth));
  world.setDefinition(cloth, world.definition(cloth));
  const std::int32_t row[] = {1};
  const double velocity[] = {.1, .2, .3};
  world.scatter(StateArray::Velocity, packedArray(row, 1), packedArray(velocity, 1, 3));
  world.scatter(JointArray::TargetSpeed, packedArray(row, 1), packedArray(velocity, 1));
  world.removeAttachment(attachment);
  world.removeDeformable(cable);
  world.removeJoint(drag);
  world.removeBody(kinematic);
  world.restore(snapshot);
}

/// The head, the calls and a step of a log.
const std::vector<Ordered>& everyCall() {
  static const std::vector<Ordered> all = [] {
    const Scene scene = smallScene();
    WorldOptions options;
    options.threads = 1;
    options.params.iterations = 2;  // the last one, and one that is not
    World world(scene, options);
    io::InputLog log(scratch(0), scene, options, world);
    changeInEveryWay(world);
    log.finish();
    std::vector<Ordered> lines;
    for (const std::string& line : linesOf(contentOf(scratch(0)))) lines.push_back(Ordered::parse(line));
    return lines;
  }();
  return all;
}

/// A value inside of another, or all of it.
Ordered& somewhere(ByteSource& in, Ordered& json) {
  Ordered* at = &json;
  while (at->is_structured() && !at->empty() && in.below(8) != 0)
    at = &*std::next(at->begin(), in.byte() % static_cast<std::ptrdiff_t>(at->size()));
  return *at;
}

Ordered anyText(ByteSource& in) {
  static constexpr const char* kTexts[] = {"",    "cpu",   "reference", "lockstep", "static", "kinematic",
                                           "ice", "named", "sphere",    "box",      "hinge",  "\xff"};
  return kTexts[in.byte() % std::size(kTexts)];
}

void change(ByteSource& in, Ordered& line) {
  Ordered& value = somewhere(in, line);
  switch (in.below(9)) {
    case 0:
      value = in.bits();
      return;
    case 1:
      value = in.below(16) - 3;
      return;
    case 2:
      value = in.between(-2, 2);
      return;
    case 3:
      value = in.flag() ? Ordered(in.flag()) : Ordered(nullptr);
      return;
    case 4:
      value = anyText(in);
      return;
    case 5:
      if (value.is_array() && !value.empty()) value.erase(value.size() - 1);
      if (value.is_object() && !value.empty()) value.erase(value.begin());
      return;
    case 6:
      if (value.is_array() && !value.empty()) value.push_back(somewhere(in, value));
      return;
    case 7: {
      Ordered other = everyCall()[in.byte() % everyCall().size()];
      value = somewhere(in, other);
      return;
    }
    default: {
      Ordered other = everyCall()[in.byte() % everyCall().size()];
      if (value.is_object() && other.is_object()) value.update(other);
    }
  }
}

struct Line {
  Ordered json;
  std::string text;  ///< of a line that was read
};
std::vector<Line> parsedLines(const std::string& log) {
  std::vector<Line> lines;
  for (std::string& text : linesOf(log))
    lines.push_back({Ordered::parse(text, nullptr, false), std::move(text)});
  return lines;
}
/// Lines as bytes choose them. One in four is changed.
std::vector<Line> forgedLines(ByteSource in) {
  const auto changed = [&](Ordered line) {
    for (int changes = in.below(8) < 6 ? 0 : 1 + in.below(3); changes > 0; --changes) change(in, line);
    return Line{std::move(line), {}};
  };
  std::vector<Line> lines{changed(everyCall().front())};
  while (!in.atEnd() && lines.size() < kMostLines)
    lines.push_back(changed(everyCall()[in.byte() % everyCall().size()]));
  return lines;
}

/// So that a world stays small.
void bound(Ordered& object, const char* key, int most) {
  if (object.is_object() && object.contains(key) && object[key].is_number() && object[key] > most)
    object[key] = most;
}

/// Lines that name no tables, with few steps of short loops. What is no object stays as it is.
std::vector<std::string> prepared(std::vector<Line> lines) {
  int steps = 0;
  std::size_t bodies = 0;
  std::vector<std::string> out;
  for (auto& [line, text] : lines) {
    if (line.is_object()) {
      for (const char* key : {"tables", "hashes"})
        if (line.contains(key) && line[key].is_array()) line[key] = Ordered::array();
      // two engines and a comparison after each kernel tell no more of the log
      if (line.contains("backend") && line["backend"] == "lockstep") line["backend"] = "cpu";
      if (line.contains("params"))
        bound(line["params"], "iterations", kMostIterations),
            bound(line["params"], "substeps", kMostSubsteps);
      for (const Ordered* holder : {&line, line.contains("scene") ? &line["scene"] : &line})
        if (holder->is_object() && holder->contains("bodies")) bodies += (*holder)["bodies"].size();
      if (bodies > kMostBodies) break;
      if (line.contains("call") && line["call"] == "step" && ++steps > kMostSteps) break;
    }
    const bool isKept = line.is_discarded() || (!line.is_object() && !text.empty());
    out.push_back(isKept ? std::move(text) : line.dump(-1, ' ', false, Ordered::error_handler_t::replace));
  }
  return out;
}

void write(const std::vector<std::string>& lines) {
  std::ofstream out(scratch(0), std::ios::binary);
  for (const std::string& line : lines) out << line << '\n';
}

/// The line that an Error names, from 1.
std::size_t lineOf(const Error& error, std::size_t count) {
  const std::string begin = scratch(0) + ", line ", text = error.what();
  expect(text.starts_with(begin), "an Error without a line: " + text);
  const std::size_t line = std::stoul(text.substr(begin.size()));
  expect(line > 0 && line <= count, "an Error of a line that is not there: " + text);
  return line;
}

/// Replays the lines without those that are an Error, and records it. Nothing for a log without a good head.
std::optional<io::Replay> replayGoodLines(std::vector<std::string> lines) {
  for (int errors = 1; !lines.empty(); ++errors) {
    write(lines);
    try {
      return io::replayInputs(scratch(0), {.threads = 1, .record = scratch(1)});
    } catch (const Error& error) {
      expect(!std::filesystem::exists(scratch(1)), "a replay that failed left a log");
      const std::size_t bad = lineOf(error, lines.size());
      expect(errors <= kMostErrors + 1,
             std::string("lines before an Error give another one: ") + error.what());
      if (bad == 1) break;
      if (errors < kMostErrors)
        lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(bad) - 1);
      else
        lines.resize(bad - 1);
    }
  }
  return {};
}

void expectFaithful(const io::Replay& first, int threads) {
  const std::string log = contentOf(scratch(1));
  const io::Replay second = io::replayInputs(scratch(1), {.threads = threads, .record = scratch(2)});
  if (second.difference)
    fail("a replay differs from its log after step " + std::to_string(second.difference->step) + " in " +
         second.difference->table);
  expect(second.steps == first.steps && second.hash == first.hash, "a replay ends elsewhere");
  expect(contentOf(scratch(2)) == log, "a log is written again with other bytes");
}

}  // namespace

/// A faithful replay has three threads in one of 32 cases: on few cores they wait for one another.
void testInput(std::span<const std::uint8_t> bytes) {
  everyCall();
  const bool isText = !bytes.empty() && bytes.front() == '{';
  std::vector<Line> lines = isText ? parsedLines({bytes.begin(), bytes.end()})
                                   : forgedLines(ByteSource(bytes));
  const std::optional<io::Replay> replay = replayGoodLines(prepared(std::move(lines)));
  if (replay) {
    expect(!replay->difference, "a log without tables has a difference");
    try {
      expectFaithful(*replay, isReplay() || lotOf(bytes, 32) == 0 ? 3 : 1);
    } catch (const Error& error) {
      fail(std::string("the log of a replay is an Error: ") + error.what());
    }
  }
  for (int which = 0; which < 3; ++which) std::filesystem::remove(scratch(which));
}

}  // namespace rubble::fuzz
