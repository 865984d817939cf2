"""Imports against MuJoCo: numbers of the models, and motion. Exit status 77 where Python has no mujoco.

usage: oracle.py RUBBLE [MODEL...]"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

try:
    import mujoco
    import numpy as np
except ImportError:
    print("oracle: this Python has no mujoco")
    sys.exit(77)

import compound_models
import generated_models
from scene_bodies import mass_of, matrix, parts_of, pose_of

MODELS = pathlib.Path(__file__).resolve().parent / "models"
TOLERANCE = 1e-6
HAS_COMPOSITES = int(mujoco.__version__.split(".")[0]) < 4
problems = []
counts = {}


def check(what, own, theirs, scale=1.0):
    """Notes a problem unless the numbers are the same to TOLERANCE of the scale."""
    own, theirs = np.asarray(own, float), np.asarray(theirs, float)
    counts[what.split(":")[0]] = counts.get(what.split(":")[0], 0) + own.size
    if own.shape != theirs.shape or not np.all(np.abs(own - theirs) <= TOLERANCE * scale):
        problems.append(f"{what}: {own.tolist()} here, {theirs.tolist()} in MuJoCo")


def run(rubble, *arguments):
    return subprocess.run([rubble, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def compare_bodies(model, data, scene, name):
    roots = {}
    for body in range(1, model.nbody):
        root = model.body_weldid[body]
        if root != 0 and model.body_mocapid[root] < 0:
            roots.setdefault(root, []).append(body)
    bodies = {body["name"]: body for body in scene["bodies"]}
    moving = [b for b in scene["bodies"] if b.get("motion", "dynamic") == "dynamic" and "mass" in b]
    theirs = sum(model.body_mass[body] for members in roots.values() for body in members)
    check(f"{name} total mass", sum(body["mass"] for body in moving), theirs, theirs)
    check(f"{name} number of bodies", len(moving), len(roots))
    for root, members in roots.items():
        own = bodies.get(model.body(root).name)
        if own is None:
            problems.append(f"{name}: no body {model.body(root).name}")
            continue
        mass = sum(model.body_mass[members])
        center = sum(model.body_mass[b] * data.xipos[b] for b in members) / mass
        inertia = np.zeros((3, 3))
        for b in members:
            axes, offset = data.ximat[b].reshape(3, 3), data.xipos[b] - center
            inertia += axes @ np.diag(model.body_inertia[b]) @ axes.T
            inertia += model.body_mass[b] * (offset @ offset * np.eye(3) - np.outer(offset, offset))
        label = f"{name} body: {model.body(root).name}"
        own_mass, own_center, own_inertia = mass_of(own)
        check(label.replace("body", "mass", 1), own_mass, mass, mass)
        check(label.replace("body", "center of mass", 1), own_center, center)
        check(label.replace("body", "inertia", 1), own_inertia, inertia, np.trace(inertia))
        check(label.replace("body", "position", 1), pose_of(own)[1], data.xpos[root])
        check(label.replace("body", "orientation", 1), pose_of(own)[0], data.xmat[root].reshape(3, 3))


def joint_named(scene, name):
    return next((j for j in scene.get("joints", []) if name in j["name"].split("+")), None)


def frame_of(scene, joint, side):
    """Anchor and axes of a joint in the world."""
    anchor = np.array(joint.get("anchor_" + side, [0, 0, 0]))
    axes = matrix(joint.get("frame_" + side, [1, 0, 0, 0]))
    body = next((b for b in scene["bodies"] if b["name"] == joint["body_" + side]), None)
    if body is None:
        return anchor, axes
    rotation, at = pose_of(body)
    return at + rotation @ anchor, rotation @ axes


def hinges_of(scene, joint):
    """Of the axes of rotation of a joint: number, a point, direction, present angle; in the world."""
    (at_a, axes_a), (at_b, axes_b) = (frame_of(scene, joint, side) for side in "ab")
    if joint["type"] != "gimbal":
        return [(k, at_a, axes.T[k], 0.0) for k in range(3) for axes in (axes_b, axes_a)]
    tilt, offset = joint.get("tilt_b", 0.0), np.array(joint.get("offset_b", [0, 0, 0]))
    middle = axes_b @ [0, np.cos(tilt), np.sin(tilt)]
    inner, x = axes_a[:, 0], axes_b[:, 0]
    angle = np.arctan2(-inner @ np.cross(x, middle), inner @ x)
    return [(0, at_a, inner, 0.0), (1, at_b + axes_b @ offset, middle, angle), (2, at_b, axes_b[:, 2], 0.0)]


def compare_joints(model, data, scene, name):
    for index in range(model.njnt):
        kind = model.jnt_type[index]
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            continue
        label = model.joint(index).name
        own = joint_named(scene, label)
        if own is None:
            problems.append(f"{name}: no joint {label}")
            continue
        if kind == mujoco.mjtJoint.mjJNT_BALL:
            for side in "ab":
                check(f"{name} anchor: {label}", frame_of(scene, own, side)[0], data.xanchor[index])
            continue
        axis = data.xaxis[index]
        slides = kind == mujoco.mjtJoint.mjJNT_SLIDE
        axes = hinges_of(scene, own)
        if slides:
            axes = [(k, None, frame_of(scene, own, "b")[1][:, k], 0.0) for k in range(3)]
        place, point, direction, angle = max(axes, key=lambda each: abs(each[2] @ axis))
        along = direction @ axis
        check(f"{name} axis: {label}", abs(along), 1)
        if not slides:
            check(f"{name} anchor: {label}", np.cross(data.xanchor[index] - point, axis), [0, 0, 0])
        single = own["type"] in ("hinge", "slider")
        if single:
            check(f"{name} axis of a single joint: {label}", place, 0)
        offset = 0 if slides else 3
        axis = own.get("axes", [{}])[0 if single else place + offset]
        swapped = own["body_a"] != model.body(model.body_weldid[model.jnt_bodyid[index]]).name
        sign = np.sign(along) * (-1 if swapped else 1)
        low, high = axis.get("min", "free"), axis.get("max", "free")
        check(f"{name} is limited: {label}", low != "free", bool(model.jnt_limited[index]))
        if model.jnt_limited[index]:
            reference = model.qpos0[model.jnt_qposadr[index]]
            ends = [low - angle, high - angle] if sign > 0 else [angle - high, angle - low]
            check(f"{name} range: {label}", ends, model.jnt_range[index] - reference)
        dof = model.jnt_dofadr[index]
        check(f"{name} friction: {label}", axis.get("friction", 0), model.dof_frictionloss[dof])
        viscous = np.ravel(model.dof_damping[dof])[0]
        check(f"{name} damping: {label}", axis.get("damping", 0), viscous, 1 + viscous)
        check(f"{name} armature: {label}", axis.get("armature", 0), model.dof_armature[dof])
        stiffness, damping, motor = np.ravel(model.jnt_stiffness[index])[0], 0.0, 0.0
        for i in range(model.nu):
            if model.actuator_trntype[i] != mujoco.mjtTrn.mjTRN_JOINT or model.actuator_trnid[i, 0] != index:
                continue
            if model.actuator_gaintype[i] != mujoco.mjtGain.mjGAIN_FIXED:  # no drive
                continue
            gear, bias = model.actuator_gear[i, 0], model.actuator_biasprm[i]
            stiffness, damping = stiffness - gear ** 2 * bias[1], damping - gear ** 2 * bias[2]
            motor += gear * bias[0] if bias[1] == 0 and bias[2] == 0 else 0
        check(f"{name} stiffness: {label}", axis.get("drive_stiffness", 0), stiffness, 1 + stiffness)
        check(f"{name} drive damping: {label}", axis.get("drive_damping", 0), damping, 1 + damping)
        check(f"{name} motor: {label}", axis.get("motor_force", 0), motor * sign, 1 + abs(motor))


def compare_tendons(model, scene, name):
    for index in range(model.ntendon):
        label = model.tendon(index).name
        own = joint_named(scene, label)
        if own is None:
            problems.append(f"{name}: no tendon {label}")
            continue
        axis = own.get("axes", [{}])[0]
        stiffness = np.ravel(model.tendon_stiffness[index])[0]
        if stiffness > 0 and model.tendon_lengthspring[index, 0] == model.tendon_lengthspring[index, 1]:
            start = own.get("terms") and not own.get("path")
            if not start:
                check(f"{name} rest length: {label}", axis.get("target_position", 0),
                      model.tendon_lengthspring[index, 0])
        if model.tendon_limited[index] and own.get("path"):
            check(f"{name} tendon range: {label}", [axis.get("min"), axis.get("max")],
                  model.tendon_range[index])
        check(f"{name} tendon friction: {label}", axis.get("friction", 0), model.tendon_frictionloss[index])
        check(f"{name} tendon damping: {label}", axis.get("damping", 0),
              np.ravel(model.tendon_damping[index])[0])
        check(f"{name} tendon armature: {label}", axis.get("armature", 0), model.tendon_armature[index])


def compare_geoms(model, data, scene, name):
    own = [part for body in scene["bodies"] for part in parts_of(body)]
    types = {mujoco.mjtGeom.mjGEOM_SPHERE: ("sphere", 1), mujoco.mjtGeom.mjGEOM_BOX: ("box", 3),
             mujoco.mjtGeom.mjGEOM_CAPSULE: ("capsule", 2), mujoco.mjtGeom.mjGEOM_CYLINDER: ("cylinder", 2)}
    if not np.any(model.geom_contype | model.geom_conaffinity):
        return
    for index in range(model.ngeom):
        kind = types.get(mujoco.mjtGeom(model.geom_type[index]))
        if kind is None or (model.geom_contype[index] == 0 and model.geom_conaffinity[index] == 0):
            continue
        label = f"{name} geom: {index}"
        candidates = [part for part in own if part[0] == kind[0]]
        nearest = min(candidates, default=None, key=lambda p: np.linalg.norm(p[2] - data.geom_xpos[index])
                      + np.linalg.norm(np.subtract(p[1], model.geom_size[index][:kind[1]])))
        if nearest is None:
            problems.append(f"{label}: no {kind[0]}")
            continue
        check(label.replace("geom", "size of geom", 1), nearest[1], model.geom_size[index][:kind[1]])
        check(label.replace("geom", "position of geom", 1), nearest[2], data.geom_xpos[index])
        if kind[0] != "sphere":
            z, theirs = nearest[3][:, 2], data.geom_xmat[index].reshape(3, 3)[:, 2]
            check(label.replace("geom", "axis of geom", 1), abs(z @ theirs), 1)


def compare_looks(model, scene, name):
    """Colors of what the viewer of MuJoCo shows, apart from its usual gray and from textures."""
    gray, own, theirs = (0.5, 0.5, 0.5), [], []
    for look in scene.get("looks", []):
        own += [tuple(np.round(part["color"], 5)) for part in look["parts"] if "color" in part]
    for index in range(model.ngeom):
        color, material = model.geom_rgba[index], model.geom_matid[index]
        if material >= 0 and model.mat_texid[material].max() >= 0:
            continue
        if material >= 0 and np.allclose(color, [*gray, 1]):
            color = model.mat_rgba[material]
        if 0 <= model.geom_group[index] <= 2 and color[3] > 0:
            theirs.append(tuple(np.round(color[:3].astype(float), 5)))
    plain = [c for c in theirs if c != gray]
    if sorted(c for c in own if c in plain) != sorted(plain):
        problems.append(f"{name}: colors {sorted(own)} here, {sorted(plain)} in MuJoCo")
    counts["colors"] = counts.get("colors", 0) + 3 * len(plain)


def import_scene(rubble, file, folder, *options):
    scene = folder / (file.stem + ".json")
    run(rubble, "import", file, "-q", "-o", scene, *options)
    return json.loads(scene.read_text())


def compare(rubble, file, folder):
    if file.suffix == ".urdf":
        # MuJoCo finds meshes beside the file only
        text = file.read_text().replace("package://models/", "").replace("<robot", '<robot xmlns:m="x"', 1)
        settings = '<mujoco><compiler strippath="false"/></mujoco>'
        text = text.replace('<link name="base">', settings + '<link name="base">', 1)
        copy = file.parent / "oracle_copy.urdf"
        copy.write_text(text)
        try:
            model = mujoco.MjModel.from_xml_path(str(copy))
        finally:
            copy.unlink()
    else:
        model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    scene = import_scene(rubble, file, folder)
    name = file.stem
    check(f"{name} gravity", scene["gravity"], model.opt.gravity)
    compare_bodies(model, data, scene, name)
    compare_joints(model, data, scene, name)
    compare_tendons(model, scene, name)
    compare_geoms(model, data, scene, name)
    if file.suffix == ".xml":
        compare_looks(model, scene, name)


def compare_keys(rubble, file, folder):
    """Bodies in each keyframe that has a name, those of attached models among them."""
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    for key in range(model.nkey):
        if not (label := model.key(key).name):
            continue
        mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        scene = import_scene(rubble, file, folder, "--key", label)
        compare_bodies(model, data, scene, f"{file.stem} keyframe {label}:")


def compare_flexcomps(rubble, folder):
    """Vertices in their order, and elements, of the types that MuJoCo generates."""
    kinds = [("grid", 1, "5 1 1"), ("circle", 1, "7 1 1"), ("grid", 2, "3 4 1"), ("square", 2, "4 3 1"),
             ("disc", 2, "5 4 1"), ("grid", 3, "2 3 4"), *((kind, dim, "4 3 5") for dim in (2, 3)
                                                         for kind in ("box", "cylinder", "ellipsoid"))]
    for kind, dim, count in kinds:
        file = folder / f"{kind}_{dim}.xml"
        file.write_text(f"""<mujoco><worldbody><body name="b" pos="0 0 1">
            <flexcomp name="f" type="{kind}" dim="{dim}"
            count="{count}" spacing=".1 .2 .3" radius=".01" pos="1 2 3" euler="10 20 30" mass="2">
            <edge equality="true"/></flexcomp></body>
            </worldbody></mujoco>""")
        model = mujoco.MjModel.from_xml_path(str(file))
        if model.flex_dim[0] != dim:  # versions before 4 have no shells
            continue
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_flex(model, data)
        own = import_scene(rubble, file, folder)["deformables"][0]
        check(f"vertices of flexible objects: {file.stem}", own["vertices"], data.flexvert_xpos)
        theirs = model.flex_elem.reshape(-1, dim + 1)
        if dim == 1:
            check(f"cables that are closed: {file.stem}", own.get("closed", False), theirs[-1, 1] == 0)
            continue
        elements = np.array(own["triangles" if dim == 2 else "tetrahedra"])
        if dim == 2:
            normals = [np.cross(*(data.flexvert_xpos[e[:, 1:]] - data.flexvert_xpos[e[:, :1]]).swapaxes(0, 1))
                       for e in (each[np.lexsort(np.sort(each).T)] for each in (elements, theirs))]
            check(f"normals of sheets: {file.stem}", *normals)
        if (kind, dim) != ("grid", 3):  # its cells are divided otherwise
            check(f"elements: {file.stem}", *(sorted(map(sorted, e.tolist())) for e in (elements, theirs)))
        corners = data.flexvert_xpos[theirs] - data.flexvert_xpos[theirs[:, :1]]
        sizes = np.abs(np.linalg.det(corners[:, 1:])) / 6 if dim == 3 else \
            np.linalg.norm(np.cross(corners[:, 1], corners[:, 2]), axis=1) / 2
        height = own["thickness"] if dim == 2 else 1
        check(f"masses of flexible objects: {file.stem}", own["density"] * sizes.sum() * height, 2)


def positions(rubble, scene, bodies, steps, dt, folder, iterations="8"):
    """Positions of the bodies after so many steps."""
    axes = ("x_m", "y_m", "z_m")
    scene["verdict"] = [{"metric": f"{body}.{axis}", "min": -1e9} for body in bodies for axis in axes]
    file = folder / "moment.json"
    file.write_text(json.dumps(scene))
    record = json.loads(run(rubble, "run", file, "--backend", "reference", "--steps", steps, "--dt", dt,
                            "--iterations", iterations, "-q", "--json", "-"))
    metrics = {claim["metric"]: claim["value"] for claim in record["verdict"]["claims"]}
    return np.array([[metrics[f"{body}.{axis}"] for axis in axes] for body in bodies])


def compare_push(rubble, name, impulse, folder):
    """Does a standing robot fall after an impulse on all of its bodies [N s], as MuJoCo's does?"""
    file, settled, end = MODELS / (name + ".xml"), 2.0, 5.0
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    change = np.array([*impulse, 0]) / model.body_mass.sum()
    while data.time < settled:
        mujoco.mj_step(model, data)
    stood = data.qpos[2]
    data.qvel[:3] += change
    while data.time < end:
        mujoco.mj_step(model, data)
    theirs = data.qpos[2] / stood
    scene = import_scene(rubble, file, folder, "--key", "stand")
    moving = [b["name"] for b in scene["bodies"] if b.get("motion", "dynamic") == "dynamic" and "mass" in b]
    dt, root = model.opt.timestep, model.body(1).name
    before = positions(rubble, scene, [root], round(settled / dt), dt, folder, "4")[0, 2]
    scene["events"] = [{"step": round(settled / dt),
                        "set_velocity": [{"body": body, "velocity": change.tolist()} for body in moving]}]
    own = positions(rubble, scene, [root], round(end / dt), dt, folder, "4")[0, 2] / before
    print(f"oracle: {name} pushed by {impulse} N s: at {own:.2f} of its height here, {theirs:.2f} in MuJoCo")
    if (own > 0.95) != (theirs > 0.95):
        problems.append(f"{name} pushed by {impulse}: {own:.2f} of its height here, {theirs:.2f} in MuJoCo")


