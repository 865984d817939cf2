"""Keys of definitions, as in scene files. Written by tools/make_python_stubs from their schema."""
from typing import Any, Literal, Sequence, TypedDict, Union

import numpy as np

from . import _bodies

Numbers = Union[Sequence[Any], np.ndarray]  # of the shape that the field says
Vector = Union[Sequence[float], np.ndarray]  # 3 numbers
Quaternion = Union[Sequence[float], np.ndarray]  # 4 numbers, the scalar first
Shape = Union[dict[str, Any], str, "_bodies.Shape"]  # a definition, the name of one, or a shape of the world
Named = Union[str, int]  # a name or an index

class Turn(TypedDict):
    axis: Vector
    degrees: float

class Material(TypedDict, total=False):
    friction: float
    """Coefficients [1]; dynamic friction is at most static friction."""
    static_friction: float
    """Coefficients [1]; dynamic friction is at most static friction."""
    dynamic_friction: float
    """Coefficients [1]; dynamic friction is at most static friction."""
    restitution: float
    """0 to 1."""
    rolling_friction: float
    """Levers [m]."""
    torsional_friction: float
    """Levers [m]."""
    friction_combine: Literal["usual", "average", "minimum", "multiply", "maximum", "geometric_mean"]
    """How a pair makes one number of two: `"usual"`, `"average"`, `"minimum"`, `"multiply"`, `"maximum"`,
    `"geometric_mean"`. Of two different rules the later one in this list holds."""
    restitution_combine: Literal["usual", "average", "minimum", "multiply", "maximum", "geometric_mean"]
    """How a pair makes one number of two: `"usual"`, `"average"`, `"minimum"`, `"multiply"`, `"maximum"`,
    `"geometric_mean"`. Of two different rules the later one in this list holds."""
    surface_velocity: Vector
    """Of a conveyor, body axes [m/s]."""
    one_way: Vector
    """Of a one-way surface: direction of the side that holds, body axes."""
    name: str
    """For pair rules."""

class MaterialPair(TypedDict, total=False):
    friction: float
    """Coefficients [1]; dynamic friction is at most static friction."""
    static_friction: float
    """Coefficients [1]; dynamic friction is at most static friction."""
    dynamic_friction: float
    """Coefficients [1]; dynamic friction is at most static friction."""
    restitution: float
    """0 to 1."""
    rolling_friction: float
    """Levers [m]."""
    torsional_friction: float
    """Levers [m]."""

class BodyOptions(TypedDict, total=False):
    name: str
    """A text; joints, events and claims refer to it."""
    motion: Literal["dynamic", "kinematic", "static"]
    """`"dynamic"`, `"kinematic"` (follows its velocity, pushes others) or `"static"`."""
    density: float
    """[kg/m3]; gives mass and inertia."""
    mass: float
    """[kg], in place of `density`; inertia goes with it."""
    inertia: Vector
    """Three principal moments about the center of mass, body axes [kg m2], in place of those of the
    shape."""
    material: Union[Material, dict[str, Any], str]
    """A material, or the name of one in `materials`."""
    position: Vector
    """Of the shape frame, world [m]."""
    orientation: Union[Quaternion, Turn]
    """Body to world: a unit quaternion `[w, x, y, z]`, or `{"axis": [x, y, z], "degrees": angle}`."""
    velocity: Vector
    """Of the center of mass, world axes [m/s]."""
    angular_velocity: Vector
    """World axes [rad/s]."""
    gravity_scale: float
    """Factor on gravity for this body."""
    linear_damping: float
    """c: the velocity of a free body decays as exp(-c t) [1/s]."""
    angular_damping: float
    """c: the angular velocity of a free body decays as exp(-c t) [1/s]."""
    lock_translation: Sequence[Literal["x", "y", "z"]]
    """World axes that it does not move along."""
    lock_rotation: Sequence[Literal["x", "y", "z"]]
    """World axes that it does not turn about."""
    layers: Sequence[int]
    """List of the layers that it is in, 0 to 31."""
    mask: Sequence[int]
    """List of the layers that it collides with."""
    group: int
    """Two bodies of one group always collide if its number is positive, and never if it is negative."""
    sensor: bool
    """It reports overlaps and has no contact forces."""
    user_data: int
    """A whole number of the caller, which events and hits return."""

