"""The shared library exports the functions of the headers and nothing else. It and the static library leave
the process of their host alone.

Arguments: library, folder of the headers, archives."""
import pathlib
import re
import subprocess
import sys

library, headers, *archives = sys.argv[1:]
try:
    listed = subprocess.run(["nm", "-D", "--defined-only", library], check=True, capture_output=True,
                            text=True)
except FileNotFoundError:
    print("skipped: nm is missing")
    sys.exit(77)
rows = [line.split() for line in listed.stdout.splitlines()]
exported = {name.split("@")[0] for _, kind, name in rows if kind in "TDBRVW"}
texts = [path.read_text(encoding="utf-8") for path in pathlib.Path(headers).glob("*.h")]
declared = {name for text in texts for name in re.findall(r"RB_API [\w \*]+?\b(rb_\w+)\(", text)}
for name in sorted(declared - exported):
    print(f"declared but not exported: {name}")
for name in sorted(exported - declared):
    print(f"exported but not declared: {name}")
print(f"{len(exported)} functions are exported")

# Functions of the C library that act on the whole process, or write to its console. Not chdir: a header of
# assimp has an inline function with it, which nothing calls.
PROCESS = re.compile(r"^(signal|sigaction|sigprocmask|setlocale|_?exit|quick_exit|fork|system|popen|"
                     r"setenv|putenv|v?printf|v?fprintf|__v?f?printf_chk|puts|putchar|perror|stdout|stderr)$")
reaching = set()
for command in [["-D", library], *([archive] for archive in archives)]:
    needed = subprocess.run(["nm", "--undefined-only", *command], check=True, capture_output=True,
                            text=True).stdout
    reaching |= {name for name in re.findall(r"\b[Uw] ([A-Za-z_]\w*)", needed) if PROCESS.match(name)}
for name in sorted(reaching):
    print(f"acts on the whole process: {name}")
sys.exit(exported != declared or bool(reaching))