def compare_motion(rubble, name, bodies, size, folder, key=None, file=None, step=1e-4, rate=8000,
                   iterations="8", moments=(0.25, 0.5, 1.0, 1.5, 2.0)):
    """Largest distance from MuJoCo over two seconds, over the size of the mechanism."""
    file = file or MODELS / (name + ".xml")
    scene = import_scene(rubble, file, folder, *(["--key", key] if key else []))
    model = mujoco.MjModel.from_xml_path(str(file))
    model.opt.timestep, model.opt.integrator = step, mujoco.mjtIntegrator.mjINT_RK4
    model.eq_solref[:], model.eq_solimp[:, :2] = [2.5 * step, 1], 0.9999
    data = mujoco.MjData(model)
    if key:
        mujoco.mj_resetDataKeyframe(model, data, model.key(key).id)
    worst = 0.0
    for moment in moments:
        while data.time < moment - step / 2:
            mujoco.mj_step(model, data)
        theirs = np.array([data.body(body).xpos for body in bodies])
        own = positions(rubble, scene, bodies, round(moment * rate), 1 / rate, folder, iterations)
        worst = max(worst, np.abs(own - theirs).max() / size)
    print(f"oracle: {name}: at most {100 * worst:.3f} % from MuJoCo over 2 s")
    if not worst < 0.01:
        problems.append(f"{name}: {100 * worst:.2f} % from MuJoCo, at most 1 %")


