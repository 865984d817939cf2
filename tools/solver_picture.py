"""What figures of block solvers share: colors, and what they take from the code.

That is the order of the solvers, constants, and rules of partition and elimination.
"""
import re

from diagram import GREY, INK, LINE, WHITE, Diagram

HELD, CONTACT, COUPLED, FILLED, GREEN = "#ececec", "#c0392b", "#e9b9b3", "#9fd0d3", "#7a9f4f"
# Colors of docs/images/step.svg, each with a strong tone for what is solved.
BLUE, YELLOW = ("#dbe7f5", "#4f7fb5"), ("#fbf2c9", "#d9b93b")
VIOLET, ORANGE = ("#e6dff2", "#8a6bbf"), ("#f7e3d0", "#d08a45")


class Picture(Diagram):
    """A figure of one solver, with a strip that says where it stands in an iteration."""

    def __init__(self, root, solver, colors, title):
        super().__init__(700)
        self.root, (self.pale, self.strong) = root, colors
        boxes = {}
        iterate = re.search(r"void iterate\(.*?\n\}", self.source("stages/step.h"), re.S).group(0)
        names = {"keepMomentum": "last only", "solveLast": "last only", "updateDuals": "multipliers"}
        for room, phase in re.findall(r"(\w+)::(\w+)\(e", iterate):
            if phase != "accelerate":
                boxes.setdefault(names.get(phase, room), set()).add(room)
        width = (self.width - 100) / len(boxes)
        self.text(20, 26, "Iteration:", color=GREY)
        for k, (name, rooms) in enumerate(boxes.items()):
            here, x = solver in rooms and name != "multipliers", 84 + k * width
            fill, stroke = (self.pale, self.strong) if here else (WHITE, LINE)
            self.box(x, 10, width - 5, 24, fill, stroke, 5, 1 + here)
            self.text(x + width / 2 - 3, 26, name, 11, INK if here else GREY, here, "middle")
        self.text(20, 62, title, 15, bold=True)

    def source(self, path):
        return (self.root / "src" / path).read_text()

    def constant(self, path, name):
        return float(re.search(rf"\b{name} = (?:Real\()?([\d.e]+)", self.source(path)).group(1))


def elimination(links):
    """Levels of bodies, parents of each, and couplings filled in, by tables/tree_plan.cpp.

    `links`: neighbors of each body.
    """
    levels, parents, filled, left = [], {}, set(), range(len(links))
    while left:
        taken, blocked = [], set()
        for i in left:
            if len(links[i]) <= 2 and i not in blocked:
                taken.append(i)
                blocked |= links[i]
        for i in taken:
            parents[i] = links[i]
            for a in links[i]:
                filled |= {(a, b) for b in links[i] - {a} - links[a]}
                links[a] = (links[a] | links[i]) - {i, a}
        left = [i for i in left if i not in taken]
        levels.append(taken)
    return levels, parents, filled


def halves(points, order, most):
    """Pieces of at most `most` points: the longest side of a box is cut at the median (cook/halving.h)."""
    if len(order) <= most:
        return [order]
    sizes = [max(c) - min(c) for c in zip(*(points[i] for i in order))]
    axis = sizes.index(max(sizes))
    order = sorted(order, key=lambda i: (points[i][axis], i))
    middle = len(order) // 2
    return halves(points, order[:middle], most) + halves(points, order[middle:], most)
