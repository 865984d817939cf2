"""Random models in MJCF and URDF, for the comparison with MuJoCo: trees of bodies with every kind of joint,
geom, orientation, default class, actuator, tendon and constraint. Seeds give the same model everywhere."""
import random

BRICK = ("-0.04 -0.04 -0.1  0.04 -0.04 -0.1  -0.04 0.05 -0.1  0.04 0.04 -0.1  "
         "-0.04 -0.04 0.1  0.04 -0.04 0.1  -0.04 0.04 0.12  0.04 0.04 0.1")
HEAD = """<compiler angle="degree" autolimits="true" {compiler}/>
<option timestep="{dt}" integrator="{integrator}" cone="elliptic" impratio="10">
 <flag energy="enable"/>
</option>
<size memory="5M"/><visual><headlight ambient="0.1 0.1 0.1"/></visual><statistic extent="1"/>
<custom><numeric name="x" data="1 2"/></custom>
<default>
 <geom rgba="0.5 0.5 0.5 1"/><joint armature="0.001" damping="0.05"/><site size="0.02"/><tendon width="0.01"/>
 <equality solref="0.005 1"/><motor ctrllimited="true" ctrlrange="-1 1"/>
 <default class="visual"><geom type="mesh" contype="0" conaffinity="0" group="2" mass="0"/></default>
 <default class="inner"><geom density="800"/><joint damping="0.2"/></default>
 <default class="stiff"><joint frictionloss="0.05" armature="0.02"/></default>
 <default class="drive"><position kp="40" kv="2" ctrlrange="-1 1"/></default>
 <default class="belt"><tendon damping="0.01"/></default>
</default>
<asset><material name="paint" rgba="1 0 0 1"/><mesh name="brick" vertex="{brick}"/>
 <mesh name="turned" vertex="{brick}" scale="1 -1 1" refquat="1 1 0 0" refpos="0.1 0 0"/></asset>
"""


