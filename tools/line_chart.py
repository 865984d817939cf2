"""Charts of lines for pages, as SVG."""
import math

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 640, 380, 56, 150, 22, 44
LINE_HEIGHT = 14  # of labels


class Line:
    """A line through points {x: y}.

    label: written beside its last point. dash: of the stroke, as in SVG; a line with dashes is thinner.
    dots: at its points, unless it has dashes.
    """

    def __init__(self, points, color, label=None, dash=None, dots=True):
        self.points, self.color, self.label, self.dash = dict(sorted(points.items())), color, label, dash
        self.dots = dots and not dash


def _labels(lines, y):
    """Heights of the labels of lines, moved apart where they would overlap."""
    found = sorted((y(list(line.points.values())[-1]) + 4, k) for k, line in enumerate(lines) if line.label)
    out, last = {}, -LINE_HEIGHT
    for height, k in found:
        last = out[k] = max(height, last + LINE_HEIGHT)
    return out


def chart(lines, x_ticks, y_ticks, y_range, x_label, y_label, *, log_x=True, log_y=True, mark=None):
    """SVG of lines.

    x_ticks, y_ticks: numbers that are written; x goes from the first to the last. y_range: (least, most).
    mark: (y, text) of a dotted line across.
    """
    def place(value, low, high, log):
        return (math.log(value / low) / math.log(high / low) if log else (value - low) / (high - low))

    def x(value):
        return LEFT + place(value, x_ticks[0], x_ticks[-1], log_x) * (WIDTH - LEFT - RIGHT)

    def y(value):
        return HEIGHT - BOTTOM - place(value, *y_range, log_y) * (HEIGHT - TOP - BOTTOM)

    def number(value):
        return f"{value:,.0f}" if value >= 10 or value == int(value) else f"{value:g}"

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
           'font-family="DejaVu Sans, sans-serif" font-size="12">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>']
    for value in y_ticks:
        out.append(f'<path d="M{LEFT} {y(value):.1f}H{WIDTH - RIGHT}" stroke="#e2e2e2"/>'
                   f'<text x="{LEFT - 8}" y="{y(value) + 4:.1f}" text-anchor="end">{number(value)}</text>')
    for value in x_ticks:
        out.append(f'<text x="{x(value):.1f}" y="{HEIGHT - BOTTOM + 20}" text-anchor="middle">'
                   f'{number(value)}</text>')
    out.append(f'<text x="{LEFT}" y="{TOP - 8}">{y_label}</text>')
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 8}" text-anchor="middle">'
               f'{x_label}</text>')
    if mark:
        out.append(f'<path d="M{LEFT} {y(mark[0]):.1f}H{WIDTH - RIGHT}" stroke="#777777" '
                   'stroke-dasharray="1 3"/>'
                   f'<text x="{LEFT + 6}" y="{y(mark[0]) + 14:.1f}" fill="#777777">{mark[1]}</text>')
    heights = _labels(lines, y)
    for k, line in enumerate(lines):
        points = " ".join(f"{x(a):.1f},{y(b):.1f}" for a, b in line.points.items())
        style = f'stroke-dasharray="{line.dash}" stroke-opacity="0.7"' if line.dash else 'stroke-width="2.2"'
        out.append(f'<polyline points="{points}" fill="none" stroke="{line.color}" {style}/>')
        if line.dots:
            out += [f'<circle cx="{x(a):.1f}" cy="{y(b):.1f}" r="3.5" fill="{line.color}"/>'
                    for a, b in line.points.items()]
        if line.label:
            last = list(line.points)[-1]
            out.append(f'<text x="{x(last) + 8:.1f}" y="{heights[k]:.1f}" fill="{line.color}">'
                       f'{line.label}</text>')
    return "\n".join(out + ["</svg>"]) + "\n"
