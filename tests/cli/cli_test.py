#!/usr/bin/env python3
"""Drives the real program: exit status, messages, what the files hold. Usage: cli_test.py PATH_OF_RUBBLE"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

RUBBLE = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else "rubble"
FILES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scenes", "files")

RECORD_KEYS = {
    "scene", "backend", "device", "threads", "commit", "bodies", "manifolds", "contacts", "colors", "clashes", "iterations", "dt",
    "settled_ms", "smash_ms", "stages_ms", "smash_stages_ms", "restarts", "solve_ms", "collision_ms", "total_ms", "top_drop_m", "penetration_m", "joint_gap_m",
    "energy_j", "engine_mb", "bytes_per_body", "rss_mb", "verdict", "machine", "date"}

FALLING = {
    "name": "falling ball",
    "steps": 30,
    "bodies": [{"name": "ball", "shape": {"type": "sphere", "radius": 0.5}, "position": [0, 0, 100]}],
}
DRAWS = json.loads(subprocess.run([RUBBLE, "info", "build", "--json"], capture_output=True, text=True,
                                  check=True).stdout)["drawing"]["pictures"].startswith("on")


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, content):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(content if isinstance(content, str) else json.dumps(content))
        return self.path(name)

    def falling(self, **changes):
        return self.write("falling.json", {**FALLING, **changes})

    def rubble(self, *arguments, status=0):
        done = subprocess.run([RUBBLE, *arguments], capture_output=True, text=True, timeout=600)
        self.assertEqual(done.returncode, status, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def refused(self, *arguments, says):
        """Status 2, the message on standard error, nothing on standard output."""
        done = self.rubble(*arguments, status=2)
        self.assertIn(says, done.stderr)
        self.assertEqual(done.stdout, "")
        return done


class Replay(Case):
    def test_the_same_bits_or_the_first_difference(self):
        log = self.path("fall.inputs")
        self.rubble("run", self.falling(), "--steps", "5", "--quiet", "--record-inputs", log)
        replayed = self.rubble("replay", log, "--check", "--threads", "2").stdout
        self.assertIn("5 steps, the same bits", replayed)
        self.rubble("replay", log, "--record-inputs", self.path("again.inputs"))
        with open(log, "rb") as first, open(self.path("again.inputs"), "rb") as second:
            self.assertEqual(first.read(), second.read())
        with open(log, encoding="utf-8") as file:
            lines = file.read().splitlines()
        step = json.loads(lines[3])
        step["hashes"] = [value + 1 for value in step["hashes"]]
        lines[3] = json.dumps(step)
        other = self.write("other.inputs", "\n".join(lines) + "\n")
        self.assertIn("after step 3", self.rubble("replay", other, "--check", status=1).stdout)
        self.rubble("replay", other)
        self.refused("replay", self.write("damaged.inputs", lines[0] + "\n{"), says="line 2")
        self.refused("replay", self.path("none"), says="none")
        done = self.refused("replay", self.write("empty.inputs", ""),
                            says="expected a log of inputs, got an empty file")
        done = self.refused("replay", self.write("text.inputs", "no"), says="line 1")
        self.assertNotIn("json.exception", done.stderr)


class Usage(Case):
    def test_help_everywhere(self):
        self.assertIn("Subcommands", self.rubble("--help").stdout)
        for command in ["run", "bench", "check", "compare", "demo", "info", "picture", "plot", "render",
                        "replay", "soak", "view"]:
            self.assertIn("Usage: rubble " + command, self.rubble(command, "--help").stdout)
        self.assertRegex(self.rubble("--version").stdout, r"^rubble \d+\.\d+\.\d+")

    def test_bad_usage(self):
        self.refused(says="subcommand")
        self.refused("fly", says="fly")
        self.refused("run", says="scene")
        self.refused("run", "pile-1k", "--steps", "0", says="--steps")
        self.refused("run", "pile-1k", "--steps", "many", says="--steps")
        self.refused("run", "pile-1k", "--whatever", says="--whatever")
        self.refused("bench", says="scenes")
        self.refused("picture", "pile-1k", says="--out")

    def test_output_that_is_lost_is_a_failure(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([RUBBLE, "info", "build"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=600)
        self.assertEqual(done.returncode, 2)
        self.assertIn("rubble: ", done.stderr)

    def test_more_threads_than_cores_say_nothing(self):
        done = self.rubble("run", "tower", "--steps", "3", "--threads", str(os.cpu_count() + 3))
        self.assertNotIn("arning", done.stderr)

    def test_threads_have_a_bound(self):
        self.refused("run", "pyramid", "--steps", "1", "--threads", "1000000", says="threads: expected a number from 0 to 1024")

    def test_check_cooks_shapes(self):
        flat = {"type": "hull", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]}
        file = self.write("flat.json", {"bodies": [{"shape": flat}]})
        self.refused("check", file, says="bodies[0].shape.points")
        fault = json.loads(self.rubble("check", file, "--json", status=2).stdout)[0]["faults"][0]
        self.assertEqual(fault["path"], "bodies[0].shape.points")
        self.assertTrue(fault["message"].startswith("expected "))
        late = {**FALLING, "events": [{"step": 3, "add": [{"shape": flat}]}]}
        self.refused("check", self.write("late.json", late), says="events[0].add[0].shape.points: expected")

    def test_names_that_do_not_exist(self):
        self.assertIn("pile-1k", self.refused("run", "pile-1kk", says="pile-1kk").stderr)
        self.refused("run", "pile-1k", "--arg", "nxx=3", says="nxx")
        self.refused("run", "pile-1k", "--arg", "nx", says="NAME=VALUE")
        self.refused("run", "pile-1k", "--arg", "nx=three", says="a number")
        self.refused("run", "pile-1k", "--arg", "nx=-3", says="nx")
        self.refused("run", "pile-1k", "--backend", "abacus", says="cpu")
        self.refused("run", "pile-1k", "--preset", "magic", says="engine, paper or demo3d")
        self.refused("run", "pile-1k", "--param", "magic=1", says="magic")
        self.refused("run", "nowhere.json", says="nowhere.json")
        self.refused("run", "pile-1k", "--picture", "x.png", "--size", "big", says="--size")
        self.refused("run", "pile-1k", "--at", "3", says="--picture")

    def test_mistyped_words_are_answered_with_near_ones(self):
        for words, says in [(["runn", "pile-1k"], "did you mean run?"), (["info", "sceens"], "or scenes?"),
                            (["run", "pile-1k", "--step", "10"], "did you mean --steps"),
                            (["sceens"], "did you mean info scene or info scenes?"),
                            (["pile-1kk"], "run pile-1k"),
                            (["run", "pile-1k", "--param", "iteration=5"], "iterations"),
                            (["run", "pile-1k", "--param", "K=5"], "rubble info params"),
                            (["run", "scene.yaml"], ".json"), (["run", "zzzzzzzz"], "rubble info scenes")]:
            self.assertLess(len(self.refused(*words, says=says).stderr), 500, words)

    def test_numbers_say_what_was_expected(self):
        whole = "expected a whole number from 1 to 2147483647, got "
        for option, value, says in [("-n", "0", whole), ("-n", "abc", whole), ("-n", "3.5", whole),
                                    ("-i", "nan", whole),
                                    ("-n", "9" * 20, whole + "9" * 20), ("-n", "1" * 400, whole),
                                    ("--dt", "-1", "expected a number above 0"),
                                    ("-t", "-1", "expected a whole number from 0 to")]:
            done = self.refused("run", "pile-1k", option, value, says=says)
            self.assertLess(len(done.stderr), 300)

    def test_help_lists_names_alone(self):
        text = self.rubble("run", "--help").stdout
        self.assertIn("{letters,messages,stores}", text)
        self.assertNotIn("->", text)
        self.refused("run", "pile-1k", "--exchange", "pigeons", says="{letters,messages,stores}")

    def test_a_backend_that_is_off_says_why(self):
        if "cuda" not in json.loads(self.rubble("info", "build", "--json").stdout)["backends"]:
            self.refused("run", "pile-1k", "-b", "cuda", says="off: ")

    def test_info_names_the_instruction_sets(self):
        sets = json.loads(self.rubble("info", "build", "--json").stdout)["instruction_sets"]
        self.assertEqual(sets[0], "baseline")
        self.assertIn(f"{sets[-1]} (of {', '.join(sets)})", self.rubble("info", "build").stdout)

    def test_completion_and_manual_name_everything(self):
        for shell, program in [("bash", "bash"), ("zsh", "zsh"), ("fish", "fish")]:
            script = self.rubble("completion", shell).stdout
            for word in ["compare", "tower-20", "camera-path"]:
                self.assertIn(word, script)
            if shutil.which(program):
                subprocess.run([program, "-n"], input=script, text=True, check=True)
        complete = ("source /dev/stdin; COMP_WORDS=(rubble {}); COMP_CWORD={}; _rubble; "
                    "echo ${{COMPREPLY[@]}}")
        script = self.rubble("completion", "bash").stdout
        for words, count, wanted in [("com", 1, "compare"), ("info scen", 2, "scenes"),
                                     ("run --rec", 2, "--record-inputs"), ("run tower-2", 2, "tower-20")]:
            done = subprocess.run(["bash", "-c", complete.format(words, count)], input=script, text=True,
                                  capture_output=True)
            self.assertIn(wanted, done.stdout.split(), done.stderr)
        manual = self.rubble("man").stdout
        self.assertTrue(manual.startswith(".TH RUBBLE 1"))
        for word in ["rubble info scenes", "camera\\-path", "EXIT STATUS"]:
            self.assertIn(word, manual)

    def test_reports_as_json(self):
        good, bad = self.falling(), self.write("bad.json", {"bodies": [{"shape": {"type": "box"}, "mas": 1}]})
        listed = json.loads(self.rubble("check", good, bad, "--json", status=2).stdout)
        self.assertEqual([entry["good"] for entry in listed], [True, False])
        self.assertTrue(all(fault["message"] for fault in listed[1]["faults"]))
        empty = self.write("empty.json", "")
        done = self.rubble("check", self.path("none.json"), empty, good, "--json", status=2)
        listed = json.loads(done.stdout)
        self.assertEqual([entry["good"] for entry in listed], [False, False, True])
        self.assertEqual(listed[1]["faults"][0]["message"], "expected a scene, got an empty file")
        compared = json.loads(self.rubble("compare", good, "--steps", "3", "--json").stdout)
        self.assertEqual([entry["step"] for entry in compared["steps"]], [1, 2, 3])

    def test_outputs_are_opened_before_the_first_step(self):
        for option in ["--json", "--record", "--record-inputs"]:
            done = self.rubble("run", self.falling(), option, "/nowhere/out.rubble", status=2)
            self.assertNotIn("step", done.stderr)
        for words in [["run", self.falling(), "--every", "30", "--checkpoint"],
                      ["bench", self.falling(), "--json"],
                      ["bench", "--search-60hz", "--json"], ["soak", "--steps", "5", "--json"],
                      ["export", self.falling(), "--record", self.path("kept.rubble"), "-o"]]:
            done = self.refused(*words, "/nowhere/out.csv",
                                says="/nowhere/out.csv: expected a file that can be written")
            self.assertNotIn("step", done.stderr)
        self.assertFalse(os.path.exists(self.path("kept.rubble")))

    def test_what_was_written_as_json(self):
        def written(*words):
            record = json.loads(self.rubble(*words, "-q", "--json").stdout)
            for entry in record["files"]:
                self.assertEqual(entry["bytes"], os.path.getsize(entry["file"]))
            return [os.path.basename(entry["file"]) for entry in record["files"]], record

        files, record = written("export", self.falling(), "--steps", "3", "-o", self.path("fall.csv"))
        self.assertEqual((files, record["frames"]), (["fall.csv"], 4))
        files, record = written("demo", "--scene", self.falling(), "--out", self.path("out"), "--steps", "3",
                                "--no-film")
        self.assertEqual(set(files), set(os.listdir(self.path("out"))))
        self.assertIs(record["holds"], True)
        cube = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1))
        cube += "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
        mesh = self.write("cube.obj", cube)
        files, record = written("fracture", mesh, "--pieces", "3", "-o", self.path("cube.json"))
        self.assertEqual(files, ["cube.json"])
        self.assertGreaterEqual(record["bodies"], 3)
        self.refused("fracture", mesh, "--json", "--run", says="--json")

    def test_files_that_cannot_be_written(self):
        for option in ["--json", "--record", "--picture"]:
            self.refused_late(option)

    def refused_late(self, option):
        done = self.rubble("run", self.falling(steps=2), "-q", option, "/nowhere/at/all.png", status=2)
        self.assertIn("/nowhere/at/all.png", done.stderr)


class Run(Case):
    def test_free_fall_and_verdict(self):
        # Implicit Euler: g dt^2 n (n + 1) / 2.
        fall = 9.81 / 3600 * 30 * 31 / 2
        claim = {"metric": "ball.drop_m", "min": fall * 0.9999, "max": fall * 1.0001, "why": "free fall"}
        done = self.rubble("run", self.falling(verdict=[claim]))
        self.assertIn("verdict: holds", done.stdout)
        self.assertIn("free fall", done.stdout)
        self.assertIn("step 30/30", done.stderr)
        done = self.rubble("run", self.falling(verdict=[{**claim, "max": fall * 0.99991}]), status=1)
        self.assertIn("verdict: does not hold", done.stdout)

    def test_time_step_scales_steps(self):
        record = json.loads(self.rubble("run", self.falling(), "--dt", "0.008333333333333333", "--json", "-").stdout)
        self.assertAlmostEqual(record["dt"], 1 / 120)
        self.assertIn("step 60/60", self.rubble("run", self.falling(), "--dt", "0.008333333333333333").stderr)

    def test_a_time_step_too_short_for_the_number_of_steps_is_refused(self):
        self.refused("run", self.falling(steps=2000000000), "--dt", "1e-6", says="--dt")

    def test_quiet_says_nothing(self):
        done = self.rubble("run", self.falling(), "-q")
        self.assertEqual((done.stdout, done.stderr), ("", ""))

    def test_goes_on_from_a_checkpoint_of_the_same_scene_and_parameters(self):
        def end(scene, *arguments):
            self.rubble("run", scene, "-q", "--hash", "--json", self.path("end.json"), *arguments)
            with open(self.path("end.json"), encoding="utf-8") as file:
                return json.load(file)["hash"]

        state = self.path("fall.state")
        scene = self.falling()
        whole = end(scene, "--steps", "9", "--checkpoint", state, "--every", "5")
        self.assertEqual(end(scene, "--steps", "9", "--resume", state), whole)
        self.refused("run", scene, "-q", "--resume", state, "--iterations", "20",
                     says="iterations: expected that of the checkpoint, 4, got 20")
        self.refused("run", scene, "-q", "--resume", state, "--preset", "paper", says="of the checkpoint")
        other = self.falling(gravity=[0, 0, -3])
        self.refused("run", other, "-q", "--resume", state, says="expected a checkpoint of scene ")
        self.refused("run", other, "-q", "--resume", other, says="expected a checkpoint that")

    def test_json_record(self):
        file = self.path("record.json")
        # What the verdict of so small a pile is, this test does not judge.
        done = subprocess.run([RUBBLE, "run", "pile-1k", "--arg", "nx=2", "--arg", "nz=2", "--arg", "levels=3", "--steps", "130",
                               "--threads", "1", "-q", "--json", file], capture_output=True, text=True, timeout=600)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        with open(file, encoding="utf-8") as text:
            record = json.load(text)
        self.assertEqual(set(record), RECORD_KEYS)
        self.assertEqual(record["threads"], 1)
        self.assertEqual(record["iterations"], 4)
        self.assertEqual(record["bodies"], 13)
        self.assertGreater(record["rss_mb"], 1)
        self.assertEqual(set(record["settled_ms"]), {"mean", "median", "p95"})
        self.assertEqual(set(record["smash_ms"]), {"mean", "max", "p95"})
        self.assertAlmostEqual(record["collision_ms"] + record["solve_ms"], record["total_ms"], places=6)
        self.assertEqual(record["verdict"]["holds"], done.returncode == 0)

    def test_json_on_standard_output_is_alone(self):
        done = self.rubble("run", self.falling(), "--json", "-")
        self.assertEqual(set(json.loads(done.stdout)), RECORD_KEYS)


class Bench(Case):
    def test_a_record_for_each_scene_and_thread_count(self):
        done = self.rubble("bench", f"{self.falling()},pile-1k", "--steps", "12", "--threads", "1,2", "-q", "--json", "-")
        records = json.loads(done.stdout)
        self.assertEqual([(os.path.basename(r["scene"]), r["threads"]) for r in records],
                         [("falling.json", 1), ("falling.json", 2), ("pile-1k", 1), ("pile-1k", 2)])
        for record in records:
            self.assertEqual(set(record), RECORD_KEYS)
            self.assertIsNone(record["smash_ms"])

    def test_search_brackets_the_largest_scene(self):
        small = ["--arg", "bricks=4", "--arg", "courses=4", "--arg", "ball_radius=0.5", "--steps", "124", "--threads", "1"]
        # no scene is as fast as this: the search ends after its first trial
        done = self.rubble("bench", "--search-60hz", "--limit", "1e-9", *small, "--json", "-", status=1)
        found = json.loads(done.stdout)
        self.assertEqual((found["walls"], len(found["trials"])), (0, 1))
        trial = found["trials"][0]
        self.assertEqual((trial["walls"], trial["holds"]), (1, False))
        self.assertEqual(trial["bodies"], 4 * 4 + 2 + 1)
        self.assertGreater(trial["bytes_per_body"], 0)
        self.refused("bench", "--search-60hz", "--backend", "abacus", says="abacus")

    def test_what_cannot_run_is_said_first(self):
        self.refused("bench", "pile-1k,nothing", says="nothing")


class Check(Case):
    def test_what_holds_no_scene(self):
        open(self.path("empty.json"), "w", encoding="utf-8").close()
        for command in ("check", "run"):
            self.refused(command, self.path("empty.json"), says="expected a scene, got an empty file")
        self.refused("check", self.folder.name, says="a folder")

    def test_good_files(self):
        for name in sorted(os.listdir(FILES)):
            self.assertIn("good", self.rubble("check", os.path.join(FILES, name)).stdout)

    def test_every_fault_is_named(self):
        file = self.write("bad.json", {"bodies": [{"shape": {"type": "bix"}, "mass": -1}],
                                       "verdict": [{"metric": "x.y", "min": 0}], "step": 3})
        done = self.refused("check", file, says="bad.json: 4 faults")
        for path in ["bodies[0].shape.type", "bodies[0].mass", "verdict[0].metric", "step"]:
            self.assertIn(path + ": ", done.stderr)
        self.assertIn("step: unknown key (did you mean", done.stderr)

    def test_syntax(self):
        self.refused("check", self.write("bad.json", "{\n  \"bodies\": [}\n"), says="line 2, column 14")

    def test_run_refuses_the_same(self):
        self.refused("run", self.falling(verdict=[{"metric": "bull.drop_m", "min": 0}]), says="verdict[0].metric")


class Info(Case):
    def test_lists(self):
        for topic in ["scenes", "forces", "deformables", "params", "build", "metrics"]:
            self.assertTrue(self.rubble("info", topic).stdout)
            self.assertTrue(json.loads(self.rubble("info", topic, "--json").stdout))
        names = [scene["name"] for scene in json.loads(self.rubble("info", "scenes", "--json").stdout)]
        self.assertIn("pile-10k", names)
        self.assertEqual(len(names), len(set(names)))
        self.refused("info", says="subcommand")
        self.refused("info", "magic", says="there is no subcommand 'magic'")
        self.refused("info", "scene", "nothing-like-it", says="nothing-like-it")

    def test_registry_scenes_are_good_files(self):
        for name in ["pile-1k", "pyramid-50", "pendulum"]:
            known = [scene["name"] for scene in json.loads(self.rubble("info", "scenes", "--json").stdout)]
            if name not in known:
                continue
            self.assertIn(name, self.rubble("info", "scene", name).stdout)
            file = self.write(name + ".json", self.rubble("info", "scene", name, "--json").stdout)
            self.rubble("check", file, "-q")


class Compare(Case):
    def test_one_backend_against_itself(self):
        done = self.rubble("compare", self.falling(), "--backends", "cpu", "--threads", "1,2", "--within", "0")
        self.assertIn("identical bits", done.stdout)
        self.assertIn("verdict: holds", done.stdout)

    def test_bad_lists(self):
        self.refused("compare", self.falling(), "--backends", "cpu,cpu,cpu", says="two backends")
        self.refused("compare", self.falling(), "--backends", "cpu,abacus", says="abacus")


class Soak(Case):
    def test_a_short_one_holds_and_repeats(self):
        first, again = (json.loads(self.rubble("soak", "--steps", "150", "--bodies", "40", "--seed", "3", "--json", "-").stdout) for _ in "ab")
        self.assertEqual(first["faults"], [])
        self.assertGreaterEqual(first["steps"], 150)
        self.assertGreater(first["edits"]["added"], 40)
        self.assertEqual(first["edits"], again["edits"])
        self.assertEqual(first["engine_mb"], again["engine_mb"])

    def test_memory_that_grows_is_a_fault(self):
        arguments = ["soak", "--steps", "300", "--bodies", "40", "--json", self.path("soak.json")]
        flat = self.rubble(*arguments, "--growth", "100")
        self.assertIn("verdict: holds", flat.stdout)
        # a negative limit is one that no run keeps
        grown = self.rubble(*arguments, "--growth=-100", status=1)
        self.assertIn("fault: resident memory", grown.stdout)
        self.assertIn("verdict: does not hold", grown.stdout)
        with open(self.path("soak.json"), encoding="utf-8") as file:
            record = json.load(file)
        memory = record["rss_mb"]
        self.assertEqual(len(record["faults"]), 1)
        self.assertEqual(memory["allowed"], -100)
        self.assertGreater(min(memory[key] for key in ("start", "tenth", "end")), 1)
        # tables that grow are no fault
        self.assertLessEqual(memory["growth"], memory["end"] - memory["tenth"] + 1e-9)
        self.assertGreater(memory["growth"], memory["end"] - memory["tenth"] - record["engine_mb"] - 1e-9)

    def test_bad_numbers(self):
        self.refused("soak", "--bodies", "1", says="--bodies")
        self.refused("soak", "--growth", "much", says="--growth")
        self.refused("soak", "--backend", "abacus", says="abacus")


class BestBackend(Case):
    def test_is_taken_by_run_and_demo(self):
        names = json.loads(self.rubble("info", "build", "--json").stdout)["backends"]
        best = "cuda" if "cuda" in names else "cpu"
        self.rubble("run", self.falling(), "-q", "--json", self.path("run.json"))
        self.rubble("demo", "--scene", self.falling(), "--out", self.path("out"), "--steps", "3", "-q")
        for file in ["run.json", "out/report.json"]:
            with open(self.path(file), encoding="utf-8") as text:
                self.assertEqual(json.load(text)["backend"], best)


class Demo(Case):
    def test_writes_everything(self):
        out = self.path("out")
        done = self.rubble("demo", "--scene", self.falling(), "--out", out, "--steps", "5", "--no-film", "-q")
        files = {"report.json", "report.txt", "trajectory.rubble"}
        if DRAWS:
            files |= {"1-start.png", "5-end.png"}
        else:
            self.assertIn("no pictures", done.stdout)
        self.assertEqual(files, set(os.listdir(out)))
        with open(os.path.join(out, "report.json"), encoding="utf-8") as text:
            self.assertEqual(set(json.load(text)), RECORD_KEYS)


if __name__ == "__main__":
    unittest.main(verbosity=1)
