// C interface of lin-canny: distances, contacts, rays, scenes and checkers of robots, with proven bounds.
//
// Generated from the sources of crates/capi: do not edit. README.md there shows how to build and link.
//
// Rules
// * A handle is a number; zero is none. Free it once. A stale, foreign or invented handle is LC_HANDLE.
// * Functions return a status, except those that cannot fail. After an error, lc_last_error is its message, and no
//   answer is written, except where the function says so.
// * Arrays are read during the call and never kept. Answers are written to memory of the caller.
// * A size or a stride is the sizeof of the struct that the caller knows. A later version may add fields at the end.
//   Bytes of an answer beyond the fields that this version knows are set to zero.
//   A struct of options may be null; a field that is zero has its default.
// * Every function may be called in any thread. Geometries are shared freely. A pair, a scene or a checker serves one
//   call at a time: a second one returns LC_BUSY at once, and so does a callback that uses the object of its call.
// * A function that returns a text says who frees it.
//
// Undefined, because C cannot check it: a pointer that is not null, aligned and wrong; a count larger than the array;
// memory that another thread or a callback writes during the call; an answer that overlaps an array or another answer
// of the call, except where the function says so; a callback that does not return, because of an exception, a longjmp
// or the end of its thread; a text without end.


#ifndef LIN_CANNY_H
#define LIN_CANNY_H

#include <stddef.h>
#include <stdint.h>

// The version of the interface. It grows by one with every change that breaks compiled callers.
#define LC_ABI 0

// The whole motion is proven free.
#define LC_FREE 0

// A pair is proven in contact, or closer than its required distance.
#define LC_BLOCKED 1

// A pair is within rounding error of contact or of its required distance.
#define LC_OPEN 2

// RRT-Connect (Kuffner and LaValle 2000).
#define LC_PLAN_RRT_CONNECT 0

// The opportunistic planner (Canny and Lin 1993).
#define LC_PLAN_OPPORTUNISTIC 1

// A box about the origin: half extents along x, y and z.
#define LC_BOX 1

// A ball about the origin: radius.
#define LC_BALL 2

// A capsule along z: half the length of its segment, radius.
#define LC_CAPSULE 3

// A cylinder along z: half height, radius.
#define LC_CYLINDER 4

// A cone along z with its apex at half the height: half height, radius.
#define LC_CONE 5

// An ellipsoid: semi-axes along x, y and z.
#define LC_ELLIPSOID 6

// The half-space of all points p with n . p <= offset: n (of any length), offset.
#define LC_HALF_SPACE 8

// A point: x, y, z.
#define LC_POINT 9

// A segment: x, y, z of both ends.
#define LC_SEGMENT 10

// A geometry is a convex polyhedron or polygon.
#define LC_KIND_POLYHEDRON 1

// A geometry is a point or a segment.
#define LC_KIND_WIRE 2

// A geometry is a rounded polyhedron: ball, capsule, rounded box or hull.
#define LC_KIND_ROUNDED 3

// A geometry is a cylinder, cone or ellipsoid, rounded or not.
#define LC_KIND_CURVED 4

// A geometry consists of convex pieces.
#define LC_KIND_COMPOUND 5

// A geometry is a mesh of triangles.
#define LC_KIND_MESH 6

// A geometry is one convex element at many points.
#define LC_KIND_CLOUD 7

// A geometry is a surface of Bézier patches.
#define LC_KIND_SURFACE 8

// A geometry is a half-space.
#define LC_KIND_HALF_SPACE 9

// Asks for contact state, distance and bounds.
#define LC_DISTANCE 1

// Asks for witness points and normal.
#define LC_POINTS 2

// Asks for features and subshapes.
#define LC_FEATURES 4

// Asks for points and normal in the frames of the bodies: `point_on_a` and `normal` in that of A,
// `point_on_b` in that of B. Without it they are in the world.
#define LC_BODY_FRAMES 8

// Asks for no depth: overlapping convex geometries have the distance zero and no lower bound.
#define LC_NO_DEPTH 16

// Asks for an upper bound of the depth of two overlapping polyhedra, in a fraction of the time of
// the depth.
#define LC_LOCAL_DEPTH 32

// Accepts a contact at the start that a cast proves not to come closer: see
// `start_contact_margin`.
#define LC_ACCEPT_START 1

// Nothing is met, proven for the whole interval or length.
#define LC_MISS 0

// The first contact is after `safe`, and at the latest at `hit`.
#define LC_HIT 1

// The geometries are in contact at the start, or the origin of the ray is inside.
#define LC_AT_START 2

// Rounding hides whether there is a contact; nothing is known beyond `safe`.
#define LC_UNCLEAR 4

// A limit ended the cast; nothing is known beyond `safe`.
#define LC_INCOMPLETE 5

// Bodies are proven apart.
#define LC_SEPARATED 0

// Bodies touch, or the bounds do not decide and no finer arithmetic exists.
#define LC_TOUCHING 1

// Bodies are proven to share an inner point.
#define LC_OVERLAPPING 2

// The bounds do not decide.
#define LC_UNDECIDED 3

// Checks the pairs of adjacent links as well.
#define LC_CHECK_ADJACENT 1

// Skips bodies whose mesh file does not exist; nothing is checked against them.
#define LC_SKIP_MISSING_MESHES 2

// Uses mesh files as they are, and not their hulls.
#define LC_MESHES_AS_GIVEN 4

// Events of the boxes of bodies.
#define LC_QUERY_BOXES 1

// Whether bodies share a point, and events of that.
#define LC_QUERY_OVERLAP 2

// Whether bodies are at most `within` apart, and events of that.
#define LC_QUERY_WITHIN 4

// The signed distance of bodies at most `distance` apart.
#define LC_QUERY_DISTANCE 8

// Witness points, normal and features of the pairs that have a distance.
#define LC_QUERY_FEATURES 16

// The depth of overlaps of convex bodies.
#define LC_QUERY_DEPTH 32

// First contacts between two steps of bodies that `lc_scene_advance` moves, in a bracket of the
// width `impact`.
#define LC_QUERY_IMPACT 64

// The first times between two steps at which bodies come within the distance `impact_within`, in a
// bracket of the width `impact`.
#define LC_QUERY_IMPACT_WITHIN 128

// Pairs of two fixed bodies as well, for instance the parts of an assembly. Without it such pairs
// are left out.
#define LC_QUERY_FIXED 256

