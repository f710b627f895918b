// C++17 over lin_canny.h: owners that move, views of arrays, exceptions. Header only.
//
// A method calls the function of the C interface that its body names; the comments there hold. An error throws
// lin_canny::Error. Functions without a method take the handle that get() returns.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "lin_canny.h"

namespace lin_canny {

/// An error of the library: its status, and its message as what().
class Error : public std::runtime_error {
 public:
  Error(lc_status status, const char *message) : std::runtime_error(message), status_(status) {}
  lc_status status() const noexcept { return status_; }

 private:
  lc_status status_;
};

/// Throws the error of a status.
inline void check(lc_status status) {
  if (status != LC_OK) throw Error(status, lc_last_error());
}

/// A view of contiguous elements, as std::span of C++20. It does not keep them alive.
template <class T>
class Span {
 public:
  constexpr Span() noexcept = default;
  constexpr Span(const T *data, std::size_t size) noexcept : data_(data), size_(size) {}
  template <std::size_t N>
  constexpr Span(const std::array<T, N> &a) noexcept : data_(a.data()), size_(N) {}
  template <std::size_t N>
  constexpr Span(const T (&a)[N]) noexcept : data_(a), size_(N) {}
  Span(const std::vector<T> &v) noexcept : data_(v.data()), size_(v.size()) {}
  constexpr const T *data() const noexcept { return data_; }
  constexpr std::size_t size() const noexcept { return size_; }
  constexpr const T *begin() const noexcept { return data_; }
  constexpr const T *end() const noexcept { return data_ + size_; }

 private:
  const T *data_ = nullptr;
  std::size_t size_ = 0;
};

using Point = std::array<double, 3>;
using Triangle = std::array<std::uint32_t, 3>;
using Cell = std::array<std::uint16_t, 3>;
static_assert(sizeof(Point) == 24 && sizeof(Triangle) == 12 && sizeof(Cell) == 6, "arrays of arrays are flat");

/// The pose of the world.
inline constexpr lc_pose identity{{0, 0, 0}, {0, 0, 0, 1}};

/// A pose without rotation.
constexpr lc_pose at(double x, double y, double z) noexcept { return {{x, y, z}, {0, 0, 0, 1}}; }

/// An answer of three values. It has no conversion to bool, because neither value of a bool is undecided.
enum class Decision { No, Yes, Undecided };

/// Reports a long call; false stops it. It may throw: the exception leaves the call that runs it.
using Progress = std::function<bool(const char *stage, std::uint64_t done, std::uint64_t total)>;

namespace detail {

inline const double *flat(Span<Point> points) noexcept { return points.size() ? points.data()->data() : nullptr; }

inline const std::uint32_t *flat(Span<Triangle> triangles) noexcept {
  return triangles.size() ? triangles.data()->data() : nullptr;
}

/// Carries a callback over the border, where no exception may pass.
struct Reporter {
  const Progress *progress;
  std::exception_ptr thrown;

  explicit Reporter(const Progress &p) : progress(&p) {}
  lc_progress callback() const noexcept { return *progress ? call : nullptr; }

  void finish(lc_status status) const {
    if (thrown) std::rethrow_exception(thrown);
    check(status);
  }

  static std::int32_t call(void *context, const char *stage, std::uint64_t done, std::uint64_t total) noexcept {
    auto &reporter = *static_cast<Reporter *>(context);
    try {
      return (*reporter.progress)(stage, done, total) ? 0 : 1;
    } catch (...) {
      reporter.thrown = std::current_exception();
      return 1;
    }
  }
};

/// Takes a text of the library.
inline std::string taken(char *text) {
  struct Free {
    char *text;
    ~Free() { lc_text_free(text); }
  } free{text};
  return text;
}

/// Calls until the capacity suffices for all elements.
template <class T, class Call>
std::vector<T> all(Call call) {
  std::vector<T> found(16);
  std::size_t count = 0;
  check(call(found.data(), found.size(), &count));
  while (count > found.size()) {
    found.resize(count);
    check(call(found.data(), found.size(), &count));
  }
  found.resize(count);
  return found;
}

}  // namespace detail

/// Owns a handle: moves, never copies.
template <class H, lc_status (*Free)(H)>
class Owner {
 public:
  Owner() noexcept = default;
  explicit Owner(H handle) noexcept : handle_(handle) {}
  Owner(Owner &&other) noexcept : handle_(std::exchange(other.handle_, H{0})) {}
  /// Frees the old handle. A move of an owner to itself changes nothing.
  Owner &operator=(Owner &&other) noexcept {
    Owner taken(std::move(other));
    std::swap(handle_, taken.handle_);
    return *this;
  }
  Owner(const Owner &) = delete;
  Owner &operator=(const Owner &) = delete;
  ~Owner() {
    const lc_status status = Free(handle_);
    assert(status == LC_OK && "freed during a call with it");
    (void)status;
  }
  H get() const noexcept { return handle_; }
  explicit operator bool() const noexcept { return handle_.id != 0; }

