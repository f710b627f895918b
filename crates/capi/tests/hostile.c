/* What a caller can do wrong, as far as C can check it: every case is a status, none is undefined behaviour.

   usage: hostile COPY CALLS [SEED]; COPY is another file of the library. Exit code 0 if all is as expected. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fenv.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "lin_canny.h"
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

static int failures = 0;
#define EXPECT(call, wanted)                                                                                 \
  do {                                                                                                       \
    lc_status s_ = (call);                                                                                   \
    if (s_ != (wanted)) {                                                                                    \
      ++failures;                                                                                            \
      printf("line %d: status %d, expected %d: %s\n", __LINE__, (int)s_, (int)(wanted), lc_last_error());   \
    }                                                                                                        \
  } while (0)
#define TRUE(x)                                                                                              \
  do {                                                                                                       \
    if (!(x)) {                                                                                              \
      ++failures;                                                                                            \
      printf("line %d: not " #x "\n", __LINE__);                                                             \
    }                                                                                                        \
  } while (0)

static const lc_pose here = {{0, 0, 0}, {0, 0, 0, 1}};
static const lc_pose there = {{1.7, 0.1, 0.2}, {0, 0, 0, 1}};
static double cube[24];
static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

static lc_geometry box(double h) {
  lc_geometry g = {0};
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 3; ++j) cube[3 * k + j] = k >> j & 1 ? h : -h;
  EXPECT(lc_hull_new(cube, 8, NULL, NULL, &g), LC_OK);
  return g;
}

static uint64_t x = 1;
static uint64_t any(void) {
  x ^= x << 13;
  x ^= x >> 7;
  x ^= x << 17;
  return x;
}

static void pairs(void) {
  lc_geometry a = box(.5), b = box(.5), none = {0}, wild = {0x0123456789abcdefu}, g = {77};
  lc_pair p, q = {0};
  lc_answer o, first;
  EXPECT(lc_pair_new(a, b, &p), LC_OK);
  lc_geometry pair_as_geometry = {p.id};
  EXPECT(lc_pair_new(none, a, &q), LC_HANDLE);
  EXPECT(lc_pair_new(wild, a, &q), LC_HANDLE);
  EXPECT(lc_pair_new(pair_as_geometry, a, &q), LC_HANDLE);
  EXPECT(lc_geometry_free(b), LC_OK); /* the pair keeps it */
  EXPECT(lc_pair_new(b, a, &q), LC_HANDLE);
  EXPECT(lc_geometry_free(b), LC_HANDLE);
  lc_geometry c = box(.4); /* in the slot of b */
  TRUE(((c.id ^ b.id) & 0xffffff) == 0 && c.id != b.id);
  EXPECT(lc_pair_new(b, a, &q), LC_HANDLE);
  TRUE(q.id == 0);
  EXPECT(lc_pair_new(a, a, NULL), LC_ARGUMENT);
  EXPECT(lc_pair_new(a, a, (lc_pair *)((char *)&q + 1)), LC_ARGUMENT);
  EXPECT(lc_hull_new(NULL, 8, NULL, NULL, &g), LC_ARGUMENT);
  EXPECT(lc_hull_new(cube, SIZE_MAX / 2, NULL, NULL, &g), LC_ARGUMENT);
  EXPECT(lc_hull_new(cube, SIZE_MAX / 24 + 2, NULL, NULL, &g), LC_ARGUMENT);
  EXPECT(lc_hull_new(cube, 0, NULL, NULL, &g), LC_REFUSED);
  EXPECT(lc_hull_new(NULL, 0, NULL, NULL, &g), LC_REFUSED);
  TRUE(g.id == 77); /* untouched by errors */
  cube[4] = NAN;
  EXPECT(lc_hull_new(cube, 8, NULL, NULL, &g), LC_REFUSED);
  printf("NaN: %s\n", lc_last_error());
  uint32_t triangle[3] = {0, 1, 8}, sizes[2] = {3, 0xffffffffu};
  EXPECT(lc_mesh_new(cube, 8, triangle, 1, NULL, NULL, &g), LC_REFUSED);
  EXPECT(lc_mesh_repaired_new(cube, 8, triangle, 1, 0, NULL, NULL, &g), LC_REFUSED);
  EXPECT(lc_faces_new(cube, 8, sizes, 2, triangle, 3, &g), LC_ARGUMENT);
  double radius[4] = {-1, 1, 0, 0};
  EXPECT(lc_shape_new(LC_CYLINDER, radius, 2, &g), LC_REFUSED);
  EXPECT(lc_shape_new(LC_CYLINDER, radius, 3, &g), LC_ARGUMENT);
  EXPECT(lc_shape_new(99, radius, 1, &g), LC_ARGUMENT);
  EXPECT(lc_surface_new(0xffffffffu, 0xffffffffu, cube, NULL, 1, &g), LC_ARGUMENT);
  EXPECT(lc_voxels_new(cube, cube, NULL, SIZE_MAX / 3, &g), LC_ARGUMENT);
  EXPECT(lc_heights_new(cube, SIZE_MAX / 2, 4, 1, 1, NULL, &g), LC_ARGUMENT);
  lc_pose bad = here;
  bad.rotation[0] = 3;
  EXPECT(lc_pair_ask(p, &here, &bad, LC_POINTS, &o, sizeof o), LC_REFUSED);
  printf("pose: %s\n", lc_last_error());
  bad = here, bad.translation[1] = NAN;
  EXPECT(lc_pair_ask(p, &here, &bad, LC_POINTS, &o, sizeof o), LC_REFUSED);
  bad = here, bad.translation[1] = INFINITY;
  EXPECT(lc_pair_ask(p, &here, &bad, LC_POINTS, &o, sizeof o), LC_REFUSED);
  EXPECT(lc_pair_ask(p, &here, NULL, LC_POINTS, &o, sizeof o), LC_ARGUMENT);
  EXPECT(lc_pair_ask(p, &here, &there, LC_POINTS, NULL, sizeof o), LC_ARGUMENT);
  EXPECT(lc_pair_ask(p, &here, &there, LC_POINTS, &o, 8), LC_ARGUMENT);
  EXPECT(lc_pair_ask(p, &here, &there, 0xffffffffu & ~(uint32_t)(LC_BODY_FRAMES | LC_NO_DEPTH | LC_LOCAL_DEPTH), &o, sizeof o), LC_OK);
  /* A caller of a later version: what this one does not know is zero. */
  struct {
    lc_answer known;
    double later[4];
  } later;
  memset(&later, 0xff, sizeof later);
  EXPECT(lc_pair_ask(p, &here, &there, LC_POINTS, &later.known, sizeof later), LC_OK);
  TRUE(memcmp(&later.known, &o, sizeof o) == 0 && later.later[0] == 0 && later.later[3] == 0);
  /* Options of a later version: zero is no option, anything else is refused. */
  struct {
    lc_cast_options known;
    double later;
  } options = {{1, 1e-6, 0, 0, 0, 0}, 0};
  lc_motion still = {here, {0, 0, 0}, {0, 0, 0}}, moving = {there, {-1, 0, 0}, {0, 0, 0}};
  lc_cast cast;
  EXPECT(lc_pair_cast(p, &still, &moving, &options.known, sizeof options, &cast, sizeof cast), LC_OK);
  TRUE(cast.state == LC_HIT && cast.safe <= cast.hit && cast.hit - cast.safe < 1e-5 && fabs(cast.hit - 0.7) < 1e-5);
  options.later = 1;
  EXPECT(lc_pair_cast(p, &still, &moving, &options.known, sizeof options, &cast, sizeof cast), LC_ARGUMENT);
  EXPECT(lc_pair_cast(p, &still, &moving, &options.known, 8, &cast, sizeof cast), LC_ARGUMENT);
  /* The answer over a pose. */
  union {
    lc_pose pose;
    lc_answer answer;
  } over;
  over.pose = there;
  EXPECT(lc_pair_ask(p, &here, &over.pose, LC_POINTS, &over.answer, sizeof over.answer), LC_OK);
  TRUE(over.answer.distance == o.distance);
  /* A batch that ends at its third pose, and a pose that is repeated. */
  lc_pose three[3] = {there, there, there};
  three[2].rotation[3] = 0;
  lc_answer answers[3];
  size_t done = 9;
  EXPECT(lc_pair_ask_many(p, &here, 0, three, sizeof *three, 3, 7, answers, sizeof *answers, &done), LC_REFUSED);
  TRUE(done == 2 && answers[1].distance == o.distance);
  EXPECT(lc_pair_ask_many(p, &here, 0, three, 0, 3, 7, answers, sizeof *answers, &done), LC_OK);
  TRUE(done == 3 && answers[2].distance == o.distance);
  EXPECT(lc_pair_ask_many(p, &here, 0, three, 8, 3, 7, answers, sizeof *answers, &done), LC_ARGUMENT);
  EXPECT(lc_pair_ask_many(p, &here, 0, three, 57, 3, 7, answers, sizeof *answers, &done), LC_ARGUMENT);
  EXPECT(lc_pair_ask_many(p, &here, 0, three, sizeof *three, SIZE_MAX / 16, 7, answers, sizeof *answers, &done), LC_ARGUMENT);
  EXPECT(lc_pair_ask_many(p, NULL, 0, NULL, 0, 0, 7, NULL, sizeof *answers, &done), LC_OK);
  TRUE(done == 0);
  /* Lists: no room, less room than needed, a range that is none. */
  lc_contact contacts[2];
  const lc_pose touching = {{0.99, 0.1, 0.2}, {0, 0, 0, 1}};
  EXPECT(lc_pair_contacts(p, &here, &touching, 0.1, 0, NULL, sizeof *contacts, 0, &done), LC_OK);
  TRUE(done == 4);
  EXPECT(lc_pair_contacts(p, &here, &touching, 0.1, 0, contacts, sizeof *contacts, 2, &done), LC_OK);
  TRUE(done == 4 && contacts[1].separation < 0);
  EXPECT(lc_pair_contacts(p, &here, &touching, NAN, 0, contacts, sizeof *contacts, 2, &done), LC_REFUSED);
  EXPECT(lc_pair_contacts(p, &here, &touching, 0.1, 9, contacts, sizeof *contacts, 2, &done), LC_REFUSED);
  EXPECT(lc_pair_contacts(p, &here, &touching, 0.1, 0, contacts, 8, 2, &done), LC_ARGUMENT);
  uint32_t within = 9;
  EXPECT(lc_pair_within(p, &here, &there, NAN, &within), LC_REFUSED);
  printf("within: %s\n", lc_last_error());
  TRUE(within == 9);
  EXPECT(lc_pair_within(p, &here, &there, INFINITY, &within), LC_OK);
  TRUE(within == 1);
  EXPECT(lc_pair_within(p, &here, &there, -INFINITY, &within), LC_OK);
  TRUE(within == 0);
  /* A replay: the same answer again; a text that is none. */
  char *text = NULL;
  EXPECT(lc_pair_replay(p, &here, &there, &text), LC_OK);
  EXPECT(lc_replay_answer(text, 7, &answers[0], sizeof *answers), LC_OK);
  TRUE(answers[0].lower <= o.upper && o.lower <= answers[0].upper);
  lc_text_free(text);
  EXPECT(lc_pair_replay(p, &here, &touching, &text), LC_OK);
  EXPECT(lc_replay_answer(text, LC_DISTANCE, &answers[0], sizeof *answers), LC_OK);
  EXPECT(lc_replay_answer(text, LC_DISTANCE | LC_NO_DEPTH, &answers[1], sizeof *answers), LC_OK);
  TRUE(answers[0].distance < 0 && answers[1].distance == 0);
  lc_text_free(text);
  EXPECT(lc_replay_answer("no replay", 7, &answers[0], sizeof *answers), LC_REFUSED);
  EXPECT(lc_replay_answer("\xff\xfe", 7, &answers[0], sizeof *answers), LC_ARGUMENT);
  EXPECT(lc_replay_answer(NULL, 7, &answers[0], sizeof *answers), LC_ARGUMENT);
  EXPECT(lc_pair_reset(p), LC_OK);
