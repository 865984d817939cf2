#!/usr/bin/env python3
"""Pages and the schema of scene files are what the program says. Usage: reference_test.py PATH_OF_RUBBLE"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

RUBBLE = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else "rubble"
ROOT = pathlib.Path(__file__).resolve().parents[2]
SCHEMA = json.loads((ROOT / "docs/scene.schema.json").read_text(encoding="utf-8"))
KINDS = {"object": dict, "array": list, "string": str, "boolean": bool, "integer": int,
         "number": (int, float)}
SCENES = ["pyramid", "every-shape", "planetary", "rack", "ragdoll", "soft-gripper", "flag", "cloth-sphere",
          "conveyor", "layers", "sand-column", "suspension-bridge", "atwood", "robot-arm"]


def faults(value, schema, at="scene"):
    """What is wrong with a value: the keywords of JSON Schema that the schema uses."""
    if "$ref" in schema:
        schema = SCHEMA["$defs"][schema["$ref"].rsplit("/", 1)[1]]
    if "anyOf" in schema:
        found = [faults(value, one, at) for one in schema["anyOf"]]
        return [] if [] in found else min(found, key=len)
    if "enum" in schema:
        return [] if value in schema["enum"] else [f"{at}: {value!r}"]
    kind = schema.get("type")
    if kind and (not isinstance(value, KINDS[kind]) or (isinstance(value, bool) and kind != "boolean")):
        return [f"{at}: no {kind}"]
    if kind == "array":
        size = schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value))
        inside = schema.get("items", {})
        return ([] if size else [f"{at}: {len(value)} items"]) + [
            fault for i, item in enumerate(value) for fault in faults(item, inside, f"{at}[{i}]")]
    if kind == "object":
        known = schema.get("properties", {})
        wrong = [f"{at}: no {key}" for key in schema.get("required", []) if key not in value]
        for key, item in value.items():
            if key in known:
                wrong += faults(item, known[key], f"{at}.{key}")
            elif schema.get("additionalProperties") is False:
                wrong.append(f"{at}: unknown key {key}")
        return wrong
    return []


def values_of(text):
    """The values of an example, one after the other; keys without an object around them are one."""
    text = "{" + text + "}" if text.startswith('"') else text
    while text.strip(" \n,"):
        text = text.lstrip(" \n,")
        value, end = json.JSONDecoder().raw_decode(text)
        yield value
        text = text[end:]


def as_scene(value):
    """A scene with an example: its keys, a joint or an event."""
    if "step" in value:
        value = {"events": [value]}
    elif "type" in value:
        value = {"joints": [value]}
    return {"bodies": [], **value}


class Reference(unittest.TestCase):
    def test_what_comes_from_the_program_is_up_to_date(self):
        for tool in ("make_reference", "make_joints"):
            done = subprocess.run([sys.executable, "-B", str(ROOT / "tools" / tool), RUBBLE, "--check"],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_scenes_keep_to_the_schema(self):
        for name in SCENES:
            text = subprocess.run([RUBBLE, "info", "scene", name, "--json"], capture_output=True, text=True,
                                  check=True).stdout
            self.assertEqual(faults(json.loads(text), SCHEMA), [], name)
        for file in (ROOT / "scenes/files").glob("*.json"):
            self.assertEqual(faults(json.loads(file.read_text(encoding="utf-8")), SCHEMA), [], file.name)

    def test_examples_keep_to_the_schema_and_have_keys_that_the_program_knows(self):
        page = (ROOT / "docs/scene_format.md").read_text(encoding="utf-8")
        blocks = re.findall(r"^```json\n(.*?)^```", page, re.S | re.M)
        self.assertGreater(len(blocks), 4)
        for block in blocks:
            for value in values_of(block):
                scene = as_scene(value)
                self.assertEqual(faults(scene, SCHEMA), [], value)
                self.assertNotIn("unknown key", self.checked(scene).stderr)

    def test_keys_of_materials_and_their_pairs_are_in_the_schema(self):
        scene = {"materials": {"a": {"friction": 0.5, "name": "ice"}},
                 "material_pairs": [{"a": "ice", "b": "ice", "restitution": 0.5}],
                 "bodies": [{"shape": {"type": "box", "size": [1, 1, 1]},
                             "material": {"one_way": [0, 0, 1]}}]}
        self.assertEqual(self.checked(scene).returncode, 0)
        self.assertEqual(faults(scene, SCHEMA), [])
        scene["material_pairs"][0]["colour"] = 1
        self.assertNotEqual(faults(scene, SCHEMA), [])

    def checked(self, scene):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "scene.json")
            file.write_text(json.dumps(scene), encoding="utf-8")
            return subprocess.run([RUBBLE, "check", file], capture_output=True, text=True)

    def test_what_the_schema_refuses_the_program_refuses(self):
        box = {"shape": {"type": "box", "size": [1, 1, 1]}}
        wrong = [{}, {"bodies": [{}]}, {"bodies": [{**box, "colour": 1}]},
                 {"bodies": [{**box, "position": [0, 0]}]}, {"bodies": [{**box, "motion": "still"}]},
                 {"bodies": [{"shape": {"type": "cube"}}]},
                 {"bodies": [box], "steps": "many"}, {"bodies": [box], "joints": [{"type": "glue"}]},
                 {"bodies": [box], "verdict": [{"max": 1}]},
                 {"bodies": [{"shape": {"type": "sphere", "size": 1}}]}]
        for scene in wrong:
            self.assertNotEqual(faults(scene, SCHEMA), [], scene)
            self.assertEqual(self.checked(scene).returncode, 2, scene)


if __name__ == "__main__":
    unittest.main()
