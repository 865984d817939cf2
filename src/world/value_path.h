#pragma once
/// Paths of authored values: lists, names and keys of scene files (docs/worlds.md).
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <rubble/actuators.h>
#include <rubble/scene.h>

#include "math/field.h"

namespace rubble {

/// A part of a path. A name or a key is text; an element of a list is a number.
struct PathPart {
  std::string text;
  int index = -1;        ///< of digits; -1: of others
  bool isPlace = false;  ///< a number in brackets: a place in a list, and no name
};

/// "bodies.pole.mass", "joints["left.hip"].axes[0].friction", "gravity".
class ValuePath {
 public:
  /// Throws Error at "path" for text that is no path.
  explicit ValuePath(const std::string& text);

  const std::string& text() const { return text_; }
  const std::string& list() const { return parts_.front().text; }
  /// Parts after the list.
  std::size_t size() const { return parts_.size() - 1; }
  const PathPart& part(std::size_t i) const { return parts_[i + 1]; }
  /// The keys after so many parts.
  std::span<const PathPart> keys(std::size_t names) const { return std::span(parts_).subspan(names + 1); }

 private:
  std::string text_;
  std::vector<PathPart> parts_;
};

/// Both coefficients of friction at once, as "friction" of scene files.
struct BothFrictions {
  double *first, *second;
};
struct BothPairFrictions {
  std::optional<double>*first, *second;
};

/// A value of a definition.
struct ValuePlace {
  FieldInfo field;
  std::variant<double*, bool*, Vec3*, Quat*, std::vector<double>*, std::optional<double>*,
               std::optional<Vec3>*, BothFrictions, BothPairFrictions>
      at;

  /// Throws Error unless the value has so many numbers. Whether they are allowed, validate() of the
  /// definition finds.
  void set(std::span<const double> numbers) const;
  /// Appends the numbers. Throws Error for one that the definition does not give.
  void get(std::vector<double>& to) const;
};

/// Finds the value that keys name. Throws Error at "path" if there is none.
ValuePlace placeIn(BodyDef& body, std::span<const PathPart> keys);
ValuePlace placeIn(Material& material, std::span<const PathPart> keys);
ValuePlace placeIn(MaterialPair& pair, std::span<const PathPart> keys);
ValuePlace placeIn(JointDef& joint, std::span<const PathPart> keys);
ValuePlace placeIn(Deformable& object, std::span<const PathPart> keys);
ValuePlace placeIn(AttachmentDef& attachment, std::span<const PathPart> keys);
ValuePlace placeIn(ActuatorDef& actuator, std::span<const PathPart> keys);
/// Is it one of the keys that give the state of a body?
bool isBodyState(std::span<const PathPart> keys);

}  // namespace rubble
