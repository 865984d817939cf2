"""USD imports against OpenUSD: masses, frames, joints, and text against crate files. Exit status 77 where
Python has no pxr.

usage: usd_oracle.py RUBBLE [MODEL...]"""
import json
import pathlib
import subprocess
import sys
import tempfile
import warnings

try:
    import numpy as np
    from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, UsdUtils
except ImportError:
    print("usd_oracle: this Python has no pxr")
    sys.exit(77)

warnings.simplefilter("ignore")
MODELS = pathlib.Path(__file__).resolve().parent / "models"
TOLERANCE = 1e-6
problems = []
count = 0


def check(what, own, theirs, scale=1.0, tolerance=TOLERANCE):
    global count
    own, theirs = np.asarray(own, float), np.asarray(theirs, float)
    count += own.size
    if own.shape != theirs.shape or not np.all(np.abs(own - theirs) <= tolerance * scale):
        problems.append(f"{what}: {own.tolist()} here, {theirs.tolist()} in OpenUSD")


def matrix(q):
    s, x, y, z = np.asarray(q, float) / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - s * z), 2 * (x * z + s * y)],
                     [2 * (x * y + s * z), 1 - 2 * (x * x + z * z), 2 * (y * z - s * x)],
                     [2 * (x * z - s * y), 2 * (y * z + s * x), 1 - 2 * (x * x + y * y)]])


def numbers(q):
    return [q.GetReal(), *q.GetImaginary()]


def run(rubble, *arguments):
    return subprocess.run([rubble, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def import_scene(rubble, file, folder):
    scene = folder / (file.name + ".json")
    run(rubble, "import", file, "-q", "-o", scene)
    return json.loads(scene.read_text())


class Stage:
    """The stage with its units turned to meters and z up."""

    def __init__(self, file):
        self.stage = Usd.Stage.Open(str(file))
        self.cache = UsdGeom.XformCache()
        self.meters = UsdGeom.GetStageMetersPerUnit(self.stage)
        self.kilograms = UsdPhysics.GetStageKilogramsPerUnit(self.stage)
        y_up = UsdGeom.GetStageUpAxis(self.stage) == UsdGeom.Tokens.y
        self.up = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]) if y_up else np.eye(3)

    def frame(self, prim):
        """Rotation and position of a prim in meters, z up."""
        world = self.cache.GetLocalToWorldTransform(prim)
        turn = matrix(numbers(world.RemoveScaleShear().ExtractRotationQuat()))
        return self.up @ turn, self.up @ np.array(world.ExtractTranslation()) * self.meters

    def point(self, prim, local):
        world = self.cache.GetLocalToWorldTransform(prim) if prim else Gf.Matrix4d(1)
        return self.up @ np.array(world.Transform(Gf.Vec3d(*local))) * self.meters


