#!/usr/bin/env python3
"""Random command lines against the real program. Usage: argument_lines.py PATH_OF_RUBBLE [LINES [SEED]]

Every line must end with status 0, 1 or 2, without a crash, and say at most 2,000 characters on standard
error. Lines that run for longer than LIMIT_S are stopped; few may."""
import concurrent.futures
import os
import pathlib
import random
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

LIMIT_S = 20
SCENE = '{"bodies": [{"shape": {"type": "sphere", "radius": 1}}], "steps": 2}'
MOST_CHARACTERS = 2000
MOST_STOPPED = 0.01
PROGRESS = re.compile(r": step \d+/\d+, ")
SCENES = ["pyramid", "tower", "drop", "pendulum", "soft-flat", "door", "rope"]
FILES = ["scene.json", "broken.json", "empty", "folder", "missing.json", "out.rubble", "p.png", "p.jpg",
         "f_%04d.png", "x.mp4", "a.csv", "-", "/dev/null", "/nowhere/x.png", "x.obj", "report.json", "m.xml"]
ODD = ["", " ", "-1", "0", "1", "3", "1e9", "1e999", "nan", "inf", "-inf", "abc", "0x10", "1,2,3", "1,2",
       "a=b", "base=3", "base=", "=3", "base=1e300", "K=5", "iterations=0", "%s%n", "\u00e9\u4e2d",
       "x" * 300, "--",
       "cpu", "cuda", "320x0", "64x36", "-5x5", "99999999999999999999", "'", "\"", "\\", "\t", "body",
       "speed", "contacts,forces", "red", "ff00ff"]


def options_of(rubble, command):
    text = subprocess.run([rubble, *command, "--help"], capture_output=True, text=True, check=True).stdout
    return sorted(set(re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", text)))


def commands_of(rubble):
    text = subprocess.run([rubble, "--help"], capture_output=True, text=True, check=True).stdout
    names = re.findall(r"^  ([a-z]+)  ", text.split("Subcommands:", 1)[1], re.M)
    return {name: options_of(rubble, [name]) for name in names}


def misspelt(word, random_):
    if len(word) < 2:
        return word
    at = random_.randrange(len(word))
    before, after = word[:at], word[at + 1:]
    return before + random_.choice(["", 2 * word[at], "q"]) + after


def line_of(commands, random_):
    name = random_.choice(sorted(commands))
    words = [name]
    for _ in range(random_.randrange(7)):
        kind = random_.random()
        if kind < 0.4:
            words.append(random_.choice(commands[name]))
        elif kind < 0.55:
            words.append(random_.choice(SCENES))
        elif kind < 0.75:
            words.append(random_.choice(FILES))
        else:
            words.append(random_.choice(ODD))
    if random_.random() < 0.15:
        at = random_.randrange(len(words))
        words[at] = misspelt(words[at], random_)
    # most lines that could run long run short
    if name in ("run", "render", "compare", "bench", "picture") and random_.random() < 0.9:
        words += ["--steps", "2"]
    if name in ("demo", "soak", "view") and "--help" not in words:
        words += ["--no-such-option"]
    return words


def fault_of(rubble, words, folder):
    """What is wrong with the answer to a line; "" if nothing is, "stopped" if it ran too long."""
    environment = {**os.environ, "DISPLAY": ":none", "RUBBLE_GL": "software"}
    try:
        done = subprocess.run([rubble, *words], cwd=folder, capture_output=True, timeout=LIMIT_S,
                              env=environment, stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return "stopped"
    said = done.stderr.decode("utf-8", "replace")
    if done.returncode not in (0, 1, 2):
        return f"status {done.returncode}: {said[-300:]}"
    # progress on a pipe, a line for each tenth of each run, is no message
    said = "\n".join(line for line in said.splitlines() if not PROGRESS.search(line))
    if len(said) > MOST_CHARACTERS:
        return f"{len(said)} characters: {said[:200]}"
    if done.returncode == 2 and not said.strip():
        return "refused without a message"
    return ""


def main():
    rubble = os.path.abspath(sys.argv[1])
    lines = int(sys.argv[2]) if len(sys.argv) > 2 else 10000
    random_ = random.Random(int(sys.argv[3]) if len(sys.argv) > 3 else 1)
    commands = commands_of(rubble)
    faults, stopped = [], []
    pool = concurrent.futures.ThreadPoolExecutor(os.cpu_count())
    with tempfile.TemporaryDirectory() as folder, pool:
        def tried(number, words):
            own = pathlib.Path(folder, str(number))
            own.mkdir()
            (own / "folder").mkdir()
            (own / "empty").write_text("")
            (own / "broken.json").write_text('{"bodies": [')
            (own / "scene.json").write_text(SCENE)
            fault = fault_of(rubble, words, own)
            shutil.rmtree(own)
            return fault
        jobs = {pool.submit(tried, number, words): words
                for number, words in enumerate(line_of(commands, random_) for _ in range(lines))}
        for job in concurrent.futures.as_completed(jobs):
            if job.result() == "stopped":
                stopped.append(jobs[job])
            elif job.result():
                faults.append((jobs[job], job.result()))
                print("rubble", shlex.join(jobs[job]), "->", job.result(), flush=True)
    print(f"{lines} lines, {len(faults)} faults, {len(stopped)} stopped after {LIMIT_S} s")
    for words in stopped[:5]:
        print("  stopped: rubble", shlex.join(words))
    sys.exit(1 if faults or len(stopped) > MOST_STOPPED * lines else 0)


if __name__ == "__main__":
    main()
