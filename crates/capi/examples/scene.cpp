// A scene: balls that fall on a floor past a post. Events, first contacts between two steps, the closest pair, a ray.
#include <cmath>
#include <cstdio>
#include <vector>

#include "lin_canny.hpp"

using namespace lin_canny;

static int run() {
  Scene scene;
  lc_queries near{};
  near.flags = LC_QUERY_OVERLAP | LC_QUERY_WITHIN | LC_QUERY_IMPACT;
  near.within = 0.25;
  near.impact = 1e-6;
  scene.set_queries(0, 1, near);  // balls are in group 0, what is fixed in group 1

  const Geometry floor = Geometry::half_space({0, 0, 1}, 0), post = Geometry::cylinder(1, 0.2), ball = Geometry::ball(0.1);
  const lc_body ground = scene.add(floor, identity, 1, true);
  const lc_body pillar = scene.add(post, at(0, 0, 1), 1, true);
  std::vector<lc_body> balls;
  for (int k = 0; k < 5; ++k) {
    balls.push_back(scene.add(ball, at(0.5 * k - 1, 0, 2.53 + 0.2 * k)));
    scene.set_velocity(balls.back(), {0, 0, -4}, {0, 0, 0});
  }
  scene.step();

  int impacts = 0, began = 0, wrong = 0;
  for (int step = 0; step < 20; ++step) {
    scene.advance(0.05);
    scene.step();
    for (const lc_event &e : scene.events()) began += e.change == LC_OVERLAP_BEGAN;
    for (const lc_impact &i : scene.impacts()) {
      ++impacts;
      wrong += i.state != LC_HIT || i.hit - i.safe > 1e-5;
      const lc_body hit = i.a.id == ground.id || i.a.id == pillar.id ? i.b : i.a;
      std::printf("step %2d: ball %llu meets %s between %.9f and %.9f\n", step, static_cast<unsigned long long>(hit.id & 0xffffffff),
                  i.a.id == ground.id || i.b.id == ground.id ? "the floor" : "the post", i.safe, i.hit);
      scene.set_velocity(hit, {0, 0, 0}, {0, 0, 0});
    }
  }
  const auto closest = scene.closest_pair(0, 1);
  const lc_ray_hit found = scene.cast_ray({{0.3, 0, 1.5}, {-1, 0, 0}, 10}, 1u << 1);
  std::printf("%d first contacts, %d overlaps; closest pair %.6f; the ray meets the post at %.9f\n", impacts, began,
              closest ? closest->answer.distance : INFINITY, found.hit);
  return wrong == 0 && impacts > 0 && closest && found.state == LC_HIT && std::fabs(found.hit - 0.1) < 1e-9 ? 0 : 1;
}

int main() {
  int wrong = 1;
  try {
    wrong = run();
  } catch (const std::exception &e) {
    std::printf("error: %s\n", e.what());
  }
  return wrong || lc_live() != 0;
}
