"""Structs and functions of the C library. Written by tools/make_python_abi from include/rubble/c/*.h."""
from ctypes import POINTER, Structure, c_char_p, c_double, c_int, c_int32, c_int64, c_uint32, c_uint64, \
    c_void_p

API_VERSION = 3
OK = 0
INVALID = 1
OUT_OF_MEMORY = 2
FAILED = 3
POSITION = 0
ORIENTATION = 1
VELOCITY = 2
ANGULAR_VELOCITY = 3
FORCE = 4
TORQUE = 5
JOINT_POSITION = 0
JOINT_SPEED = 1
JOINT_DRIVE_FORCE = 2
JOINT_LIMIT_FORCE = 3
JOINT_FRICTION_FORCE = 4
JOINT_LOWER_LIMIT = 5
JOINT_UPPER_LIMIT = 6
JOINT_TARGET_POSITION = 7
JOINT_TARGET_SPEED = 8
JOINT_APPLIED_FORCE = 9
SENSOR_CONTACT_FORCE = 0
SENSOR_TOUCH = 1
SENSOR_ACCELERATION = 2
SENSOR_ANGULAR_RATE = 3
SENSOR_JOINT_FORCE = 4
SENSOR_JOINT_TORQUE = 5
VERTEX_POSITION = 0
VERTEX_VELOCITY = 1


class Error(Structure):
    _fields_ = [("status", c_int32), ("message", c_char_p), ("path", c_char_p), ("expected", c_char_p),
                ("found", c_char_p)]


class BodyId(Structure):
    _fields_ = [("index", c_int32), ("generation", c_uint32)]


class ShapeId(Structure):
    _fields_ = [("index", c_int32), ("generation", c_uint32)]


class JointId(Structure):
    _fields_ = [("index", c_int32), ("generation", c_uint32)]


class DeformableId(Structure):
    _fields_ = [("index", c_int32), ("generation", c_uint32)]


class AttachmentId(Structure):
    _fields_ = [("index", c_int32), ("generation", c_uint32)]


class Array(Structure):
    _fields_ = [("data", c_void_p), ("shape", c_int64 * 2), ("strides", c_int64 * 2), ("typestr", c_char_p),
                ("device", c_int32), ("stream", c_uint64), ("epoch", c_int64)]


class PoseFrame(Structure):
    _fields_ = [("step", c_int64), ("time", c_double), ("position", Array), ("orientation", Array)]


class BodyState(Structure):
    _fields_ = [("position", c_double * 3), ("orientation", c_double * 4), ("velocity", c_double * 3),
                ("angular_velocity", c_double * 3)]


class Mass(Structure):
    _fields_ = [("mass", c_double), ("inertia", c_double * 3), ("center", c_double * 3),
                ("axes", c_double * 4)]


class ContactLoad(Structure):
    _fields_ = [("force", c_double * 3), ("torque", c_double * 3), ("residual", c_double),
                ("points", c_int32)]


class AxisState(Structure):
    _fields_ = [("position", c_double), ("speed", c_double), ("limit_force", c_double),
                ("drive_force", c_double), ("friction_force", c_double), ("motor_force", c_double)]


class JointState(Structure):
    _fields_ = [("gap", c_double), ("angle", c_double), ("force", c_double * 3), ("torque", c_double * 3),
                ("axis_count", c_int32), ("broken", c_int32), ("axes", AxisState * 6)]


class AttachmentEnds(Structure):
    _fields_ = [("object", DeformableId), ("other_object", DeformableId), ("body", BodyId),
                ("anchor", c_double * 3)]


class Surface(Structure):
    _fields_ = [("vertices", c_void_p), ("vertex_count", c_int64), ("triangles", c_void_p),
                ("triangle_count", c_int64), ("segments", c_void_p), ("segment_count", c_int64),
                ("radius", c_double), ("spheres", c_int32)]


class ContactPoint(Structure):
    _fields_ = [("a", BodyId), ("b", BodyId), ("position", c_double * 3), ("normal", c_double * 3),
                ("depth", c_double), ("force", c_double * 3), ("part_a", c_int32), ("part_b", c_int32)]


