"""Keys of definitions, as in scene files. A vector is 3 numbers, a quaternion 4 with the scalar first."""
from typing import Any, Literal, Sequence, TypedDict, Union

Vector = Any
Quaternion = Any
Hard = Union[float, Literal["hard"]]
Breaks = Union[float, Literal["never"]]
Shape = Any  # a definition, the name of one, or a Shape of the world

class Material(TypedDict, total=False):
    friction: float
    static_friction: float
    dynamic_friction: float
    restitution: float
    friction_combine: str
    restitution_combine: str
    rolling_friction: float  # [m]
    torsional_friction: float  # [m]
    surface_velocity: Vector  # [m/s]

class BodyOptions(TypedDict, total=False):
    name: str
    motion: Literal["static", "kinematic", "dynamic"]
    material: Union[Material, dict[str, Any], str]
    density: float  # [kg/m3]
    mass: float  # [kg]
    inertia: Vector  # [kg m2]
    position: Vector  # [m]
    orientation: Union[Quaternion, dict[str, Any]]
    velocity: Vector  # [m/s]
    angular_velocity: Vector  # [rad/s]
    gravity_scale: float
    user_data: int
    linear_damping: float  # [1/s]
    angular_damping: float  # [1/s]
    lock_translation: Sequence[Literal["x", "y", "z"]]
    lock_rotation: Sequence[Literal["x", "y", "z"]]
    layers: Sequence[int]
    mask: Sequence[int]
    group: int
    sensor: bool

class BodyFields(BodyOptions, total=False):
    shape: Shape

class AxisFields(TypedDict, total=False):
    locked: bool
    min: Union[float, Literal["free"]]  # [m] or [rad]
    max: Union[float, Literal["free"]]
    limit_stiffness: Hard
    limit_damping: float
    target_position: float
    target_speed: float
    drive_stiffness: Hard
    drive_damping: Hard
    max_drive_force: Hard
    friction: float
    armature: float  # [kg] or [kg m2]
    damping: float
    motor_force: float

class JointValues(TypedDict, total=False):
    name: str
    anchor_a: Vector  # in the frame of the body [m]
    anchor_b: Vector
    frame_a: Quaternion
    frame_b: Quaternion
    orientation_a_to_b: Quaternion
    stiffness: Hard  # [N/m]
    damping: float  # [N s/m]
    damping_ratio: float
    angular_stiffness: Hard  # [N m/rad]
    angular_damping: float  # [N m s/rad]
    angular_damping_ratio: float
    max_force: Hard  # [N]
    max_torque: Hard  # [N m]
    length: float  # [m]
    ratio: float
    pulley_a: Vector  # [m]
    pulley_b: Vector
    swing_y: Union[float, Literal["free"]]  # [rad]
    swing_z: Union[float, Literal["free"]]
    friction: float  # [N m]
    drive_orientation: Quaternion
    drive_stiffness: Hard  # [N m/rad]
    drive_damping: Hard  # [N m s/rad]
    max_drive_torque: Hard  # [N m]
    axes: Sequence[Union[AxisFields, dict[str, Any]]]
    break_force: Breaks  # [N]
    break_torque: Breaks  # [N m]
    collide: bool

class JointFields(JointValues, total=False):
    anchor: Vector  # in the world [m]
    axis: Vector
    axis_b: Vector
    frame: Any

class SceneJointFields(JointFields, total=False):
    frame_body_a: Union[str, int]
    frame_body_b: Union[str, int]
    joint_a: str
    joint_b: str

class DeformableFields(TypedDict, total=False):
    type: Literal["tet_solid", "cloth", "cable", "net", "particles"]
    name: str
    vertices: Any  # (n, 3) [m]
    start: Any
    fixed: Sequence[int]
    velocity: Vector  # [m/s]
    angular_velocity: Vector  # [rad/s]
    material: Union[Material, dict[str, Any], str]
    gravity_scale: float
    collide: bool
    collide_surface: bool
    collide_self: bool
    collide_vertices: bool
    tetrahedra: Any
    triangles: Any
    youngs_modulus: float  # [Pa]
    poisson_ratio: float
    density: float  # [kg/m3]
    viscosity: float  # [Pa s]
    yield_stress: float  # [Pa]
    hardening: float  # [Pa]
    contact_radius: float  # [m]
    thickness: float  # [m]
    bending_stiffness: float  # [N m]
    bending_damping: float  # [N s/rad]
    rest_folded: bool
    tear_stretch: Breaks
    pressure: float  # [Pa]
    closed: bool
    radius: float  # [m]
    break_force: Breaks  # [N]
    masses: Sequence[float]  # [kg]
    edges: Any
    mesh: dict[str, Any]
    elements: Sequence[dict[str, Any]]

class AttachmentFields(TypedDict, total=False):
    name: str
    weights: Sequence[float]
    anchor: Vector  # [m]
    other_vertices: Sequence[int]
    other_weights: Sequence[float]
    stiffness: Hard  # [N/m]
    break_force: Breaks  # [N]

class SceneAttachmentFields(AttachmentFields, total=False):
    body: Union[str, int]
    other_object: Union[str, int]

class RodFields(TypedDict, total=False):
    name: str
    radius: float  # [m]
    youngs_modulus: float  # [Pa]
    poisson_ratio: float
    density: float  # [kg/m3]
    viscosity: float  # [Pa s]
    break_force: Breaks  # [N]
    break_torque: Breaks  # [N m]
    start: Union[int, Literal["world"]]
    end: Union[int, Literal["world"]]
    material: Union[Material, dict[str, Any]]

class FilterFields(TypedDict, total=False):
    layers: int
    mask: int
    sensors: bool
    ignore: Any
    deformables: bool
    ignore_object: Any
