"""Scene definitions."""
from __future__ import annotations

import ctypes
import json
import os
from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Sequence, Union

import numpy as np

from . import _abi  # noqa: F401
from ._library import Handle, check, encode, json_of, lib, text_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._fields import (ActuatorFields, BodyOptions, DeformableFields, EventFields, MaterialPair,
                          SceneAttachmentFields, SceneJointFields, SensorFields)
    from ._options import ImportOptions, RodFields, SceneFields, SceneValues

Definition = dict[str, Any]


def _import(file: bytes, options: bytes, report: Any, pointer: Any) -> int:
    return lib.rb_scene_import(file, options, pointer, ctypes.byref(report))


class Rod(NamedTuple):
    """Indices of the parts of a rod in a scene."""

    first_body: int  #: index of its first body
    bodies: int  #: number of bodies, one after the other
    first_joint: int  #: index of its first joint
    joints: int  #: number of joints


class Scene:
    """Bodies, joints, deformable objects and events, in physical units, with the keys of scene files.

    Every `add` checks its definition at once and raises `Error` with the path of the invalid field.
    References to bodies are names or indices.

    Args:
        gravity: [m/s2].
        folder: Where mesh files that definitions name are looked for.
        values: Other keys of a scene: name, description, steps, iterations, dt, camera.
    """

    #: What became of each element of the model that the scene was imported from; empty for other scenes.
    report: Definition = {}

    def __init__(self, *, gravity: Union[Sequence[float], np.ndarray] = (0, 0, -9.81),
                 folder: str = "", **values: Unpack[SceneValues]) -> None:
        self._own(Handle(lib.rb_scene_create, lib.rb_scene_destroy, folder.encode()))
        self.set(gravity=gravity, **values)

    def _own(self, handle: Handle) -> None:
        self._handle = handle

    @property
    def _pointer(self) -> ctypes.c_void_p:
        return self._handle.pointer

    @classmethod
    def _of(cls, create: Any, *arguments: Any) -> "Scene":
        scene = cls.__new__(cls)
        scene._own(Handle(create, lib.rb_scene_destroy, *arguments))
        return scene

    @classmethod
    def load(cls, file: Union[str, os.PathLike[str]]) -> "Scene":
        """Reads a scene file. The error of an invalid one lists every fault."""
        return cls._of(lib.rb_scene_read, os.fsencode(file))

    @classmethod
    def from_model(cls, file: Union[str, os.PathLike[str]], *, strict: bool = False,
                   **options: Unpack[ImportOptions]) -> "Scene":
        """A scene of a model (MJCF, URDF, USD, glTF with physics), with the report of its import in `report`.

        strict: refuse a model of which anything is lost or approximate. Options: ``key`` (keyframe of MJCF),
        ``srdf``, ``packages`` (folders by name), ``folders`` (further ones), ``floating_base``.
        """
        report = ctypes.c_char_p()
        scene = cls._of(_import, os.fsencode(file), encode({"strict": strict, **options}), report)
        scene.report = json.loads(report.value or b"{}")
        return scene

    @classmethod
    def from_json(cls, json: Union[str, Definition], folder: str = "") -> "Scene":
        """A scene from JSON text or from a dict."""
        text = json.encode() if isinstance(json, str) else encode(json)
        return cls._of(lib.rb_scene_parse, text, folder.encode())

    @classmethod
    def from_registry(cls, name: str, **arguments: float) -> "Scene":
        """A scene of the registry (see `rubble.scenes`): ``Scene.from_registry("pyramid", base=10)``."""
        return cls._of(lib.rb_scene_build, name.encode(), encode(arguments))

    def to_json(self) -> str:
        """JSON text that reads back bit for bit."""
        return text_of(lib.rb_scene_text, self._pointer)

    def to_dict(self) -> Definition:
        """The scene with the keys of scene files, a copy. `from_json` reads it back."""
        return json_of(lib.rb_scene_text, self._pointer)

    def save(self, file: Union[str, os.PathLike[str]]) -> None:
        """Writes a scene file, which `load` reads back bit for bit. Raises `Error` if it
        cannot be written."""
        check(lib.rb_scene_write(self._pointer, os.fsencode(file)))

    def set(self, **values: Unpack[SceneFields]) -> None:
        """Sets keys that are no lists: gravity, materials, shapes, camera, sun, sky, steps and others."""
        for key, value in values.items():
            check(lib.rb_scene_set(self._pointer, key.encode(), encode(value)))

    def add(self, list: str, definition: Any) -> int:
        """Adds an element to "bodies", "joints", "deformables", "attachments", "exclusions", "events",
        "sensors", "actuators", "looks", "cameras", "lights", "material_pairs" or "verdict". Returns its
        index."""
        out = ctypes.c_int64()
        check(lib.rb_scene_add(self._pointer, list.encode(), encode(definition), ctypes.byref(out)))
        return out.value

    def add_body(self, shape: Union[Definition, str], **fields: Unpack[BodyOptions]) -> int:
        """Adds a body: name, position [m], mass [kg] or density [kg/m3], motion, material and others.
        Returns its index."""
        return self.add("bodies", {"shape": shape, **fields})

    def add_joint(self, type: str, body_a: Union[str, int], body_b: Union[str, int] = "world",
                  **fields: Unpack[SceneJointFields]) -> int:
        """Adds a joint between two bodies by name or index ("world": the static world). "anchor" [m] and
        "axis" are in the world."""
        return self.add("joints", {"type": type, "body_a": body_a, "body_b": body_b, **fields})

    def add_deformable(self, definition: Optional[Definition] = None,
                       **fields: Unpack[DeformableFields]) -> int:
        """Adds a deformable object: keys of scene files, or a definition that `tet_box` and others make."""
        return self.add("deformables", {**(definition or {}), **fields})

    def add_attachment(self, object: Union[str, int], vertices: Sequence[int],
                       **fields: Unpack[SceneAttachmentFields]) -> int:
        """Attaches vertices of an object to `body`, to `other_object` or to the world."""
        return self.add("attachments", {"object": object, "vertices": list(vertices), **fields})

    def add_rod(self, points: Any, **fields: Unpack[RodFields]) -> Rod:
        """Adds a rod of rigid segments along points (n, 3) [m] that resists stretch, bending and twist."""
        out = (ctypes.c_int32 * 4)()
        check(lib.rb_scene_add_rod(self._pointer, encode({"points": points, **fields}), out))
        return Rod(*out)

    def add_event(self, step: int, **actions: Unpack[EventFields]) -> int:
        """Adds an event that a `Run` applies before a step: add, remove, set_velocity and others."""
        return self.add("events", {"step": step, **actions})

    def add_sensor(self, type: str, **fields: Unpack[SensorFields]) -> int:
        """A sensor for `rubble.Sensors`: type ("acceleration", "touch", "joint_position" and others), name,
        body, position, orientation, joint, axis, volume and other keys of scene files."""
        return self.add("sensors", {"type": type, **fields})

    def add_actuator(self, type: str, **fields: Unpack[ActuatorFields]) -> int:
        """An actuator for `rubble.Actuators`: type ("force", "position", "muscle", "wrench" and others),
        name, joint, axis, body, gain, dynamics and other keys of scene files."""
        return self.add("actuators", {"type": type, **fields})

    def exclude(self, a: Union[str, int], b: Union[str, int]) -> int:
        """Two bodies that do not collide."""
        return self.add("exclusions", [a, b])

    def add_material_pair(self, a: str, b: str, **coefficients: Unpack[MaterialPair]) -> int:
        """A rule for contacts of two named materials: friction (or static_friction and dynamic_friction),
        restitution [1], rolling_friction and torsional_friction [m] that replace the mixtures."""
        return self.add("material_pairs", {"a": a, "b": b, **coefficients})

    def count(self, list: str) -> int:
        """Number of elements of a list."""
        out = ctypes.c_int64()
        check(lib.rb_scene_count(self._pointer, list.encode(), ctypes.byref(out)))
        return out.value

    def _repr_png_(self) -> Optional[bytes]:
        """How the scene begins, for notebooks."""
        from ._film import NOTEBOOK, in_notebook
        from ._world import World
        return in_notebook(lambda: World(self, threads=1).render(**NOTEBOOK))

    def __repr__(self) -> str:
        kinds = ("bodies", "joints", "deformables")
        return "<rubble.Scene " + ", ".join(f"{self.count(kind)} {kind}" for kind in kinds) + ">"