def shape_info(stage):
    """Volume and inertia at density 1 of the shapes of the models, for OpenUSD to add up."""
    def info(prim):
        out = UsdPhysics.RigidBodyAPI.MassInformation()
        world = stage.cache.GetLocalToWorldTransform(prim)
        scale = np.array([world.GetRow3(i).GetLength() for i in range(3)])
        center = np.zeros(3)
        if prim.IsA(UsdGeom.Cube):
            edges = UsdGeom.Cube(prim).GetSizeAttr().Get() * scale
            volume = edges.prod()
            x, y, z = edges ** 2
            inertia = np.diag([y + z, x + z, x + y]) * volume / 12
        elif prim.IsA(UsdGeom.Sphere):
            r = UsdGeom.Sphere(prim).GetRadiusAttr().Get() * scale[0]
            volume = 4 / 3 * np.pi * r ** 3
            inertia = np.eye(3) * 0.4 * volume * r * r
        elif prim.IsA(UsdGeom.Mesh):
            mesh = UsdGeom.Mesh(prim)
            points = np.array(mesh.GetPointsAttr().Get(), float) * scale
            faces, at, triangles = mesh.GetFaceVertexIndicesAttr().Get(), 0, []
            for corners in mesh.GetFaceVertexCountsAttr().Get():
                triangles += [(faces[at], faces[at + k - 1], faces[at + k]) for k in range(2, corners)]
                at += corners
            volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
            for t in triangles:
                a, b, c = points[list(t)]
                v = np.dot(a, np.cross(b, c)) / 6
                s = a + b + c
                volume += v
                first += v * s / 4
                second += v / 20 * (np.outer(s, s) + np.outer(a, a) + np.outer(b, b) + np.outer(c, c))
            center = first / volume
            second -= volume * np.outer(center, center)
            inertia = np.trace(second) * np.eye(3) - second
        else:
            api = UsdGeom.Capsule(prim) if prim.IsA(UsdGeom.Capsule) else UsdGeom.Cylinder(prim)
            r, h = api.GetRadiusAttr().Get() * scale[0], api.GetHeightAttr().Get() * scale[0]
            cylinder, ball = np.pi * r * r * h, 4 / 3 * np.pi * r ** 3 if prim.IsA(UsdGeom.Capsule) else 0.0
            volume = cylinder + ball
            axial = cylinder * r * r / 2 + ball * 0.4 * r * r
            across = cylinder * (r * r / 4 + h * h / 12) + ball * (0.4 * r * r + h * h / 4 + 0.375 * h * r)
            axis = "XYZ".index(api.GetAxisAttr().Get())
            inertia = np.eye(3) * across
            inertia[axis, axis] = axial
        out.volume = float(volume)
        out.inertia = Gf.Matrix3f(*inertia.flatten().tolist())
        out.centerOfMass = Gf.Vec3f(*center.tolist())
        body = prim
        while not body.HasAPI(UsdPhysics.RigidBodyAPI):
            body = body.GetParent()
        # in the frame of the body, without its scale
        frame = stage.cache.GetLocalToWorldTransform(body).RemoveScaleShear()
        local = world.RemoveScaleShear() * frame.GetInverse()
        out.localPos = Gf.Vec3f(local.ExtractTranslation())
        out.localRot = Gf.Quatf(local.ExtractRotationQuat())
        return out
    return info


def mass_of(body):
    given = body["shape"].get("mass_properties")
    frame, at = matrix(body.get("orientation", [1, 0, 0, 0])), np.array(body.get("position", [0, 0, 0]))
    if given is None:
        shape, m = body["shape"], body["mass"]
        if shape["type"] == "sphere":
            return m, at, np.eye(3) * 0.4 * m * shape["radius"] ** 2
        if shape["type"] == "cylinder":
            r, h = shape["radius"], shape["length"]
            across = m * (r * r / 4 + h * h / 12)
            return m, at, frame @ np.diag([across, across, m * r * r / 2]) @ frame.T
        x, y, z = np.square(shape["size"])
        return m, at, frame @ np.diag([y + z, x + z, x + y]) @ frame.T * m / 12
    axes = frame @ matrix(given["axes"])
    scale = body["mass"] / given["mass"]
    return body["mass"], at + frame @ given["center"], scale * axes @ np.diag(given["inertia"]) @ axes.T


def compare_bodies(stage, scene, name):
    bodies = {body["name"]: body for body in scene["bodies"]}
    info = shape_info(stage)
    for prim in stage.stage.Traverse():
        if not prim.HasAPI(UsdPhysics.RigidBodyAPI):
            continue
        path = str(prim.GetPath())
        own = bodies.get(path[1:])
        if own is None:
            problems.append(f"{name}: no body {path}")
            continue
        turn, at = stage.frame(prim)
        check(f"{path} position", own.get("position", [0, 0, 0]), at)
        check(f"{path} orientation", matrix(own.get("orientation", [1, 0, 0, 0])), turn)
        if own.get("motion") == "kinematic":
            continue
        mass, inertia, center, axes = UsdPhysics.RigidBodyAPI(prim).ComputeMassProperties(info)
        own_mass, own_center, own_inertia = mass_of(own)
        mass *= stage.kilograms
        # OpenUSD computes in single precision
        check(f"{path} mass", own_mass, mass, mass, 2e-6)
        # the center is in the frame of the prim, with its scale
        has_mass = prim.HasAPI(UsdPhysics.MassAPI)
        given = UsdPhysics.MassAPI(prim).GetCenterOfMassAttr().Get() if has_mass else None
        if given is not None and np.all(np.isfinite(given)):
            check(f"{path} center", own_center, stage.point(prim, given))
        else:
            check(f"{path} center", own_center, at + turn @ np.array(center) * stage.meters, 1, 1e-5)
        basis = turn @ matrix(numbers(axes))
        theirs = basis @ np.diag(np.array(inertia) * stage.kilograms * stage.meters ** 2) @ basis.T
        check(f"{path} inertia", own_inertia, theirs, np.trace(theirs), 5e-6)