#if defined(LC_TESTING)
  /* A panic inside: the pair goes on with new state. */
  EXPECT(lc_pair_ask(p, &here, &there, 7, &first, sizeof first), LC_OK);
  EXPECT(lc_test_panic(p), LC_PANIC);
  printf("panic: %s\n", lc_last_error());
  EXPECT(lc_pair_ask(p, &here, &there, 7, &o, sizeof o), LC_OK);
  TRUE(memcmp(&first, &o, sizeof o) == 0);
#else
  (void)first;
#endif
  EXPECT(lc_pair_free(p), LC_OK);
  EXPECT(lc_pair_free(p), LC_HANDLE);
  EXPECT(lc_pair_ask(p, &here, &there, 7, &o, sizeof o), LC_HANDLE);
  EXPECT(lc_pair_free((lc_pair){0}), LC_OK);
  lc_text_free(NULL);
  EXPECT(lc_geometry_free(a), LC_OK);
  EXPECT(lc_geometry_free(c), LC_OK);
  TRUE(lc_live() == 0);
}

static void scenes_and_checkers(void) {
  lc_geometry g = box(.5);
  lc_scene s = {0}, other = {0};
  lc_body b = {0}, c = {0};
  lc_queries queries = {LC_QUERY_WITHIN | LC_QUERY_OVERLAP, 0, 0.5, 0, 0, 0};
  lc_scene_pair pair;
  size_t count;
  EXPECT(lc_scene_new(&s), LC_OK);
  EXPECT(lc_scene_new(&other), LC_OK);
  EXPECT(lc_scene_set_queries(s, 0, 32, &queries, sizeof queries), LC_REFUSED);
  queries.within = NAN;
  EXPECT(lc_scene_set_queries(s, 0, 0, &queries, sizeof queries), LC_REFUSED);
  queries.within = 0.5;
  EXPECT(lc_scene_set_queries(s, 0, 0, &queries, sizeof queries), LC_OK);
  EXPECT(lc_scene_set_queries(s, 0, 0, &queries, 4), LC_ARGUMENT);
  EXPECT(lc_scene_add(s, g, &here, 0, 0, &b), LC_OK);
  EXPECT(lc_scene_add(s, g, &there, 0, 0, &c), LC_OK);
  EXPECT(lc_scene_add(s, (lc_geometry){s.id}, &there, 0, 0, &c), LC_HANDLE);
  lc_pose bad = here;
  bad.rotation[3] = NAN;
  EXPECT(lc_scene_add(s, g, &bad, 0, 0, &c), LC_REFUSED);
  EXPECT(lc_scene_closest_pair(s, 0, 0, &pair, sizeof pair), LC_REFUSED); /* a step is due */
  EXPECT(lc_scene_step(s), LC_OK);
  EXPECT(lc_scene_closest_pair(s, 0, 0, &pair, sizeof pair), LC_OK);
  TRUE(pair.a.id == b.id && pair.b.id == c.id && fabs(pair.answer.distance - 0.7) < 1e-12);
  EXPECT(lc_scene_set_poses(s, &b, &here, 0, SIZE_MAX / 4), LC_ARGUMENT);
  EXPECT(lc_scene_remove(s, (lc_body){0}), LC_REFUSED);
  EXPECT(lc_scene_remove(s, (lc_body){~0ull}), LC_REFUSED);
  EXPECT(lc_scene_remove(s, c), LC_OK);
  EXPECT(lc_scene_remove(s, c), LC_REFUSED);
  EXPECT(lc_scene_pairs(s, &pair, sizeof pair, 1, &count), LC_OK);
  EXPECT(lc_scene_step(s), LC_OK);
  EXPECT(lc_scene_pairs(s, &pair, sizeof pair, 1, &count), LC_OK);
  TRUE(count == 0);
  /* Points of a pair whose body was removed: an error, and no answer before it. */
  lc_queries points = {LC_QUERY_DISTANCE | LC_QUERY_FEATURES, 0, 0, 2, 0, 0};
  lc_body last = {0};
  lc_scene_pair both[3];
  EXPECT(lc_scene_set_queries(s, 0, 0, &points, sizeof points), LC_OK);
  EXPECT(lc_scene_add(s, g, &there, 0, 0, &c), LC_OK);
  EXPECT(lc_scene_add(s, g, &there, 0, 0, &last), LC_OK);
  EXPECT(lc_scene_step(s), LC_OK);
  EXPECT(lc_scene_pairs(s, both, sizeof *both, 3, &count), LC_OK);
  TRUE(count == 3);
  EXPECT(lc_scene_remove(s, last), LC_OK);
  memset(both, 0xff, sizeof both);
  count = 77;
  EXPECT(lc_scene_pairs(s, both, sizeof *both, 3, &count), LC_REFUSED);
  TRUE(count == 77 && both[0].a.id == ~0ull);
  EXPECT(lc_scene_free(s), LC_OK);
  EXPECT(lc_scene_step(s), LC_HANDLE);
  EXPECT(lc_scene_free(other), LC_OK);

  const double bounds[6] = {-9, 9, -9, 9, -9, 9};
  const double q[9] = {0, 0, 0, 6, 0, 0, 0, 6, 0};
  lc_checker check = {0}, copy = {0};
  lc_world_body wall = {0}, found[1];
  lc_verdict verdict[2];
  lc_near near;
  uint8_t is_free = 9;
  EXPECT(lc_checker_new_body(g, bounds, -1, &check), LC_REFUSED);
  EXPECT(lc_checker_new_body(g, bounds, NAN, &check), LC_REFUSED);
  EXPECT(lc_checker_new_body(g, bounds, 0, &check), LC_OK);
  EXPECT(lc_checker_clearance_many(check, q, 3, 1, &near, sizeof near, NULL, &count), LC_OK);
  TRUE(near.a.id == 0 && isinf(near.distance));
  const lc_pose at = {{3, 0, 0}, {0, 0, 0, 1}};
  EXPECT(lc_checker_obstacle_add(check, "wall", g, &at, &wall), LC_OK);
  EXPECT(lc_checker_obstacle_add(check, NULL, g, &at, &wall), LC_ARGUMENT);
  EXPECT(lc_checker_find(check, "wal", found, 1, &count), LC_REFUSED);
  printf("name: %s\n", lc_last_error());
  EXPECT(lc_checker_find(check, "wall", found, 1, &count), LC_OK);
  TRUE(count == 1 && found[0].id == wall.id);
  EXPECT(lc_checker_obstacle_move(check, (lc_world_body){wall.id + 1}, &at), LC_REFUSED);
  EXPECT(lc_checker_obstacle_move(check, (lc_world_body){~0ull}, &at), LC_REFUSED);
  EXPECT(lc_checker_free_at_many(check, q, 4, 1, &is_free, &count), LC_ARGUMENT);
  EXPECT(lc_checker_free_at_many(check, q, 3, SIZE_MAX / 8, &is_free, &count), LC_ARGUMENT);
  EXPECT(lc_checker_free_at_many(check, q, 3, 1, &is_free, &count), LC_OK);
  TRUE(is_free == 1);
  EXPECT(lc_checker_certify_many(check, q, q + 3, 3, 2, verdict, sizeof *verdict, &count), LC_OK);
  TRUE(verdict[0].state == LC_BLOCKED && verdict[0].b.id == wall.id && verdict[0].free_until <= 1. / 3 && 1. / 3 <= verdict[0].contact_at);
  EXPECT(lc_checker_copy(check, &copy), LC_OK);
  EXPECT(lc_checker_certify_path(copy, q, 3, 3, verdict, sizeof *verdict), LC_OK);
  TRUE(verdict[0].state == LC_BLOCKED && verdict[0].segment == 0);
  EXPECT(lc_checker_certify_curve(copy, q, 3, 3, verdict, sizeof *verdict), LC_OK);
  EXPECT(lc_checker_set_margin(copy, -1), LC_REFUSED);
  EXPECT(lc_checker_set_margin(copy, 0.25), LC_OK);
  EXPECT(lc_checker_remove(copy, wall), LC_OK);
  EXPECT(lc_checker_remove(copy, wall), LC_REFUSED);
  EXPECT(lc_checker_certify_many(copy, q, q + 3, 3, 1, verdict, sizeof *verdict, &count), LC_OK);
  TRUE(verdict[0].state == LC_FREE);
  EXPECT(lc_checker_nearest_many(check, q, 3, 3, SIZE_MAX / 2, 1, 1, &near, sizeof near, NULL), LC_ARGUMENT);
  EXPECT(lc_checker_free(copy), LC_OK);
  EXPECT(lc_checker_free(check), LC_OK);
  EXPECT(lc_checker_copy(check, &copy), LC_HANDLE);
  lc_robot_files files = {"no such file", NULL, NULL, NULL, 0, 0, 0};
  EXPECT(lc_checker_load(&files, sizeof files, &check), LC_REFUSED);
  printf("file: %s\n", lc_last_error());
  files.packages = NULL, files.package_count = 3;
  EXPECT(lc_checker_load(&files, sizeof files, &check), LC_ARGUMENT);
  EXPECT(lc_checker_load(NULL, 0, &check), LC_ARGUMENT);
  EXPECT(lc_geometry_free(g), LC_OK);
  TRUE(lc_live() == 0);
}