 private:
  H handle_{0};
};

class Geometry : public Owner<lc_geometry, lc_geometry_free> {
 public:
  using Owner::Owner;
  static Geometry hull(Span<Point> points, const Progress &progress = {}) {
    lc_geometry g{0};
    detail::Reporter reporter(progress);
    reporter.finish(lc_hull_new(detail::flat(points), points.size(), reporter.callback(), &reporter, &g));
    return Geometry(g);
  }
  static Geometry polygon(Span<Point> points) {
    lc_geometry g{0};
    check(lc_polygon_new(detail::flat(points), points.size(), &g));
    return Geometry(g);
  }
  static Geometry faces(Span<Point> points, Span<std::uint32_t> sizes, Span<std::uint32_t> indices) {
    lc_geometry g{0};
    check(lc_faces_new(detail::flat(points), points.size(), sizes.data(), sizes.size(), indices.data(),
                       indices.size(), &g));
    return Geometry(g);
  }
  static Geometry box(double half_x, double half_y, double half_z) { return shape(LC_BOX, {half_x, half_y, half_z}); }
  static Geometry ball(double radius) { return shape(LC_BALL, {radius}); }
  static Geometry capsule(double half_length, double radius) { return shape(LC_CAPSULE, {half_length, radius}); }
  static Geometry cylinder(double half_height, double radius) { return shape(LC_CYLINDER, {half_height, radius}); }
  static Geometry cone(double half_height, double radius) { return shape(LC_CONE, {half_height, radius}); }
  static Geometry ellipsoid(double x, double y, double z) { return shape(LC_ELLIPSOID, {x, y, z}); }
  static Geometry half_space(Point normal, double offset) {
    return shape(LC_HALF_SPACE, {normal[0], normal[1], normal[2], offset});
  }
  static Geometry point(Point p) { return shape(LC_POINT, {p[0], p[1], p[2]}); }
  static Geometry segment(Point a, Point b) { return shape(LC_SEGMENT, {a[0], a[1], a[2], b[0], b[1], b[2]}); }
  static Geometry mesh(Span<Point> points, Span<Triangle> triangles, const Progress &progress = {}) {
    lc_geometry g{0};
    detail::Reporter reporter(progress);
    reporter.finish(lc_mesh_new(detail::flat(points), points.size(), detail::flat(triangles), triangles.size(),
                                reporter.callback(), &reporter, &g));
    return Geometry(g);
  }
  /// A solid from any triangles; `repair` says what was changed.
  static Geometry repaired_mesh(Span<Point> points, Span<Triangle> triangles, double weld = 0,
                                const Progress &progress = {}) {
    lc_geometry g{0};
    detail::Reporter reporter(progress);
    reporter.finish(lc_mesh_repaired_new(detail::flat(points), points.size(), detail::flat(triangles), triangles.size(),
                                         weld, reporter.callback(), &reporter, &g));
    return Geometry(g);
  }
  /// Row by row; with a base the mesh is a solid.
  static Geometry heights(Span<double> heights, std::size_t rows, std::size_t columns, double dx, double dy,
                          std::optional<double> base = {}) {
    if (heights.size() != rows * columns) throw std::invalid_argument("number of heights is not rows * columns");
    lc_geometry g{0};
    check(lc_heights_new(heights.data(), rows, columns, dx, dy, base ? &*base : nullptr, &g));
    return Geometry(g);
  }
  static Geometry cloud(Span<Point> points, double radius = 0) {
    lc_geometry g{0};
    check(lc_cloud_new(detail::flat(points), points.size(), radius, nullptr, &g));
    return Geometry(g);
  }
  /// A ball of its own radius at each point.
  static Geometry cloud(Span<Point> points, Span<double> radii) {
    if (points.size() != radii.size()) throw std::invalid_argument("number of points is not that of radii");
    lc_geometry g{0};
    check(lc_cloud_new(detail::flat(points), points.size(), 0, radii.data(), &g));
    return Geometry(g);
  }
  /// Boxes of the sides `size` at the occupied cells of a grid whose cell 0, 0, 0 starts at `origin`.
  static Geometry voxels(Point origin, Point size, Span<Cell> cells) {
    lc_geometry g{0};
    const std::uint16_t *data = cells.size() ? cells.data()->data() : nullptr;
    check(lc_voxels_new(origin.data(), size.data(), data, cells.size(), &g));
    return Geometry(g);
  }
  /// Bézier patches of the degrees p and q, one after another; without weights they are polynomial.
  static Geometry surface(std::uint32_t p, std::uint32_t q, Span<Point> points, Span<double> weights = {}) {
    const std::uint64_t net = (std::uint64_t{p} + 1) * (std::uint64_t{q} + 1);
    if (net == 0 || points.size() % net != 0) throw std::invalid_argument("number of points is not a multiple of (p + 1) (q + 1)");
    if (weights.size() != 0 && weights.size() != points.size()) {
      throw std::invalid_argument("number of points is not that of weights");
    }
    lc_geometry g{0};
    check(lc_surface_new(p, q, detail::flat(points), weights.data(), static_cast<std::size_t>(points.size() / net), &g));
    return Geometry(g);
  }
  static Geometry compound(Span<lc_geometry> pieces, Span<lc_pose> poses) {
    if (pieces.size() != poses.size()) throw std::invalid_argument("number of pieces is not that of poses");
    lc_geometry g{0};
    check(lc_compound_new(pieces.data(), poses.data(), pieces.size(), &g));
    return Geometry(g);
  }
  Geometry rounded(double radius) const {
    lc_geometry g{0};
    check(lc_rounded_new(get(), radius, &g));
    return Geometry(g);
  }
  lc_geometry_info info() const {
    lc_geometry_info found;
    check(lc_geometry_get_info(get(), &found, sizeof found));
    return found;
  }
  /// What the repair of a mesh has changed; zeros if the geometry was not repaired.
  lc_mesh_repair repair() const {
    lc_mesh_repair found;
    check(lc_geometry_get_repair(get(), &found, sizeof found));
    return found;
  }
  /// The least corner and the greatest.
  std::array<Point, 2> bounding_box(const lc_pose &pose = identity) const {
    std::array<Point, 2> found;
    check(lc_geometry_box(get(), &pose, found[0].data()));
    return found;
  }
  lc_ray_hit cast_ray(const lc_ray &ray, const lc_pose &pose = identity) const {
    lc_ray_hit found;
    std::size_t done = 0;
    check(lc_ray_cast_many(get(), &pose, &ray, 1, &found, sizeof found, &done));
    return found;
  }

