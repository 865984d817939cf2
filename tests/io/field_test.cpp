/// Lists of fields (math/field.h) and what is generated from them.
#include <algorithm>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <rubble/info.h>

#include "cook/shape_traits.h"
#include "forces/joint_kind.h"

namespace rubble {
namespace {

TEST(Fields, NameTheirMembersInCamelCase) {
  EXPECT_EQ(field("length", "m", "", &JointDef::length).name(), "length");
  EXPECT_EQ(field("max_drive_torque", "N m", "", &JointDef::maxDriveTorque).name(), "maxDriveTorque");
  EXPECT_EQ(std::get<0>(kOrientationField).name(), "orientationAtoB");
}

TEST(Fields, OfJointsAreListedOnceEachInTheOrderOfTheirMembers) {
  const std::vector<JointField>& fields = sharedJointFields();
  const JointDef def;
  const auto place = [&](const JointField& field) {
    const void* at = nullptr;
    field.visit(def, [&](const auto& value) { at = &value; });
    return at;
  };
  for (std::size_t i = 1; i < fields.size(); ++i) EXPECT_LT(place(fields[i - 1]), place(fields[i]));
}

TEST(Fields, EnumeratorsOfJointsAndShapesHaveTheirKeywords) {
  EXPECT_EQ(jointType("drag"), JointType::Drag);
  EXPECT_EQ(jointType("angular_spring"), JointType::AngularSpring);
  EXPECT_STREQ(keyword(static_cast<JointType>(99)), "");
  EXPECT_THROW(jointType("screw"), Error);
  EXPECT_EQ(shapeType("distance_field"), ShapeType::DistanceField);
  EXPECT_EQ(shapeType("box"), ShapeType::Box);
  EXPECT_THROW(shapeType("torus"), Error);
}

TEST(Fields, AreInTheDescriptionOfSceneFiles) {
  std::ifstream file(RUBBLE_SOURCE_DIR "/docs/scene_format.md");
  std::stringstream text;
  text << file.rdbuf();
  const auto expectKey = [&](const char* key) {
    EXPECT_NE(text.str().find("`" + std::string(key) + "`"), std::string::npos) << key;
  };
  for (const JointKind& kind : jointKinds())
    for (const JointField& field : kind.fields) expectKey(field.key);
  std::apply([&](const auto&... f) { (expectKey(f.key), ...); }, kAxisFields);
}

TEST(Fields, OfEveryJointAreInItsListing) {
  for (const JointKind& kind : jointKinds()) {
    const std::vector<ForceInfo> infos = forceInfos();
    const auto info = std::find_if(infos.begin(), infos.end(), [&](auto& i) { return i.name == kind.name; });
    ASSERT_NE(info, infos.end()) << kind.name;
    EXPECT_EQ(info->fields.size(),
              kind.fields.size() + (kind.axes > 0 ? std::tuple_size_v<decltype(kAxisFields)> : 0));
  }
}

}  // namespace
}  // namespace rubble