// The boxes of two bodies started to overlap.
#define LC_BOXES_MET 1

// Two bodies started to share a point.
#define LC_OVERLAP_BEGAN 2

// Two bodies came within the distance of the query.
#define LC_CAME_WITHIN 3

// Two bodies left the distance of the query.
#define LC_LEFT_WITHIN 4

// Two bodies stopped sharing a point.
#define LC_OVERLAP_ENDED 5

// The boxes of two bodies stopped overlapping.
#define LC_BOXES_PARTED 6

// The query is not enabled, or was not answered yet: nothing is known. It is not zero, as zero is a
// proof that the answer is no.
#define LC_NOT_ASKED 2

// What a call returns.
enum lc_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The call has written its answer.
  LC_OK = 0,
  // A pointer is null or misaligned, or a size, a count or a text is invalid.
  LC_ARGUMENT = 1,
  // A handle is zero, of another kind, of another copy of the library, or of a freed object.
  LC_HANDLE = 2,
  // Another call is using the object: a call of another thread, or the call that runs this
  // callback.
  LC_BUSY = 3,
  // The library refuses the input; the message says why.
  LC_REFUSED = 4,
  // The library has a defect; the message is that of the panic. A pair goes on without its
  // cached state; a scene and a checker refuse all later calls.
  LC_PANIC = 5,
  // There is no room for more handles of this kind.
  LC_FULL = 6,
  // A callback stopped the call.
  LC_STOPPED = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum lc_status lc_status;
#else
typedef int32_t lc_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A geometry. It never changes, and threads, pairs, scenes and checkers may share it.
typedef struct lc_geometry {
  // The handle; zero is none.
  uint64_t id;
} lc_geometry;

// A checker of a robot, or of one rigid body, among obstacles.
//
// One call at a time: a call during another one returns `LC_BUSY`. Any thread; `lc_checker_copy`
// makes one for another thread.
typedef struct lc_checker {
  // The handle; zero is none.
  uint64_t id;
} lc_checker;

// The sizes of a checker.
typedef struct lc_checker_info {
  // The numbers of a configuration.
  size_t coordinates;
  // The numbers of a gradient. It is one less than `coordinates` for a body that turns.
  size_t degrees_of_freedom;
  // The bodies of the robot.
  size_t robot_bodies;
  // The distance that pairs without a margin of their own must keep.
  double margin;
} lc_checker_info;

// A body of a checker: a robot body, an object that the robot carries, or an obstacle.
//
// It is valid in its checker, and in copies made later, until the body is removed. It is never
// used again.
typedef struct lc_world_body {
  // The id; zero is none.
  uint64_t id;
} lc_world_body;

// A pose: a translation, then a unit quaternion x, y, z, w.
//
// The squared norm of the quaternion must be within 1e-12 of 1.
typedef struct lc_pose {
  // The translation.
  double translation[3];
  // The unit quaternion x, y, z, w.
  double rotation[4];
} lc_pose;

// The signed distance of a pair of bodies, with points in the world.
typedef struct lc_near {
  // The first body; zero if there is no pair: then the distances are infinite and all else is
  // zero.
  struct lc_world_body a;
  // The second body.
  struct lc_world_body b;
  // The signed distance: negative for an overlap, zero for an overlap of unknown depth.
  double distance;
  // Proven lower bound of the signed distance.
  double lower;
  // Proven upper bound of the signed distance.
  double upper;
  // The signed distance less the required distance of the pair.
  double excess;
  // The witness on the first body.
  double point_on_a[3];
  // The witness on the second body.
  double point_on_b[3];
  // The unit vector from the first body to the second; zero for an overlap of unknown depth.
  double normal[3];
} lc_near;

// The verdict about a motion. Times are from 0 to 1 along the segment or curve.
typedef struct lc_verdict {
  // `LC_FREE`, `LC_BLOCKED` or `LC_OPEN`.
  uint32_t state;
  // The number of contacts at the start that were accepted: these pairs are proven apart only after
  // they have left the contact.
  uint32_t start_contacts;
  // The segment of a path to which the verdict belongs.
  uint64_t segment;
  // All pairs are proven apart up to this time.
  double free_until;
  // The pair is proven in contact at this time, if blocked; else infinite.
  double contact_at;
  // The distance that all pairs are proven to keep, if free; else zero.
  double clearance;
  // The first body of the pair, if blocked; else zero.
  struct lc_world_body a;
  // The second body of the pair.
  struct lc_world_body b;
  // The closest point of the first body, if blocked, in the world.
  double point_on_a[3];
  // The closest point of the second body.
  double point_on_b[3];
} lc_verdict;

// Options of a search for a path; all zero is the default.
typedef struct lc_plan_options {
  // The random seed; the same seed gives the same path.
  uint64_t seed;
  // The largest number of random slices of the opportunistic planner; zero is 10,000.
  uint64_t slices;
  // The largest number of pair queries; zero is 1,000,000.
  uint64_t queries;
  // The number of random shortcuts that are tried. Configurations without which the path is
  // proven free and not longer are removed in any case.
  uint64_t shorten;
  // The largest number of samples of RRT-Connect; zero is 100,000.
  uint64_t samples;
  // `LC_PLAN_RRT_CONNECT` or `LC_PLAN_OPPORTUNISTIC`.
  uint32_t method;
  // Zero.
  uint32_t reserved;
} lc_plan_options;

// Reports how far a long call is; `total` is zero if it is unknown.
//
// The library calls it on the thread of the call, with the floating-point mode of the library,
// which is set again afterwards. `stage` ends with a zero and is valid until the callback returns.
// A value other than zero stops the call with `LC_STOPPED`. The callback must return: an
// exception, a `longjmp` or the end of its thread is undefined. It may call the library, with
// other objects than those of the running call, but must not write to arrays of that call.
typedef int32_t (*lc_progress)(void *context, const char *stage, uint64_t done, uint64_t total);

// Counts of the work of a checker since it was made.
typedef struct lc_check_work {
  // Segments checked.
  uint64_t segments;
  // Segments proven free.
  uint64_t free;
  // Distance queries on segments.
  uint64_t queries;
  // Single configurations checked.
  uint64_t configurations;
  // Distance queries at single configurations.
  uint64_t measures;
  // Margin predicates at single configurations.
  uint64_t decisions;
} lc_check_work;