class VertexContact(Structure):
    _fields_ = [("object", DeformableId), ("vertex", c_int32), ("body", BodyId),
                ("other_object", DeformableId), ("other_vertex", c_int32), ("normal", c_double * 3),
                ("depth", c_double), ("force", c_double * 3)]


class ContactEvent(Structure):
    _fields_ = [("phase", c_int32), ("a", BodyId), ("b", BodyId), ("user_data_a", c_uint64),
                ("user_data_b", c_uint64), ("shape_user_data_a", c_uint64), ("shape_user_data_b", c_uint64),
                ("sensor", c_int32), ("impulse", c_double * 3), ("first_point", c_int64),
                ("point_count", c_int64)]


class JointEvent(Structure):
    _fields_ = [("joint", JointId), ("user_data", c_uint64), ("a", BodyId), ("b", BodyId),
                ("force", c_double * 3), ("torque", c_double * 3)]


class SleepEvent(Structure):
    _fields_ = [("body", BodyId), ("asleep", c_int32), ("user_data", c_uint64)]


class Events(Structure):
    _fields_ = [("contacts", c_void_p), ("contact_count", c_int64), ("points", c_void_p),
                ("point_count", c_int64), ("joints", c_void_p), ("joint_count", c_int64),
                ("sleeps", c_void_p), ("sleep_count", c_int64)]


class StepReport(Structure):
    _fields_ = [("step", c_int64), ("bodies", c_int32), ("pairs", c_int32), ("manifolds", c_int32),
                ("contacts", c_int32), ("vertices", c_int32), ("vertex_contacts", c_int32),
                ("colors", c_int32), ("clashes", c_int32), ("broken_joints", c_int32),
                ("sleeping_bodies", c_int32), ("stopped_bodies", c_int32), ("quarantined", c_int32),
                ("failed_solves", c_int32), ("restarts", c_int32), ("sorted", c_int32),
                ("unfinished_motion", c_double), ("total_ms", c_double)]


class Distribution(Structure):
    _fields_ = [("mean", c_double), ("p99", c_double), ("max", c_double)]


class Quality(Structure):
    _fields_ = [("penetration", Distribution), ("joint_gap_mean", c_double), ("joint_gap_max", c_double),
                ("kinetic_energy", c_double), ("potential_energy", c_double), ("max_speed", c_double)]


class SolverState(Structure):
    _fields_ = [("color", c_int32), ("stiffness", c_double), ("multiplier", c_double)]


class QueryFilter(Structure):
    _fields_ = [("layers", c_uint32), ("mask", c_uint32), ("sensors", c_int32), ("ignore", BodyId),
                ("deformables", c_int32), ("ignore_object", DeformableId)]


class Ray(Structure):
    _fields_ = [("origin", c_double * 3), ("direction", c_double * 3), ("max_distance", c_double),
                ("filter", QueryFilter)]


class RayArrays(Structure):
    _fields_ = [("origins", Array), ("directions", Array), ("max_distance", c_double),
                ("filter", QueryFilter)]


class RayHitArrays(Structure):
    _fields_ = [("distances", Array), ("bodies", Array), ("normals", Array)]


class Cast(Structure):
    _fields_ = [("shape", c_void_p), ("position", c_double * 3), ("orientation", c_double * 4),
                ("displacement", c_double * 3), ("filter", QueryFilter)]


class Overlap(Structure):
    _fields_ = [("shape", c_void_p), ("position", c_double * 3), ("orientation", c_double * 4),
                ("filter", QueryFilter)]


class Closest(Structure):
    _fields_ = [("point", c_double * 3), ("max_distance", c_double), ("filter", QueryFilter)]


class Hit(Structure):
    _fields_ = [("hit", c_int32), ("body", BodyId), ("object", DeformableId), ("part", c_int32),
                ("triangle", c_int32), ("distance", c_double), ("position", c_double * 3),
                ("normal", c_double * 3), ("user_data", c_uint64), ("shape_user_data", c_uint64)]


class DebugLine(Structure):
    _fields_ = [("from", c_double * 3), ("to", c_double * 3), ("color", c_uint32)]


