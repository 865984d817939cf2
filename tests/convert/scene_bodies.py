"""Frames, masses and primitives of the bodies of a scene file."""
import mujoco
import numpy as np


def matrix(q):
    out = np.zeros(9)
    mujoco.mju_quat2Mat(out, np.asarray(q, float) / np.linalg.norm(q))
    return out.reshape(3, 3)


def pose_of(body):
    """Rotation and position of a body in the world."""
    return matrix(body.get("orientation", [1, 0, 0, 0])), np.array(body.get("position", [0, 0, 0]))


def simple_mass(shape, mass):
    """Principal moments of a shape without mass properties of its own."""
    kind = shape["type"]
    if kind == "sphere":
        return np.full(3, 0.4 * mass * shape["radius"] ** 2)
    if kind == "box":
        x, y, z = np.square(shape["size"])
        return mass / 12 * np.array([y + z, x + z, x + y])
    r, length = shape["radius"], shape["length"]
    if kind == "cylinder":
        across = mass * (r * r / 4 + length * length / 12)
        return np.array([across, across, mass * r * r / 2])
    cylinder, ball = np.pi * r * r * length, 4 / 3 * np.pi * r ** 3
    density, half = mass / (cylinder + ball), length / 2
    axial = density * (cylinder * r * r / 2 + ball * 0.4 * r * r)
    of_ends = ball * (0.4 * r * r + half * half + 0.75 * half * r)
    across = density * (cylinder * (r * r / 4 + half * half / 3) + of_ends)
    return np.array([across, across, axial])


def mass_of(body):
    """Mass, center of mass and inertia tensor in the world."""
    frame, at = pose_of(body)
    given = body["shape"].get("mass_properties")
    if given is None:
        return body["mass"], at, frame @ np.diag(simple_mass(body["shape"], body["mass"])) @ frame.T
    axes = frame @ matrix(given["axes"])
    scale = body["mass"] / given["mass"]
    return body["mass"], at + frame @ given["center"], scale * axes @ np.diag(given["inertia"]) @ axes.T


def parts_of(body):
    """Type, size and pose in the world of each convex primitive of a body."""
    frame, at = pose_of(body)
    shape = body["shape"]
    parts = shape["parts"] if shape["type"] == "compound" else [{"shape": shape}]
    for part in parts:
        each = part["shape"]
        q = part.get("orientation", [1, 0, 0, 0])
        size = {"sphere": lambda: [each["radius"]], "box": lambda: [s / 2 for s in each["size"]],
                "capsule": lambda: [each["radius"], each["length"] / 2],
                "cylinder": lambda: [each["radius"], each["length"] / 2]}.get(each["type"])
        if size:
            yield each["type"], size(), at + frame @ part.get("position", [0, 0, 0]), frame @ matrix(q)