// What a repair of a mesh has changed.
typedef struct lc_mesh_repair {
  // Number of points that moved to another one within the tolerance.
  uint64_t welded;
  // Number of triangles that were inverted.
  uint64_t turned;
  // Number of holes that were closed. Their triangles count on from those given.
  uint64_t caps;
  // Number of points of the longest loop around a hole.
  uint64_t longest_loop;
  // Area of the triangles that close holes, as a share of the area of the mesh, from 0 to 1.
  double cap_share;
  // 1 if the triangles cancel in pairs, so that nothing is inside.
  uint32_t is_empty;
} lc_mesh_repair;

// What a geometry is.
typedef struct lc_geometry_info {
  // One of `LC_KIND_POLYHEDRON` and so on; zero is another kind.
  uint32_t kind;
  // 0 for open meshes and surfaces, which have no inside; 1 for all others.
  uint32_t is_solid;
  // The centre of a ball that contains the geometry, in its frame.
  double center[3];
  // The radius of the ball.
  double radius;
} lc_geometry_info;

// A pair of two geometries and its tracker, which caches the state of the last query.
//
// One call at a time: a call during another one returns `LC_BUSY`. Any thread.
typedef struct lc_pair {
  // The handle; zero is none.
  uint64_t id;
} lc_pair;

// The closest points of two geometries, with bounds of the signed distance.
typedef struct lc_answer {
  // The groups of fields that are set: a mask of `LC_DISTANCE`, `LC_POINTS`, `LC_FEATURES`. The
  // other fields are zero. Without `LC_DISTANCE` the state is `LC_UNDECIDED`, and the bounds are
  // infinite.
  uint32_t answered;
  // `LC_SEPARATED`, `LC_TOUCHING`, `LC_OVERLAPPING` or `LC_UNDECIDED`.
  uint32_t state;
  // The signed distance; minus the penetration depth if convex geometries overlap, zero if
  // others do.
  double distance;
  // Proven lower bound of the signed distance; minus infinity if nothing is known.
  double lower;
  // Proven upper bound of the signed distance.
  double upper;
  // The witness on A.
  double point_on_a[3];
  // The witness on B.
  double point_on_b[3];
  // The unit normal from A to B.
  double normal[3];
  // The feature of A: dimension (0 vertex, 1 edge, 2 face) and index.
  uint32_t feature_a[2];
  // The feature of B.
  uint32_t feature_b[2];
  // The piece, triangle, patch or point of A and of B; zero for a convex geometry.
  uint32_t subshapes[2];
} lc_answer;

// A contact point of two geometries, in the world.
typedef struct lc_contact {
  // The point on A.
  double point_on_a[3];
  // The point on B.
  double point_on_b[3];
  // The unit normal from A to B.
  double normal[3];
  // The signed distance along the normal; negative in an overlap.
  double separation;
  // The group of contacts with nearly the same normal; 0 is the deepest.
  uint32_t group;
  // The convex patch or piece of A and of B.
  uint32_t patches[2];
  // Zero.
  uint32_t reserved;
  // The features of A and of B at which the contact first appeared, which name it while it
  // lasts: dimension and index of each.
  uint32_t name[4];
} lc_contact;

// Bounds of the penetration depth of two solids, in the world.
typedef struct lc_penetration {
  // No shorter translation separates the solids.
  double lower;
  // The length of `shift`.
  double upper;
  // A translation of B that separates the solids.
  double shift[3];
} lc_penetration;

// The volume that two solids share, with its centre of mass in the world.
typedef struct lc_overlap_volume {
  // Lower bound; it may be negative by rounding.
  double lower;
  // Upper bound.
  double upper;
  // The centre of mass of the common part; NaN unless the volume is certainly positive.
  double centroid[3];
  // Bound of the error of each coordinate of the centroid; 0 without a centroid.
  double centroid_error;
  // 1 if a solid was found to cover points twice or to face inward: each point counts by both
  // winding numbers then.
  uint32_t covers_itself;
  // Zero.
  uint32_t reserved;
} lc_overlap_volume;

// A body at a constant velocity, from time zero.
typedef struct lc_motion {
  // The pose at time zero.
  struct lc_pose pose;
  // The velocity of the origin of the body in the world, in lengths per time.
  double linear[3];
  // The angular velocity in the world, in radians per time.
  double angular[3];
} lc_motion;

// Options of a cast; all zero is the default, except the duration.
typedef struct lc_cast_options {
  // The cast covers the times from 0 to this.
  double duration;
  // The geometries are closer than this at the end of the free interval; zero is as narrow as
  // rounding allows.
  double tolerance;
  // The distance that the geometries must keep.
  double distance;
  // With `LC_ACCEPT_START`: the largest distance, or depth, of a contact at the start that is
  // accepted.
  double start_contact_margin;
  // A mask of `LC_ACCEPT_START`.
  uint32_t flags;
  // Zero.
  uint32_t reserved;
} lc_cast_options;

// The first contact of two moving geometries. Points and normal are in the world, at the time
// `safe`.
typedef struct lc_cast {
  // `LC_MISS`, `LC_HIT`, `LC_AT_START`, `LC_UNCLEAR` or `LC_INCOMPLETE`.
  uint32_t state;
  // The number of distance queries.
  uint32_t queries;
  // The geometries are proven apart up to this time.
  double safe;
  // The geometries are proven in contact at this time; infinite without a proof.
  double hit;
  // The witness on A; zero without a contact.
  double point_on_a[3];
  // The witness on B; zero without a contact.
  double point_on_b[3];
  // The unit normal from A to B; zero without a contact.
  double normal[3];
  // 1 if a contact at the start was accepted; the three fields below are its own.
  uint32_t start_accepted;
  // Zero.
  uint32_t reserved;
  // Lower bound of the signed distance at the start.
  double start_distance;
  // The signed distance that is proven to be kept.
  double start_kept;
  // The time at which the geometries have left the margin; infinite if they slide to the end.
  double start_until;
} lc_cast;

// A ray in the world; its direction may have any length except zero.
typedef struct lc_ray {
  // The origin.
  double origin[3];
  // The direction.
  double direction[3];
  // The length, which may be infinite.
  double length;
} lc_ray;

