"""Options of calls. Written by tools/make_python_stubs."""
from typing import Any, Literal, Sequence, TypedDict, Union

from . import _bodies, _soft
from ._fields import Material, Numbers, Vector

class SceneValues(TypedDict, total=False):
    name: str
    """Title of the scene."""
    description: str
    """What it shows."""
    steps: int
    """Length of a full run."""
    iterations: int
    """Iterations per step that the verdict is stated for."""
    substeps: int
    """Full steps that each time step is divided into."""
    dt: float
    """Time step [s]."""
    smash_step: int
    """First step of the smash phase."""
    materials: dict[str, Any]
    """Materials by name."""
    shapes: dict[str, Any]
    """Shapes by name."""
    camera: dict[str, Any]
    """Eye and target [m]."""
    sun: Union[Vector, dict[str, Any]]
    """Direction to the sun, or direction, color and strength."""
    sky: float
    """Factor on the light of the sky."""

class SceneFields(SceneValues, total=False):
    gravity: Vector
    """[m/s2]."""

class Parameters(TypedDict, total=False):
    dt: float
    """Time step [s]."""
    iterations: int
    """Iterations a step."""
    substeps: int
    """Full steps of dt / substeps each."""
    sort_interval: int
    """Bodies are put in an order of space in memory after so many steps each time; 0: never."""
    sleeping: bool
    """Islands of bodies at rest are left out of the steps."""
    sleep_speed: float
    """Surface speed over sqrt(g L) below which a body is still."""
    sleep_delay: float
    """Time after which an island of still bodies sleeps [s]."""
    start_stiffness: float
    """K: k_start = K m_row / dt^2."""
    contact_ramp_rate: float
    """B of contacts: beta = B (m_row / dt^2) / L; beta itself [N/m2] if literalBeta."""
    joint_ramp_rate: float
    """B of joints."""
    literal_beta: bool
    """Ramp rates are beta itself."""
    error_retention: float
    """Alpha: part of an inherited error left alone in a step; below 0: 1 - min(1, 3 dt)."""
    warm_start_decay: float
    """gamma of a step of 1/60 s."""
    max_stiffness: float
    """k_max over m_row / dt^2."""
    tangent_stiffness: float
    """Stiffness of tangential rows over that of normal rows."""
    contact_policy: int
    """Stiffness of contacts: 0 ramp, 1 follows the load."""
    joint_policy: int
    """Stiffness of joints: 0 ramp, 1 follows the load."""
    load_acceleration: float
    """A over gravity: k = |lambda| / (a dt^2) where stiffness follows the load."""
    cone_hessian: bool
    """Cone-consistent Hessian of friction."""
    dormant_rows: bool
    """Rows that stay open are left out of a step."""
    impact_rule: bool
    """Multipliers of an impact are not warm-started."""
    compliant_rows: bool
    """Finite stiffness by compliant multipliers, else by the ramp."""
    coarse_correction: bool
    """Rigid motions of groups of bodies are solved for as well."""
    joint_trees: bool
    """Bodies that hang together by joints are solved for together as well, and so are the vertices of
    ropes and rods, and bodies stacked as a column."""
    acceleration: float
    """rho of the Chebyshev acceleration of deformable solids; 0: none."""
    drift_correction: float
    """Rate at which tangential drift of sticking contacts is taken back; below 0: that of other errors
    [1/s]."""
    contact_margin: float
    """Smallest detection margin over the bounding diameter."""
    recycle_tolerance: float
    """Relative motion (over the diameter; rad) below which a manifold is kept; 0: never."""

class WorldOptions(Parameters, total=False):
    preset: Literal["engine", "paper", "demo3d"]
    """Parameters to begin with."""
    timings: bool
    """Measure the stages of each step."""
    instruction_set: Literal["", "baseline", "avx2"]
    """Of the CPU; empty: the best one."""

class RunOptions(WorldOptions, total=False):
    backend: str
    """One of info()["backends"]."""
    threads: int
    """0: one per core."""
    events: bool
    """Collect the events of each step."""

class RodFields(TypedDict, total=False):
    name: str
    """Beginning of the names of its bodies and joints."""
    radius: float
    """Of its circular section [m]."""
    youngs_modulus: float
    """E [Pa]."""
    poisson_ratio: float
    """nu, -1 to 0.5."""
    density: float
    """Of the rod [kg/m3]."""
    viscosity: float
    """Of the strain rate [Pa s]."""
    break_force: Union[float, Literal["never"]]
    """Per joint [N]."""
    break_torque: Union[float, Literal["never"]]
    """Per joint [N m]."""
    start: Union[int, Literal["world"]]
    """Body that its first end is fixed to."""
    end: Union[int, Literal["world"]]
    """Body that its last end is fixed to."""
    material: Union[Material, dict[str, Any]]
    """Of its surface."""

class FilterFields(TypedDict, total=False):
    layers: int
    """Bit set of the layers that the query is in."""
    mask: int
    """Bit set of the layers that it meets."""
    sensors: bool
    """Also test sensors."""
    ignore: "Union[_bodies.Body, None]"
    """A body that is left out."""
    deformables: bool
    """Also test deformable objects."""
    ignore_object: "Union[_soft.Deformable, None]"
    """A deformable object that is left out."""

class ImportOptions(TypedDict, total=False):
    key: str
    """Keyframe of an MJCF model to begin with."""
    srdf: str
    """File with exclusions beside a URDF model."""
    packages: dict[str, str]
    """Folders of packages by name."""
    folders: Sequence[str]
    """Further folders to look for meshes in."""
    floating_base: bool
    """URDF: the root is a free body."""

class ModelOptions(ImportOptions, total=False):
    strict: bool
    """Refuse what is not exact."""

class PainterOptions(TypedDict, total=False):
    samples: int
    """Per pixel."""
    color_by: str
    """A quantity: "body", "speed", "strain" or another."""
    full_value: float
    """Value of the hottest color; 0: the largest one of each picture."""

class PictureOptions(PainterOptions, total=False):
    width: int
    """[pixels]."""
    height: int
    """[pixels]."""
    eye: Vector
    """Of the camera [m]."""
    target: Vector
    """Of the camera [m]."""
    field_of_view: float
    """Full vertical angle [rad]."""

class DrawOptions(TypedDict, total=False):
    surfaces: bool
    """Draw surfaces."""
    edges: bool
    """Draw edges."""
    contacts: bool
    """Draw contacts."""
    joints: bool
    """Draw joints."""
    bounds: bool
    """Draw bounds."""
    names: bool
    """Draw names."""
    force_scale: float
    """Length of a force [m/N]."""
    plane_size: float
    """Edge of a plane [m]."""
    segments: int
    """Triangles per circle, 3 or more."""