 private:
  static Geometry shape(std::uint32_t kind, std::initializer_list<double> parameters) {
    lc_geometry g{0};
    check(lc_shape_new(kind, parameters.begin(), parameters.size(), &g));
    return Geometry(g);
  }
};

class Pair : public Owner<lc_pair, lc_pair_free> {
 public:
  Pair() noexcept = default;
  Pair(const Geometry &a, const Geometry &b) : Owner(make(a, b)) {}
  /// Witness points and normal are in the world.
  lc_answer closest(const lc_pose &a, const lc_pose &b) { return ask(a, b, LC_DISTANCE | LC_POINTS | LC_FEATURES); }
  lc_answer ask(const lc_pose &a, const lc_pose &b, std::uint32_t wanted) {
    lc_answer found;
    check(lc_pair_ask(get(), &a, &b, wanted, &found, sizeof found));
    return found;
  }
  /// B at many poses.
  std::vector<lc_answer> ask_many(const lc_pose &a, Span<lc_pose> b, std::uint32_t wanted) {
    std::vector<lc_answer> found(b.size());
    std::size_t done = 0;
    check(lc_pair_ask_many(get(), &a, 0, b.data(), sizeof(lc_pose), b.size(), wanted, found.data(), sizeof(lc_answer),
                           &done));
    return found;
  }
  /// True unless the geometries are proven to be more than the distance apart.
  bool within(const lc_pose &a, const lc_pose &b, double distance) {
    return decide_within(a, b, distance) != Decision::No;
  }
  /// True unless the geometries are proven to share no point.
  bool intersects(const lc_pose &a, const lc_pose &b) { return within(a, b, 0); }
  /// Whether the geometries are at most the distance apart; a Bézier surface may leave it undecided.
  Decision decide_within(const lc_pose &a, const lc_pose &b, double distance) {
    std::uint32_t found = LC_UNDECIDED;
    check(lc_pair_within(get(), &a, &b, distance, &found));
    return found == 0 ? Decision::No : found == 1 ? Decision::Yes : Decision::Undecided;
  }
  std::vector<lc_contact> contacts(const lc_pose &a, const lc_pose &b, double prediction, std::uint32_t max_points = 4) {
    return detail::all<lc_contact>([&](lc_contact *out, std::size_t capacity, std::size_t *count) {
      return lc_pair_contacts(get(), &a, &b, prediction, max_points, out, sizeof *out, capacity, count);
    });
  }
  lc_overlap_volume overlap(const lc_pose &a, const lc_pose &b) {
    lc_overlap_volume found;
    check(lc_pair_overlap(get(), &a, &b, &found, sizeof found));
    return found;
  }