// Where a ray enters a geometry, in the world.
typedef struct lc_ray_hit {
  // `LC_MISS`, `LC_HIT`, `LC_AT_START` or `LC_UNCLEAR`.
  uint32_t state;
  // The triangle or piece; zero for a geometry of one piece.
  uint32_t subshape;
  // The body of a scene; zero for a ray against one geometry.
  uint64_t body;
  // All points of the ray up to this distance are outside; infinite for a miss.
  double safe;
  // A point up to this distance is inside; infinite without a proof.
  double hit;
  // The point; zero without a hit.
  double point[3];
  // The outward unit normal; zero without a hit.
  double normal[3];
} lc_ray_hit;

// The files of a robot and its cell; what is null or zero is left out.
typedef struct lc_robot_files {
  // The robot: URDF, MJCF or SDFormat.
  const char *robot;
  // Pairs of links that are not checked: SRDF.
  const char *srdf;
  // The obstacles: JSON or SDFormat.
  const char *cell;
  // Folders of `package://` paths, searched before those of `ROS_PACKAGE_PATH`.
  const char *const *packages;
  // The number of folders.
  size_t package_count;
  // A mask of `LC_CHECK_ADJACENT` and so on.
  uint32_t flags;
  // Zero.
  uint32_t reserved;
} lc_robot_files;

// A scene: bodies of which a step finds the close pairs and runs the enabled queries.
//
// One call at a time: a call during another one returns `LC_BUSY`. Any thread.
typedef struct lc_scene {
  // The handle; zero is none.
  uint64_t id;
} lc_scene;

// The queries of the pairs of two groups; all zero is none.
typedef struct lc_queries {
  // A mask of `LC_QUERY_BOXES` and so on.
  uint32_t flags;
  // Zero.
  uint32_t reserved;
  // The distance of `LC_QUERY_WITHIN`.
  double within;
  // The range of `LC_QUERY_DISTANCE`; may be infinite.
  double distance;
  // The width of the brackets of `LC_QUERY_IMPACT` and `LC_QUERY_IMPACT_WITHIN`, as a distance:
  // at the end of the free interval the bodies are at most this far from contact, or from the
  // distance.
  double impact;
  // The distance of `LC_QUERY_IMPACT_WITHIN`.
  double impact_within;
} lc_queries;

// A body of a scene; valid in its scene until it is removed.
typedef struct lc_body {
  // The id; zero is none.
  uint64_t id;
} lc_body;

// A change of a pair in the last step.
typedef struct lc_event {
  // The body with the lower index.
  struct lc_body a;
  // The body with the higher index.
  struct lc_body b;
  // `LC_BOXES_MET` and so on; zero is another change.
  uint32_t change;
  // Zero.
  uint32_t reserved;
} lc_event;

// The first contact of two bodies in the time of the last `lc_scene_advance`, or the first time
// within a distance.
typedef struct lc_impact {
  // The body with the lower index.
  struct lc_body a;
  // The body with the higher index.
  struct lc_body b;
  // `LC_HIT`, `LC_UNCLEAR` or `LC_INCOMPLETE`.
  uint32_t state;
  // Zero.
  uint32_t reserved;
  // The bodies are proven apart up to this time, or farther apart than `distance`.
  double safe;
  // The bodies are proven in contact at this time, or within `distance`; infinite without a proof.
  double hit;
  // The distance of `LC_QUERY_IMPACT_WITHIN`; zero for a contact.
  double distance;
} lc_impact;

// Two bodies of a scene and the answers about them. Points and normal are in the world.
typedef struct lc_scene_pair {
  // The first body: operand A of the answer; zero if there is no pair.
  struct lc_body a;
  // The second body.
  struct lc_body b;
  // Whether the bodies share a point: 0 no, 1 yes, `LC_NOT_ASKED`.
  uint32_t overlaps;
  // Whether the bodies are within the distance of the query: 0 no, 1 yes, `LC_NOT_ASKED`.
  uint32_t within;
  // The distance, and points if the query enables features: see `answered`.
  struct lc_answer answer;
} lc_scene_pair;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Returns the version of the interface of the loaded library; compare it with `LC_ABI`.
uint32_t lc_abi(void);

// Returns the version of the library, such as "0.1.0".
const char *lc_version(void);

// Returns the message of the last error of this thread, or an empty text.
//
// The text is valid until the next error of this thread. It must not be freed.
const char *lc_last_error(void);

// Frees a text that a function of this library returned; null is no error.
//
// Contract: `text` is null, or is from this library and not freed, and its length is unchanged. No check is
// possible.
void lc_text_free(char *text);

// Returns the number of live objects of all kinds, for tests that look for leaks.
uint64_t lc_live(void);

// Makes the checker of one body that moves in a box of space: least and greatest x, then y, then
// z.
//
// With `radius` zero the body does not turn: a configuration is x, y, z. With a positive radius it
// turns: a configuration is x, y, z and a unit quaternion x, y, z, w, and a radian counts as the
// length `radius`.
//
// Contract: `bounds` points to six numbers, `out` to a handle.
lc_status lc_checker_new_body(struct lc_geometry body, const double *bounds, double radius, struct lc_checker *out);

// Makes another checker of the same robot and world, with new state: one for each thread.
//
// Contract: `out` points to a handle.
lc_status lc_checker_copy(struct lc_checker checker, struct lc_checker *out);

// Frees a checker; zero is no error. `LC_BUSY` during a call with it: then nothing is freed.
lc_status lc_checker_free(struct lc_checker checker);

// Writes the sizes of a checker; `out_size` is `sizeof(lc_checker_info)`.
//
// Contract: `out` points to `out_size` bytes.
lc_status lc_checker_get_info(struct lc_checker checker, struct lc_checker_info *out, size_t out_size);

// Writes least and greatest value of each coordinate of position: those of a turn are not limited
// and left out.
//
// Contract: `low` and `high` point to `capacity` numbers, `count` to a number.
lc_status lc_checker_limits(struct lc_checker checker, double *low, double *high, size_t capacity, size_t *count);

// Writes the name of a coordinate; `lc_text_free` frees it.
//
// Contract: `out` points to a pointer.
lc_status lc_checker_coordinate_name(struct lc_checker checker, size_t index, char **out);

// Writes the name of a body; `lc_text_free` frees it.
//
// Contract: `out` points to a pointer.
lc_status lc_checker_body_name(struct lc_checker checker, struct lc_world_body body, char **out);

