"""Rubble: rigid-body, joint and soft-body physics by Augmented Vertex Block Descent.

    import rubble
    scene = rubble.Scene()
    scene.add_body(rubble.plane(), name="ground")
    scene.add_body(rubble.box(1, 1, 1), name="crate", position=(0, 0, 3))
    world = rubble.World(scene)
    world.step(120)
    print(world.bodies["crate"].position)

Units are SI. Quaternions have the scalar first and rotate from body to world. Frames are right-handed, and no
axis is built in as up. Definitions have the keys of scene files.
"""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Union

from ._actuators import Actuators
from ._arrays import Array, DeviceArray
from ._bodies import Bodies, Body, ContactLoad, Shape, Shapes
from ._film import Film
from ._joints import AxisState, Joint, Joints, JointState
from ._library import Error, json_of, lib
from ._picture import Painter, save_png
from ._queries import DebugDraw, Events, Hit, Quality, RayHits
from ._recording import Frame, Recorder, Recording
from ._registry import Argument, Claim, Run, SceneInfo, Verdict, scenes
from ._scene import Rod, Scene
from ._sensors import Sensors
from ._shapes import (Mass, box, capsule, compound, cone, cylinder, distance_field, height_field, hull,
                      mass_of, mesh, plane, sphere)
from ._soft import (Attachment, Attachments, Deformable, Deformables, Surface, cable_along, cloth_sheet,
                    straight_cable, tet_ball, tet_box, tet_solid)
from ._world import Params, Snapshot, StepReport, World
from ._worlds import Worlds

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import ModelOptions


def info() -> dict[str, Any]:
    """Version, commit, backends, OpenGL, force types, deformable kinds and parameters of this build."""
    return json_of(lib.rb_info)


def load(file: Union[str, os.PathLike[str]], **options: Unpack[ModelOptions]) -> Scene:
    """A scene of a scene file (.json), or of a model of another program: see `Scene.from_model`."""
    if os.fspath(file).endswith(".json"):
        return Scene.load(file)
    return Scene.from_model(file, **options)


__version__: str = info()["version"]
__all__ = [
    "Actuators", "Argument", "Array", "Attachment", "Attachments", "AxisState", "Bodies", "Body", "Claim",
    "ContactLoad", "DebugDraw", "Deformable", "Deformables", "DeviceArray", "Error", "Events", "Film",
    "Frame", "Hit", "Joint", "JointState", "Joints", "Mass", "Painter", "Params", "Quality", "RayHits",
    "Recorder", "Recording", "Rod", "Run", "Scene", "SceneInfo", "Sensors", "Shape", "Shapes", "Snapshot",
    "StepReport", "Surface", "Verdict", "World", "Worlds", "box", "cable_along", "capsule", "cloth_sheet",
    "compound", "cone", "cylinder", "distance_field", "height_field", "hull", "info", "load", "mass_of",
    "mesh", "plane", "save_png", "scenes", "sphere", "straight_cable", "tet_ball", "tet_box", "tet_solid",
]
for _name in __all__:  # tracebacks and help() name them as users do
    globals()[_name].__module__ = "rubble"