def compare_compounds(rubble, folder):
    """Generated mechanisms of bodies with several joints: as they stand, and their motion."""
    for make, seeds in ((compound_models.hinges, 20), (compound_models.couplings, 8)):
        name, (text, bodies) = make.__name__, make(range(seeds))
        file = folder / (name + ".xml")
        file.write_text(text)
        compare(rubble, file, folder)
        compare_motion(rubble, name, bodies, compound_models.SIZE, folder, "on", file, 2.5e-4, 2000, "2",
                       (0.5, 2.0))


def compare_rest(rubble, name, key, bodies, folder, seconds=3.0, most=2e-4):
    """Distance from where bodies rest in MuJoCo, at 4 iterations and the time step of the model [m]."""
    file = MODELS / (name + ".xml")
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    if key:
        mujoco.mj_resetDataKeyframe(model, data, model.key(key).id)
    while data.time < seconds - model.opt.timestep / 2:
        mujoco.mj_step(model, data)
    dt = model.opt.timestep
    scene = import_scene(rubble, file, folder, *(["--key", key] if key else []))
    own = positions(rubble, scene, bodies, round(seconds / dt), dt, folder, "4")
    worst = np.abs(own - np.array([data.body(body).xpos for body in bodies])).max()
    print(f"oracle: {name} {key or ''} comes to rest {1000 * worst:.3f} mm from where it does in MuJoCo")
    if not worst < most:
        problems.append(f"{name} {key}: at rest {1000 * worst:.2f} mm from MuJoCo, at most {1000 * most:.2f}")


