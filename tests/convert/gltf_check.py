"""Binary glTF files that `rubble export` writes, against the rules of the glTF 2.0 specification that files
can break: container, references, buffers, accessors and their bounds, hierarchy, animations, cameras.

usage: gltf_check.py RUBBLE [FILE.glb...]"""
import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile

COMPONENTS = {5120: ("b", 1), 5121: ("B", 1), 5122: ("h", 2), 5123: ("H", 2), 5125: ("I", 4), 5126: ("f", 4)}
SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
TOP = {"asset", "scene", "scenes", "nodes", "meshes", "materials", "accessors", "bufferViews", "buffers",
       "animations", "cameras"}


class Glb:
    def __init__(self, data):
        self.problems = []
        self.want(len(data) >= 20 and data[:4] == b"glTF", "12 bytes of header: magic")
        version, total = struct.unpack_from("<II", data, 4)
        self.want(version == 2, "version 2")
        self.want(total == len(data), f"the length {total} is that of the file, {len(data)}")
        chunks, at = [], 12
        while at < len(data):
            size, kind = struct.unpack_from("<I4s", data, at)
            self.want(size % 4 == 0, "chunks of a multiple of 4 bytes")
            chunks.append((kind, data[at + 8:at + 8 + size]))
            at += 8 + size
        self.want(at == len(data), "chunks end with the file")
        self.want(chunks[0][0] == b"JSON" and chunks[0][1][-1:] in b" }",
                  "JSON comes first, padded with spaces")
        self.json = json.loads(chunks[0][1])
        self.want(len(chunks) == 2 and chunks[1][0] == b"BIN\0", "one binary chunk")
        self.binary = chunks[1][1]
        self.check()

    def want(self, holds, what):
        if not holds:
            self.problems.append("not so: " + what)

    def list(self, name):
        found = self.json.get(name, [])
        self.want(name not in self.json or found, f"{name} is not an empty list")
        return found

    def index(self, value, name, who):
        good = isinstance(value, int) and 0 <= value < len(self.json.get(name, []))
        self.want(good, f"{who} is an index of {name}: {value}")
        return self.json[name][value] if good else {}

    def values(self, accessor):
        letter, size = COMPONENTS[accessor["componentType"]]
        view = self.json["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        count = accessor["count"] * SIZES[accessor["type"]]
        return struct.unpack_from(f"<{count}{letter}", self.binary, start)

    def check(self):
        self.want(set(self.json) <= TOP, f"known keys: {set(self.json) - TOP}")
        self.want(self.json["asset"].get("version") == "2.0", "asset.version 2.0")
        self.check_buffers()
        self.check_nodes()
        self.check_meshes()
        for animation in self.list("animations"):
            self.check_animation(animation)
        for camera in self.list("cameras"):
            lens = camera[camera["type"]]
            sees = 0 < lens["yfov"] < math.pi and 0 < lens["znear"] < lens["zfar"]
            self.want(sees, "a camera that can see")

    def check_buffers(self):
        buffers = self.list("buffers")
        self.want(len(buffers) == 1 and "uri" not in buffers[0], "one buffer, the binary chunk")
        length = buffers[0]["byteLength"]
        self.want(length <= len(self.binary) <= length + 3, "the chunk has the bytes of its buffer")
        for view in self.list("bufferViews"):
            end = view.get("byteOffset", 0) + view["byteLength"]
            self.want(view["byteLength"] > 0 and end <= length, f"a view lies in its buffer: {view}")
        for i, accessor in enumerate(self.list("accessors")):
            size = COMPONENTS[accessor["componentType"]][1]
            view = self.index(accessor["bufferView"], "bufferViews", f"accessors[{i}].bufferView")
            start = accessor.get("byteOffset", 0)
            bytes_ = accessor["count"] * SIZES[accessor["type"]] * size
            self.want(accessor["count"] > 0, f"accessors[{i}] has elements")
            self.want((start + view.get("byteOffset", 0)) % size == 0, f"accessors[{i}] is aligned")
            self.want(start + bytes_ <= view["byteLength"], f"accessors[{i}] lies in its view")
            values = self.values(accessor)
            self.want(all(math.isfinite(v) for v in values), f"accessors[{i}] is finite")
            n = SIZES[accessor["type"]]
            for key, choose in (("min", min), ("max", max)):
                if key in accessor:
                    single = [struct.unpack("<f", struct.pack("<f", x))[0] for x in accessor[key]]
                    own = [choose(values[k::n]) for k in range(n)]
                    self.want(single == own,
                              f"accessors[{i}].{key} is that of its values: {accessor[key]}, {own}")

    def check_nodes(self):
        nodes, parents = self.list("nodes"), {}
        self.index(self.json.get("scene"), "scenes", "scene")
        for i, node in enumerate(nodes):
            self.want("children" not in node or node["children"], f"nodes[{i}].children is not empty")
            for child in node.get("children", []):
                self.index(child, "nodes", f"nodes[{i}].children")
                self.want(child not in parents, f"nodes[{child}] has one parent")
                parents[child] = i
            if "mesh" in node:
                self.index(node["mesh"], "meshes", f"nodes[{i}].mesh")
            if "rotation" in node:
                norm = math.hypot(*node["rotation"])
                self.want(abs(norm - 1) < 1e-5, f"nodes[{i}].rotation has length 1: {norm}")
            if "matrix" in node:
                self.want(not {"translation", "rotation", "scale"} & set(node),
                          f"nodes[{i}] has a matrix alone")
        for i in range(len(nodes)):
            at, steps = i, 0
            while at in parents and steps <= len(nodes):
                at, steps = parents[at], steps + 1
            self.want(steps <= len(nodes), f"nodes[{i}] is in no cycle")
        for scene in self.list("scenes"):
            for root in scene.get("nodes", []):
                self.want(root not in parents, f"nodes[{root}] of a scene is a root")

    def check_meshes(self):
        for i, mesh in enumerate(self.list("meshes")):
            for part in mesh["primitives"]:
                points = self.index(part["attributes"]["POSITION"], "accessors", f"meshes[{i}] POSITION")
                self.want(points["type"] == "VEC3" and {"min", "max"} <= set(points),
                          f"meshes[{i}] has bounds")
                corners = self.index(part["indices"], "accessors", f"meshes[{i}] indices")
                self.want(corners["type"] == "SCALAR" and corners["componentType"] in (5121, 5123, 5125),
                          f"meshes[{i}] indices are whole numbers")
                self.want(corners["count"] % 3 == 0, f"meshes[{i}] has whole triangles")
                self.want(max(self.values(corners)) < points["count"], f"meshes[{i}] indices name its points")
                self.index(part["material"], "materials", f"meshes[{i}].material")
        for material in self.list("materials"):
            color = material["pbrMetallicRoughness"]["baseColorFactor"]
            self.want(len(color) == 4 and all(0 <= c <= 1 for c in color), f"a color of 0 to 1: {color}")

    def check_animation(self, animation):
        targets = set()
        for channel in animation["channels"]:
            target = (channel["target"]["node"], channel["target"]["path"])
            self.want(target not in targets, f"one channel for {target}")
            targets.add(target)
            node = self.index(target[0], "nodes", "a target")
            self.want("matrix" not in node, "a target has no matrix")
            good = 0 <= channel["sampler"] < len(animation["samplers"])
            self.want(good, "a sampler that is there")
            sampler = animation["samplers"][channel["sampler"]]
            times = self.index(sampler["input"], "accessors", "input")
            values = self.index(sampler["output"], "accessors", "output")
            self.want(times["componentType"] == 5126 and {"min", "max"} <= set(times), "times have bounds")
            moments = self.values(times)
            self.want(moments[0] >= 0 and all(a < b for a, b in zip(moments, moments[1:])), "times ascend")
            self.want(values["count"] == times["count"], "a value for each time")
            kind = "VEC4" if target[1] == "rotation" else "VEC3"
            self.want(values["type"] == kind, f"values of {target[1]}")
            if target[1] == "rotation":
                q = self.values(values)
                self.want(all(abs(math.hypot(*q[k:k + 4]) - 1) < 1e-4 for k in range(0, len(q), 4)),
                          "rotations of length 1")


def main():
    rubble, files, bad = sys.argv[1], [pathlib.Path(f) for f in sys.argv[2:]], 0
    with tempfile.TemporaryDirectory() as path:
        if not files:
            for i, (scene, steps) in enumerate((("pyramid", 40), ("every-shape", 30), ("jenga", 12))):
                file = pathlib.Path(path) / f"{i}.glb"
                done = subprocess.run([rubble, "export", scene, "--steps", str(steps), "-o", file],
                                      capture_output=True, text=True)
                if done.returncode:
                    print(f"gltf_check: {scene}: {done.stderr}")
                    bad += 1
                else:
                    files.append(file)
        for file in files:
            glb = Glb(file.read_bytes())
            bad += len(glb.problems)
            for problem in glb.problems[:20]:
                print(f"gltf_check: {file.name}: {problem}")
            print(f"gltf_check: {file.name}: {len(glb.json['nodes'])} nodes, "
                  f"{len(glb.json['accessors'])} accessors, {len(glb.problems)} problems")
    return 1 if bad else 0


sys.exit(main())