class Generator:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.count = 0
        self.joints, self.balls, self.frees, self.sites, self.bodies, self.rounds = [], [], [], [], [], []

    def name(self, kind):
        self.count += 1
        return f"{kind}{self.count}"

    def number(self, low, high):
        return f"{self.random.uniform(low, high):.4g}"

    def vector(self, low, high, count=3):
        return " ".join(self.number(low, high) for _ in range(count))

    def one(self, *choices):
        return self.random.choice(choices)

    def orientation(self):
        return self.one("", f'quat="{self.vector(-1, 1, 4)}"', f'euler="{self.vector(-90, 90)}"',
                        f'axisangle="{self.vector(0.1, 1)} {self.number(-90, 90)}"',
                        f'zaxis="{self.vector(0.1, 1)}"', f'xyaxes="1 {self.number(-1, 1)} 0 0 1 0.3"')

    def geom(self):
        kind = self.one("box", "sphere", "capsule", "cylinder", "ellipsoid", "mesh", "fitted", "between")
        place = f'pos="{self.vector(-0.1, 0.1)}" {self.orientation()}'
        if kind == "mesh":
            return f'<geom type="mesh" mesh="{self.one("brick", "turned")}" group="3" {place}/>'
        if kind == "fitted":
            kind = self.one("box", "sphere", "capsule", "cylinder", "ellipsoid")
            return f'<geom type="{kind}" mesh="{self.one("brick", "turned")}" {place}/>'
        if kind == "between":
            ends = f'{self.vector(-0.1, 0.1)} {self.vector(0.12, 0.3)}'
            return f'<geom type="{self.one("capsule", "cylinder", "box")}" fromto="{ends}" size="0.03"/>'
        label = self.name("g")
        if kind in ("sphere", "cylinder"):
            self.rounds.append(label)
        sizes = {"sphere": 1, "capsule": 2, "cylinder": 2}.get(kind, 3)
        more = self.one("", 'density="300"', 'mass="0.7"', 'contype="2" conaffinity="3"',
                        'group="3" priority="1"',
                        'friction="1 0.005 0.001" condim="4"', 'solref="0.01 1" solimp="0.9 0.99 0.001"',
                        'margin="0.001" gap="0.001"', "" if kind == "ellipsoid" else 'shellinertia="true"')
        return f'<geom name="{label}" type="{kind}" size="{self.vector(0.02, 0.1, sizes)}" {place} {more}/>'

    def hinge(self, more=""):
        label = self.name("j")
        self.joints.append(label)
        return f'<joint name="{label}" {more}/>'

    def joint(self):
        kind = self.one("hinge", "hinge", "hinge", "slide", "ball", "several", "none")
        place = f'pos="{self.vector(-0.05, 0.05)}"'
        if kind == "none":
            return ""
        if kind == "ball":
            self.balls.append(self.name("j"))
            return f'<joint name="{self.balls[-1]}" type="ball" armature="0" {place}/>'
        if kind == "several":
            axes = self.random.sample(["1 0 0", "0 1 0", "0 0 1"], 2)
            return "".join(self.hinge(f'axis="{axis}" {place} range="-40 40"') for axis in axes)
        more = self.one('armature="0.01"', 'frictionloss="0.1"', 'springref="10" stiffness="2"',
                        'damping="0.5"',
                        'class="stiff"', 'solreflimit="0.005 1"', 'actuatorfrcrange="-10 10"',
                        'springdamper="0.1 1"', 'margin="0.01"', 'ref="0.1"')
        if kind == "slide":
            return self.hinge(f'type="slide" axis="{self.vector(0.1, 1)}" range="-0.1 0.2" {more}')
        axis = self.one("1 0 0", "0 1 0", self.vector(0.1, 1))
        limit = self.one("", f'range="-{self.number(5, 120)} {self.number(5, 120)}"')
        return self.hinge(f'axis="{axis}" {place} {limit} {more}')

    def body(self, depth):
        self.bodies.append(self.name("b"))
        own = self.bodies[-1]
        text = f'<body name="{own}" pos="{self.vector(-0.3, 0.3)}" {self.orientation()} '
        text += self.one("", 'childclass="inner"', 'gravcomp="1"') + ">"
        if depth == 0 and self.random.random() < 0.5:
            self.frees.append(self.name("j"))
            text += f'<freejoint name="{self.frees[-1]}"/>'
        else:
            text += self.joint()
        if self.random.random() < 0.5:
            text += f'<inertial pos="{self.vector(-0.05, 0.05)}" mass="{self.number(0.2, 3)}" '
            text += self.one('diaginertia="0.01 0.012 0.009" quat="1 2 3 4"',
                             'fullinertia="0.01 0.012 0.009 0.001 -0.0005 0.0002"') + "/>"
        text += '<geom size="0.03"/><geom class="visual" mesh="brick" material="paint"/>'
        text += "".join(self.geom() for _ in range(self.random.randrange(3)))
        text += f'<frame pos="{self.vector(-0.1, 0.1)}" {self.orientation()}>{self.geom()}</frame>'
        for _ in range(self.random.randrange(3)):
            self.sites.append(self.name("s"))
            place = f'pos="{self.vector(-0.1, 0.1)}" {self.orientation()}'
            text += f'<site name="{self.sites[-1]}" {place} group="4"/>'
        text += self.one("", '<light pos="0 0 2" mode="trackcom"/>',
                         '<camera pos="0 -1 0" xyaxes="1 0 0 0 0 1"/>')
        below = 0 if depth == 4 else self.random.randrange(1, 4) if depth == 0 else self.random.randrange(3)
        return text + "".join(self.body(depth + 1) for _ in range(below)) + "</body>"

    def actuator(self, joint):
        return self.one(
            f'<position joint="{joint}" kp="{self.number(5, 200)}" kv="1" ctrlrange="-1 1" '
            'forcerange="-50 50"/>',
            f'<position class="drive" joint="{joint}"/>',
            f'<position joint="{joint}" kp="30" dampratio="1"/>',
            f'<motor joint="{joint}" gear="{self.number(1, 100)}"/>', f'<velocity joint="{joint}" kv="2"/>',
            f'<general joint="{joint}" gainprm="50" biastype="affine" biasprm="0 -50 -3" ctrlrange="-2 2"/>',
            f'<general joint="{joint}" dyntype="filter" dynprm="0.05" gainprm="10"/>',
            f'<intvelocity joint="{joint}" kp="50" actrange="-1 1"/>',
            f'<cylinder joint="{joint}" timeconst="0.1" area="0.01" ctrlrange="0 1"/>',
            f'<muscle joint="{joint}" force="{self.number(1, 9)}" lengthrange="-1 1" ctrlrange="0 1"/>',
            f'<damper joint="{joint}" kv="2" ctrlrange="0 1"/>', "")

    def relations(self):
        actuators = "".join(self.actuator(joint) for joint in self.joints)
        tendons = equality = contact = ""
        for joint in self.balls:
            actuators += f'<motor joint="{joint}" gear="0 1 0"/>'
            actuators += f'<position jointinparent="{joint}" gear="1 0 0"/>'
        for joint in self.frees:
            actuators += f'<motor joint="{joint}" gear="0 0 1 0 0.1 0"/>'
        if self.sites:
            actuators += f'<motor site="{self.one(*self.sites)}" gear="0 0 1 0 0 0.01" ctrlrange="0 10"/>'
            actuators += f'<adhesion body="{self.one(*self.bodies)}" ctrlrange="0 1" gain="10"/>'
        if len(self.sites) > 1:
            first, last = self.random.sample(self.sites, 2)
            around = f'<geom geom="{self.one(*self.rounds)}"/>' if self.rounds else ""
            tendons += '<spatial name="cord" width="0.002" springlength="0.2" stiffness="5" damping="0.1" '
            tendons += 'range="0 2">'
            tendons += f'<site site="{first}"/>{around}<site site="{last}"/></spatial>'
            actuators += '<motor tendon="cord" gear="-1"/>'
        if len(self.joints) > 1:
            first, last = self.random.sample(self.joints, 2)
            tendons += f'<fixed name="belt" range="-1 1" class="belt"><joint joint="{first}" coef="1"/>'
            tendons += f'<joint joint="{last}" coef="-0.5"/></fixed>'
            actuators += '<position tendon="belt" kp="10" dampratio="1"/>'
            first, last = self.random.sample(self.joints, 2)
            equality += f'<joint joint1="{first}" joint2="{last}" polycoef="0 {self.number(0.5, 2)} 0 0 0"/>'
        if len(self.bodies) > 1:
            first, last = self.random.sample(self.bodies, 2)
            contact += f'<exclude body1="{first}" body2="{last}"/>'
            equality += f'<weld body1="{first}" body2="{last}" active="false"/>'
        sensors = "".join(f'<{kind} site="{self.one(*self.sites)}"/>' for kind in
                          ("accelerometer", "gyro", "force", "torque", "touch", "rangefinder") if self.sites)
        for joint in self.joints[:2]:
            sensors += f'<jointpos joint="{joint}"/><jointvel joint="{joint}"/>'
        return (f"<tendon>{tendons}</tendon><equality>{equality}</equality><contact>{contact}</contact>"
                f"<actuator>{actuators}</actuator><sensor>{sensors}</sensor>")

    def model(self):
        compiler = self.one("", 'inertiafromgeom="true"', 'balanceinertia="true"', 'eulerseq="XYZ"',
                            'boundmass="0.01" boundinertia="1e-4"', 'eulerseq="zyx"')
        head = HEAD.format(compiler=compiler, dt=self.one("0.002", "0.004", "0.001"), brick=BRICK,
                           integrator=self.one("Euler", "implicitfast", "RK4"))
        world = "".join(self.body(0) for _ in range(self.one(1, 2)))
        ground = ('<geom type="plane" size="0 0 0.05" pos="0 0 -2"/>'
                  '<geom type="box" size="1 1 0.1" pos="3 0 -2"/>')
        return f"<mujoco>{head}<worldbody>{ground}{world}</worldbody>{self.relations()}</mujoco>"


    def urdf_link(self, name):
        shape = self.one(f'<box size="{self.vector(0.05, 0.3)}"/>',
                         f'<sphere radius="{self.number(0.02, 0.1)}"/>',
                         f'<cylinder radius="{self.number(0.02, 0.1)}" length="{self.number(0.05, 0.3)}"/>')
        origin = f'<origin xyz="{self.vector(-0.1, 0.1)}" rpy="{self.vector(-2, 2)}"/>'
        collision = f"<collision>{origin}<geometry>{shape}</geometry></collision>" * self.one(1, 2)
        tensor = 'ixx="0.02" iyy="0.025" izz="0.03" ixy="0.001" ixz="-0.002" iyz="0.0005"'
        inertial = f'<inertial>{origin}<mass value="{self.number(0.5, 3)}"/><inertia {tensor}/></inertial>'
        return f'<link name="{name}">{self.one("", inertial)}{collision}</link>'

    def urdf(self):
        count = self.random.randrange(3, 10)
        names = ["base"] + [f"link{i}" for i in range(1, count)]
        text = "".join(self.urdf_link(name) for name in names)
        for i, name in enumerate(names[1:], 1):
            kind = self.one("revolute", "revolute", "continuous", "prismatic", "fixed")
            ends = f'<parent link="{names[self.random.randrange(i)]}"/><child link="{name}"/>'
            place = f'<origin xyz="{self.vector(-0.3, 0.3)}" rpy="{self.vector(-1, 1)}"/>'
            axis = f'<axis xyz="{self.vector(0.1, 1)}"/><limit lower="-1" upper="1.5"/>'
            dynamics = f'<dynamics damping="{self.number(0, 1)}" friction="{self.number(0, 1)}"/>'
            text += f'<joint name="joint{i}" type="{kind}">{ends}{place}{axis}{dynamics}</joint>'
        return f'<robot name="generated">{text}</robot>'


def model(seed):
    """The text of a model in MJCF."""
    return Generator(seed).model()


def robot(seed):
    """The text of a model in URDF."""
    return Generator(seed).urdf()