// Writes the bodies of a name. A wrong name is `LC_REFUSED`, and the message states the nearest
// name.
//
// `count` is their number; if it exceeds `capacity`, the first are written.
//
// Contract: `name` points to a text that ends with a zero, `out` to `capacity` ids, `count` to a number.
lc_status lc_checker_find(struct lc_checker checker,
                          const char *name,
                          struct lc_world_body *out,
                          size_t capacity,
                          size_t *count);

// Adds an obstacle at a pose in the world.
//
// Contract: `name` points to a text that ends with a zero, `pose` to a pose, `out` to an id.
lc_status lc_checker_obstacle_add(struct lc_checker checker,
                                  const char *name,
                                  struct lc_geometry geometry,
                                  const struct lc_pose *pose,
                                  struct lc_world_body *out);

// Moves an obstacle to a pose in the world.
//
// Contract: `pose` points to a pose.
lc_status lc_checker_obstacle_move(struct lc_checker checker,
                                   struct lc_world_body obstacle,
                                   const struct lc_pose *pose);

// Removes an obstacle, or an object that a link carries.
lc_status lc_checker_remove(struct lc_checker checker, struct lc_world_body body);

// Attaches an object to a link of the robot at a pose in the frame of the link.
//
// `touch_links` are names of links whose pairs with the object are not checked; the link itself is
// one of them only if it is named.
//
// Contract: `link` and `name` point to texts that end with a zero, `touch_links` to `touch_count` of them,
// `pose` to a pose, `out` to an id.
lc_status lc_checker_attach(struct lc_checker checker,
                            const char *link,
                            const char *name,
                            struct lc_geometry geometry,
                            const struct lc_pose *pose,
                            const char *const *touch_links,
                            size_t touch_count,
                            struct lc_world_body *out);

// Excludes the pair of two bodies, or includes it again if `excluded` is zero.
lc_status lc_checker_exclude(struct lc_checker checker,
                             struct lc_world_body a,
                             struct lc_world_body b,
                             uint32_t excluded);

// Sets the distance that pairs without a margin of their own must keep.
lc_status lc_checker_set_margin(struct lc_checker checker, double margin);

// Sets the distance that the pair of two bodies must keep; a negative one removes it.
lc_status lc_checker_set_pair_margin(struct lc_checker checker,
                                     struct lc_world_body a,
                                     struct lc_world_body b,
                                     double margin);

// Accepts a contact at the start of a motion of at most this distance or depth; a negative one
// accepts none.
//
// The contact is accepted if the pair is proven not to come closer until it has left the margin.
lc_status lc_checker_set_start_contact(struct lc_checker checker, double margin);

// Writes the pose of a body in the world at a configuration.
//
// Contract: `q` points to `coordinates` numbers, `out` to a pose.
lc_status lc_checker_pose(struct lc_checker checker,
                          struct lc_world_body body,
                          const double *q,
                          size_t coordinates,
                          struct lc_pose *out);

// Writes whether each of `count` configurations keeps the margins: 1 if it is proven, else 0.
//
// The call ends at the first configuration that is refused; `done` is the number of answers.
//
// Contract: `q` points to `count * coordinates` numbers, `out` to `count` bytes, `done` to a number.
lc_status lc_checker_free_at_many(struct lc_checker checker,
                                  const double *q,
                                  size_t coordinates,
                                  size_t count,
                                  uint8_t *out,
                                  size_t *done);

// Writes the pair of least signed distance at each of `count` configurations.
//
// `gradients` may be null; else it gets the derivatives of each distance by the degrees of
// freedom. The call ends at the first configuration that is refused; `done` is the number of
// answers.
//
// Contract: `q` points to `count * coordinates` numbers, `out` to `count` elements of `out_stride` bytes,
// `gradients` is null or points to `count * degrees_of_freedom` numbers, `done` to a number.
lc_status lc_checker_clearance_many(struct lc_checker checker,
                                    const double *q,
                                    size_t coordinates,
                                    size_t count,
                                    struct lc_near *out,
                                    size_t out_stride,
                                    double *gradients,
                                    size_t *done);

// Writes the `columns` closest pairs at each of `count` configurations, the closest first.
//
// Pairs whose distance exceeds the least of a row by more than `slack`, which may be infinite, are
// left out: entries without a pair have `a.id` zero. Each row has the bits of a new checker's, for
// any number of threads, at most 256. `gradients` may be null.
//
// Contract: `q` points to `count * coordinates` numbers, `out` to `count * columns` elements of `out_stride`
// bytes, `gradients` is null or points to `count * columns * degrees_of_freedom` numbers.
lc_status lc_checker_nearest_many(struct lc_checker checker,
                                  const double *q,
                                  size_t coordinates,
                                  size_t count,
                                  size_t columns,
                                  double slack,
                                  size_t threads,
                                  struct lc_near *out,
                                  size_t out_stride,
                                  double *gradients);

// Writes the verdicts about `count` straight segments, each over its whole length.
//
// The call ends at the first segment that is refused; `done` is the number of verdicts.
//
// Contract: `from` and `to` point to `count * coordinates` numbers, `out` to `count` elements of
// `out_stride` bytes, `done` to a number.
lc_status lc_checker_certify_many(struct lc_checker checker,
                                  const double *from,
                                  const double *to,
                                  size_t coordinates,
                                  size_t count,
                                  struct lc_verdict *out,
                                  size_t out_stride,
                                  size_t *done);

// Writes the verdict about a path of `count` configurations: free, or the verdict about its first
// segment that is not.
//
// `out_size` is `sizeof(lc_verdict)`.
//
// Contract: `q` points to `count * coordinates` numbers, `out` to `out_size` bytes.
lc_status lc_checker_certify_path(struct lc_checker checker,
                                  const double *q,
                                  size_t coordinates,
                                  size_t count,
                                  struct lc_verdict *out,
                                  size_t out_size);

// Writes the verdict about a polynomial curve, given by its `count` Bézier control points.
//
// `out_size` is `sizeof(lc_verdict)`. `LC_REFUSED` if the space has no curves: a body that turns.
//
// Contract: `points` points to `count * coordinates` numbers, `out` to `out_size` bytes.
lc_status lc_checker_certify_curve(struct lc_checker checker,
                                   const double *points,
                                   size_t coordinates,
                                   size_t count,
                                   struct lc_verdict *out,
                                   size_t out_size);

