"""The Python of every page runs: the blocks of a page one after the other, as someone would type them."""
from support import Case, main  # first: it skips the test where numpy is missing

import contextlib
import importlib.util
import io
import os
import pathlib
import re
import tempfile

import rubble

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^```python\n(.*?)^```", re.S | re.M)
# Packages that a machine need not have. A block that names one is left out where it is missing.
OPTIONAL = {"torch": r"\btorch\b", "gymnasium": r"\bgymnasium\b|from rubble import gym", "jax": r"\bjax\b",
            "cupy": r"\bcupy\b"}
HAS_CUDA = "cuda" in rubble.info()["backends"]
# Sizes that a test cannot afford.
SMALLER = {"range(1000)": "range(2)", "num_envs=256": "num_envs=3", "4096": "5",
           "(scene, 1000)": "(scene, 5)"}

ROBOT = """<mujoco><worldbody>
<body pos="0 0 1"><joint name="knee" type="hinge" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.05" mass="1" contype="0" conaffinity="0"/>
<site name="tip"/></body></worldbody>
<actuator><motor name="knee" joint="knee" gear="5"/></actuator>
<sensor><gyro name="gyro" site="tip"/></sensor><keyframe><key name="home" qpos="0.1"/></keyframe></mujoco>"""


def robot():
    pathlib.Path("robot.xml").write_text(ROBOT, encoding="utf-8")
    return {"policy": lambda worlds: 0.1, "fallen": [True] + 4 * [False]}


def carts():
    """A cart with a pole, beside a sheet of cloth."""
    import numpy as np
    scene = rubble.Scene()
    scene.add_body(rubble.box(1, 0.5, 0.5), name="cart", mass=1)
    scene.add_body(rubble.capsule(0.05, 1), name="pole", mass=0.1, position=(0, 0, 0.75))
    scene.add_joint("hinge", "pole", "cart", name="hip", anchor=(0, 0, 0.25), axis=(0, 1, 0))
    scene.add("deformables", {"type": "cloth", "name": "block", "youngs_modulus": 1e6,
                              "vertices": [[2, 0, 0], [3, 0, 0], [2, 1, 0]],
                              "triangles": [[0, 1, 2]]})
    scene.add_sensor("angular_rate", body="pole", name="gyro")
    scene.add_sensor("touch", body="cart", name="touch")
    worlds = rubble.Worlds(scene, 5)
    return {"np": np, "scene": scene, "worlds": worlds, "done": np.arange(5) == 2,
            "stiffnesses": np.full(1, 10.0), "vectors": np.tile([0, 0, -9.81], (5, 1)),
            "rows": np.arange(5), "torques": np.zeros(5)}


def crate():
    import numpy as np
    return {"rows": np.array([0]), "forces": np.zeros((1, 3))}


# What the blocks of a page go on from.
BEFORE = {"docs/importing.md": robot, "docs/worlds.md": carts, "docs/python.md": crate}


class Pages(Case):
    def test_blocks_run(self):
        count = 0
        for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
            name = page.relative_to(ROOT).as_posix()
            blocks = BLOCK.findall(page.read_text(encoding="utf-8"))
            if not blocks or name.startswith("docs/research/"):
                continue
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                before = os.getcwd()
                os.chdir(folder)
                try:
                    count += self.run_page(name, blocks)
                finally:
                    os.chdir(before)
        self.assertGreater(count, 10)

    def run_page(self, name, blocks):
        names = {"rubble": rubble, **BEFORE.get(name, dict)()}
        count = 0
        for number, code in enumerate(blocks):
            needed = [package for package, sign in OPTIONAL.items() if re.search(sign, code)]
            if any(importlib.util.find_spec(package) is None for package in needed):
                continue
            if 'backend="cuda"' in code and not HAS_CUDA:
                continue
            if ".render(" in code and not rubble.info()["opengl"].startswith("on"):
                continue
            for size, smaller in SMALLER.items():
                code = code.replace(size, smaller)
            for package in needed:
                names.setdefault(package, importlib.import_module(package))
            with contextlib.redirect_stdout(io.StringIO()):
                exec(compile(code, f"{name}: block {number + 1} of Python", "exec"), names)
            count += 1
        return count


if __name__ == "__main__":
    main()