/* A callback that uses the library, stops the call, and asks for the object of its own call. */
struct back {
  lc_checker own;
  int calls, stop_at;
};
/* A callback that stops the call in its second stage. */
static int32_t second(void *context, const char *stage, uint64_t done, uint64_t total) {
  (void)context, (void)done, (void)total;
  return strcmp(stage, "shortcuts") == 0;
}
static int32_t again(void *context, const char *stage, uint64_t done, uint64_t total) {
  struct back *b = context;
  (void)stage, (void)done, (void)total;
  lc_geometry other = box(.3);
  EXPECT(lc_geometry_free(other), LC_OK);
  if (b->own.id) {
    EXPECT(lc_checker_set_margin(b->own, 0), LC_BUSY);
    EXPECT(lc_checker_free(b->own), LC_BUSY);
  }
  return ++b->calls >= b->stop_at;
}
/* A callback that changes the floating-point mode. */
static int32_t upward(void *context, const char *stage, uint64_t done, uint64_t total) {
  (void)context, (void)stage, (void)done, (void)total;
  return fesetround(FE_UPWARD);
}
static void callbacks(void) {
  double *cloud = malloc(3 * 4000 * sizeof *cloud);
  for (int k = 0; k < 12000; ++k) cloud[k] = sin(k * 0.7 + k % 3);
  struct back b = {{0}, 0, 3};
  lc_geometry g = {0};
  EXPECT(lc_hull_new(cloud, 4000, again, &b, &g), LC_STOPPED);
  TRUE(g.id == 0 && b.calls == 3 && lc_live() == 0);
  EXPECT(lc_hull_new(cloud, 4000, upward, NULL, &g), LC_OK);
  volatile double one = 1, tiny = 1e-30; /* fegetround reads another register than this sum */
  TRUE(one + tiny == 1);
  fesetround(FE_TONEAREST);
  EXPECT(lc_geometry_free(g), LC_OK);
  free(cloud);
  const double bounds[6] = {-9, 9, -9, 9, -9, 9}, start[3] = {-5, 0, 0}, goal[3] = {5, 0, 0};
  g = box(.5);
  lc_world_body wall;
  EXPECT(lc_checker_new_body(g, bounds, 0, &b.own), LC_OK);
  EXPECT(lc_checker_obstacle_add(b.own, "wall", g, &here, &wall), LC_OK);
  size_t count = 7;
  b.calls = 0, b.stop_at = 1;
  EXPECT(lc_checker_plan(b.own, start, goal, 3, NULL, 0, again, &b, &count), LC_STOPPED);
  TRUE(count == 7);
  EXPECT(lc_checker_path(b.own, NULL, 3, 0, &count), LC_OK);
  TRUE(count == 0);
  b.stop_at = 1 << 30;
  EXPECT(lc_checker_plan(b.own, start, goal, 3, NULL, 0, again, &b, &count), LC_OK);
  TRUE(count >= 2);
  double path[3 * 64];
  EXPECT(lc_checker_path(b.own, path, 3, 64, &count), LC_OK);
  TRUE(count <= 64 && path[0] == -5 && path[3 * count - 3] == 5);
  /* Stopped while the path is shortened: the path so far, whose segments are proven free. */
  lc_plan_options options = {1, 0, 0, 1000, 0, LC_PLAN_RRT_CONNECT, 0};
  lc_verdict verdict;
  size_t length = count;
  count = 7;
  EXPECT(lc_checker_plan(b.own, start, goal, 3, &options, sizeof options, second, NULL, &count), LC_STOPPED);
  TRUE(count == 7);
  EXPECT(lc_checker_path(b.own, path, 3, 64, &count), LC_OK);
  TRUE(count >= length && count <= 64 && path[0] == -5 && path[3 * count - 3] == 5);
  EXPECT(lc_checker_certify_path(b.own, path, 3, count, &verdict, sizeof verdict), LC_OK);
  TRUE(verdict.state == LC_FREE);
  /* A caller that knows the first four options; a method that does not exist; too few options. */
  EXPECT(lc_checker_plan(b.own, start, goal, 3, &options, 32, NULL, NULL, &count), LC_OK);
  TRUE(count >= 2);
  options.method = 2;
  EXPECT(lc_checker_plan(b.own, start, goal, 3, &options, sizeof options, NULL, NULL, &count), LC_ARGUMENT);
  printf("method: %s\n", lc_last_error());
  EXPECT(lc_checker_plan(b.own, start, goal, 3, &options, 24, NULL, NULL, &count), LC_ARGUMENT);
  EXPECT(lc_checker_free(b.own), LC_OK);
  EXPECT(lc_geometry_free(g), LC_OK);
}