  lc_penetration penetration(const lc_pose &a, const lc_pose &b) {
    lc_penetration found;
    check(lc_pair_penetration(get(), &a, &b, &found, sizeof found));
    return found;
  }
  lc_cast cast(const lc_motion &a, const lc_motion &b, const lc_cast_options &options) {
    lc_cast found;
    check(lc_pair_cast(get(), &a, &b, &options, sizeof options, &found, sizeof found));
    return found;
  }
  std::string replay(const lc_pose &a, const lc_pose &b) {
    char *text = nullptr;
    check(lc_pair_replay(get(), &a, &b, &text));
    return detail::taken(text);
  }
  /// The answer of a text of replay(), in this or another process.
  static lc_answer answer_of(const std::string &replay, std::uint32_t wanted = LC_DISTANCE | LC_POINTS | LC_FEATURES) {
    lc_answer found;
    check(lc_replay_answer(replay.c_str(), wanted, &found, sizeof found));
    return found;
  }
  void reset() { check(lc_pair_reset(get())); }

 private:
  static lc_pair make(const Geometry &a, const Geometry &b) {
    lc_pair p{0};
    check(lc_pair_new(a.get(), b.get(), &p));
    return p;
  }
};

class Scene : public Owner<lc_scene, lc_scene_free> {
 public:
  Scene() : Owner(make()) {}
  void set_queries(std::uint32_t group_a, std::uint32_t group_b, const lc_queries &queries) {
    check(lc_scene_set_queries(get(), group_a, group_b, &queries, sizeof queries));
  }
  lc_body add(const Geometry &geometry, const lc_pose &pose, std::uint32_t group = 0, bool fixed = false) {
    lc_body body{0};
    check(lc_scene_add(get(), geometry.get(), &pose, group, fixed, &body));
    return body;
  }
  void remove(lc_body body) { check(lc_scene_remove(get(), body)); }
  void set_pose(lc_body body, const lc_pose &pose) { check(lc_scene_set_poses(get(), &body, &pose, sizeof pose, 1)); }
  void set_poses(Span<lc_body> bodies, Span<lc_pose> poses) {
    if (bodies.size() != poses.size()) throw std::invalid_argument("number of bodies is not that of poses");
    check(lc_scene_set_poses(get(), bodies.data(), poses.data(), sizeof(lc_pose), bodies.size()));
  }
  lc_pose pose(lc_body body) const {
    lc_pose found;
    check(lc_scene_pose(get(), body, &found));
    return found;
  }
  void set_velocity(lc_body body, Point linear, Point angular) {
    check(lc_scene_set_velocity(get(), body, linear.data(), angular.data()));
  }
  void exclude(lc_body a, lc_body b, bool excluded = true) { check(lc_scene_exclude(get(), a, b, excluded)); }
  void advance(double time) { check(lc_scene_advance(get(), time)); }
  void step() { check(lc_scene_step(get())); }
  std::vector<lc_event> events() const { return list<lc_event>(lc_scene_events); }
  std::vector<lc_impact> impacts() const { return list<lc_impact>(lc_scene_impacts); }
  std::vector<lc_scene_pair> pairs() const { return list<lc_scene_pair>(lc_scene_pairs); }
  std::optional<lc_scene_pair> closest_pair(std::uint32_t group_a, std::uint32_t group_b) const {
    lc_scene_pair found;
    check(lc_scene_closest_pair(get(), group_a, group_b, &found, sizeof found));
    return found.a.id ? std::optional<lc_scene_pair>(found) : std::nullopt;
  }
  lc_ray_hit cast_ray(const lc_ray &ray, std::uint32_t groups = 0xffffffffu) const {
    lc_ray_hit found;
    check(lc_scene_cast_ray(get(), &ray, groups, &found, sizeof found));
    return found;
  }

