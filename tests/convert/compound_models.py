"""Random mechanisms of bodies with several joints, for the comparison with MuJoCo. Each function returns the
text of a model with one mechanism for each seed, side by side, and the names of its bodies."""
import math
import random

SIZE = 0.5  # of a mechanism, about [m]
HEAD = """<mujoco model="{title}">
  <option gravity="0 0 -5"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>{bodies}</worldbody>
  <tendon>{tendons}</tendon><equality>{equality}</equality><actuator>{actuators}</actuator>
  <keyframe><key name="on" qpos="{qpos}" ctrl="{ctrl}"/></keyframe>
</mujoco>
"""


def text(values):
    return " ".join(f"{value:.5g}" for value in values)


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


class Mechanisms:
    def __init__(self, title):
        self.parts = {"title": title, "bodies": "", "tendons": "", "equality": "", "actuators": ""}
        self.qpos, self.ctrl, self.names = [], [], []

    def text(self):
        return HEAD.format(**self.parts, qpos=text(self.qpos), ctrl=text(self.ctrl)), self.names


class Mechanism:
    """Adds bodies with two or three hinges, and at times a slide before or after them, in chains."""

    def __init__(self, all_of_them, seed):
        self.all, self.random, self.seed = all_of_them, random.Random(seed), seed

    def vector(self, size):
        return [self.random.uniform(-size, size) for _ in range(3)]

    def direction(self):
        while True:
            v = self.vector(1)
            if 0.1 < dot(v, v) < 1:
                return [x / math.sqrt(dot(v, v)) for x in v]

    def axes(self, count):
        """Directions that are far from one plane, or from one line."""
        while True:
            axes = [self.direction() for _ in range(max(count, 2))]
            normal = cross(axes[0], axes[1])
            if math.sqrt(dot(normal, normal)) > 0.6 and (count < 3 or abs(dot(normal, axes[2])) > 0.6):
                return axes[:count]

    def body(self, name, place, inner="", slides=False, hinges=0):
        """A body at `place`, and the names of its joints. Springs keep the second of three hinges from 90
        degrees."""
        count, joints = hinges or self.random.choice((2, 3)), []
        axes = self.axes(count)
        body, kinds = f'<body name="{name}" pos="{text(place)}">', [str(k) for k in range(count)]
        after = slides and count > 1 and self.random.random() < 0.5
        if slides:
            kinds.insert(count if after else 0, "s")
        for kind in kinds:
            joints.append(f"{name}_{kind}")
            if kind == "s":  # along the hinge beside it, or across that and the next one
                first, second = (axes[::-1] if after else axes + [self.direction()])[:2]
                along = self.random.choice((first, cross(first, second)))
                body += (f'<joint name="{joints[-1]}" type="slide" axis="{text(along)}" damping="3" '
                         f'stiffness="{self.random.uniform(200, 400):.4g}"/>')
                self.all.qpos.append(self.random.uniform(-0.03, 0.03))
                continue
            k, axis = int(kind), axes[int(kind)]
            stiffness = self.random.uniform(8, 14) if k == 1 and count == 3 else self.random.uniform(2, 6)
            armature = self.random.choice((0, 0, 0.01))
            body += (f'<joint name="{joints[-1]}" axis="{text(axis)}" pos="{text(self.vector(0.15))}" '
                     f'stiffness="{stiffness:.4g}" damping="{self.random.uniform(0.1, 0.3):.4g}" '
                     f'springref="{self.random.uniform(-20, 20):.4g}" armature="{armature}"/>')
            self.all.qpos.append(self.random.uniform(-0.4, 0.4))
        self.all.names.append(name)
        end = text(self.vector(0.3))
        mass = self.random.uniform(1, 2)
        body += f'<geom type="capsule" size="0.04" fromto="0 0 0 {end}" mass="{mass:.4g}"/>'
        return body + inner + "</body>", joints

    def motor(self, joint):
        kind = self.random.choice((f'<motor joint="{joint}" gear="2"/>',
                                   f'<position joint="{joint}" kp="4"/>', ""))
        self.all.parts["actuators"] += kind
        self.all.ctrl += [self.random.uniform(-0.5, 0.5)] if kind else []


def hinges(seeds):
    """Chains of two bodies with two or three hinges each, whose axes are any and do not meet."""
    out = Mechanisms("hinges of one body that do not meet")
    for seed in seeds:
        own = Mechanism(out, seed)
        at = len(out.qpos)
        inner, more = own.body(f"lower{seed}", own.vector(0.3))
        below, out.qpos[at:] = out.qpos[at:], []
        outer, joints = own.body(f"upper{seed}", [2.0 * seed, 0, 0], inner, slides=seed % 4 == 3)
        out.qpos += below
        out.parts["bodies"] += outer
        for joint in joints[-2:] + more[:1]:
            own.motor(joint)
    return out.text()


def couplings(seeds):
    """Pairs of bodies with several joints: one coordinate follows a polynomial of one of the other body, and
    a fixed tendon with a spring sums two or three of them."""
    out = Mechanisms("couplings of bodies with several joints")
    for seed in seeds:
        own, joints, at = Mechanism(out, seed), [], []
        for k in range(2):
            at.append(len(out.qpos))
            # with one hinge: travel beside hinges that do not meet is approximate
            slides = (seed + k) % 3 == 0
            text_of, names = own.body(f"{'ab'[k]}{seed}", [2.0 * seed, k, 0], "", slides, int(slides))
            out.parts["bodies"] += text_of
            joints.append(names)
        first, second = (own.random.randrange(len(names)) for names in joints)
        slides = [name.endswith("_s") for name in (joints[0][first], joints[1][second])]
        scale = (0.1 if slides[0] else 1) / (0.1 if slides[1] else 1)
        c = [0, scale * own.random.uniform(0.4, 1), 0, 0, 0]
        if not any(slides):
            c[2], c[3] = own.random.uniform(-0.3, 0.3), own.random.uniform(-0.2, 0.2)
        q = out.qpos[at[1] + second]
        out.qpos[at[0] + first] = sum(each * q ** n for n, each in enumerate(c))
        out.parts["equality"] += (f'<joint joint1="{joints[0][first]}" joint2="{joints[1][second]}" '
                                  f'polycoef="{" ".join(map(str, c))}"/>')
        terms = [name for pair in joints for name in pair if not name.endswith("_s")]
        terms = own.random.sample(terms, own.random.choice((2, 3)))
        out.parts["tendons"] += (f'<fixed name="sum{seed}" stiffness="{own.random.uniform(1, 4):.4g}" '
                                 'springlength="0.2" damping="0.05">')
        for name in terms:
            out.parts["tendons"] += f'<joint joint="{name}" coef="{own.random.uniform(-1, 1):.4g}"/>'
        out.parts["tendons"] += "</fixed>"
        out.parts["actuators"] += f'<motor tendon="sum{seed}"/>'
        out.ctrl.append(own.random.uniform(-0.5, 0.5))
    return out.text()
