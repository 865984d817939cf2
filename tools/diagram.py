"""Diagrams for pages, as SVG: boxes, arrows, paragraphs and matrices."""
import html
import textwrap

INK, GREY, LINE, WHITE = "#222222", "#666666", "#999999", "#ffffff"
LEADING = 15  # of text

HEAD = ('<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
        f'orient="auto"><path d="M0 0L8 4L0 8Z" fill="{INK}"/></marker></defs>')


class Diagram:
    """Shapes of one picture, the later ones above the earlier ones. Lengths are pixels, y goes down."""

    def __init__(self, width):
        self.width, self.out = width, []

    def box(self, x, y, w, h, fill, stroke=LINE, rx=0, width=1):
        self.out.append(f'<rect x="{x:g}" y="{y:g}" width="{w:g}" height="{h:g}" rx="{rx}" fill="{fill}" '
                        f'stroke="{stroke}" stroke-width="{width}"/>')

    def line(self, *points, color=INK, width=1.0, dash="", arrow=False):
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
        self.out.append(f'<path d="M{path}" fill="none" stroke="{color}" stroke-width="{width}"'
                        + (f' stroke-dasharray="{dash}"' if dash else "")
                        + (' marker-end="url(#head)"' if arrow else "") + "/>")

    def area(self, points, fill, stroke=WHITE):
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
        self.out.append(f'<path d="M{path}Z" fill="{fill}" stroke="{stroke}"/>')

    def dot(self, x, y, r, fill, stroke="none"):
        self.out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r}" fill="{fill}" stroke="{stroke}"/>')

    def text(self, x, y, words, size=12, color=INK, bold=False, anchor="start"):
        weight = ' font-weight="bold"' if bold else ""
        for k, line in enumerate(words.split("\n")):
            self.out.append(f'<text x="{x:g}" y="{y + LEADING * k:g}" font-size="{size}" fill="{color}"'
                            f'{weight} text-anchor="{anchor}">{html.escape(line)}</text>')

    def notes(self, x, y, letters, *notes):
        """Paragraphs of (head, words), at most `letters` wide, one below the other."""
        for head, words in notes:
            lines = textwrap.wrap(words, letters)
            self.text(x, y, head, bold=True)
            self.text(x, y + LEADING, "\n".join(lines), color="#333333")
            y += LEADING * len(lines) + 24

    def key(self, x, y, *entries):
        """Squares of (fill, words), one below the other."""
        for k, (fill, words) in enumerate(entries):
            self.box(x, y + 18 * k - 10, 11, 11, fill)
            self.text(x + 18, y + 18 * k, words)

    def ground(self, x, y, w):
        self.line((x, y), (x + w, y), width=1.5)
        for k in range(int(w / 8)):
            self.line((x + 8 * k + 8, y + 1), (x + 8 * k + 2, y + 7), color=LINE)

    def matrix(self, x, y, cell, rows, columns, fills):
        """`fills`: {(row, column): color}; other elements are zero."""
        self.box(x, y, cell * columns, cell * rows, WHITE, "none")
        for color in dict.fromkeys(fills.values()):
            path = "".join(f"M{x + j * cell:g} {y + i * cell:g}h{cell}v{cell}h-{cell}z"
                           for (i, j), fill in fills.items() if fill == color)
            self.out.append(f'<path d="{path}" fill="{color}" stroke="{WHITE}" stroke-width="0.7"/>')
        self.box(x, y, cell * columns, cell * rows, "none", GREY)

    def svg(self, height):
        return "\n".join([
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {height}" '
            'font-family="DejaVu Sans, sans-serif">', HEAD,
            f'<rect width="{self.width}" height="{height}" fill="{WHITE}"/>', *self.out, "</svg>", ""])