def compare_sensors(rubble, name, folder, seconds=0.4, most=5e-3):
    """Readings after a time, over the largest one of each sensor until then."""
    file = MODELS / (name + ".xml")
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    steps, substeps = 40, 40
    dt = seconds / steps / substeps
    model.opt.timestep, model.opt.integrator = dt, mujoco.mjtIntegrator.mjINT_RK4
    theirs = []
    for _ in range(steps * substeps):
        mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        theirs.append(data.sensordata.copy())
    theirs = np.array(theirs)
    import_scene(rubble, file, folder)
    readings = folder / "readings.csv"
    run(rubble, "run", folder / (name + ".json"), "--backend", "reference",
        "--dt", dt, "--steps", len(theirs),
        "--iterations", "20", "-q", "--sensors", readings)
    with open(readings, encoding="utf-8") as lines:
        names = lines.readline().strip().split(",")
    own = np.loadtxt(readings, delimiter=",", skiprows=1)[1:]
    compared, worst = 0, 0.0
    for index in range(model.nsensor):
        sensor = model.sensor(index)
        columns = [k for k, column in enumerate(names) if column.split(".")[0] == sensor.name]
        if not columns:
            continue
        at = model.sensor_adr[index]
        expected = theirs[:, at:at + len(columns)]
        if sensor.name == "tip_turn" and expected[-1] @ own[-1, columns] < 0:
            expected = -expected
        # contacts settle in MuJoCo, and its forces are those of the instant
        last = slice(-20, None)
        error = np.abs(own[last, columns].mean(0) - expected[last].mean(0)).max()
        scale = max(np.abs(expected).max(), 1e-3)
        compared, worst = compared + len(columns), max(worst, error / scale)
        if not error < most * scale:
            problems.append(f"{name} {sensor.name}: {own[last, columns].mean(0)} here, "
                            f"{expected[last].mean(0)} in MuJoCo")
    print(f"oracle: {compared} readings of {name}: at most {100 * worst:.3f} % from MuJoCo")
    counts["readings"] = compared