 private:
  static lc_scene make() {
    lc_scene s{0};
    check(lc_scene_new(&s));
    return s;
  }
  template <class T>
  std::vector<T> list(lc_status (*call)(lc_scene, T *, std::size_t, std::size_t, std::size_t *)) const {
    return detail::all<T>([&](T *out, std::size_t capacity, std::size_t *count) {
      return call(get(), out, sizeof *out, capacity, count);
    });
  }
};

/// A configuration has as many numbers as `coordinates()`.
class Checker : public Owner<lc_checker, lc_checker_free> {
 public:
  Checker() noexcept = default;
  explicit Checker(lc_checker handle) : Owner(handle), info_(read(handle)) {}
  /// A robot and its cell from files; `srdf` and `cell` may be null.
  static Checker load(const char *robot, const char *srdf = nullptr, const char *cell = nullptr) {
    lc_robot_files files{};
    files.robot = robot;
    files.srdf = srdf;
    files.cell = cell;
    return load(files);
  }
  static Checker load(const lc_robot_files &files) {
    lc_checker c{0};
    check(lc_checker_load(&files, sizeof files, &c));
    return Checker(c);
  }
  /// One body in a box of space: least and greatest x, y, z. A radius above zero lets it turn.
  static Checker body(const Geometry &body, const std::array<double, 6> &bounds, double radius = 0) {
    lc_checker c{0};
    check(lc_checker_new_body(body.get(), bounds.data(), radius, &c));
    return Checker(c);
  }
  /// A checker of the same world for another thread.
  Checker copy() const {
    lc_checker c{0};
    check(lc_checker_copy(get(), &c));
    return Checker(c);
  }
  std::size_t coordinates() const noexcept { return info_.coordinates; }
  std::size_t degrees_of_freedom() const noexcept { return info_.degrees_of_freedom; }
  /// Least and greatest value of each coordinate of position; those of a turn are not limited and left out.
  std::array<std::vector<double>, 2> limits() const {
    std::array<std::vector<double>, 2> found{std::vector<double>(coordinates()), std::vector<double>(coordinates())};
    std::size_t count = 0;
    check(lc_checker_limits(get(), found[0].data(), found[1].data(), coordinates(), &count));
    for (auto &side : found) side.resize(count);
    return found;
  }
  std::string coordinate_name(std::size_t index) const {
    char *text = nullptr;
    check(lc_checker_coordinate_name(get(), index, &text));
    return detail::taken(text);
  }
  std::string name(lc_world_body body) const {
    char *text = nullptr;
    check(lc_checker_body_name(get(), body, &text));
    return detail::taken(text);
  }
  std::vector<lc_world_body> find(const char *name) const {
    return detail::all<lc_world_body>([&](lc_world_body *out, std::size_t capacity, std::size_t *count) {
      return lc_checker_find(get(), name, out, capacity, count);
    });
  }
  lc_world_body add_obstacle(const char *name, const Geometry &geometry, const lc_pose &pose) {
    lc_world_body added{0};
    check(lc_checker_obstacle_add(get(), name, geometry.get(), &pose, &added));
    return added;
  }
  void move_obstacle(lc_world_body body, const lc_pose &pose) { check(lc_checker_obstacle_move(get(), body, &pose)); }
  void remove(lc_world_body body) { check(lc_checker_remove(get(), body)); }
  lc_world_body attach(const char *link, const char *name, const Geometry &geometry, const lc_pose &pose,
                       Span<const char *> touch_links = {}) {
    lc_world_body added{0};
    check(lc_checker_attach(get(), link, name, geometry.get(), &pose, touch_links.data(), touch_links.size(), &added));
    return added;
  }
  void exclude(lc_world_body a, lc_world_body b, bool excluded = true) {
    check(lc_checker_exclude(get(), a, b, excluded));
  }
  /// The pose of a body in the world at a configuration.
  lc_pose pose(lc_world_body body, Span<double> q) const {
    lc_pose found;
    check(lc_checker_pose(get(), body, q.data(), q.size(), &found));
    return found;
  }
  void set_margin(double margin) { check(lc_checker_set_margin(get(), margin)); }
  void set_pair_margin(lc_world_body a, lc_world_body b, double margin) {
    check(lc_checker_set_pair_margin(get(), a, b, margin));
  }
  void set_start_contact(double margin) { check(lc_checker_set_start_contact(get(), margin)); }
  /// Proven by exact predicates.
  bool is_free(Span<double> q) {
    std::uint8_t found = 0;
    std::size_t done = 0;
    check(lc_checker_free_at_many(get(), q.data(), q.size(), 1, &found, &done));
    return found != 0;
  }
  lc_near clearance(Span<double> q) {
    lc_near found;
    std::size_t done = 0;
    check(lc_checker_clearance_many(get(), q.data(), q.size(), 1, &found, sizeof found, nullptr, &done));
    return found;
  }
  struct Nearest {
    /// `columns` entries for each configuration, the closest first; an entry without a pair has `a.id` zero.
    std::vector<lc_near> pairs;
    /// The derivatives of the distance of each entry by the degrees of freedom.
    std::vector<double> gradients;
  };
  /// The closest pairs at many configurations, and no pair whose distance exceeds the least by more than `slack`.
  Nearest nearest(Span<double> q, std::size_t columns, double slack, std::size_t threads = 1) {
    const std::size_t count = rows(q);
    Nearest found{std::vector<lc_near>(count * columns), std::vector<double>(count * columns * degrees_of_freedom())};
    check(lc_checker_nearest_many(get(), q.data(), coordinates(), count, columns, slack, threads, found.pairs.data(),
                                  sizeof(lc_near), found.gradients.data()));
    return found;
  }
  /// The straight segment between two configurations, over its whole length.
  lc_verdict certify(Span<double> from, Span<double> to) {
    lc_verdict found;
    std::size_t done = 0;
    check(lc_checker_certify_many(get(), from.data(), to.data(), same(from, to), 1, &found, sizeof found, &done));
    return found;
  }
  /// `q` holds one configuration after another.
  lc_verdict certify_path(Span<double> q) {
    lc_verdict found;
    check(lc_checker_certify_path(get(), q.data(), coordinates(), rows(q), &found, sizeof found));
    return found;
  }
  /// `points` are Bézier control points, one configuration after another.
  lc_verdict certify_curve(Span<double> points) {
    lc_verdict found;
    check(lc_checker_certify_curve(get(), points.data(), coordinates(), rows(points), &found, sizeof found));
    return found;
  }
  /// A path of proven segments, one configuration after another; empty if a limit ended the search. If `progress` stops
  /// the call while it shortens the path, path() is the path so far.
  std::vector<double> plan(Span<double> start, Span<double> goal, const lc_plan_options &options = {},
                           const Progress &progress = {}) {
    detail::Reporter reporter(progress);
    std::size_t count = 0;
    reporter.finish(lc_checker_plan(get(), start.data(), goal.data(), same(start, goal), &options, sizeof options,
                                    reporter.callback(), &reporter, &count));
    return path();
  }
  /// The path of the last call of plan().
  std::vector<double> path() const {
    std::size_t count = 0;
    check(lc_checker_path(get(), nullptr, coordinates(), 0, &count));
    std::vector<double> path(count * coordinates());
    check(lc_checker_path(get(), path.data(), coordinates(), count, &count));
    return path;
  }
  lc_check_work work() const {
    lc_check_work found;
    check(lc_checker_get_work(get(), &found, sizeof found));
    return found;
  }

 private:
  static lc_checker_info read(lc_checker handle) {
    lc_checker_info info{};
    check(lc_checker_get_info(handle, &info, sizeof info));
    return info;
  }
  /// The numbers of both configurations.
  static std::size_t same(Span<double> a, Span<double> b) {
    if (a.size() != b.size()) throw std::invalid_argument("two configurations have different sizes");
    return a.size();
  }
  std::size_t rows(Span<double> q) const {
    if (coordinates() == 0 || q.size() % coordinates() != 0) {
      throw std::invalid_argument("size is not a multiple of the number of coordinates");
    }
    return q.size() / coordinates();
  }
  lc_checker_info info_{};
};

}  // namespace lin_canny
