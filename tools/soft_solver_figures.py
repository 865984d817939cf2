"""Figures of the block solvers of deformable objects, for tools/draw_solvers."""
from diagram import GREY, INK, WHITE
from solver_picture import BLUE, COUPLED, FILLED, GREEN, HELD, ORANGE, VIOLET, Picture, halves


def clusters(root):
    p = Picture(root, "clusters", ORANGE,
                "Clusters: vertices of a solid move as rigid units, from coarse to fine")
    finest = int(p.constant("forces/soft_model.h", "kFinestCluster"))
    points = [(i, j, k) for i in range(16) for j in range(4) for k in range(2)]
    pieces, tones = [list(range(len(points)))], [p.strong, BLUE[1], GREEN, VIOLET[1]]
    levels = next(level for level in range(9) if len(points) <= finest << 3 * level)

    for column, level in enumerate(range(levels, -1, -1)):
        left = 24 + 232 * column
        if column:
            pieces = [part for piece in pieces for part in halves(points, piece, finest << 3 * level)]

        def place(i, j, k, left=left):
            return left + 11 * i + 5 * k, 156 - 13 * j - 6 * k + 0.13 * i * i
        rows = [[(i, j, 0) for i in range(16)] for j in range(4)] + [[(i, 3, 1) for i in range(16)]]
        for row in [*rows, *([(i, j, 0) for j in range(4)] + [(i, 3, 1)] for i in range(16))]:
            p.line(*(place(*at) for at in row), color="#cccccc")
        tone = {v: tones[(n + n // 4) % 4] for n, piece in enumerate(pieces) for v in piece}
        for v in sorted(tone, key=lambda v: -points[v][2]):
            p.dot(*place(*points[v]), 3.2, tone[v])
        p.text(left, 88, f"level {level}", bold=True)
        p.text(left, 218, f"{len(pieces)} clusters of {len(pieces[0])} vertices" if column
               else f"the whole object, {len(points)} vertices", color=GREY)
        if level > 0:
            p.line((left + 192, 144), (left + 220, 144), arrow=True)
    p.text(left, 234, "only summed, not moved", color=GREY)

    p.text(24, 270, "One cluster and the elements", bold=True)
    grid = [(i, j) for i in range(8) for j in range(8)]
    own = set(halves(grid, list(range(64)), 16)[0])
    spot = [(28 + 24 * i, 452 - 24 * j) for i, j in grid]
    for a in (8 * i + j for i in range(7) for j in range(7)):
        for corners in ((a, a + 8, a + 9), (a, a + 9, a + 1)):
            inside = len(own & set(corners))
            p.area([spot[v] for v in corners], [HELD, COUPLED, COUPLED, p.pale][inside], "#bbbbbb")
    for v, at in enumerate(spot):
        p.dot(*at, 4.5, p.strong if v in own else WHITE, INK if v in own else GREY)
    p.key(222, 290, (p.pale, "inside: left out"), (COUPLED, "across the boundary"), (HELD, "elsewhere"))
    p.notes(222, 362, 24, ("Held", "all vertices of other clusters"))
    relaxation = p.constant("stages/coarse/coarse.h", "kAggregateRelaxation")
    p.notes(404, 270, 42, ("Unknowns", "one rigid motion: (dp, dw), rotation exact"),
            ("Summed over vertices", "inertia, loads, contacts, attachments"),
            ("Summed over elements across", "force and Hessian; one that n clusters share counts n / 2 times "
             "in each Hessian"),
            ("Step", f"all clusters of a level at once, {relaxation:g} of the Newton step"))
    return p.svg(472)


def strands(root):
    p = Picture(root, "strands", ORANGE, "Strands: all vertices of a cable or rod, in one banded elimination")
    band, count = int(p.constant("state/vertices.h", "kStrandBand")), 8
    for k in range(1, count - 1):
        arc = [(60 + 82 * (k + t / 8), 122 + (-1) ** k * 34 * (1 - (t / 8) ** 2)) for t in range(-8, 9)]
        p.line(*arc, color=GREEN, width=1.8)
    p.line((60, 122), (60 + 82 * (count - 1), 122), color=p.strong, width=4)
    for k in range(count):
        p.dot(60 + 82 * k, 122, 11, WHITE, INK)
        p.text(60 + 82 * k, 126, str(k), bold=True, anchor="middle")
    p.text(20, 186, "springs join each vertex to the next,", color=p.strong)
    p.text(258, 186, "bends each to the next two", color=GREEN)

    entries = {}
    for k in range(count):
        for to, color in [(k, p.strong), (k + 1, "#f0c27a"), (k + 2, GREEN)][:count - k]:
            entries.update({(3 * k + i, 3 * to + j): color for i in range(3) for j in range(3)
                            if to < k + 2 or i == j})
    for j in range(3 * count):
        reach = [b for b in range(j + 1, j + band + 1) if (j, b) in entries]
        for a, b in ((a, b) for a in reach for b in reach if a < b):
            entries.setdefault((a, b), FILLED)
    p.text(20, 220, f"H of {count} vertices, 3 rows each", bold=True)
    entries.update({(j, i): color for (i, j), color in entries.items()})
    p.matrix(20, 232, 9, 3 * count, 3 * count, entries)
    p.key(254, 242, (p.strong, "the vertex itself"), ("#f0c27a", "springs and bends"), (GREEN, "bends"),
          (FILLED, "filled in"), (WHITE, "zero"))
    p.text(254, 346, f"{band} entries beside\nthe diagonal", color="#333333")
    p.notes(424, 220, 38, ("Unknowns", "3 of each vertex"),
            ("Held", "all else; contacts, attachments and loads add to the diagonal"),
            ("Step", "cut so that no two neighbors move apart by more than half of their distance"),
            ("Multipliers", "of springs take the same share of lambda <- K (C - c0 + J dx)"))
    return p.svg(462)