/* The floating-point mode of the host: the same bits in every mode, and the mode is set back. */
static void modes(void) {
  lc_geometry a = box(.5), b = box(.4999);
  lc_pair p;
  lc_answer plain, other;
  EXPECT(lc_pair_new(a, b, &p), LC_OK);
  const lc_pose turned = {{1.7, 0.1, 0.2}, {0.5, 0.5, 0.5, 0.5}};
  EXPECT(lc_pair_ask(p, &here, &turned, 7, &plain, sizeof plain), LC_OK);
  const int modes[] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
  for (int k = 0; k < 3; ++k) {
    fesetround(modes[k]);
    EXPECT(lc_pair_ask(p, &here, &turned, 7, &other, sizeof other), LC_OK);
    TRUE(fegetround() == modes[k]);
    fesetround(FE_TONEAREST);
    TRUE(memcmp(&plain, &other, sizeof plain) == 0);
  }
#if defined(__x86_64__)
  const unsigned was = _mm_getcsr();
  _mm_setcsr(was | 0x8040); /* flush to zero, denormals are zero: what -ffast-math sets */
  EXPECT(lc_pair_ask(p, &here, &turned, 7, &other, sizeof other), LC_OK);
  if (!getenv("VALGRIND")) TRUE((_mm_getcsr() & 0x8040) == 0x8040); /* valgrind does not model the bits */
  _mm_setcsr(was);
  TRUE(memcmp(&plain, &other, sizeof plain) == 0);
#endif
  feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW | FE_UNDERFLOW); /* a host that traps */
  EXPECT(lc_pair_ask(p, &here, &turned, 7, &other, sizeof other), LC_OK);
  fedisableexcept(FE_ALL_EXCEPT);
  TRUE(memcmp(&plain, &other, sizeof plain) == 0);
  EXPECT(lc_pair_free(p), LC_OK);
  EXPECT(lc_geometry_free(a), LC_OK);
  EXPECT(lc_geometry_free(b), LC_OK);
}

