#pragma once
/// The report of an import: what each element became, and everything that was not used.
#include <string>
#include <vector>

namespace rubble::convert {

/// A line of a model file.
struct Place {
  std::string file;
  int line = 0;  ///< from 1; 0: a file without lines

  /// "robot.xml:12"; line 0: unknown.
  std::string text() const { return line > 0 ? file + ":" + std::to_string(line) : file; }
};

/// Effect on the motion of what was not used as written.
enum class Effect {
  None,         ///< none
  Approximate,  ///< the motion is close to that of the model
  Lost,         ///< a part of the model is absent
};
/// "none", "approximate" or "lost".
const char* keyword(Effect effect);

/// An element or attribute that was not used, or not exactly.
struct Note {
  Effect effect = Effect::Lost;
  Place place;
  std::string what;  ///< "joint.armature"
  std::string why;
};

/// An element and what it became.
struct Conversion {
  Place place;
  std::string from;  ///< "joint 'knee'"
  std::string to;    ///< "hinge 'knee'"
};

struct Report {
  std::string file;
  std::string format;  ///< "MJCF", "URDF", "USD" or "glTF"
  std::vector<Conversion> conversions;
  std::vector<Note> notes;

  void converted(const Place& place, std::string from, std::string to);
  void note(Effect effect, const Place& place, std::string what, std::string why);
  std::size_t count(Effect effect) const;
  /// Is the scene equivalent to the model?
  bool exact() const { return count(Effect::Approximate) + count(Effect::Lost) == 0; }
};

/// For people. Notes of the same kind are one line, with the first place and their number. `all`: also the
/// conversions and the notes without effect.
std::string textOf(const Report& report, bool all);
/// For programs, with every note.
std::string jsonOf(const Report& report);

/// 'name', in quotes, or nothing if there is none.
std::string inQuotes(const std::string& name);

}  // namespace rubble::convert