// Searches for a path between two configurations, of segments that are proven free.
//
// `count` is the number of configurations of the path, which `lc_checker_path` copies. Zero means
// that a limit ended the search, which proves nothing. `progress` may be null; its stage is
// "queries", then "shortcuts". If it stops the call in the second, `lc_checker_path` copies the path so
// far. `options_size` is `sizeof(lc_plan_options)`.
//
// Contract: `start` and `goal` point to `coordinates` numbers, `options` is null or points to `options_size`
// bytes, `count` to a number; `progress` may be called with `context`.
lc_status lc_checker_plan(struct lc_checker checker,
                          const double *start,
                          const double *goal,
                          size_t coordinates,
                          const struct lc_plan_options *options,
                          size_t options_size,
                          lc_progress progress,
                          void *context,
                          size_t *count);

// Copies the path of the last `lc_checker_plan`, one configuration after another.
//
// `count` is the number of its configurations; if it exceeds `capacity`, the first are written.
//
// Contract: `q` points to `capacity * coordinates` numbers, `count` to a number.
lc_status lc_checker_path(struct lc_checker checker, double *q, size_t coordinates, size_t capacity, size_t *count);

// Writes counts of the work of a checker since it was made; `out_size` is `sizeof(lc_check_work)`.
//
// Contract: `out` points to `out_size` bytes.
lc_status lc_checker_get_work(struct lc_checker checker, struct lc_check_work *out, size_t out_size);

// Makes the convex hull of `count` points, three numbers each.
//
// `progress` may be null. Any thread.
//
// Contract: `xyz` points to `3 * count` numbers, `out` to a handle; `progress` may be called with `context`.
lc_status lc_hull_new(const double *xyz, size_t count, lc_progress progress, void *context, struct lc_geometry *out);

// Makes the convex polygon that is the hull of `count` points of a plane.
//
// Contract: `xyz` points to `3 * count` numbers, `out` to a handle.
lc_status lc_polygon_new(const double *xyz, size_t count, struct lc_geometry *out);

// Makes a convex polyhedron of faces.
//
// `sizes` has the number of vertices of each of `faces` faces, and `indices` the indices of their
// vertices, one face after another, counterclockwise from outside.
//
// Contract: `xyz` points to `3 * vertices` numbers, `sizes` to `faces` numbers, `indices` to `index_count`
// numbers, `out` to a handle.
lc_status lc_faces_new(const double *xyz,
                       size_t vertices,
                       const uint32_t *sizes,
                       size_t faces,
                       const uint32_t *indices,
                       size_t index_count,
                       struct lc_geometry *out);

// Makes a shape of a kind (`LC_BOX` and so on) from its `count` parameters.
//
// Contract: `parameters` points to `count` numbers, `out` to a handle.
lc_status lc_shape_new(uint32_t kind, const double *parameters, size_t count, struct lc_geometry *out);

// Makes a convex geometry rounded by a radius: the points within the radius of it.
//
// Contract: `out` points to a handle.
lc_status lc_rounded_new(struct lc_geometry geometry, double radius, struct lc_geometry *out);

// Makes a compound of `count` convex pieces, each at a pose.
//
// Contract: `pieces` and `poses` point to `count` elements, `out` to a handle.
lc_status lc_compound_new(const struct lc_geometry *pieces,
                          const struct lc_pose *poses,
                          size_t count,
                          struct lc_geometry *out);

// Makes a mesh of `triangles` triples of indices of `vertices` points: a solid if the mesh is
// closed.
//
// Triangles are counterclockwise from outside. `progress` may be null.
//
// Contract: `xyz` points to `3 * vertices` numbers, `indices` to `3 * triangles` numbers, `out` to a handle;
// `progress` may be called with `context`.
lc_status lc_mesh_new(const double *xyz,
                      size_t vertices,
                      const uint32_t *indices,
                      size_t triangles,
                      lc_progress progress,
                      void *context,
                      struct lc_geometry *out);

// Makes a mesh as `lc_mesh_new` does, after a repair of cracks, inverted triangles and holes: a
// solid for all input. `lc_geometry_get_repair` says what was changed.
//
// Points at most `weld` from an earlier point move to it; zero welds equal points alone. Do not
// repair a mesh whose opening is meant, as that of a cup: what reaches in would overlap the mesh.
//
// Contract: As in `lc_mesh_new`.
lc_status lc_mesh_repaired_new(const double *xyz,
                               size_t vertices,
                               const uint32_t *indices,
                               size_t triangles,
                               double weld,
                               lc_progress progress,
                               void *context,
                               struct lc_geometry *out);

// Makes the mesh of a height field of `rows` by `columns` values, row by row.
//
// The value of row i and column j is the z at x = j * dx and y = i * dy. `base` may be null: the
// mesh is an open surface. Otherwise it points to the z of a base below all heights, and the mesh
// is a solid.
//
// Contract: `heights` points to `rows * columns` numbers, `base` is null or points to a number, `out` to a
// handle.
lc_status lc_heights_new(const double *heights,
                         size_t rows,
                         size_t columns,
                         double dx,
                         double dy,
                         const double *base,
                         struct lc_geometry *out);

// Makes a cloud of `count` points.
//
// With `radii` null, each point is a ball of the radius `radius`; zero is the point itself.
// Otherwise `radii` has a radius for each point.
//
// Contract: `xyz` points to `3 * count` numbers, `radii` is null or points to `count` numbers, `out` to a
// handle.
lc_status lc_cloud_new(const double *xyz, size_t count, double radius, const double *radii, struct lc_geometry *out);

// Makes a cloud of boxes from `count` occupied cells of a grid, three indices each.
//
// `origin` is the least corner of the cell 0, 0, 0; `size` are the sides of a cell.
//
// Contract: `origin` and `size` point to three numbers, `cells` to `3 * count` numbers, `out` to a handle.
lc_status lc_voxels_new(const double *origin,
                        const double *size,
                        const uint16_t *cells,
                        size_t count,
                        struct lc_geometry *out);

// Makes a surface of `patches` Bézier patches of the degrees `p` and `q`.
//
// A patch has (p + 1) * (q + 1) control points, those of one value of the first parameter after
// another. `weights` may be null; otherwise it has a weight for each control point.
//
// Contract: `xyz` points to the control points of all patches, three numbers each, `weights` is null or
// points to as many numbers as there are control points, `out` to a handle.
lc_status lc_surface_new(uint32_t p,
                         uint32_t q,
                         const double *xyz,
                         const double *weights,
                         size_t patches,
                         struct lc_geometry *out);

