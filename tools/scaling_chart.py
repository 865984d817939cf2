"""The chart of runs on several GPUs: measured steps, and the two predictions of docs/research/scaling.md."""
import math
import re

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 640, 380, 56, 150, 22, 44
COLORS = {"walls-1m": "#3b6ea5", "walls-2m": "#4f8f5b", "walls-4m": "#b5482f", "ring-1m": "#8a6d3b"}
COUNTS = [1, 2, 4]
LOWEST_MS, HIGHEST_MS, TICKS_MS = 2.5, 50, [3, 5, 10, 20, 40]
FRAME_MS = 1000 / 60


def predictions(text):
    """For each table of predictions, times by scene and number of GPUs [ms]."""
    tables = []
    for block in re.findall(r"\| scene \| 1 GPU \|.*?\n\n", text, re.S)[:2]:
        lines = [[cell.strip(" `") for cell in line.strip("|").split("|")]
                 for line in block.strip().splitlines()]
        counts = [int(cell.split()[0]) for cell in lines[0][1:]]
        tables.append({line[0]: dict(zip(counts, map(float, line[1:]))) for line in lines[2:]})
    return tables


def chart(measured, text):
    """SVG. `measured`: settled steps by scene and number of GPUs [ms]; `text`: the page of predictions."""
    def x(gpus):
        return LEFT + math.log2(gpus) / math.log2(COUNTS[-1]) * (WIDTH - LEFT - RIGHT)

    def y(ms):
        return TOP + math.log(HIGHEST_MS / ms) / math.log(HIGHEST_MS / LOWEST_MS) * (HEIGHT - TOP - BOTTOM)

    def line(times, color, style):
        points = " ".join(f"{x(n):.1f},{y(times[n]):.1f}" for n in COUNTS if n in times)
        return f'<polyline points="{points}" fill="none" stroke="{color}" {style}/>'

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
           'font-family="DejaVu Sans, sans-serif" font-size="12">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>']
    for ms in TICKS_MS:
        out.append(f'<path d="M{LEFT} {y(ms):.1f}H{WIDTH - RIGHT}" stroke="#e2e2e2"/>'
                   f'<text x="{LEFT - 8}" y="{y(ms) + 4:.1f}" text-anchor="end">{ms}</text>')
    for gpus in COUNTS:
        out.append(f'<text x="{x(gpus):.1f}" y="{HEIGHT - BOTTOM + 20}" text-anchor="middle">{gpus}</text>')
    out.append(f'<text x="{LEFT}" y="{TOP - 8}">settled step [ms]</text>')
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 8}" text-anchor="middle">GPUs</text>')
    out.append(f'<path d="M{LEFT} {y(FRAME_MS):.1f}H{WIDTH - RIGHT}" stroke="#777777" '
               'stroke-dasharray="1 3"/>'
               f'<text x="{LEFT + 6}" y="{y(FRAME_MS) + 14:.1f}" fill="#777777">60 Hz</text>')
    divided, least = predictions(text)
    for scene, color in COLORS.items():
        out.append(line(divided[scene], color, 'stroke-dasharray="6 4" stroke-opacity="0.7"'))
        out.append(line(least[scene], color, 'stroke-dasharray="2 3" stroke-opacity="0.7"'))
        out.append(line(measured[scene], color, 'stroke-width="2.2"'))
        out += [f'<circle cx="{x(n):.1f}" cy="{y(ms):.1f}" r="3.5" fill="{color}"/>'
                for n, ms in sorted(measured[scene].items())]
        last = max(measured[scene])
        out.append(f'<text x="{x(last) + 8:.1f}" y="{y(measured[scene][last]) + 4:.1f}" '
                   f'fill="{color}">{scene}</text>')
    return "\n".join(out + ["</svg>"]) + "\n"
