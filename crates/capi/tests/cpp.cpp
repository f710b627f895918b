// The C++ header: owners move, errors throw, callbacks stop and throw, nothing leaks.
#include <cmath>
#include <cstdio>
#include <type_traits>

#include "lin_canny.hpp"

using namespace lin_canny;

static int failures = 0;
#define TRUE(x) \
  do { \
    if (!(x)) ++failures, std::printf("line %d: not " #x "\n", __LINE__); \
  } while (0)

template <class F>
static lc_status status_of(F call) {
  try {
    call();
  } catch (const Error &e) {
    if (!*e.what()) ++failures;
    return e.status();
  }
  return LC_OK;
}

static_assert(!std::is_copy_constructible_v<Geometry> && std::is_nothrow_move_constructible_v<Geometry>);
/* No value of a predicate, a handle or an answer becomes a bool unasked. */
static_assert(std::is_same_v<decltype(std::declval<Pair &>().intersects(identity, identity)), bool>);
static_assert(std::is_same_v<decltype(std::declval<Pair &>().within(identity, identity, 0)), bool>);
static_assert(!std::is_constructible_v<bool, Decision> && !std::is_convertible_v<Geometry, bool>);
static_assert(!std::is_constructible_v<bool, lc_answer> && !std::is_constructible_v<bool, lc_verdict>);
static_assert(!std::is_constructible_v<bool, lc_cast> && !std::is_constructible_v<bool, lc_ray_hit>);
static_assert(!std::is_copy_assignable_v<Pair> && std::is_nothrow_move_assignable_v<Pair>);

static void geometries() {
  const std::vector<Point> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  TRUE(Geometry::polygon(square).info().kind == LC_KIND_POLYHEDRON);
  TRUE(Geometry::segment({0, 0, 0}, {1, 0, 0}).info().kind == LC_KIND_WIRE);
  const Geometry box = Geometry::box(.5, .5, .5), round = box.rounded(.25);
  TRUE(round.info().kind == LC_KIND_ROUNDED && round.bounding_box(at(1, 0, 0))[1][0] >= 1.75);
  TRUE(Geometry::cone(1, .5).info().kind == LC_KIND_CURVED && Geometry::ellipsoid(1, 1, 1).info().is_solid == 1);
  const lc_geometry pieces[] = {box.get(), round.get()};
  const lc_pose poses[] = {identity, at(1, 0, 0)};
  TRUE(Geometry::compound(pieces, poses).info().kind == LC_KIND_COMPOUND);
  TRUE(Geometry::cloud(square, .1).info().kind == LC_KIND_CLOUD);
  const double radii[] = {.1, .1, .3, .1};
  TRUE(Geometry::cloud(square, radii).bounding_box()[1][0] >= 1.3);
  TRUE(Geometry::surface(1, 1, square).info().kind == LC_KIND_SURFACE);
  const std::vector<double> weights(4, 1.0);
  TRUE(Geometry::surface(1, 1, square, weights).info().is_solid == 0);
  const std::vector<Cell> cells{{0, 0, 0}, {3, 0, 0}};
  TRUE(Geometry::voxels({0, 0, 0}, {1, 1, 1}, cells).bounding_box()[1][0] >= 4);
  const double heights[] = {0, 1, 0, 1, 2, 1};
  TRUE(Geometry::heights(heights, 2, 3, 1, 1).info().is_solid == 0);
  TRUE(Geometry::heights(heights, 2, 3, 1, 1, -1.0).info().is_solid == 1);
  const lc_ray_hit hit = box.cast_ray({{2, 0, 0}, {-1, 0, 0}, 9});
  TRUE(hit.state == LC_HIT && std::fabs(hit.hit - 1.5) < 1e-11 && hit.safe <= 1.5);
  const lc_ray_hit miss = box.cast_ray({{2, 0, 0}, {1, 0, 0}, 9});
  TRUE(miss.state == LC_MISS && std::isinf(miss.hit) && std::isinf(miss.safe));
  TRUE(status_of([] { Geometry::hull(std::vector<Point>{}); }) == LC_REFUSED);
  TRUE(status_of([] { Geometry::ball(-1); }) == LC_REFUSED);
}

static void callbacks() {
  std::vector<Point> many;
  for (int k = 0; k < 3000; ++k) many.push_back({std::sin(1. * k), std::sin(k + 1.), std::sin(7. * k)});
  int calls = 0;
  const auto stop = [&](const char *, std::uint64_t, std::uint64_t) { return ++calls < 2; };
  TRUE(status_of([&] { Geometry::hull(many, stop); }) == LC_STOPPED && calls == 2);
  bool is_thrown = false;
  try {
    Geometry::hull(many, [](const char *stage, std::uint64_t, std::uint64_t) -> bool { throw std::runtime_error(stage); });
  } catch (const Error &) {
  } catch (const std::runtime_error &) {
    is_thrown = true;
  }
  TRUE(is_thrown);
}

static void pairs() {
  Geometry die = Geometry::box(.5, .5, .5);
  Geometry moved = std::move(die);
  TRUE(!die && moved);
  TRUE(status_of([&] { Pair again(die, moved); }) == LC_HANDLE);
  Pair pair(moved, moved);
  const lc_answer o = pair.closest(at(1, 2, 3), at(2.5, 2, 3));
  TRUE(o.lower <= .5 && .5 <= o.upper && std::fabs(o.point_on_b[0] - 2) < 1e-12 && o.normal[0] == 1);
  const lc_answer local = pair.ask(at(1, 2, 3), at(2.5, 2, 3), LC_DISTANCE | LC_POINTS | LC_BODY_FRAMES);
  TRUE(std::fabs(local.point_on_b[0] + .5) < 1e-12);
  /* A predicate stands in a condition: it is false if the geometries are proven apart. */
  TRUE(pair.intersects(identity, at(1, 0, 0)) && pair.within(identity, at(1.5, 0, 0), .5));
  TRUE(!pair.intersects(identity, at(99, 0, 0)) && !pair.within(identity, at(1.5, 0, 0), .25));
  TRUE(pair.decide_within(identity, at(1, 0, 0), 0) == Decision::Yes);
  TRUE(pair.decide_within(identity, at(99, 0, 0), 0) == Decision::No);
  const Geometry sheet = Geometry::surface(1, 1, std::vector<Point>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  Pair open(sheet, Geometry::ball(.5));
  TRUE(open.decide_within(identity, at(.3, .4, .5), 0) == Decision::Undecided && open.intersects(identity, at(.3, .4, .5)));
  TRUE(!open.intersects(identity, at(.3, .4, .75)));
  TRUE(status_of([&] { pair.within(identity, identity, std::nan("")); }) == LC_REFUSED);
  TRUE(pair.contacts(identity, at(.99, 0, 0), .1).size() == 4);
  const lc_penetration depth = pair.penetration(identity, at(.75, 0, 0));
  TRUE(depth.lower <= .25 && .25 <= depth.upper && depth.upper < .2500001);
  const lc_overlap_volume volume = pair.overlap(identity, at(.75, 0, 0));
  TRUE(volume.lower <= .25 && .25 <= volume.upper && volume.upper - volume.lower < 1e-15 && volume.covers_itself == 0);
  TRUE(std::fabs(volume.centroid[0] - .375) < 1e-12 && std::fabs(volume.centroid[1]) < 1e-12);
  TRUE(status_of([&] { open.overlap(identity, identity); }) == LC_REFUSED);
  const std::vector<lc_pose> poses(100, at(1.5, 0, 0));
  const auto all = pair.ask_many(identity, poses, LC_DISTANCE);
  TRUE(all.size() == 100 && all[99].lower <= .5 && .5 <= all[99].upper && (all[99].answered & LC_POINTS) == 0);
  const std::string replay = pair.replay(identity, at(3, 0, 0));
  TRUE(std::fabs(Pair::answer_of(replay).distance - 2) < 1e-12);
  Pair other;
  other = std::move(pair);
  TRUE(other && status_of([&] { pair.reset(); }) == LC_HANDLE);
  /* An assignment frees the old handle at once; one to itself changes nothing. */
  const std::uint64_t live = lc_live();
  Geometry first = Geometry::ball(1), second = Geometry::ball(2);
  first = std::move(second);
  TRUE(lc_live() == live + 1 && !second && first.bounding_box()[1][0] >= 2);
  Geometry &same = first;
  first = std::move(same);
  TRUE(lc_live() == live + 1 && first);
}

static void checkers() {
  const Geometry box = Geometry::box(.5, .5, .5);
  Checker checker = Checker::body(box, {-9, 9, -9, 9, -9, 9});
  checker.add_obstacle("wall", box, at(3, 0, 0));
  const double a[] = {0, 0, 0}, b[] = {6, 0, 0}, c[] = {0, 6, 0};
  TRUE(checker.is_free(a) && std::fabs(checker.clearance(a).distance - 2) < 1e-12);
  const lc_verdict blocked = checker.certify(a, b);
  TRUE(blocked.state == LC_BLOCKED && blocked.free_until <= 1. / 3 && 1. / 3 <= blocked.contact_at && checker.name(blocked.b) == "wall");
  TRUE(checker.certify(a, c).state == LC_FREE);
  Checker copy = checker.copy();
  const auto path = copy.plan(a, b);
  TRUE(path.size() >= 6 && copy.certify_path(path).state == LC_FREE);
  const lc_plan_options options{};
  TRUE(status_of([&] { copy.plan(a, b, options, [](const char *, std::uint64_t, std::uint64_t) { return false; }); }) == LC_STOPPED);
  /* Stopped in the second stage: the path so far. */
  const auto second = [](const char *stage, std::uint64_t, std::uint64_t) { return std::string(stage) != "shortcuts"; };
  TRUE(status_of([&] { copy.plan(a, b, options, second); }) == LC_STOPPED);
  TRUE(copy.path().size() >= path.size() && copy.certify_path(copy.path()).state == LC_FREE);
  TRUE(checker.limits()[0] == std::vector<double>(3, -9) && checker.limits()[1] == std::vector<double>(3, 9));
  TRUE(status_of([&] { checker.find("wal"); }) == LC_REFUSED);
  TRUE(status_of([&] { checker.is_free(std::vector<double>(2)); }) == LC_ARGUMENT);
  checker.set_pair_margin(blocked.a, blocked.b, 2.5);
  TRUE(!checker.is_free(a));
  checker.set_pair_margin(blocked.a, blocked.b, -1);
  TRUE(checker.is_free(a));
  checker.set_start_contact(.1);
  const double both[] = {0, 0, 0, 0, 2, 0};
  const auto nearest = checker.nearest(both, 2, INFINITY, 2);
  TRUE(nearest.pairs.size() == 4 && nearest.pairs[0].b.id == blocked.b.id && nearest.pairs[1].a.id == 0);
  TRUE(nearest.gradients.size() == 12 && std::fabs(nearest.gradients[0] + 1) < 1e-9 && nearest.pairs[2].distance > 2);
  const std::vector<double> odd(4);
  bool is_thrown = false;
  try {
    checker.certify_path(odd);
  } catch (const std::invalid_argument &) {
    is_thrown = true;
  }
  TRUE(is_thrown);
}

int main() {
  geometries();
  callbacks();
  pairs();
  checkers();
  TRUE(lc_live() == 0);
  std::puts(failures ? "FAILED" : "ok");
  return failures != 0;
}