// Writes what the repair of a mesh has changed: zeros for a geometry that was not repaired.
// `out_size` is `sizeof(lc_mesh_repair)`.
//
// Contract: `out` points to `out_size` bytes.
lc_status lc_geometry_get_repair(struct lc_geometry geometry, struct lc_mesh_repair *out, size_t out_size);

// Writes what a geometry is; `out_size` is `sizeof(lc_geometry_info)`.
//
// Contract: `out` points to `out_size` bytes.
lc_status lc_geometry_get_info(struct lc_geometry geometry, struct lc_geometry_info *out, size_t out_size);

// Writes the box of a geometry at a pose, rounded outward: the least x, y, z, then the greatest.
//
// Contract: `pose` points to a pose, `out` to six numbers.
lc_status lc_geometry_box(struct lc_geometry geometry, const struct lc_pose *pose, double *out);

// Frees the handle of a geometry; zero is no error.
//
// Pairs, scenes and checkers that use the geometry keep it. Any thread.
lc_status lc_geometry_free(struct lc_geometry geometry);

// Makes a pair of two geometries, which may be the same.
//
// Contract: `out` points to a handle.
lc_status lc_pair_new(struct lc_geometry a, struct lc_geometry b, struct lc_pair *out);

// Frees a pair; zero is no error.
//
// During a call with the pair, in another thread or in a callback of it, the result is `LC_BUSY`
// and nothing is freed.
lc_status lc_pair_free(struct lc_pair pair);

// Drops the cached state: the next answer has the bits of a new pair's.
lc_status lc_pair_reset(struct lc_pair pair);

// Writes the answer about a pair at two poses in the world: the fields of the mask `wanted`, and
// maybe more.
//
// `out_size` is `sizeof(lc_answer)`. Unknown bits of the mask are ignored; `answered` says which
// fields are set. `out` may be the memory of a pose.
//
// Contract: `pose_a` and `pose_b` point to poses, `out` to `out_size` bytes.
lc_status lc_pair_ask(struct lc_pair pair,
                      const struct lc_pose *pose_a,
                      const struct lc_pose *pose_b,
                      uint32_t wanted,
                      struct lc_answer *out,
                      size_t out_size);

// Writes the answers about a pair at `count` pairs of poses, as `lc_pair_ask` does for each.
//
// A stride is the number of bytes from one element to the next; zero repeats one pose.
// `out_stride` is also the size of an answer that the caller knows, and all of these bytes are
// written. The call ends at the first pose that is refused; `done` is the number of answers.
//
// Contract: The arrays have `count` elements at their strides; `done` points to a number.
lc_status lc_pair_ask_many(struct lc_pair pair,
                           const struct lc_pose *poses_a,
                           size_t stride_a,
                           const struct lc_pose *poses_b,
                           size_t stride_b,
                           size_t count,
                           uint32_t wanted,
                           struct lc_answer *out,
                           size_t out_stride,
                           size_t *done);

// Writes whether the geometries of a pair are at most `distance` apart: 0 no, 1 yes,
// `LC_UNDECIDED` unknown. So the answer is zero only if they are proven to be farther apart.
//
// With a distance of zero: whether they share a point. For a negative distance the answer is no,
// and NaN is `LC_REFUSED`. Exact for polyhedra and meshes; only a Bézier surface leaves it
// undecided. For other curved geometries, what the bounds do not decide is yes.
//
// Contract: `pose_a` and `pose_b` point to poses, `out` to a number.
lc_status lc_pair_within(struct lc_pair pair,
                         const struct lc_pose *pose_a,
                         const struct lc_pose *pose_b,
                         double distance,
                         uint32_t *out);

// Writes the contact points of a pair that are at most `prediction` apart, the deepest group
// first.
//
// A group has at most `max_points` points, 1 to 8; zero means 4. `count` is the number of
// contacts; if it exceeds `capacity`, the first `capacity` are written. Bézier surfaces have no
// contacts.
//
// Contract: `pose_a` and `pose_b` point to poses, `out` to `capacity` elements of `out_stride` bytes,
// `count` to a number.
lc_status lc_pair_contacts(struct lc_pair pair,
                           const struct lc_pose *pose_a,
                           const struct lc_pose *pose_b,
                           double prediction,
                           uint32_t max_points,
                           struct lc_contact *out,
                           size_t out_stride,
                           size_t capacity,
                           size_t *count);

// Writes bounds of the penetration depth of the geometries of a pair.
//
// `LC_REFUSED` if one of them has no inside: an open mesh or a Bézier surface. `out_size` is
// `sizeof(lc_penetration)`.
//
// Contract: `pose_a` and `pose_b` point to poses, `out` to `out_size` bytes.
lc_status lc_pair_penetration(struct lc_pair pair,
                              const struct lc_pose *pose_a,
                              const struct lc_pose *pose_b,
                              struct lc_penetration *out,
                              size_t out_size);

// Writes bounds of the volume that the geometries of a pair share.
//
// `LC_REFUSED` if one of them is no polyhedron, no closed mesh and no union of polyhedra that do
// not overlap each other. `out_size` is `sizeof(lc_overlap_volume)`.
//
// Contract: `pose_a` and `pose_b` point to poses, `out` to `out_size` bytes.
lc_status lc_pair_overlap(struct lc_pair pair,
                          const struct lc_pose *pose_a,
                          const struct lc_pose *pose_b,
                          struct lc_overlap_volume *out,
                          size_t out_size);

// Writes when two moving geometries first touch, or come within the distance of the options.
//
// `options_size` is `sizeof(lc_cast_options)`, `out_size` is `sizeof(lc_cast)`.
//
// Contract: `motion_a` and `motion_b` point to motions, `options` to `options_size` bytes, `out` to
// `out_size` bytes.
lc_status lc_pair_cast(struct lc_pair pair,
                       const struct lc_motion *motion_a,
                       const struct lc_motion *motion_b,
                       const struct lc_cast_options *options,
                       size_t options_size,
                       struct lc_cast *out,
                       size_t out_size);

// Writes the next query of a pair of convex polyhedra as a text that repeats it bit for bit.
//
// `lc_text_free` frees the text. Attach it to a report of a wrong answer. `LC_REFUSED` for other
// kinds.
//
// Contract: `pose_a` and `pose_b` point to poses, `out` to a pointer.
lc_status lc_pair_replay(struct lc_pair pair, const struct lc_pose *pose_a, const struct lc_pose *pose_b, char **out);