def main():
    rubble = str(pathlib.Path(sys.argv[1]).resolve())
    files = [pathlib.Path(f).resolve() for f in sys.argv[2:]]
    with tempfile.TemporaryDirectory() as path:
        folder = pathlib.Path(path)
        os.chdir(folder)  # MuJoCo logs into the present one
        for file in files or sorted(MODELS.glob("*.xml")) + sorted(MODELS.glob("*.urdf")):
            if not file.stem.endswith("_part") and (HAS_COMPOSITES or "composite" not in file.stem):
                compare(rubble, file, folder)
                if file.suffix == ".xml":
                    compare_keys(rubble, file, folder)
        for seed in range(0 if files else 30):
            for ending, make in (("xml", generated_models.model), ("urdf", generated_models.robot)):
                file = folder / f"generated_{seed}.{ending}"
                file.write_text(make(seed))
                compare(rubble, file, folder)
        if not files:
            compare_flexcomps(rubble, folder)
            compare_compounds(rubble, folder)
            compare_motion(rubble, "pendulum", ["bob"], 1.0, folder)
            compare_motion(rubble, "double_pendulum", ["upper", "lower"], 0.9, folder)
            compare_motion(rubble, "two_hinges", ["bob"], 0.7, folder)
            compare_motion(rubble, "reach", ["bob", "tip"], 1.0, folder)
            compare_motion(rubble, "fourbar", ["crank", "coupler", "rocker"], 0.8, folder)
            compare_motion(rubble, "armature_pendulum", ["upper", "lower"], 0.9, folder)
            compare_motion(rubble, "geared", ["slow", "fast", "rod", "cam"], 0.5, folder)
            compare_motion(rubble, "finger", ["proximal", "middle", "distal"], 0.11, folder)
            compare_motion(rubble, "wrapped", ["arm", "fore", "load", "bob"], 0.4, folder)
            compare_motion(rubble, "two_tendons", ["a", "b", "c", "d"], 0.6, folder)
            compare_motion(rubble, "telescope", ["s1", "s4", "h1", "h4"], 0.4, folder)
            compare_motion(rubble, "gimbals", ["thigh", "foot", "arm"], 0.5, folder, "away")
            compare_motion(rubble, "compound", ["paddle", "wheel", "wrist", "carriage"], 0.4, folder, "on")
            compare_motion(rubble, "muscle_arm", ["upper", "fore"], 0.55, folder, "lift")
            compare_motion(rubble, "filters", [*"abcdefg"], 1.0, folder, "on")
            compare_motion(rubble, "rotors", ["craft"], 1.0, folder, "fly")
            compare_motion(rubble, "cable", ["link2", "link6", "link11"], 0.96, folder)
            if HAS_COMPOSITES:
                compare_motion(rubble, "composite_cable", ["cB_1", "cB_5", "cB_last"], 1.0, folder)
            compare_sensors(rubble, "sensors", folder)
            compare_rest(rubble, "soft_limits", "", ["slide", "flap", "tip", "a", "b", "ball"], folder)
            compare_rest(rubble, "drone", "hover", ["drone"], folder)
            compare_rest(rubble, "hanging", "hold", ["box"], folder)
            compare_rest(rubble, "gripper", "half", ["left_follower", "right_follower"], folder, most=1e-3)
            for impulse in ([50, 0], [0, 50], [10, 0], [0, 10]):
                compare_push(rubble, "standing_humanoid", impulse, folder)
                compare_push(rubble, "standing_quadruped", impulse, folder)
    for problem in problems:
        print("oracle:", problem)
    print(f"oracle: {sum(counts.values())} numbers compared, {len(problems)} problems")
    return 1 if problems else 0


sys.exit(main())
