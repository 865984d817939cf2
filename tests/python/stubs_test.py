"""Stubs have every key of the schema of scene files, and the package takes every key of the stubs."""
import ast
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile

from support import Case, main  # first: it skips the test where numpy is missing

import rubble

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCHEMA = json.loads((ROOT / "docs/scene.schema.json").read_text(encoding="utf-8"))
BOX = rubble.box(1, 1, 1)
SAMPLES = {"int": 1, "float": 0.25, "str": "free", "bool": True, "Vector": (1, 0, 0)}


def classes():
    """Fields of each TypedDict of the stubs, with those that it inherits: name to type."""
    found = {}
    for name in ("_fields", "_options"):
        tree = ast.parse((ROOT / f"python/rubble/{name}.pyi").read_text(encoding="utf-8"))
        for node in tree.body:
            if isinstance(node, ast.ClassDef):
                own = {each.target.id: ast.unparse(each.annotation) for each in node.body
                       if isinstance(each, ast.AnnAssign)}
                bases = [base.id for base in node.bases if base.id in found]
                found[node.name] = {**{k: v for base in bases for k, v in found[base].items()}, **own}
    return found


FIELDS = classes()


def keys_of(name):
    found = SCHEMA["$defs"][name]
    return set((found["anyOf"][-1] if "anyOf" in found else found)["properties"])


def told(call):
    """What the package says of a call."""
    try:
        call()
    except (rubble.Error, RuntimeError) as error:
        return str(error)
    return ""