/* A system without memory for another thread: the call does the work alone, with the same bits. */
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define LIMITS 0
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define LIMITS 0
#endif
#ifndef LIMITS
#define LIMITS 1
#endif
#if LIMITS
static void *nothing(void *context) { return context; }
static void no_threads(void) {
  enum { ROWS = 64 };
  const double bounds[6] = {-9, 9, -9, 9, -9, 9};
  static double q[3 * ROWS];
  static lc_near alone[ROWS], many[ROWS];
  lc_geometry g = box(.5);
  lc_checker check = {0};
  lc_world_body wall;
  memset(alone, 1, sizeof alone);
  for (int k = 0; k < ROWS; ++k) q[3 * k] = 2 + .1 * k;
  EXPECT(lc_checker_new_body(g, bounds, 0, &check), LC_OK);
  EXPECT(lc_checker_obstacle_add(check, "wall", g, &here, &wall), LC_OK);
  EXPECT(lc_checker_nearest_many(check, q, 3, ROWS, 1, 1, 1, alone, sizeof *alone, NULL), LC_OK);
  unsigned long pages = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  const int read = file ? fscanf(file, "%lu", &pages) : 0;
  TRUE(read == 1);
  if (file) fclose(file);
  struct rlimit was, less;
  TRUE(getrlimit(RLIMIT_AS, &was) == 0);
  less = was;
  less.rlim_cur = pages * (unsigned long)sysconf(_SC_PAGESIZE) + (1u << 20);
  pthread_t thread;
  TRUE(setrlimit(RLIMIT_AS, &less) == 0);
  const int failed = pthread_create(&thread, NULL, nothing, NULL);
  const lc_status status = lc_checker_nearest_many(check, q, 3, ROWS, 1, 1, 64, many, sizeof *many, NULL);
  setrlimit(RLIMIT_AS, &was);
  TRUE(failed != 0);
  if (!failed) pthread_join(thread, NULL);
  EXPECT(status, LC_OK);
  TRUE(memcmp(alone, many, sizeof alone) == 0);
  EXPECT(lc_checker_free(check), LC_OK);
  EXPECT(lc_geometry_free(g), LC_OK);
}
#endif

/* Threads: one pair by two of them, one geometry by all, a handle freed during calls. */
static lc_pair shared;
static lc_geometry common;
static void *same_pair(void *count) {
  long *n = count;
  for (int k = 0; k < 50000; ++k) {
    lc_answer o;
    lc_pose at = there;
    at.translation[0] -= 1e-6 * k;
    lc_status s = lc_pair_ask(shared, &here, &at, 7, &o, sizeof o);
    if (s == LC_OK) {
      ++n[0];
      if (!(o.distance > 0.5 && o.distance < 0.8)) ++n[3];
    } else {
      ++n[s == LC_BUSY ? 1 : 2];
    }
  }
  return NULL;
}
static void *own_pairs(void *wrong) {
  for (int k = 0; k < 10000; ++k) {
    lc_pair p = {0};
    lc_answer o;
    if (lc_pair_new(common, common, &p) != LC_OK || lc_pair_ask(p, &here, &there, 7, &o, sizeof o) != LC_OK ||
        lc_pair_free(p) != LC_OK)
      ++*(long *)wrong;
  }
  return NULL;
}
static void *freeing(void *tries) {
  for (;;) {
    lc_status s = lc_pair_free(shared);
    ++*(long *)tries;
    if (s != LC_BUSY) return NULL;
  }
}
static void threads(void) {
  pthread_t t[4];
  long n[2][4] = {{0}}, wrong[4] = {0}, tries = 0;
  common = box(.5);
  EXPECT(lc_pair_new(common, common, &shared), LC_OK);
  for (int k = 0; k < 2; ++k) pthread_create(&t[k], NULL, same_pair, n[k]);
  for (int k = 0; k < 2; ++k) pthread_join(t[k], NULL);
  printf("two threads, one pair: %ld answered, %ld busy\n", n[0][0] + n[1][0], n[0][1] + n[1][1]);
  TRUE(n[0][2] + n[1][2] + n[0][3] + n[1][3] == 0);
  for (int k = 0; k < 4; ++k) pthread_create(&t[k], NULL, own_pairs, &wrong[k]);
  for (int k = 0; k < 4; ++k) pthread_join(t[k], NULL);
  TRUE(wrong[0] + wrong[1] + wrong[2] + wrong[3] == 0);
  memset(n, 0, sizeof n);
  pthread_create(&t[0], NULL, same_pair, n[0]);
  pthread_create(&t[1], NULL, freeing, &tries);
  for (int k = 0; k < 2; ++k) pthread_join(t[k], NULL);
  printf("freed during calls: %ld answered, %ld busy, %ld stale, %ld tries\n", n[0][0], n[0][1], n[0][2], tries);
  TRUE(n[0][3] == 0);
  EXPECT(lc_geometry_free(common), LC_OK);
  TRUE(lc_live() == 0);
}

