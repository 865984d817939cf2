#!/usr/bin/env python3
"""Runs of `rubble run` on the processes of mpirun: the hash of one engine, one writer of files, and an end
within seconds if a process is killed. Arguments: the program, mpirun."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

RUBBLE, MPIRUN = sys.argv[1:3]
SCENE = ["run", "pile-1k", "-a", "levels=6", "-q"]


def launch(count, arguments):
    """The command line of so many processes, which may be more than cores, and of root in a container."""
    return [MPIRUN, "--oversubscribe", "--allow-run-as-root", "-n", str(count), RUBBLE, *arguments]


def report(command):
    """The JSON that a run prints. Its exit status is the verdict of the scene, which does not matter."""
    done = subprocess.run([*command, "--hash", "--json", "-"], capture_output=True, text=True, timeout=300)
    assert done.stdout.count('"scene"') == 1, done.stdout + done.stderr
    return json.loads(done.stdout)


def same_bits(folder, one):
    for count in (2, 3):
        file = folder / f"{count}.rubble"
        many = report(launch(count, [*SCENE, "-n", "12", "-b", "distributed", "--record", str(file)]))
        assert many["hash"] == one, (count, many["hash"], one)
        assert len(many["ranks"]) == count and all(rank["bytes"] > 0 for rank in many["ranks"])
        assert file.stat().st_size > 0


def checkpoint(folder, one):
    """A run that goes on from a checkpoint of two processes has the bits of one that did not stop."""
    file = folder / "state"
    report(launch(2, [*SCENE, "-n", "8", "-b", "distributed", "--checkpoint", str(file), "--every", "4"]))
    for command in ([RUBBLE, *SCENE, "-b", "cpu"], [RUBBLE, *SCENE, "-b", "distributed", "--ranks", "3"],
                    launch(3, [*SCENE, "-b", "distributed"])):
        assert report([*command, "-n", "12", "--resume", str(file)])["hash"] == one, command


def children(process):
    """Processes of the program that belong to mpirun."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            parent = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
            if parent == process.pid and RUBBLE in (entry / "cmdline").read_text():
                found.append(int(entry.name))
        except (OSError, ValueError, IndexError):
            continue
    return found


def killed(folder, _):
    error = folder / "error"
    with error.open("w") as stream:
        job = subprocess.Popen(launch(2, [*SCENE, "-n", "100000", "-b", "distributed"]),
                               stdout=subprocess.DEVNULL, stderr=stream)
        end = time.monotonic() + 60
        while len(children(job)) < 2 and time.monotonic() < end:
            time.sleep(.1)
        time.sleep(1)
        os.kill(children(job)[1], signal.SIGKILL)
        begin = time.monotonic()
        status = job.wait(timeout=10)
    assert status != 0, status
    assert "signal 9" in error.read_text(), error.read_text()
    print(f"a killed process ends the job after {time.monotonic() - begin:.1f} s")


def main():
    with tempfile.TemporaryDirectory() as name:
        one = report([RUBBLE, *SCENE, "-n", "12", "-b", "cpu"])["hash"]
        for test in (same_bits, checkpoint, killed):
            test(pathlib.Path(name), one)
    print("mpi_test: all runs as expected")


main()
