#!/usr/bin/env python3
"""Pages and the schema of scene files are what the program says. Usage: reference_test.py PATH_OF_RUBBLE"""
import json
import os
import pathlib
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


class Reference(unittest.TestCase):
    def test_pages_are_up_to_date(self):
        done = subprocess.run([sys.executable, "-B", str(ROOT / "tools/make_reference"), RUBBLE, "--check"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_scenes_keep_to_the_schema(self):
        for name in SCENES:
            text = subprocess.run([RUBBLE, "info", "scene", name, "--json"], capture_output=True, text=True,
                                  check=True).stdout
            self.assertEqual(faults(json.loads(text), SCHEMA), [], name)
        for file in (ROOT / "scenes/files").glob("*.json"):
            self.assertEqual(faults(json.loads(file.read_text(encoding="utf-8")), SCHEMA), [], file.name)

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
            with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
                json.dump(scene, file)
                file.flush()
                done = subprocess.run([RUBBLE, "check", file.name], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, scene)


if __name__ == "__main__":
    unittest.main()
