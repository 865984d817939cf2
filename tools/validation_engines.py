"""Comparisons of the validation book with a trusted engine: the same model, and readings of the same sensors.

A model is an MJCF file of docs/validation/models/ with sensors. What the engine reads is kept in
docs/validation/references/ with its name, version and settings: the book is made without the engine."""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

INTERVAL = 0.1  # s between readings; a multiple of every time step of the book


def model_path(root, entry):
    return root / "docs/validation/models" / f"{entry['model']}.xml"


def reference_path(root, entry):
    return root / "docs/validation/references" / f"{entry['model']}.json"


def reference(root, entry):
    """{"engine", "settings", "seconds", "readings": {sensor: [[numbers of a moment], ...]}}"""
    return json.loads(reference_path(root, entry).read_text(encoding="utf-8"))


def readings(rubble, backend, path, key, steps, options, timeout):
    """{sensor: [[numbers after a step], ...]}, and the report of the run."""
    with tempfile.TemporaryDirectory() as folder:
        scene, table = pathlib.Path(folder) / "model.json", pathlib.Path(folder) / "readings.csv"
        command = [rubble, "import", str(path), "-q", "-o", str(scene)] + (["--key", key] if key else [])
        subprocess.run(command, capture_output=True, check=True)
        command = [rubble, "run", str(scene), "--backend", backend, "--threads", "1", "--no-stages", "-q",
                   "--json", "-", "--steps", str(steps), "--sensors", str(table), *options]
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout)
        if done.returncode not in (0, 1):
            raise RuntimeError(f"{path.name}: {done.stderr.strip()}")
        with table.open(encoding="utf-8") as lines:
            rows = list(csv.reader(lines))
    columns = {}
    for index, name in enumerate(rows[0]):
        columns.setdefault(name.split(".")[0], []).append(index)
    numbers = [[float(value) for value in row] for row in rows[1:]]
    report = json.loads(done.stdout)
    return ({name: [[row[k] for k in places] for row in numbers] for name, places in columns.items()},
            report[0] if isinstance(report, list) else report)


def error(entry, known, own, rate):
    """Largest distance of a motion from the engine's over the size of the model; of forces at rest, over the
    largest reading."""
    every = round(INTERVAL * rate)
    size = entry.get("size") or max(abs(v) for each in known["readings"].values() for v in each[-1])
    worst = 0.0
    for name, theirs in known["readings"].items():
        mine = own[name]
        after = len(mine) - round(known["seconds"] * rate)  # 1 where the table begins before the first step
        if "size" in entry:
            pairs = [(mine[(k + 1) * every - 1 + after], moment) for k, moment in enumerate(theirs)]
        else:
            last = mine[-every:]
            pairs = [([sum(column) / every for column in zip(*last)], theirs[-1])]
        for here, there in pairs:
            distance = max(abs(a - b) for a, b in zip(here, there, strict=True))
            worst = max(worst, distance) if distance == distance else float("inf")
    return worst / size


def measure(root, rubble, backend, entry, iterations, rate, timeout):
    known = reference(root, entry)
    own, report = readings(rubble, backend, model_path(root, entry), entry.get("key"),
                           round(known["seconds"] * rate),
                           ["-i", str(iterations), "--dt", repr(1 / rate)], timeout)
    claim = {"metric": entry["metric"], "value": error(entry, known, own, rate), "min": None,
             "max": entry["at_most"]}
    return {**report, "verdict": {"claims": [claim]}}


def record(root, entry):
    """Runs the model in MuJoCo: small steps, the integrator RK4, constraints as hard as its step allows."""
    import mujoco
    step = 1 / entry.get("reference_rate", 10000)
    model = mujoco.MjModel.from_xml_path(str(model_path(root, entry)))
    model.opt.timestep, model.opt.integrator = step, mujoco.mjtIntegrator.mjINT_RK4
    hardness, width = [2.5 * step, 1], 0.9999
    model.eq_solref[:], model.eq_solimp[:, :2] = hardness, width
    model.geom_solref[:], model.geom_solimp[:, :2] = hardness, width
    model.opt.tolerance, model.opt.iterations = 1e-12, 200
    data = mujoco.MjData(model)
    if "key" in entry:
        mujoco.mj_resetDataKeyframe(model, data, model.key(entry["key"]).id)
    every, moments = round(INTERVAL / step), round(entry["seconds"] / INTERVAL)
    found = {model.sensor(index).name: [] for index in range(model.nsensor)}
    for _ in range(moments):
        for _ in range(every):
            mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        for name, rows in found.items():
            rows.append([float(f"{value:.7g}") for value in data.sensor(name).data])
    path = reference_path(root, entry)
    path.parent.mkdir(parents=True, exist_ok=True)
    content = {"engine": f"MuJoCo {mujoco.__version__}",
               "settings": f"time step 1/{round(1 / step)} s, RK4, "
                           f"solref {hardness[0]:.3g} {hardness[1]}, solimp {width}",
               "seconds": entry["seconds"], "interval": INTERVAL}
    lines = [f'"{name}": {json.dumps(value)},' for name, value in content.items()]
    rows = [f'"{name}": [\n' + ",\n".join(map(json.dumps, values)) + "\n]" for name, values in found.items()]
    path.write_text("{\n" + "\n".join(lines) + '\n"readings": {\n' + ",\n".join(rows) + "\n}\n}\n",
                    encoding="utf-8")


def record_all(root, entries):
    try:
        import mujoco  # noqa: F401
    except ImportError:
        sys.exit("make_validation: --references needs mujoco (pip install mujoco)")
    for entry in entries:
        print(f"reference of {entry['model']}", file=sys.stderr)
        record(root, entry)