/* Another copy of the library in one process refuses the handles of this one. */
static void copies(const char *path) {
  void *other = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (!other) {
    printf("no copy: %s\n", dlerror());
    ++failures;
    return;
  }
  lc_status (*new_hull)(const double *, size_t, lc_progress, void *, lc_geometry *);
  lc_status (*free_hull)(lc_geometry);
  *(void **)&new_hull = dlsym(other, "lc_hull_new");
  *(void **)&free_hull = dlsym(other, "lc_geometry_free");
  TRUE(new_hull != lc_hull_new);
  lc_geometry mine = box(.5), theirs = {0};
  EXPECT(new_hull(cube, 8, NULL, NULL, &theirs), LC_OK);
  EXPECT(lc_geometry_free(theirs), LC_HANDLE);
  EXPECT(free_hull(mine), LC_HANDLE);
  EXPECT(free_hull(theirs), LC_OK);
  EXPECT(lc_geometry_free(mine), LC_OK);
  dlclose(other);
}

/* Calls in random order with handles that live, are freed, foreign, invented or zero, with numbers of every size, with
   null pointers and with wrong sizes. A status is all that may happen. */
enum { N = 24 };
static lc_geometry g[N];
static lc_pair p[N];
static lc_scene s[N];
static lc_checker c[N];
static lc_body b[N];
static lc_world_body w[N];
static double v[96];
static const double odd[] = {0, -0.0, 1, -1, .5, 1e-300, 1e300, 5e-324, NAN, INFINITY, -INFINITY, 3.14159};

static uint64_t invented(void) {
  switch (any() % 5) {
    case 0: return any();
    case 1: return g[any() % N].id;
    case 2: return p[any() % N].id ^ 1ull << any() % 64;
    case 3: return c[any() % N].id;
    default: return 0;
  }
}
/* A count that the arrays below hold, or one that no array holds. */
static size_t count_of(size_t most) { return any() % 32 ? any() % (most + 1) : any() % 2 ? SIZE_MAX - any() % 64 : SIZE_MAX / 2 + 1 + any() % 64; }
/* A size that is at most that of a struct. */
static size_t size_of(size_t size) { return any() % 8 ? size : any() % (size + 1); }
#define MAYBE(pointer) (any() % 48 ? (pointer) : NULL)
#define ID (any() % 24 ? i : j)

static lc_status geometry_call(int i, int j) {
  uint32_t t[24], sizes[4];
  uint16_t cells[24];
  lc_pose q[4];
  lc_geometry_info info;
  double out[6];
  for (int n = 0; n < 24; ++n) t[n] = any() % 6, cells[n] = (uint16_t)(any() % 5);
  for (int n = 0; n < 4; ++n) q[n] = here, q[n].translation[0] = v[n], sizes[n] = any() % 5;
  lc_mesh_repair repair;
  switch (any() % 16) {
    case 0: return lc_hull_new(MAYBE(v), count_of(20), NULL, NULL, MAYBE(&g[i]));
    case 1: return lc_polygon_new(MAYBE(v), count_of(8), MAYBE(&g[i]));
    case 2: return lc_faces_new(v, count_of(8), MAYBE(sizes), count_of(4), t, count_of(24), &g[i]);
    case 3: case 4: return lc_shape_new(any() % 12, MAYBE(v), count_of(6), MAYBE(&g[i]));
    case 5: return lc_rounded_new(g[j], v[0], MAYBE(&g[i]));
    case 6: return j + 4 > N ? LC_OK : lc_compound_new(MAYBE(&g[j]), q, count_of(4), &g[i]);
    case 7: return lc_mesh_new(MAYBE(v), count_of(8), any() % 3 ? t : &faces[0][0], count_of(8), NULL, NULL, &g[i]);
    case 8: return lc_heights_new(MAYBE(v), count_of(5), count_of(5), v[60], v[61], any() % 2 ? &v[62] : NULL, &g[i]);
    case 9: return lc_cloud_new(MAYBE(v), count_of(20), v[70], any() % 2 ? v + 40 : NULL, &g[i]);
    case 10: return lc_voxels_new(MAYBE(v), v + 3, MAYBE(cells), count_of(8), &g[i]);
    case 11: return lc_surface_new(any() % 3, any() % 3, MAYBE(v), any() % 2 ? v : NULL, count_of(3), &g[i]);
    case 12: return any() % 2 ? lc_geometry_get_info(g[i], MAYBE(&info), size_of(sizeof info)) : lc_geometry_box(g[i], q, MAYBE(out));
    case 13: return lc_mesh_repaired_new(MAYBE(v), count_of(8), t, count_of(8), v[60], NULL, NULL, MAYBE(&g[i]));
    case 14: return lc_geometry_get_repair(g[i], MAYBE(&repair), size_of(sizeof repair));
    default: return lc_geometry_free(g[i]);
  }
}

static lc_status pair_call(int i, int j) {
  lc_pose q[4];
  lc_answer answers[4];
  lc_contact contacts[4];
  lc_penetration depth;
  lc_overlap_volume volume;
  lc_cast cast;
  lc_ray rays[4];
  lc_ray_hit hits[4];
  uint32_t within;
  size_t done;
  char *text = NULL;
  for (int n = 0; n < 4; ++n) {
    q[n] = here;
    for (int m = 0; m < 3; ++m) q[n].translation[m] = 2 * v[4 * n + m];
    if (any() % 16 == 0) q[n].rotation[any() % 4] = v[60];
    for (int m = 0; m < 3; ++m) rays[n].origin[m] = 3 * v[8 * n + m], rays[n].direction[m] = v[9 * n + m + 3];
    rays[n].length = any() % 2 ? 9 : v[71];
  }
  lc_pose *pose = MAYBE(q);
  switch (any() % 13) {
    case 0: if (any() % 8 == 0) return lc_pair_reset(p[i]); /* fallthrough */
    case 1: return lc_pair_new(g[i], g[j], MAYBE(&p[any() % N]));
    case 2: return lc_pair_free(p[i]);
    case 3: case 4: return lc_pair_ask(p[i], pose, &q[1], (uint32_t)any(), MAYBE(answers), size_of(sizeof *answers));
    case 5: {
      const size_t strides[] = {0, sizeof *q, 8, 57, 9};
      const size_t stride = strides[any() % 5];
      return lc_pair_ask_many(p[i], pose, stride, q, sizeof *q, count_of(stride > sizeof *q ? 3 : 4), (uint32_t)any(), MAYBE(answers), size_of(sizeof *answers), &done);
    }
    case 6: return lc_pair_within(p[i], pose, &q[1], v[50], MAYBE(&within));
    case 7: return lc_pair_contacts(p[i], pose, &q[1], fabs(v[51]) > 1 ? v[51] : .1, any() % 10, MAYBE(contacts), size_of(sizeof *contacts), count_of(4), &done);
    case 8: return lc_pair_penetration(p[i], pose, &q[1], MAYBE(&depth), size_of(sizeof depth));
    case 11: return lc_pair_overlap(p[i], pose, &q[1], MAYBE(&volume), size_of(sizeof volume));
    case 9: {
      lc_motion from = {q[0], {v[20], v[21], v[22]}, {v[23], v[24], v[25]}}, to = {q[1], {0, 0, 0}, {v[26], 0, 0}};
      lc_cast_options o = {any() % 4 ? 1 : v[27], any() % 4 ? 1e-6 : v[28], any() % 4 ? 0 : v[29], v[30], any() % 4, 0};
      return lc_pair_cast(p[i], MAYBE(&from), &to, MAYBE(&o), size_of(sizeof o), &cast, size_of(sizeof cast));
    }
    case 10: {
      lc_status status = lc_pair_replay(p[i], pose, q, MAYBE(&text));
      if (text && any() % 2) text[any() % strlen(text)] = (char)(33 + any() % 90);
      if (text) lc_replay_answer(text, 7, answers, size_of(sizeof *answers));
      lc_text_free(text);
      return status;
    }
    default: return lc_ray_cast_many(g[i], pose, MAYBE(rays), count_of(4), hits, size_of(sizeof *hits), &done);
  }
}