class DebugTriangle(Structure):
    _fields_ = [("corners", c_double * 9), ("color", c_uint32)]


class DebugText(Structure):
    _fields_ = [("position", c_double * 3), ("text", c_char_p), ("color", c_uint32)]


class DebugDraw(Structure):
    _fields_ = [("lines", c_void_p), ("line_count", c_int64), ("triangles", c_void_p),
                ("triangle_count", c_int64), ("texts", c_void_p), ("text_count", c_int64)]


class Pose(Structure):
    _fields_ = [("position", c_double * 3), ("orientation", c_double * 4)]


class Frame(Structure):
    _fields_ = [("step", c_int64), ("time", c_double), ("poses", c_void_p), ("pose_count", c_int64),
                ("vertices", c_void_p), ("vertex_count", c_int64)]


class Camera(Structure):
    _fields_ = [("eye", c_double * 3), ("target", c_double * 3), ("field_of_view", c_double)]


class Image(Structure):
    _fields_ = [("width", c_int32), ("height", c_int32), ("rgb", c_void_p)]


FUNCTIONS = {
    "rb_api_version": (c_int32, []),
    "rb_last_error": (POINTER(Error), []),
    "rb_info": (c_int, [c_void_p]),
    "rb_scene_create": (c_int, [c_char_p, c_void_p]),
    "rb_scene_parse": (c_int, [c_char_p, c_char_p, c_void_p]),
    "rb_scene_read": (c_int, [c_char_p, c_void_p]),
    "rb_scene_import": (c_int, [c_char_p, c_char_p, c_void_p, c_void_p]),
    "rb_scene_build": (c_int, [c_char_p, c_char_p, c_void_p]),
    "rb_scene_destroy": (None, [c_void_p]),
    "rb_scene_set": (c_int, [c_void_p, c_char_p, c_char_p]),
    "rb_scene_add": (c_int, [c_void_p, c_char_p, c_char_p, c_void_p]),
    "rb_scene_add_rod": (c_int, [c_void_p, c_char_p, c_void_p]),
    "rb_scene_count": (c_int, [c_void_p, c_char_p, c_void_p]),
    "rb_scene_text": (c_int, [c_void_p, c_void_p]),
    "rb_scene_write": (c_int, [c_void_p, c_char_p]),
    "rb_shape_create": (c_int, [c_char_p, c_void_p]),
    "rb_shape_destroy": (None, [c_void_p]),
    "rb_shape_mass": (c_int, [c_void_p, c_double, c_void_p]),
    "rb_tet_box": (c_int, [c_void_p, c_void_p, c_void_p, c_void_p]),
    "rb_tet_ball": (c_int, [c_void_p, c_double, c_int32, c_void_p]),
    "rb_tet_solid": (c_int, [c_void_p, c_int64, c_void_p, c_int64, c_double, c_void_p]),
    "rb_cloth_sheet": (c_int, [c_void_p, c_void_p, c_void_p, c_int32, c_int32, c_void_p]),
    "rb_straight_cable": (c_int, [c_void_p, c_void_p, c_int32, c_void_p]),
    "rb_cable_along": (c_int, [c_void_p, c_int64, c_double, c_int32, c_void_p]),
    "rb_registry": (c_int, [c_void_p]),
    "rb_run_create": (c_int, [c_char_p, c_char_p, c_char_p, c_void_p]),
    "rb_run_scene": (c_int, [c_void_p, c_char_p, c_void_p]),
    "rb_run_destroy": (None, [c_void_p]),
    "rb_run_world": (c_void_p, [c_void_p]),
    "rb_run_steps": (c_int32, [c_void_p]),
    "rb_run_step": (c_int, [c_void_p, c_void_p]),
    "rb_run_rewound": (c_int, [c_void_p]),
    "rb_run_finish": (c_int, [c_void_p, c_void_p]),
    "rb_world_create": (c_int, [c_void_p, c_char_p, c_void_p]),
    "rb_world_destroy": (None, [c_void_p]),
    "rb_world_step": (c_int, [c_void_p, c_void_p]),
    "rb_world_run_events": (c_int, [c_void_p]),
    "rb_world_report": (c_int, [c_void_p, c_void_p]),
    "rb_world_params": (c_int, [c_void_p, c_void_p]),
    "rb_world_set_params": (c_int, [c_void_p, c_char_p]),
    "rb_world_gravity": (c_int, [c_void_p, c_void_p]),
    "rb_world_set_gravity": (c_int, [c_void_p, c_void_p]),
    "rb_world_set_material_pair": (c_int, [c_void_p, c_char_p]),
    "rb_world_remove_material_pair": (c_int, [c_void_p, c_char_p, c_char_p]),
    "rb_world_material_pairs": (c_int, [c_void_p, c_void_p]),
    "rb_world_step_count": (c_int64, [c_void_p]),
    "rb_world_time": (c_double, [c_void_p]),
    "rb_world_add_body": (c_int, [c_void_p, c_char_p, c_void_p]),
    "rb_world_add_bodies": (c_int, [c_void_p, c_char_p, c_void_p, c_void_p]),
    "rb_world_remove_bodies": (c_int, [c_void_p, c_void_p, c_int64]),
    "rb_world_set_collide": (c_int, [c_void_p, BodyId, BodyId, c_int32]),
    "rb_world_body_alive": (c_int32, [c_void_p, BodyId]),
    "rb_world_bodies": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_world_find_body": (c_int, [c_void_p, c_char_p, c_void_p]),
    "rb_world_body_at": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_world_body_definition": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_set_body": (c_int, [c_void_p, BodyId, c_char_p]),
    "rb_world_body_name": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_body_mass": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_body_state": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_set_body_state": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_body_states": (c_int, [c_void_p, c_void_p, c_int64, c_void_p]),
    "rb_world_set_body_states": (c_int, [c_void_p, c_void_p, c_int64, c_void_p]),
    "rb_world_set_velocity": (c_int, [c_void_p, BodyId, c_void_p, c_void_p]),
    "rb_world_body_user_data": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_set_body_user_data": (c_int, [c_void_p, BodyId, c_uint64]),
    "rb_world_joints_of": (c_int, [c_void_p, BodyId, c_void_p, c_void_p]),
    "rb_world_set_target": (c_int, [c_void_p, BodyId, c_void_p, c_void_p]),
    "rb_world_apply_force": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_apply_force_at": (c_int, [c_void_p, BodyId, c_void_p, c_void_p]),
    "rb_world_apply_torque": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_apply_impulse": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_apply_impulse_at": (c_int, [c_void_p, BodyId, c_void_p, c_void_p]),
    "rb_world_apply_angular_impulse": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_apply_forces": (c_int, [c_void_p, c_void_p, c_int64, c_void_p, c_void_p]),
    "rb_world_apply_impulses": (c_int, [c_void_p, c_void_p, c_int64, c_void_p]),
    "rb_world_add_shape": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_world_remove_shape": (c_int, [c_void_p, ShapeId]),
    "rb_world_shape_alive": (c_int32, [c_void_p, ShapeId]),
    "rb_world_shapes": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_world_shape_of": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_shape_definition": (c_int, [c_void_p, ShapeId, c_void_p]),
    "rb_world_shape_uses": (c_int, [c_void_p, ShapeId, c_void_p]),
    "rb_world_shape_user_data": (c_int, [c_void_p, BodyId, c_int32, c_void_p]),
    "rb_world_material_of": (c_int, [c_void_p, BodyId, c_int32, c_void_p]),
    "rb_world_add_body_of": (c_int, [c_void_p, ShapeId, c_char_p, c_void_p]),
    "rb_world_set_shape": (c_int, [c_void_p, BodyId, ShapeId]),
    "rb_world_array": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_world_joint_array": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_world_sensor_array": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_world_vertex_array": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_world_first_vertex": (c_int, [c_void_p, DeformableId, c_void_p]),
    "rb_world_contact_forces": (c_int, [c_void_p, c_void_p, c_int64, c_void_p]),
    "rb_world_axes": (c_int, [c_void_p, c_void_p, c_void_p, c_void_p]),
    "rb_world_scatter_joints": (c_int, [c_void_p, c_int32, c_void_p, c_void_p]),
    "rb_world_epoch": (c_int64, [c_void_p]),
    "rb_world_device": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_world_dlpack": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_world_dlpack_of": (c_int, [c_void_p, c_void_p, c_uint64, c_void_p]),
    "rb_dlpack_delete": (None, [c_void_p]),
    "rb_world_sort_bodies": (c_int, [c_void_p]),
    "rb_world_scatter": (c_int, [c_void_p, c_int32, c_void_p, c_void_p]),
    "rb_world_begin_poses": (c_int, [c_void_p]),
    "rb_world_poses_ready": (c_int32, [c_void_p]),
    "rb_world_take_poses": (c_int, [c_void_p, c_void_p]),
    "rb_world_add_joint": (c_int, [c_void_p, c_char_p, BodyId, BodyId, BodyId, BodyId, c_void_p]),
    "rb_world_add_coupling": (c_int, [c_void_p, c_char_p, JointId, JointId, c_void_p]),
    "rb_world_remove_joint": (c_int, [c_void_p, JointId]),
    "rb_world_joint_alive": (c_int32, [c_void_p, JointId]),
    "rb_world_joints": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_world_find_joint": (c_int, [c_void_p, c_char_p, c_void_p]),
    "rb_world_joint_definition": (c_int, [c_void_p, JointId, c_void_p]),
    "rb_world_joint_name": (c_int, [c_void_p, JointId, c_void_p]),
    "rb_world_joint_bodies": (c_int, [c_void_p, JointId, c_void_p]),
    "rb_world_joint_state": (c_int, [c_void_p, JointId, c_void_p]),
    "rb_world_joint_user_data": (c_int, [c_void_p, JointId, c_void_p]),
    "rb_world_set_joint_user_data": (c_int, [c_void_p, JointId, c_uint64]),
    "rb_world_set_joint": (c_int, [c_void_p, JointId, c_char_p]),
    "rb_world_set_target_position": (c_int, [c_void_p, JointId, c_int32, c_double]),
    "rb_world_set_target_speed": (c_int, [c_void_p, JointId, c_int32, c_double]),
    "rb_world_set_motor_force": (c_int, [c_void_p, JointId, c_int32, c_double]),
    "rb_world_set_limits": (c_int, [c_void_p, JointId, c_int32, c_double, c_double]),
    "rb_world_set_length": (c_int, [c_void_p, JointId, c_double]),
    "rb_world_set_drive_orientation": (c_int, [c_void_p, JointId, c_void_p]),
    "rb_world_add_drag_joint": (c_int, [c_void_p, BodyId, c_void_p, c_double, c_double, c_void_p]),
    "rb_world_set_drag_target": (c_int, [c_void_p, JointId, c_void_p]),
    "rb_world_add_deformable": (c_int, [c_void_p, c_char_p, c_void_p]),
    "rb_world_remove_deformable": (c_int, [c_void_p, DeformableId]),
    "rb_world_deformable_alive": (c_int32, [c_void_p, DeformableId]),
    "rb_world_deformables": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_world_find_deformable": (c_int, [c_void_p, c_char_p, c_void_p]),
    "rb_world_deformable_at": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_world_deformable_definition": (c_int, [c_void_p, DeformableId, c_void_p]),
    "rb_world_set_deformable": (c_int, [c_void_p, DeformableId, c_char_p]),
    "rb_world_deformable_name": (c_int, [c_void_p, DeformableId, c_void_p]),
    "rb_world_deformable_user_data": (c_int, [c_void_p, DeformableId, c_void_p]),
    "rb_world_set_deformable_user_data": (c_int, [c_void_p, DeformableId, c_uint64]),
    "rb_world_vertex_count": (c_int, [c_void_p, DeformableId, c_void_p]),
    "rb_world_vertex_positions": (c_int, [c_void_p, DeformableId, c_void_p, c_int64]),
    "rb_world_vertex_velocities": (c_int, [c_void_p, DeformableId, c_void_p, c_int64]),
    "rb_world_vertex_masses": (c_int, [c_void_p, DeformableId, c_void_p, c_int64]),
    "rb_world_set_vertices": (c_int, [c_void_p, DeformableId, c_void_p, c_void_p, c_int64]),
    "rb_world_apply_vertex_force": (c_int, [c_void_p, DeformableId, c_int32, c_void_p]),
    "rb_world_surface": (c_int, [c_void_p, DeformableId, c_void_p]),
    "rb_world_add_attachment": (c_int, [c_void_p, c_char_p, DeformableId, BodyId, DeformableId, c_void_p]),
    "rb_world_remove_attachment": (c_int, [c_void_p, AttachmentId]),
    "rb_world_attachment_alive": (c_int32, [c_void_p, AttachmentId]),
    "rb_world_attachments": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_world_attachment_state": (c_int, [c_void_p, AttachmentId, c_void_p]),
    "rb_world_attachment_ends": (c_int, [c_void_p, AttachmentId, c_void_p]),
    "rb_world_vertex_contacts": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_world_quality": (c_int, [c_void_p, c_void_p]),
    "rb_world_contacts": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_world_contacts_of": (c_int, [c_void_p, BodyId, c_void_p, c_void_p]),
    "rb_world_contact_load": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_solver_states": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_world_vertex_solver_states": (c_int, [c_void_p, DeformableId, c_void_p, c_void_p]),
    "rb_world_events": (c_int, [c_void_p, c_void_p]),
    "rb_world_asleep": (c_int, [c_void_p, BodyId, c_void_p]),
    "rb_world_wake": (c_int, [c_void_p, BodyId]),
    "rb_world_cast_rays": (c_int, [c_void_p, c_void_p, c_int64, c_void_p]),
    "rb_world_cast_shapes": (c_int, [c_void_p, c_void_p, c_int64, c_void_p]),
    "rb_world_cast_ray_arrays": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_world_overlaps": (c_int, [c_void_p, c_void_p, c_int64, c_void_p, c_void_p]),
    "rb_world_closest_points": (c_int, [c_void_p, c_void_p, c_int64, c_void_p]),
    "rb_world_cast_rays_all": (c_int, [c_void_p, c_void_p, c_int64, c_void_p, c_void_p]),
    "rb_world_cast_shapes_all": (c_int, [c_void_p, c_void_p, c_int64, c_void_p, c_void_p]),
    "rb_world_overlaps_all": (c_int, [c_void_p, c_void_p, c_int64, c_void_p, c_void_p]),
    "rb_world_memory_bytes": (c_int64, [c_void_p]),
    "rb_world_reserve": (c_int, [c_void_p, c_char_p, c_int32]),
    "rb_world_hash": (c_int, [c_void_p, c_void_p]),
    "rb_world_table_hashes": (c_int, [c_void_p, c_void_p]),
    "rb_world_snapshot": (c_int, [c_void_p, c_void_p]),
    "rb_world_restore": (c_int, [c_void_p, c_void_p]),
    "rb_snapshot_bytes": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_snapshot_from_bytes": (c_int, [c_void_p, c_int64, c_void_p]),
    "rb_snapshot_destroy": (None, [c_void_p]),
    "rb_world_first_difference": (c_int, [c_void_p, c_void_p]),
    "rb_sensors_create": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_sensors_destroy": (None, [c_void_p]),
    "rb_sensors_list": (c_int, [c_void_p, c_void_p]),
    "rb_sensors_update": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_actuators_create": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_actuators_destroy": (None, [c_void_p]),
    "rb_actuators_list": (c_int, [c_void_p, c_void_p]),
    "rb_actuators_arrays": (c_int, [c_void_p, c_void_p, c_void_p, c_void_p]),
    "rb_actuators_apply": (c_int, [c_void_p]),
    "rb_world_debug_draw": (c_int, [c_void_p, c_char_p, c_void_p]),
    "rb_worlds_create": (c_int, [c_char_p, c_void_p]),
    "rb_worlds_destroy": (None, [c_void_p]),
    "rb_worlds_add": (c_int, [c_void_p, c_void_p, c_int32, c_void_p]),
    "rb_worlds_count": (c_int32, [c_void_p]),
    "rb_worlds_world": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_worlds_step": (c_int, [c_void_p, c_int32, c_void_p, c_void_p]),
    "rb_worlds_reset": (c_int, [c_void_p, c_void_p, c_int64, c_void_p, c_int64]),
    "rb_worlds_params": (c_int, [c_void_p, c_void_p]),
    "rb_worlds_set_params": (c_int, [c_void_p, c_char_p]),
    "rb_worlds_array": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_worlds_device": (c_int, [c_void_p, c_void_p, c_void_p]),
    "rb_worlds_dlpack_of": (c_int, [c_void_p, c_void_p, c_uint64, c_void_p]),
    "rb_worlds_rows": (c_int, [c_void_p, c_int32, c_void_p, c_void_p]),
    "rb_worlds_scatter": (c_int, [c_void_p, c_int32, c_void_p, c_void_p]),
    "rb_worlds_joint_array": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_worlds_sensor_array": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_worlds_vertex_array": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_worlds_first_vertex": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_worlds_first_axis": (c_int, [c_void_p, c_int32, c_void_p]),
    "rb_worlds_scatter_joints": (c_int, [c_void_p, c_int32, c_void_p, c_void_p]),
    "rb_worlds_contact_forces": (c_int, [c_void_p, c_void_p, c_int64, c_void_p]),
    "rb_worlds_cast_rays": (c_int, [c_void_p, c_void_p, c_void_p, c_int64, c_void_p]),
    "rb_worlds_cast_ray_arrays": (c_int, [c_void_p, c_void_p, c_void_p, c_void_p]),
    "rb_actuators_create_in": (c_int, [c_void_p, c_void_p, c_int32, c_int32, c_void_p]),
    "rb_actuators_apply_in": (c_int, [c_void_p, c_void_p]),
    "rb_sensors_create_in": (c_int, [c_void_p, c_void_p, c_int32, c_int32, c_void_p]),
    "rb_sensors_update_in": (c_int, [c_void_p, c_void_p, c_void_p, c_void_p]),
    "rb_worlds_set_values": (c_int, [c_void_p, c_char_p, c_void_p, c_int64, c_void_p, c_int32]),
    "rb_worlds_values": (c_int, [c_void_p, c_char_p, c_void_p, c_int64, c_void_p, c_void_p]),
    "rb_worlds_set_seed": (c_int, [c_void_p, c_uint64, c_void_p, c_int64]),
    "rb_worlds_random_state": (c_int, [c_void_p, c_int32, c_void_p, c_void_p, c_void_p]),
    "rb_worlds_set_random_state": (c_int, [c_void_p, c_int32, c_uint64, c_int64, c_int64]),
    "rb_worlds_uniform": (c_int, [c_void_p, c_void_p, c_int64, c_int32, c_double, c_double, c_void_p]),
    "rb_worlds_memory_bytes": (c_int64, [c_void_p]),
    "rb_recorder_create": (c_int, [c_void_p, c_char_p, c_char_p, c_double, c_void_p]),
    "rb_recorder_write": (c_int, [c_void_p, c_void_p]),
    "rb_recorder_finish": (c_int, [c_void_p]),
    "rb_recorder_destroy": (None, [c_void_p]),
    "rb_recording_open": (c_int, [c_char_p, c_void_p]),
    "rb_recording_close": (None, [c_void_p]),
    "rb_recording_info": (c_int, [c_void_p, c_void_p]),
    "rb_recording_frame": (c_int, [c_void_p, c_int64, c_void_p]),
    "rb_recording_objects": (c_int, [c_void_p, c_int64, c_void_p]),
    "rb_painter_create": (c_int, [c_char_p, c_void_p]),
    "rb_painter_destroy": (None, [c_void_p]),
    "rb_painter_draw_world": (c_int, [c_void_p, c_void_p, c_void_p, c_void_p]),
    "rb_painter_draw_frame": (c_int, [c_void_p, c_void_p, c_int64, c_void_p, c_void_p]),
    "rb_write_png": (c_int, [c_char_p, c_void_p, c_int32, c_int32]),
}