class BodyFields(BodyOptions, total=False):
    shape: Shape
    """A definition, or the name of one."""

class AxisFields(TypedDict, total=False):
    """An axis of a joint, in [m], [N] or [rad], [N m]."""
    armature: float
    """Inertia of the motor, as it acts on the axis [kg, kg m2]."""
    damping: float
    """Viscous friction, without a bound [N s/m, N m s/rad]."""
    drive_damping: Union[float, Literal["hard"]]
    """Towards the target speed; 0: none; hard: a motor [N s/m, N m s/rad]."""
    drive_stiffness: Union[float, Literal["hard"]]
    """Towards the target position; 0: none [N/m, N m/rad]."""
    friction: float
    """Resists any motion, up to this [N, N m]."""
    limit_damping: float
    """Of limits with a stiffness [N s/m, N m s/rad]."""
    limit_stiffness: Union[float, Literal["hard"]]
    """Of the limits [N/m, N m/rad]."""
    locked: bool
    """Min and max are 0."""
    max: Union[float, Literal["free"]]
    """Upper limit; equal ones lock the axis [m, rad]."""
    max_drive_force: Union[float, Literal["hard"]]
    """Largest force of the drive [N, N m]."""
    min: Union[float, Literal["free"]]
    """Lower limit [m, rad]."""
    motor_force: float
    """Of the motor, positive where it raises the coordinate [N, N m]."""
    target_position: float
    """Of the drive [m, rad]."""
    target_speed: float
    """Of the drive [m/s, rad/s]."""

class JointValues(TypedDict, total=False):
    """What a joint has wherever it is; each type takes some of these."""
    anchor_a: Vector
    """Point on body A, in its frame [m]."""
    anchor_b: Vector
    """Point on body B, in its frame [m]."""
    frame_a: Union[Quaternion, Turn]
    """Axes of the joint on A, a unit quaternion."""
    frame_b: Union[Quaternion, Turn]
    """Axes of the joint on B."""
    orientation_a_to_b: Union[Quaternion, Turn]
    """Wanted orientation of A seen from B, a unit quaternion."""
    stiffness: Union[float, Literal["hard"]]
    """Of the anchors or of the length, or "hard" [N/m]."""
    damping: float
    """Beside a stiffness [N s/m]."""
    damping_ratio: float
    """In place of damping: of critical, for the two bodies alone."""
    angular_stiffness: Union[float, Literal["hard"]]
    """Of the orientation, or "hard" [N m/rad]."""
    angular_damping: float
    """Beside an angular stiffness [N m s/rad]."""
    angular_damping_ratio: float
    """In place of angular damping."""
    max_force: Union[float, Literal["hard"]]
    """The anchors are held with this force at most, or "hard" [N]."""
    max_torque: Union[float, Literal["hard"]]
    """The orientation is held with this torque at most, or "hard" [N m]."""
    length: float
    """Below 0: as it is at the beginning [m]."""
    ratio: float
    """Between the motion of A and of B; rack: travel of B for a radian of A [m]."""
    path: Numbers
    """Five numbers for each point: side, x, y, z, weight of the segment [1, m]."""
    terms: Numbers
    """Thirteen numbers for each coordinate: kind, sides, axis, anchor, c_1-4 [1, m]."""
    tilts: Numbers
    """Two numbers for each coordinate: tilts of the gimbal that it is an angle of [rad]."""
    wraps: Numbers
    """Thirteen numbers for each sphere or cylinder that the path goes around [1, m]."""
    pulley_a: Vector
    """Point of the world that A's part runs over [m]."""
    pulley_b: Vector
    """Point of the world that B's part runs over [m]."""
    swing_y: Union[float, Literal["free"]]
    """Half angle of the cone about y, or "free" [rad]."""
    swing_z: Union[float, Literal["free"]]
    """Half angle of the cone about z, or "free" [rad]."""
    offset_b: Vector
    """From anchor B to the second axis, in the frame of B at angles of 0 [m]."""
    offset_a: Vector
    """From there to anchor A, likewise [m]."""
    tilt_b: float
    """90 degrees less the angle between the first and the second axis [rad]."""
    tilt_a: float
    """90 degrees less the angle between the second and the third axis [rad]."""
    friction: float
    """Torque that resists any turn [N m]."""
    drive_orientation: Union[Quaternion, Turn]
    """Wanted orientation of A's frame seen from B's."""
    drive_stiffness: Union[float, Literal["hard"]]
    """Towards drive_orientation, or "hard" [N m/rad]."""
    drive_damping: Union[float, Literal["hard"]]
    """Of that drive, or "hard" [N m s/rad]."""
    max_drive_torque: Union[float, Literal["hard"]]
    """Of that drive, or "hard" [N m]."""
    axes: Sequence[Union[AxisFields, dict[str, Any]]]
    """Its axes, in their order."""
    break_force: Union[float, Literal["never"]]
    """The joint breaks when its force reaches this, or "never" [N]."""
    break_torque: Union[float, Literal["never"]]
    """The joint breaks when its torque reaches this, or "never" [N m]."""
    collide: bool
    """Do the two bodies collide with one another?."""
    name: str
    """A text; events and claims refer to it."""
    user_data: int
    """A whole number of the caller, which events and hits return."""