static lc_status scene_call(int i, int j) {
  lc_pose q[4];
  lc_event events[4];
  lc_impact impacts[4];
  lc_scene_pair found[4];
  lc_ray ray = {{3 * v[0], 3 * v[1], 3 * v[2]}, {v[3], v[4], v[5]}, any() % 4 ? 9 : v[6]};
  lc_ray_hit hit;
  size_t count;
  for (int n = 0; n < 4; ++n) {
    q[n] = here;
    for (int m = 0; m < 3; ++m) q[n].translation[m] = 3 * v[4 * n + m];
    if (any() % 32 == 0) q[n].rotation[any() % 4] = v[60];
  }
  switch (any() % 16) {
    case 0: return any() % 4 ? LC_OK : lc_scene_new(MAYBE(&s[i]));
    case 1: return any() % 8 ? LC_OK : lc_scene_free(s[i]);
    case 2: {
      lc_queries o = {any() % 512, 0, any() % 4 ? .25 : v[10], any() % 4 ? 1 : v[11], any() % 4 ? 1e-6 : v[12], any() % 4 ? .1 : v[13]};
      return lc_scene_set_queries(s[i], any() % 3, any() % 34, MAYBE(&o), size_of(sizeof o));
    }
    case 3: case 4: return lc_scene_add(s[i], g[j], MAYBE(q), any() % 34, any() % 2, MAYBE(&b[any() % N]));
    case 5: return lc_scene_remove(s[i], b[j]);
    case 6: return j + 4 > N ? LC_OK : lc_scene_set_poses(s[i], MAYBE(&b[j]), q, any() % 2 ? sizeof *q : 0, count_of(4));
    case 7: return lc_scene_pose(s[i], b[j], MAYBE(q));
    case 8: return lc_scene_set_velocity(s[i], b[j], MAYBE(v), v + 3);
    case 9: return lc_scene_exclude(s[i], b[i], b[j], any() % 2);
    case 10: return lc_scene_advance(s[i], any() % 4 ? .05 : v[13]);
    case 11: return lc_scene_step(s[i]);
    case 12: return lc_scene_events(s[i], MAYBE(events), size_of(sizeof *events), count_of(4), &count);
    case 13: return any() % 2 ? lc_scene_impacts(s[i], MAYBE(impacts), size_of(sizeof *impacts), count_of(4), &count)
                              : lc_scene_pairs(s[i], MAYBE(found), size_of(sizeof *found), count_of(4), &count);
    case 14: return lc_scene_closest_pair(s[i], any() % 3, any() % 3, MAYBE(found), size_of(sizeof *found));
    default: return lc_scene_cast_ray(s[i], MAYBE(&ray), (uint32_t)any(), &hit, size_of(sizeof hit));
  }
}