// Writes the answer of a text of `lc_pair_replay`, as `lc_pair_ask` does.
//
// Contract: `replay` points to a text that ends with a zero, `out` to `out_size` bytes.
lc_status lc_replay_answer(const char *replay, uint32_t wanted, struct lc_answer *out, size_t out_size);

// Writes where `count` rays enter a geometry at a pose; neighbouring rays are fastest one after
// another.
//
// A ray that meets a Bézier surface is `LC_UNCLEAR`. The call ends at the first ray that is
// refused; `done` is the number of answers.
//
// Contract: `pose` points to a pose, `rays` to `count` rays, `out` to `count` elements of `out_stride`
// bytes, `done` to a number.
lc_status lc_ray_cast_many(struct lc_geometry geometry,
                           const struct lc_pose *pose,
                           const struct lc_ray *rays,
                           size_t count,
                           struct lc_ray_hit *out,
                           size_t out_stride,
                           size_t *done);

#if defined(LC_TESTING)
// Panics while the pair is in use.
lc_status lc_test_panic(struct lc_pair pair);
#endif

// Makes the checker of a robot and its cell from files.
//
// Paths are UTF-8. A message names the file, the line and the element. `files_size` is
// `sizeof(lc_robot_files)`.
//
// Contract: `files` points to `files_size` bytes; its texts end with a zero, and `packages` points to
// `package_count` of them; `out` points to a handle.
lc_status lc_checker_load(const struct lc_robot_files *files, size_t files_size, struct lc_checker *out);

// Makes a scene without bodies and queries.
//
// Contract: `out` points to a handle.
lc_status lc_scene_new(struct lc_scene *out);

// Frees a scene; zero is no error. `LC_BUSY` during a call with it: then nothing is freed.
lc_status lc_scene_free(struct lc_scene scene);

// Sets the queries of the pairs of two groups, 0 to 31, or of one group if both are equal.
//
// `queries_size` is `sizeof(lc_queries)`. Without queries nothing is computed.
//
// Contract: `queries` is null or points to `queries_size` bytes.
lc_status lc_scene_set_queries(struct lc_scene scene,
                               uint32_t group_a,
                               uint32_t group_b,
                               const struct lc_queries *queries,
                               size_t queries_size);

// Adds a body of a group at a pose. With `fixed` not zero the body is fixed: two fixed bodies are
// tested only with `LC_QUERY_FIXED`.
//
// Contract: `pose` points to a pose, `out` to an id.
lc_status lc_scene_add(struct lc_scene scene,
                       struct lc_geometry geometry,
                       const struct lc_pose *pose,
                       uint32_t group,
                       uint32_t fixed,
                       struct lc_body *out);

// Removes a body.
lc_status lc_scene_remove(struct lc_scene scene, struct lc_body body);

// Moves `count` bodies to their poses. `stride` is the number of bytes from one pose to the next.
//
// The call ends at the first body or pose that is refused; those before it have moved.
//
// Contract: `bodies` points to `count` ids, `poses` to `count` poses at the stride.
lc_status lc_scene_set_poses(struct lc_scene scene,
                             const struct lc_body *bodies,
                             const struct lc_pose *poses,
                             size_t stride,
                             size_t count);

// Writes the pose of a body.
//
// Contract: `out` points to a pose.
lc_status lc_scene_pose(struct lc_scene scene, struct lc_body body, struct lc_pose *out);

// Sets the velocity of a body: linear, then angular, about the origin of the geometry, in the
// world.
//
// Contract: `linear` and `angular` point to three numbers.
lc_status lc_scene_set_velocity(struct lc_scene scene,
                                struct lc_body body,
                                const double *linear,
                                const double *angular);

// Excludes a pair of bodies from all queries, or includes it again if `excluded` is zero.
lc_status lc_scene_exclude(struct lc_scene scene, struct lc_body a, struct lc_body b, uint32_t excluded);

// Moves all bodies by their velocities over a time. Call `lc_scene_step` afterwards for the
// answers.
lc_status lc_scene_advance(struct lc_scene scene, double time);

// Applies all changes and runs the enabled queries.
lc_status lc_scene_step(struct lc_scene scene);

// Writes the events of the last step. If there are more than `capacity`, the first are written;
// `count` is their number.
//
// Contract: `out` points to `capacity` elements of `out_stride` bytes, `count` to a number.
lc_status lc_scene_events(struct lc_scene scene,
                          struct lc_event *out,
                          size_t out_stride,
                          size_t capacity,
                          size_t *count);

// Writes the first contacts in the time of the last `lc_scene_advance`, as `lc_scene_events` does.
//
// Contract: As for `lc_scene_events`.
lc_status lc_scene_impacts(struct lc_scene scene,
                           struct lc_impact *out,
                           size_t out_stride,
                           size_t capacity,
                           size_t *count);

// Writes the pairs whose boxes overlap, with the answers of the last step, as `lc_scene_events`
// does.
//
// Points are in the world if no pose was set since the last step. `LC_REFUSED` if a body of a
// pair with points was removed since then.
//
// Contract: As for `lc_scene_events`.
lc_status lc_scene_pairs(struct lc_scene scene,
                         struct lc_scene_pair *out,
                         size_t out_stride,
                         size_t capacity,
                         size_t *count);

// Writes the pair of least signed distance of two groups at the last step, at any distance.
//
// If there is no pair, `out->a` is zero. At least one query of the groups must be set. `out_size`
// is `sizeof(lc_scene_pair)`.
//
// Contract: `out` points to `out_size` bytes.
lc_status lc_scene_closest_pair(struct lc_scene scene,
                                uint32_t group_a,
                                uint32_t group_b,
                                struct lc_scene_pair *out,
                                size_t out_size);

// Writes the first body that a ray enters, among the bodies of the groups of a mask: bit g stands
// for group g.
//
// `out_size` is `sizeof(lc_ray_hit)`.
//
// Contract: `ray` points to a ray, `out` to `out_size` bytes.
lc_status lc_scene_cast_ray(struct lc_scene scene,
                            const struct lc_ray *ray,
                            uint32_t groups,
                            struct lc_ray_hit *out,
                            size_t out_size);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* LIN_CANNY_H */
