#pragma once
/// Elements that scenes may name: those of ElementTypes with kDoc and kFields (math/field.h), the authored
/// members of their Model. Reader, writer, validation and listing follow from these.
#include <rubble/deformables.h>

#include "math/field.h"

namespace rubble {

struct SoftModel;

using ElementField = AnyField<ElementDef>;

/// What is known about an element type, without its types.
struct ElementKind {
  const char* name;
  const char* doc;
  int corners;
  std::vector<ElementField> fields;
  bool (*hasFields)(const ElementDef&);  ///< are ElementDef::fields empty or of this type?
  void (*add)(SoftModel&, const ElementDef&);
};

const std::vector<ElementKind>& elementKinds();
/// Null if there is none of that name.
const ElementKind* findElementKind(const std::string& name);

}  // namespace rubble