class JointFields(JointValues, total=False):
    anchor: Vector
    """A point of the world [m], where both bodies are when the scene begins."""
    axis: Vector
    """Direction of the joint's x axis in the world as the scene begins; `axis_b`: another one for B."""
    axis_b: Vector
    """Direction of the joint's x axis in the world as the scene begins; `axis_b`: another one for B."""
    frame: Union[Quaternion, Turn]
    """In its place: all three axes, an orientation."""

class SceneJointFields(JointFields, total=False):
    frame_body_a: Named
    """Gear, rack: bodies in which the axes lie as the scene begins; tendon: sides 2 and 3."""
    frame_body_b: Named
    """Gear, rack: bodies in which the axes lie as the scene begins; tendon: sides 2 and 3."""
    joint_a: str
    """In place of bodies, frame bodies, anchors and axes: names of two hinges further up (gear), of a
    hinge and a slider (rack)."""
    joint_b: str
    """In place of bodies, frame bodies, anchors and axes: names of two hinges further up (gear), of a
    hinge and a slider (rack)."""

class DeformableFields(TypedDict, total=False):
    name: str
    """Optional."""
    vertices: Numbers
    """Shape at rest, world [m]."""
    start: Numbers
    """Where the vertices start; at rest if it is not given [m]."""
    fixed: Sequence[int]
    """Vertices that never move."""
    velocity: Vector
    """At the beginning [m/s]."""
    angular_velocity: Vector
    """About the center of mass [rad/s]."""
    material: Union[Material, dict[str, Any], str]
    """Of the surface; without rolling friction and surface velocity."""
    gravity_scale: float
    """Factor on the scene's gravity."""
    collide: bool
    """With bodies."""
    collide_surface: bool
    """Vertices, edges and triangles, with those of other objects that say so."""
    collide_self: bool
    """Vertices, edges and triangles, with one another."""
    collide_vertices: bool
    """With vertices of other objects that say so, as spheres."""
    tetrahedra: Numbers
    """Four vertices each, of positive volume."""
    youngs_modulus: float
    """E [Pa]."""
    poisson_ratio: float
    """nu, 0 to below .5."""
    density: float
    """Of the solid [kg/m3]."""
    viscosity: float
    """Of the strain rate [Pa s]."""
    yield_stress: float
    """Von Mises stress at which it begins to flow [Pa]."""
    hardening: float
    """Of the yield stress, for each unit of plastic strain [Pa]."""
    contact_radius: float
    """How far from a vertex its surface lies [m]."""
    triangles: Numbers
    """Three vertices each."""
    thickness: float
    """Contacts keep half of it [m]."""
    bending_stiffness: float
    """E h^3 / (12 (1 - nu^2)) if it is not given [N m]."""
    rest_folded: bool
    """Keep the angles of the mesh; else it wants to be flat."""
    bending_damping: float
    """Of the rate of an angle, for each metre of edge [N s/rad]."""
    tear_stretch: Union[float, Literal["never"]]
    """Length over rest length at which a triangle tears."""
    pressure: float
    """Inside over outside, of a closed sheet [Pa]."""
    closed: bool
    """A ring."""
    radius: float
    """Of its circular section; also in contact [m]."""
    break_force: Union[float, Literal["never"]]
    """Tension at which a segment breaks [N]."""
    masses: Numbers
    """Of each vertex; one number serves all [kg]."""
    edges: Numbers
    """Springs: [vertex, vertex, stiffness, damping, rest length]; the last two may be left out [N/m, N
    s/m, m]."""
    mesh: dict[str, Any]
    """A file in place of vertices."""
    type: Literal["tet_solid", "cloth", "cable", "net", "particles"]
    elements: Sequence[dict[str, Any]]
    """Of types that an extension adds."""

