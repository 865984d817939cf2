/// Errors of models that are wrong or hostile.
#include "tests/convert/model_file.h"

namespace rubble {
namespace {

using test::importText;
using test::messageOf;
using test::mjcf;

std::string faultOf(const std::string& text) {
  return messageOf([&] { importText(text); });
}

void expectIn(const std::string& part, const std::string& message) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(InvalidModel, MalformedXmlIsReportedWithLineAndColumn) {
  expectIn("model.xml:2:", faultOf("<mujoco>\n<worldbody></mujoco>"));
  expectIn("well-formed", faultOf("<mujoco>"));
  expectIn("expected", faultOf(""));
}

TEST(InvalidModel, TextIsUtf8) {
  expectIn("model.xml:1:16: expected text in UTF-8", faultOf("<mujoco model='\xff'/>"));
  EXPECT_NE(faultOf("<mujoco model='\xc3\xa9\xe2\x82\xac\xf0\x9f\xa4\x96'/>").find("worldbody"),
            std::string::npos);
}

TEST(InvalidModel, DocumentTypesAreRefusedSoEntitiesCannotGrow) {
  expectIn("document type",
           faultOf("<!DOCTYPE m [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;&a;'>]><mujoco model='&b;'/>"));
}

TEST(InvalidModel, ACycleOfIncludesIsAnError) {
  const test::ModelFolder folder;
  folder.write("a.xml", "<mujocoinclude><include file='b.xml'/></mujocoinclude>");
  folder.write("b.xml", "<mujocoinclude><include file='a.xml'/></mujocoinclude>");
  const std::string file = folder.write("main.xml", mjcf("<include file='a.xml'/>"));
  expectIn("b.xml:1: include.file: expected a file that is included once",
           messageOf([&] { convert::importModel(file); }));
}

TEST(InvalidModel, FilesOutsideOfTheFolderAreNotRead) {
  const test::ModelFolder folder;
  folder.write("secret.xml", "<mujocoinclude/>");
  const std::string file = folder.write("model/main.xml", mjcf("<include file='../secret.xml'/>"));
  expectIn("in the folder of the model", messageOf([&] { convert::importModel(file); }));
  convert::ImportOptions options;
  options.folders = {folder.path().string()};
  EXPECT_EQ(messageOf([&] { convert::importModel(file, options); }), "");
  const std::string absolute = folder.write(
      "model/absolute.xml",
      mjcf("<geom type='mesh' mesh='m'/>", "<asset><mesh name='m' file='/etc/passwd'/></asset>"));
  expectIn("in the folder of the model", messageOf([&] { convert::importModel(absolute); }));
}

TEST(InvalidModel, LinksThatLeaveTheFolderAreNotFollowed) {
  const test::ModelFolder folder;
  folder.write("secret.xml", "<mujocoinclude/>");
  const std::string file = folder.write("model/main.xml", mjcf("<include file='link.xml'/>"));
  std::filesystem::create_symlink(folder.path() / "secret.xml", folder.path() / "model/link.xml");
  expectIn("in the folder of the model", messageOf([&] { convert::importModel(file); }));
}

TEST(InvalidModel, NumbersAreFiniteAndOfReasonableSize) {
  const auto sphere = [](const std::string& size) {
    return mjcf("<body><freejoint/><geom size='" + size + "'/></body>");
  };
  expectIn("model.xml:1: geom.size: expected", faultOf(sphere("1e999")));
  expectIn("finite", faultOf(sphere("nan")));
  expectIn("finite", faultOf(sphere("1e300")));
  expectIn("a number", faultOf(sphere("1,5")));
  expectIn("above 0", faultOf(sphere("0")));
  expectIn("1 to 3 numbers", faultOf(sphere("1 2 3 4")));
}

TEST(InvalidModel, CopiesOfCopiesAreBounded) {
  std::string inner = "<body><freejoint/><geom size='1'/></body>";
  for (int i = 0; i < 6; ++i) inner = "<replicate count='1000' offset='1 0 0'>" + inner + "</replicate>";
  expectIn("elements", faultOf(mjcf(inner)));
  expectIn("geom.size", faultOf(mjcf("<body><geom/></body>")));
}

TEST(InvalidModel, ElementsMayNotBeNestedWithoutEnd) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += "<body>";
  for (int i = 0; i < 100000; ++i) text += "</body>";
  expectIn("levels", faultOf(mjcf(text)));
}

TEST(InvalidModel, ReferencesNameWhatIsThere) {
  const std::string body = "<body name='b'><joint name='j'/><geom size='1'/></body>";
  expectIn("model.xml:1: exclude.body2: expected the name of a body",
           faultOf(mjcf(body, "<contact><exclude body1='b' body2='c'/></contact>")));
  expectIn("motor.joint", faultOf(mjcf(body, "<actuator><motor joint='k'/></actuator>")));
  expectIn("default class", faultOf(mjcf("<body childclass='none'><geom size='1'/></body>")));
  expectIn("no other body", faultOf(mjcf(body + "<body name='b'/>")));
}

TEST(InvalidModel, AMovingBodyHasAMass) {
  expectIn("a mass above 0", faultOf(mjcf("<body name='b'><joint/></body>")));
  expectIn("principal moments", faultOf(mjcf("<body name='b'><joint/><inertial pos='0 0 0' mass='1' "
                                             "diaginertia='1 1 5'/></body>")));
}

TEST(InvalidModel, TheRootElementTellsTheFormat) {
  expectIn("<mujoco> (MJCF) or <robot> (URDF)", faultOf("<sdf/>"));
}

}  // namespace
}  // namespace rubble