class Stubs(Case):
    def test_they_are_up_to_date(self):
        done = subprocess.run([sys.executable, "-B", str(ROOT / "tools/make_python_stubs"), "--check"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_every_key_of_the_schema_is_in_them(self):
        given = {"body": (), "material": (), "axis": (), "deformable": (), "material_pair": ("a", "b"),
                 "joint": ("type", "body_a", "body_b"), "attachment": ("object", "vertices"),
                 "sensor": ("type",), "actuator": ("type",), "event": ("step",)}
        stubs = {"joint": "SceneJointFields", "attachment": "SceneAttachmentFields", "material": "Material",
                 "material_pair": "MaterialPair"}
        for name, parameters in given.items():
            listed = set(FIELDS[stubs.get(name, name.capitalize() + "Fields")])
            self.assertEqual(keys_of(name) - set(parameters) - listed, set(), name)
        scalars = {key for key, value in SCHEMA["properties"].items() if value.get("type") != "array"}
        self.assertEqual(scalars | {"gravity"}, set(FIELDS["SceneFields"]))

    def accepted(self, name, calls, without=()):
        """Each key is known to one of the calls, and a key that does not exist is known to none."""
        for key, kind in FIELDS[name].items():
            if key in without:
                continue
            value = SAMPLES.get(kind, "hard" if "hard" in kind else [])
            texts = [told(lambda: call(**{key: value})) for call in calls]
            self.assertTrue(any("unknown key" not in text for text in texts), f"{name}.{key}: {texts}")
            texts = [told(lambda: call(**{key + "_": value})) for call in calls]
            self.assertTrue(all("unknown key" in text for text in texts), f"{name}.{key}_: {texts}")

    def test_every_key_of_them_is_accepted(self):
        def scene():
            out = rubble.Scene()
            out.add_body(BOX, name="a")
            out.add_body(BOX, name="b")
            out.add_joint("hinge", "a", "b", name="pin", anchor=(0, 0, 0))
            out.add_deformable(rubble.cloth_sheet((0, 0, 0), (1, 0, 0), (0, 1, 0), 1, 1), name="sheet")
            return out

        def joint(kind):
            placed = {"pulley_a": (0, 0, 1), "pulley_b": (1, 0, 1)} if kind == "pulley" else {}
            placed["anchor"] = (0, 0, 0)
            return lambda **fields: scene().add_joint(kind, "a", "b", **{**placed, **fields})

        def thing(kind):
            return lambda **fields: scene().add_deformable({"type": kind, "vertices": [[0, 0, 0]]}, **fields)

        kinds = SCHEMA["$defs"]["joint"]["properties"]["type"]["enum"]
        solids = SCHEMA["$defs"]["deformable"]["properties"]["type"]["enum"]
        self.accepted("BodyOptions", [lambda **fields: scene().add_body(BOX, **fields)])
        self.accepted("Material", [lambda **fields: scene().add_body(BOX, material=fields)])
        self.accepted("AxisFields", [lambda **fields: joint("six_dof")(axes=[fields])])
        self.accepted("SceneJointFields", [joint(kind) for kind in kinds])
        self.accepted("DeformableFields", [thing(kind) for kind in solids], without=("elements", "type"))
        self.accepted("SceneAttachmentFields",
                      [lambda **fields: scene().add_attachment("sheet", [0], **{"body": "a", **fields})])
        self.accepted("SensorFields", [lambda **fields: scene().add_sensor("time", **fields)])
        self.accepted("ActuatorFields",
                      [lambda **fields: scene().add_actuator("force", **{"joint": "pin", **fields})])
        self.accepted("EventFields", [lambda **fields: scene().add_event(1, **fields)])
        self.accepted("RodFields", [lambda **fields: scene().add_rod([(0, 0, 0), (1, 0, 0)], **fields)])
        self.accepted("WorldOptions", [lambda **options: rubble.World(rubble.Scene(), **options)])
        self.accepted("DrawOptions", [rubble.World(rubble.Scene()).debug_draw])
        for key, kind in FIELDS["MaterialPair"].items():
            ice = rubble.Scene(materials={"ice": {}})
            self.assertNotIn("unknown key", told(lambda: ice.add_material_pair("ice", "ice", **{key: 0.25})))
        world = rubble.World(rubble.Scene(), threads=1)
        for key in FIELDS["FilterFields"]:
            world.cast_ray((0, 0, 1), (0, 0, -1), **{key: None if key.startswith("ignore") else 1})

    def test_parameters_are_those_of_the_engine(self):
        self.assertEqual(set(FIELDS["Parameters"]), {each["key"] for each in rubble.info()["parameters"]})

    def test_a_type_checker_finds_wrong_keys_and_values(self):
        if importlib.util.find_spec("mypy") is None:
            self.skipTest("mypy is missing")
        right = ["scene.add_joint('hinge', 'a', anchor=(0, 0, 1), user_data=3, axes=[{'max': 'free'}])",
                 "scene.add_body(rubble.box(1, 1, 1), mass=2, material={'one_way': (0, 0, 1), 'name': 'a'})",
                 "scene.add_sensor('touch', body='a', volume=rubble.sphere(1))",
                 "scene.add_event(3, remove=['a'])",
                 "rubble.World(scene, dt=0.01, iterations=4, sleeping=True)",
                 "rubble.World(scene).render(320, 180, color_by='speed')"]
        wrong = ["scene.add_body(rubble.box(1, 1, 1), mas=2)",
                 "scene.add_body(rubble.box(1, 1, 1), mass='2')",
                 "scene.add_joint('hinge', 'a', stiffness='soft')", "scene.add_sensor('touch', bodies='a')",
                 "scene.add_event(3, removed=['a'])", "rubble.World(scene, iteration=4)",
                 "rubble.World(scene).render(320, 180, colour_by='speed')"]
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "program.py")
            file.write_text("\n".join(["import rubble", "scene = rubble.Scene()", *right, *wrong]) + "\n",
                            encoding="utf-8")
            core = [str(path) for path in (ROOT / "python/rubble").glob("*.py")]
            done = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", folder, *core, str(file)],
                                  capture_output=True, text=True, cwd=folder,
                                  env={**os.environ, "MYPYPATH": str(ROOT / "python")})
        lines = [line for line in done.stdout.splitlines() if ": error:" in line]
        places = {int(line.split(":")[1]) for line in lines if line.startswith("program.py")}
        first = 3 + len(right)
        self.assertEqual(places, set(range(first, first + len(wrong))), done.stdout + done.stderr)
        self.assertEqual([line for line in lines if not line.startswith("program.py")], [], "of the package")


if __name__ == "__main__":
    main()