class AttachmentFields(TypedDict, total=False):
    name: str
    """Optional."""
    weights: Numbers
    """Of these vertices; equal ones if they are not given."""
    anchor: Vector
    """In the frame of the body; where the vertices start if it is not given [m]."""
    other_vertices: Sequence[int]
    """Of a seam: of the other object."""
    other_weights: Numbers
    """Of these vertices."""
    stiffness: Union[float, Literal["hard"]]
    """Or "hard" [N/m]."""
    break_force: Union[float, Literal["never"]]
    """The attachment breaks when its force reaches this [N]."""

class SceneAttachmentFields(AttachmentFields, total=False):
    body: Named
    """Name or index of a body; the world if it is not given."""
    other_object: Named
    """Of a seam: name or index of the other object."""

class SensorFields(TypedDict, total=False):
    name: str
    """Optional."""
    body: Named
    """Of the frame; the world unless given."""
    position: Vector
    """Of the frame on the body [m]."""
    orientation: Union[Quaternion, Turn]
    """Of the frame, to the body."""
    reference: Named
    """Body of the reference frame; the world unless given."""
    reference_position: Vector
    """Of the reference frame on its body [m]."""
    reference_orientation: Union[Quaternion, Turn]
    """Of the reference frame, to its body."""
    joint: Named
    """Name or index."""
    axis: int
    """Of the joint, from 0."""
    scale: float
    """Factor on the reading of a joint."""
    offset: float
    """Added to that."""
    cutoff: float
    """Bound of each number; 0: none."""
    volume: Shape
    """Touch: a sphere, box, capsule or cylinder."""

class ActuatorFields(TypedDict, total=False):
    activation: float
    axis: int
    """Of the joint, from 0."""
    bias: Vector
    body: Named
    """Wrench, adhesion: name or index."""
    control: float
    dynamics: Literal["none", "integrator", "filter", "filter_exact", "muscle"]
    """How its input follows its control."""
    early: bool
    force: Vector
    gain: Vector
    gear: float
    included: float
    joint: Named
    """Of the other types: name or index."""
    max_activation: Union[float, Literal["free"]]
    max_control: Union[float, Literal["free"]]
    max_force: Union[float, Literal["hard"]]
    min_activation: Union[float, Literal["free"]]
    min_control: Union[float, Literal["free"]]
    min_force: Union[float, Literal["hard"]]
    muscle: dict[str, Any]
    """Its numbers."""
    name: str
    """Optional."""
    offset: float
    position: Vector
    time_constant: float
    torque: Vector

class EventFields(TypedDict, total=False):
    remove_joints: Sequence[str]
    """List of names of joints."""
    remove: Sequence[str]
    """List of names of bodies; `"brick*"` stands for every name that begins with `brick`. The joints of a
    body are removed with it."""
    add: Sequence[Union[BodyFields, dict[str, Any]]]
    """List of bodies."""
    set_velocity: Sequence[dict[str, Any]]
    """List of `{"body": name, "velocity": [x, y, z], "angular_velocity": [x, y, z]}` [m/s], [rad/s];
    default 0."""
    set_joint: Sequence[dict[str, Any]]
    """List of `{"joint": name, "axis": 0, "target_position": number, "target_speed": number,
    "motor_force": number, "length": number, "drag_to": [x, y, z]}`; other values are kept."""