def compare_joints(stage, scene, name):
    joints = {joint["name"]: joint for joint in scene.get("joints", [])}
    bodies = {body["name"]: body for body in scene["bodies"]}
    parsed = UsdPhysics.LoadUsdPhysicsFromRange(stage.stage, ["/"])
    for kind, (paths, descriptions) in parsed.items():
        if "Joint" not in str(kind):
            continue
        for path, theirs in zip(paths, descriptions):
            own = joints.get(str(path)[1:])
            if own is None:
                problems.append(f"{name}: no joint {path}")
                continue
            for side, rel, at in (("b", theirs.rel0, theirs.localPose0Position),
                                  ("a", theirs.rel1, theirs.localPose1Position)):
                prim = stage.stage.GetPrimAtPath(rel) if not rel.isEmpty else None
                # positions of OpenUSD have the scale of the prim already
                turn, origin = stage.frame(prim) if prim else (stage.up, np.zeros(3))
                point = origin + turn @ np.array(at) * stage.meters
                body = bodies.get(own["body_" + side])
                if own["type"] == "tendon":
                    start = 5 * (side == "b")
                    local = np.array(own["path"][start + 1:start + 4])
                else:
                    local = np.array(own.get("anchor_" + side, [0, 0, 0]))
                frame = matrix(body.get("orientation", [1, 0, 0, 0])) if body else np.eye(3)
                place = np.array(body.get("position", [0, 0, 0])) if body else np.zeros(3)
                check(f"{path} anchor {side}", place + frame @ local, point)
            limit = getattr(theirs, "limit", None)
            if limit is not None and limit.enabled and own["type"] in ("hinge", "slider"):
                unit = np.pi / 180 if own["type"] == "hinge" else stage.meters
                axis = own["axes"][0]
                check(f"{path} limits", [axis["min"], axis["max"]], [limit.lower * unit, limit.upper * unit])
            drive = getattr(theirs, "drive", None)
            if drive is not None and drive.enabled:
                turns = own["type"] == "hinge"
                per = stage.kilograms * (stage.meters ** 2 * 180 / np.pi if turns else 1)
                axis = own["axes"][0]
                for name, wanted in (("stiffness", drive.stiffness), ("damping", drive.damping)):
                    check(f"{path} {name}", axis.get(f"drive_{name}", 0), wanted * per, 1 + wanted)


def main():
    rubble = sys.argv[1]
    files = [pathlib.Path(f).resolve() for f in sys.argv[2:]] or sorted(MODELS.glob("*.usda"))
    with tempfile.TemporaryDirectory() as path:
        folder = pathlib.Path(path)
        for file in files:
            scene = import_scene(rubble, file, folder)
            stage = Stage(file)
            compare_bodies(stage, scene, file.name)
            compare_joints(stage, scene, file.name)
            # the same stage as a crate file, as OpenUSD writes it, also flattened
            crate = folder / (file.stem + ".usdc")
            Sdf.Layer.FindOrOpen(str(file)).Export(str(crate))
            flat = folder / (file.stem + "_flat.usdc")
            stage.stage.Flatten().Export(str(flat))
            package = folder / (file.stem + ".usdz")
            UsdUtils.CreateNewUsdzPackage(str(file), str(package))
            for other in (crate, flat, package):
                again = import_scene(rubble, other, folder)
                for each in (scene, again):
                    each.pop("name", None), each.pop("description", None)
                if again != scene:
                    problems.append(f"{other.name}: another scene than that of the text")
    for problem in problems:
        print("usd_oracle:", problem)
    print(f"usd_oracle: {count} numbers compared, {len(problems)} problems")
    return 1 if problems else 0


sys.exit(main())