static lc_status checker_call(int i, int j) {
  static const char *names[] = {"body", "wall", "", "no such name", "\xff"};
  const char *name = names[any() % 5];
  const double bounds[6] = {-9, 9, -9, 9, -9, any() % 8 ? 9 : v[0]};
  lc_pose q = here;
  lc_near near[8];
  lc_verdict verdicts[4];
  lc_checker_info info;
  lc_check_work work;
  lc_world_body found[4];
  double low[8], high[8], gradients[64];
  uint8_t is_free[8];
  static const size_t coordinates[] = {2, 3, 3, 7};
  size_t done, n = any() % 12 ? coordinates[any() % 4] : any() % 9;
  char *text = NULL;
  for (int m = 0; m < 3; ++m) q.translation[m] = 5 * v[m];
  if (any() % 32 == 0) q.rotation[any() % 4] = v[60];
  if (n == 7 && any() % 8) for (int k = 0; k < 4; ++k) v[7 * k + 3] = v[7 * k + 4] = v[7 * k + 5] = 0, v[7 * k + 6] = 1;
  switch (any() % 23) {
    case 22: {
      const char *packages[] = {".", "", "\xff"};
      const char *paths[] = {"hostile.urdf", "hostile.srdf", "hostile.json", "hostile.urdf", "no such file", ".", "\xff"};
      lc_robot_files files = {any() % 4 ? paths[0] : MAYBE(paths[any() % 7]), any() % 2 ? NULL : paths[any() % 7],
                              any() % 2 ? NULL : paths[any() % 7], any() % 2 ? NULL : packages, any() % 4, any() % 8, 0};
      if (!files.packages && any() % 8) files.package_count = 0;
      return any() % 4 ? LC_OK : lc_checker_load(MAYBE(&files), size_of(sizeof files), MAYBE(&c[j]));
    }
    case 0: return any() % 2 ? LC_OK : lc_checker_new_body(g[i], MAYBE(bounds), any() % 2 ? 0 : v[9], MAYBE(&c[j]));
    case 1: return any() % 8 ? LC_OK : lc_checker_free(c[i]);
    case 2: return any() % 4 ? LC_OK : lc_checker_copy(c[i], MAYBE(&c[j]));
    case 3: return lc_checker_get_info(c[i], MAYBE(&info), size_of(sizeof info));
    case 4: return lc_checker_limits(c[i], MAYBE(low), high, count_of(8), &done);
    case 5: { lc_status status = lc_checker_coordinate_name(c[i], any() % 9, MAYBE(&text)); lc_text_free(text); return status; }
    case 6: { lc_status status = lc_checker_body_name(c[i], w[j], MAYBE(&text)); lc_text_free(text); return status; }
    case 7: return lc_checker_find(c[i], MAYBE(name), MAYBE(found), count_of(4), &done);
    case 8: return lc_checker_obstacle_add(c[i], MAYBE(name), g[j], MAYBE(&q), MAYBE(&w[any() % N]));
    case 9: return lc_checker_obstacle_move(c[i], w[j], MAYBE(&q));
    case 10: return lc_checker_remove(c[i], w[j]);
    case 11: return lc_checker_attach(c[i], MAYBE(name), name, g[j], MAYBE(&q), MAYBE(names), count_of(3), &w[any() % N]);
    case 12: return lc_checker_exclude(c[i], w[i], w[j], any() % 2);
    case 13: return lc_checker_set_margin(c[i], any() % 2 ? 0 : v[14]);
    case 14: return any() % 2 ? lc_checker_set_pair_margin(c[i], w[i], w[j], v[15]) : lc_checker_set_start_contact(c[i], v[15]);
    case 15: return lc_checker_pose(c[i], w[j], MAYBE(v), n, MAYBE(&q));
    case 16: return lc_checker_free_at_many(c[i], MAYBE(v), n, count_of(8), MAYBE(is_free), &done);
    case 17: return lc_checker_clearance_many(c[i], MAYBE(v), n, count_of(8), MAYBE(near), size_of(sizeof *near), any() % 2 ? gradients : NULL, &done);
    case 18: return lc_checker_nearest_many(c[i], v, n, any() % 5, any() % 3, any() % 2 ? INFINITY : v[16], any() % 4, MAYBE(near), size_of(sizeof *near), any() % 2 ? gradients : NULL);
    case 19: return lc_checker_certify_many(c[i], v, MAYBE(v + 20), n, count_of(4), verdicts, size_of(sizeof *verdicts), &done);
    case 20: return any() % 2 ? lc_checker_certify_path(c[i], v, n, count_of(4), verdicts, size_of(sizeof *verdicts))
                              : lc_checker_certify_curve(c[i], v, n, count_of(4), verdicts, size_of(sizeof *verdicts));
    default: {
      lc_plan_options o = {any(), 1 + any() % 3, 100, any() % 4, 1 + any() % 9, any() % 16 ? any() % 3 : any(), 0};
      lc_status status = lc_checker_plan(c[i], v, MAYBE(v + 7), n, MAYBE(&o), size_of(sizeof o), NULL, NULL, &done);
      if (status == LC_OK) lc_checker_path(c[i], gradients, n, n ? 64 / n : 1, &done);
      return any() % 2 ? status : lc_checker_get_work(c[i], MAYBE(&work), size_of(sizeof work));
    }
  }
}

static void file(const char *path, const char *text) {
  FILE *out = fopen(path, "w");
  TRUE(out && fputs(text, out) >= 0);
  if (out) fclose(out);
}

static void fuzz(long calls) {
  TRUE(lc_abi() == LC_ABI && strlen(lc_version()) > 4);
  file("hostile.urdf",
       "<robot name='two'><link name='body'><collision><geometry><box size='.2 .2 .2'/></geometry></collision></link>"
       "<link name='upper'><collision><origin xyz='.5 0 0'/><geometry><box size='.5 .1 .1'/></geometry></collision></link>"
       "<link name='lower'><collision><origin xyz='.5 0 0'/><geometry><sphere radius='.1'/></geometry></collision></link>"
       "<joint name='one' type='revolute'><parent link='body'/><child link='upper'/><axis xyz='0 0 1'/>"
       "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>"
       "<joint name='two' type='prismatic'><parent link='upper'/><child link='lower'/><axis xyz='1 0 0'/>"
       "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>");
  file("hostile.srdf", "<robot name='two'><disable_collisions link1='body' link2='lower' reason='Never'/></robot>");
  file("hostile.json", "{\"bodies\": [{\"name\": \"wall\", \"box\": {\"size\": [1, 1, 1]}, \"xyz\": [0, 2, 0]}]}");
  long by[8] = {0};
  for (int k = 0; k < N; ++k) g[k] = box(.25 + .01 * k);
  for (int k = 0; k < 4; ++k) EXPECT(lc_scene_new(&s[k]), LC_OK);
  for (long k = 0; k < calls; ++k) {
    int i = any() % N, j = any() % N;
    for (int n = 0; n < 96; ++n) v[n] = any() % 24 ? (double)(int64_t)any() / 9.3e18 : odd[any() % 12];
    if (any() % 96 == 0) g[i].id = invented();
    if (any() % 96 == 0) p[i].id = invented();
    if (any() % 96 == 0) s[i].id = invented();
    if (any() % 96 == 0) c[i].id = invented();
    if (any() % 96 == 0) b[i].id = invented();
    if (any() % 96 == 0) w[i].id = any() % 2 ? any() : (1 + any() % 3) << 56 | any() % 3;
    lc_status status = LC_OK;
    switch (any() % 8) {
      case 0: case 1: status = geometry_call(ID, j); break;
      case 2: case 3: status = pair_call(ID, j); break;
      case 4: case 5: status = scene_call(any() % 3 ? i % 6 : i, j); break;
      default: status = checker_call(any() % 3 ? i % 6 : i, any() % 2 ? j % 6 : j); break;
    }
    if ((int)status < 0 || (int)status > 7) ++failures; else ++by[status];
    if (status == LC_PANIC) {
      ++failures;
      printf("call %ld: %s\n", k, lc_last_error());
    }
  }
  printf("%ld calls by status:", calls);
  for (int k = 0; k < 8; ++k) printf(" %ld", by[k]);
  printf("; %llu objects live\n", (unsigned long long)lc_live());
}

int main(int argc, char **argv) {
  if (argc < 3) return printf("usage: hostile COPY CALLS [SEED]\n"), 2;
  if (argc > 3) x = strtoull(argv[3], NULL, 10) * 2 + 1;
  pairs();
  scenes_and_checkers();
  callbacks();
  modes();
#if LIMITS
  if (!getenv("VALGRIND")) no_threads();
#endif
  threads();
  copies(argv[1]);
  fuzz(atol(argv[2]));
  puts(failures ? "FAILED" : "ok");
  return failures != 0;
}
