#pragma once
/// Plain structs and error codes of the C API. Units are SI. Quaternions have the scalar first and rotate
/// from body to world.
#include <stdint.h>

#if defined(_WIN32)
#define RB_API
#elif defined(RB_BUILDING_LIBRARY)
#define RB_API __attribute__((visibility("default")))
#else
#define RB_API
#endif

/// Version of this interface. It rises when a function or a struct changes; additions keep it.
#define RB_API_VERSION 3

#ifdef __cplusplus
extern "C" {
#endif

/// Result of a call. After anything but RB_OK, rb_last_error() describes the error and outputs are unchanged.
typedef enum rb_status {
  RB_OK = 0,
  RB_INVALID = 1,        ///< invalid input: path, expected value and found value are given
  RB_OUT_OF_MEMORY = 2,  ///< memory cannot be allocated
  RB_FAILED = 3          ///< any other failure
} rb_status;

/// The last error of this thread. Texts are never null and are valid until the next error of the thread.
typedef struct rb_error {
  int32_t status;        ///< rb_status
  const char* message;   ///< complete message
  const char* path;      ///< invalid field: "bodies[3].mass"; "" if there is none
  const char* expected;  ///< what the field must be, or ""
  const char* found;     ///< what it is, or ""
} rb_error;

/// Opaque objects. A null pointer may be destroyed.
typedef struct rb_scene rb_scene;
typedef struct rb_world rb_world;
typedef struct rb_worlds rb_worlds;
typedef struct rb_shape rb_shape;
typedef struct rb_snapshot rb_snapshot;
typedef struct rb_run rb_run;
typedef struct rb_recorder rb_recorder;
typedef struct rb_recording rb_recording;
typedef struct rb_painter rb_painter;
typedef struct rb_sensors rb_sensors;
typedef struct rb_actuators rb_actuators;

/// Ids: slot index and generation. Index -1: none, or the static world.
typedef struct rb_body_id {
  int32_t index;
  uint32_t generation;
} rb_body_id;
typedef struct rb_shape_id {
  int32_t index;
  uint32_t generation;
} rb_shape_id;
typedef struct rb_joint_id {
  int32_t index;
  uint32_t generation;
} rb_joint_id;
typedef struct rb_deformable_id {
  int32_t index;
  uint32_t generation;
} rb_deformable_id;
typedef struct rb_attachment_id {
  int32_t index;
  uint32_t generation;
} rb_attachment_id;

/// Arrays of body state, one row per body slot.
typedef enum rb_state_array {
  RB_POSITION = 0,          ///< center of mass, world [m]: 3 doubles
  RB_ORIENTATION = 1,       ///< principal axes -> world: 4 numbers
  RB_VELOCITY = 2,          ///< [m/s]: 3 numbers
  RB_ANGULAR_VELOCITY = 3,  ///< world axes [rad/s]: 3 numbers
  RB_FORCE = 4,             ///< at the center of mass [N]: 3 numbers; zeroed by each step
  RB_TORQUE = 5             ///< world axes [N m]: 3 numbers; zeroed by each step
} rb_state_array;

/// Arrays of joints, one row per axis of each joint, one number per row. Joints in the order of
/// rb_world_joints(). Forces act on A along the axis.
typedef enum rb_joint_array {
  RB_JOINT_POSITION = 0,         ///< [m], [rad]; angles count whole revolutions
  RB_JOINT_SPEED = 1,            ///< [m/s], [rad/s]
  RB_JOINT_DRIVE_FORCE = 2,      ///< of the last step [N], [N m]
  RB_JOINT_LIMIT_FORCE = 3,      ///< the same
  RB_JOINT_FRICTION_FORCE = 4,   ///< the same
  RB_JOINT_LOWER_LIMIT = 5,      ///< [m], [rad]; may be infinite
  RB_JOINT_UPPER_LIMIT = 6,      ///< the same
  RB_JOINT_TARGET_POSITION = 7,  ///< of the drive [m], [rad]; can be written
  RB_JOINT_TARGET_SPEED = 8,     ///< of the drive [m/s], [rad/s]; can be written
  RB_JOINT_APPLIED_FORCE = 9     ///< for the next step [N], [N m]; can be written only
} rb_joint_array;

/// What sensors measure, by body or by joint. Body axes are those of RB_ORIENTATION.
typedef enum rb_sensor_array {
  RB_SENSOR_CONTACT_FORCE = 0,  ///< by body: contacts with other bodies, world axes [N]: 3 numbers
  RB_SENSOR_TOUCH = 1,          ///< by body: sum of the normal forces [N]: 1 number
  RB_SENSOR_ACCELERATION = 2,   ///< by body: less gravity, body axes [m/s2]: 3 numbers
  RB_SENSOR_ANGULAR_RATE = 3,   ///< by body: body axes [rad/s]: 3 numbers
  RB_SENSOR_JOINT_FORCE = 4,    ///< by joint: on body B at its anchor, world axes [N]: 3 numbers
  RB_SENSOR_JOINT_TORQUE = 5    ///< by joint: on body B about its anchor, world axes [N m]: 3 numbers
} rb_sensor_array;

/// Arrays of the vertices of deformable objects, one row per vertex, 3 numbers per row. Objects are in the
/// order in which they were added.
typedef enum rb_vertex_array {
  RB_VERTEX_POSITION = 0,  ///< world [m]: doubles
  RB_VERTEX_VELOCITY = 1   ///< [m/s]
} rb_vertex_array;

/// A two-dimensional strided array. The members match the entries of __cuda_array_interface__ version 3.
typedef struct rb_array {
  const void* data;
  int64_t shape[2];     ///< rows, numbers per row
  int64_t strides[2];   ///< between rows, between numbers [bytes]
  const char* typestr;  ///< "<f4", "<f8" or "<i4"
  int32_t device;       ///< 1: GPU memory; 0: host memory
  uint64_t stream;      ///< CUDA stream on which the data is ready; 0: none
  int64_t epoch;        ///< rb_world_epoch() when the view was made
} rb_array;

typedef struct rb_pose_frame {
  int64_t step;  ///< number of steps taken
  double time;   ///< simulated time [s]
  rb_array position;
  rb_array orientation;
} rb_pose_frame;

typedef struct rb_body_state {
  double position[3];          ///< of the shape frame, world [m]
  double orientation[4];       ///< body -> world
  double velocity[3];          ///< of the center of mass [m/s]
  double angular_velocity[3];  ///< world axes [rad/s]
} rb_body_state;

typedef struct rb_mass {
  double mass;        ///< [kg]
  double inertia[3];  ///< principal moments [kg m2]
  double center[3];   ///< center of mass, in the shape frame [m]
  double axes[4];     ///< principal axes -> shape frame
} rb_mass;

/// Sum of all contacts of the last step on a body.
typedef struct rb_contact_load {
  double force[3];   ///< [N]
  double torque[3];  ///< about the center of mass [N m]
  double residual;   ///< largest remaining penetration [m]
  int32_t points;
} rb_contact_load;

/// State of a joint axis, in [m] and [N] or in [rad] and [N m].
typedef struct rb_axis_state {
  double position;
  double speed;
  double limit_force;
  double drive_force;
  double friction_force;
  double motor_force;  ///< of armature, damping and the motor
} rb_axis_state;

/// State of a joint or an attachment after the last step.
typedef struct rb_joint_state {
  double gap;        ///< linear constraint error [m]
  double angle;      ///< angular constraint error [rad]
  double force[3];   ///< on body B or on the vertices [N]
  double torque[3];  ///< on body B, about its anchor [N m]
  int32_t axis_count;
  int32_t broken;  ///< 0 or 1
  rb_axis_state axes[6];
} rb_joint_state;

typedef struct rb_attachment_ends {
  rb_deformable_id object;
  rb_deformable_id other_object;  ///< index -1: not a vertex-vertex attachment
  rb_body_id body;                ///< index -1: the world, or a vertex-vertex attachment
  double anchor[3];               ///< in the body frame, or in the world [m]
} rb_attachment_ends;

/// Geometry of a deformable object for rendering. The pointers belong to the world.
typedef struct rb_surface {
  const double* vertices;  ///< 3 numbers each [m]
  int64_t vertex_count;
  const int32_t* triangles;  ///< 3 indices each
  int64_t triangle_count;
  const int32_t* segments;  ///< 2 indices each
  int64_t segment_count;
  double radius;    ///< of the spheres or the line [m]
  int32_t spheres;  ///< 1: each vertex is rendered as a sphere
} rb_surface;

/// A contact point of the last step. The force acts on B, its opposite on A.
typedef struct rb_contact_point {
  rb_body_id a;
  rb_body_id b;
  double position[3];  ///< world [m]
  double normal[3];    ///< from A to B, unit
  double depth;        ///< > 0: penetration [m]
  double force[3];     ///< on B [N]
  int32_t part_a;      ///< of a compound: index into its parts
  int32_t part_b;
} rb_contact_point;

/// A contact of a vertex with a body or with another vertex.
typedef struct rb_vertex_contact {
  rb_deformable_id object;
  int32_t vertex;
  rb_body_id body;                ///< index -1: contact with a vertex
  rb_deformable_id other_object;  ///< index -1: contact with a body
  int32_t other_vertex;
  double normal[3];  ///< toward the vertex, or toward the other vertex
  double depth;      ///< > 0: penetration [m]
  double force[3];   ///< on the vertex, or on the other vertex [N]
} rb_vertex_contact;

typedef struct rb_contact_event {
  int32_t phase;  ///< 0: begin, 1: stay, 2: end
  rb_body_id a;
  rb_body_id b;
  uint64_t user_data_a;  ///< of the two bodies
  uint64_t user_data_b;
  uint64_t shape_user_data_a;  ///< of their shapes
  uint64_t shape_user_data_b;
  int32_t sensor;       ///< 1: one of them is a sensor
  double impulse[3];    ///< on B, over the step [N s]
  int64_t first_point;  ///< index into rb_events.points
  int64_t point_count;
} rb_contact_event;

/// A joint that broke in this step.
typedef struct rb_joint_event {
  rb_joint_id joint;
  uint64_t user_data;
  rb_body_id a;
  rb_body_id b;
  double force[3];   ///< on B [N]
  double torque[3];  ///< on B [N m]
} rb_joint_event;

typedef struct rb_sleep_event {
  rb_body_id body;
  int32_t asleep;  ///< 1: fell asleep, 0: woke
  uint64_t user_data;
} rb_sleep_event;

/// Events of the last step. The pointers belong to the world and are valid until its next step.
typedef struct rb_events {
  const rb_contact_event* contacts;
  int64_t contact_count;
  const rb_contact_point* points;
  int64_t point_count;
  const rb_joint_event* joints;
  int64_t joint_count;
  const rb_sleep_event* sleeps;
  int64_t sleep_count;
} rb_events;

/// Numbers of a step report. rb_world_report() has its lists as well.
typedef struct rb_step_report {
  int64_t step;  ///< index of the step
  int32_t bodies;
  int32_t pairs;
  int32_t manifolds;
  int32_t contacts;
  int32_t vertices;
  int32_t vertex_contacts;
  int32_t colors;
  int32_t clashes;
  int32_t broken_joints;
  int32_t sleeping_bodies;
  int32_t stopped_bodies;
  int32_t quarantined;
  int32_t failed_solves;
  int32_t restarts;
  int32_t sorted;            ///< 1: earlier array views are invalid
  double unfinished_motion;  ///< largest displacement of the last iteration, over the bounding diameter [1]
  double total_ms;           ///< wall-clock time of the step [ms]
} rb_step_report;

typedef struct rb_distribution {
  double mean;
  double p99;
  double max;
} rb_distribution;

typedef struct rb_quality {
  rb_distribution penetration;  ///< [m]
  double joint_gap_mean;        ///< [m]
  double joint_gap_max;         ///< [m]
  double kinetic_energy;        ///< [J]
  double potential_energy;      ///< relative to the origin [J]
  double max_speed;             ///< [m/s]
} rb_quality;

typedef struct rb_solver_state {
  int32_t color;      ///< -1: none
  double stiffness;   ///< largest k of its rows [N/m]
  double multiplier;  ///< largest |lambda| of these rows [N]
} rb_solver_state;

/// Selects bodies: one layer in `mask`, and one of `layers` in the mask of the body. RB_FILTER_ALL selects
/// all but sensors and deformable objects.
typedef struct rb_query_filter {
  uint32_t layers;
  uint32_t mask;
  int32_t sensors;                 ///< 1: also test sensors
  rb_body_id ignore;               ///< body to skip; index -1: none
  int32_t deformables;             ///< 1: also test deformable objects, as bodies of layer 1
  rb_deformable_id ignore_object;  ///< object to skip; index -1: none
} rb_query_filter;
/// Initializes a filter.
#define RB_FILTER_ALL                                  \
  {                                                    \
    0xffffffffu, 0xffffffffu, 0, {-1, 0}, 0, { -1, 0 } \
  }

typedef struct rb_ray {
  double origin[3];     ///< [m]
  double direction[3];  ///< any non-zero length
  double max_distance;  ///< [m]
  rb_query_filter filter;
} rb_ray;

/// Rays as arrays, all in host memory or all in that of the device of the world.
typedef struct rb_ray_arrays {
  rb_array origins;        ///< [m]: (n, 3), "<f4" or "<f8"
  rb_array directions;     ///< any non-zero length: the same
  double max_distance;     ///< [m]
  rb_query_filter filter;  ///< of all rays, without deformable objects
} rb_ray_arrays;

/// First hits of these rays, in the memory that the rays are in.
typedef struct rb_ray_hit_arrays {
  rb_array distances;  ///< [m]: (n, 1), "<f4"; without a hit `max_distance`
  rb_array bodies;     ///< index of the body: (n, 1), "<i4"; -1: no hit
  rb_array normals;    ///< outward from the body: (n, 3), "<f4"; zeros: no hit
} rb_ray_hit_arrays;

typedef struct rb_cast {
  const rb_shape* shape;   ///< convex or compound
  double position[3];      ///< [m]
  double orientation[4];   ///< shape -> world
  double displacement[3];  ///< [m]
  rb_query_filter filter;
} rb_cast;

typedef struct rb_overlap {
  const rb_shape* shape;  ///< convex or compound
  double position[3];     ///< [m]
  double orientation[4];  ///< shape -> world
  rb_query_filter filter;
} rb_overlap;

typedef struct rb_closest {
  double point[3];      ///< [m]
  double max_distance;  ///< [m]
  rb_query_filter filter;
} rb_closest;

/// What a query found.
typedef struct rb_hit {
  int32_t hit;               ///< 0: nothing; the other members are then without meaning
  rb_body_id body;           ///< index -1: a deformable object
  rb_deformable_id object;   ///< index -1: a body
  int32_t part;              ///< of a compound: index into its parts
  int32_t triangle;          ///< of a mesh, height field or deformable object: its index; otherwise -1
  double distance;           ///< [m]; of a cast: fraction of the displacement; of an overlap: 0
  double position[3];        ///< not of an overlap [m]
  double normal[3];          ///< outward from what is hit; not of an overlap or a closest point
  uint64_t user_data;        ///< of the body or object
  uint64_t shape_user_data;  ///< of the shape of the body, or of the part of a compound
} rb_hit;

/// Primitives of a debug drawing, in world coordinates [m]. Colors are 0xRRGGBB.
typedef struct rb_debug_line {
  double from[3];
  double to[3];
  uint32_t color;
} rb_debug_line;
typedef struct rb_debug_triangle {
  double corners[9];  ///< x, y, z of each corner, counter-clockwise seen from outside
  uint32_t color;
} rb_debug_triangle;
typedef struct rb_debug_text {
  double position[3];
  const char* text;
  uint32_t color;
} rb_debug_text;
/// The pointers belong to the world and are valid until its next debug drawing.
typedef struct rb_debug_draw {
  const rb_debug_line* lines;
  int64_t line_count;
  const rb_debug_triangle* triangles;
  int64_t triangle_count;
  const rb_debug_text* texts;
  int64_t text_count;
} rb_debug_draw;

typedef struct rb_pose {
  double position[3];     ///< world [m]
  double orientation[4];  ///< body -> world
} rb_pose;

/// A frame of a recording. The pointers belong to the recording and are valid until the next frame is read.
typedef struct rb_frame {
  int64_t step;  ///< steps taken before this frame
  double time;   ///< [s]
  const rb_pose* poses;
  int64_t pose_count;
  const double* vertices;  ///< of all deformable objects, 3 numbers each [m]
  int64_t vertex_count;
} rb_frame;

typedef struct rb_camera {
  double eye[3];         ///< [m]
  double target[3];      ///< [m]
  double field_of_view;  ///< full vertical angle [rad]
} rb_camera;

/// A picture: rows from the top, three bytes (red, green, blue; sRGB) per pixel, without padding. The pixels
/// belong to the painter and are valid until its next picture.
typedef struct rb_image {
  int32_t width;
  int32_t height;
  const uint8_t* rgb;
} rb_image;

#ifdef __cplusplus
}
#endif
