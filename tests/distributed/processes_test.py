#!/usr/bin/env python3
"""Runs of `rubble run` on several processes: the hash of one engine, one writer of files, and an end within
seconds if a process is killed. Arguments: the program and mpirun; without mpirun, processes that find one
another by the variables that torchrun sets."""
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time

START = "--start"
SCENE = ["run", "pile-1k", "-a", "levels=6", "-q"]


def start(count, command):
    """What torchrun does: so many processes, each of which knows its number. Returns the first status
    that is not 0."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    variables = os.environ | {"WORLD_SIZE": str(count), "LOCAL_WORLD_SIZE": str(count),
                              "MASTER_ADDR": "127.0.0.1", "RUBBLE_PORT": str(port)}
    jobs = [subprocess.Popen(command, env=variables | {"RANK": str(rank)}) for rank in range(count)]
    return next((status for status in [job.wait() for job in jobs] if status), 0)


if sys.argv[1] == START:
    sys.exit(start(int(sys.argv[2]), sys.argv[3:]))
RUBBLE, MPIRUN = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else None


def launch(count, arguments):
    """The command line of so many processes, which may be more than cores, and of root in a container."""
    if MPIRUN:
        return [MPIRUN, "--oversubscribe", "--allow-run-as-root", "-n", str(count), RUBBLE, *arguments]
    return [sys.executable, "-B", __file__, START, str(count), RUBBLE, *arguments]


def report(command):
    """The JSON that a run prints. Its exit status is the verdict of the scene, which does not matter."""
    done = subprocess.run([*command, "--hash", "--json", "-"], capture_output=True, text=True, timeout=300)
    assert done.stdout.count('"scene"') == 1, done.stdout + done.stderr
    return json.loads(done.stdout)


def same_bits(folder, one):
    alone = folder / "1.rubble"
    report([RUBBLE, *SCENE, "-n", "12", "-b", "cpu", "--record", str(alone)])
    for count, exchange in ((2, "letters"), (3, "messages")):
        file = folder / f"{count}.rubble"
        many = report(launch(count, [*SCENE, "-n", "12", "-b", "distributed", "--exchange", exchange,
                                     "--record", str(file)]))
        assert many["hash"] == one, (count, many["hash"], one)
        assert len(many["ranks"]) == count and many["rank_imbalance"] >= 0
        for rank in many["ranks"]:
            assert rank["bytes"] > 0 and rank["bodies"] > 0 and rank["own_ms"] > 0, rank
            assert {"exchange_ms", "ghosts", "rows", "messages"} <= rank.keys(), rank
        assert MPIRUN or many["threads"] <= max(1, os.cpu_count() // count), many["threads"]
        assert file.read_bytes() == alone.read_bytes(), count


def checkpoint(folder, one):
    """A run that goes on from a checkpoint of two processes has the bits of one that did not stop."""
    file = folder / "state"
    report(launch(2, [*SCENE, "-n", "8", "-b", "distributed", "--checkpoint", str(file), "--every", "4"]))
    for command in ([RUBBLE, *SCENE, "-b", "cpu"], [RUBBLE, *SCENE, "-b", "distributed", "--ranks", "3"],
                    launch(3, [*SCENE, "-b", "distributed"])):
        assert report([*command, "-n", "12", "--resume", str(file)])["hash"] == one, command


def children(process):
    """Processes of the program that belong to what started them."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            parent = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
            if parent == process.pid and RUBBLE in (entry / "cmdline").read_text():
                found.append(int(entry.name))
        except (OSError, ValueError, IndexError):
            continue
    return found


def stores(*_):
    """Processes do not reach one another's memory."""
    done = subprocess.run(launch(2, [*SCENE, "-n", "2", "-b", "distributed", "--exchange", "stores"]),
                          capture_output=True, text=True, timeout=60)
    assert done.returncode != 0 and "messages or letters" in done.stderr, done.stderr


def full(folder, _):
    """A recording that cannot be written ends the run of all, and the error names the file."""
    if not os.path.exists("/dev/full"):
        return
    file = folder / "full.rubble"
    file.symlink_to("/dev/full")
    done = subprocess.run(launch(2, [*SCENE, "-n", "100000", "-b", "distributed", "--record", str(file)]),
                          capture_output=True, text=True, timeout=60)
    assert done.returncode != 0 and str(file) in done.stderr, done.stderr
    assert MPIRUN or "rank 0 has ended" in done.stderr, done.stderr


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
    told = "signal 9" if MPIRUN else "has ended"
    assert told in error.read_text(), error.read_text()
    print(f"a killed process ends the job after {time.monotonic() - begin:.1f} s")


def main():
    with tempfile.TemporaryDirectory() as name:
        one = report([RUBBLE, *SCENE, "-n", "12", "-b", "cpu"])["hash"]
        for test in (same_bits, checkpoint, stores, full, killed):
            test(pathlib.Path(name), one)
    print("processes_test: all runs as expected")


main()
