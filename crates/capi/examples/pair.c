/* A pair in a loop: a hull that passes a cylinder. Cached state makes each query cheap; every answer has proven bounds. */
#include <stdio.h>

#include "lin_canny.h"

static int failed(const char *what) {
  printf("%s: %s\n", what, lc_last_error());
  return 1;
}

int main(void) {
  if (lc_abi() != LC_ABI) return printf("another version of the library: %u\n", (unsigned)lc_abi()), 1;
  const double corners[8][3] = {{-.5, -.5, -.5}, {.5, -.5, -.5}, {-.5, .5, -.5}, {.5, .5, -.5},
                                {-.5, -.5, .5},  {.5, -.5, .5},  {-.5, .5, .5},  {.5, .5, .5}};
  const double can[2] = {0.5, 0.25}; /* half height, radius */
  lc_geometry a = {0}, b = {0};
  lc_pair pair = {0};
  if (lc_hull_new(&corners[0][0], 8, NULL, NULL, &a) != LC_OK) return failed("hull");
  if (lc_shape_new(LC_CYLINDER, can, 2, &b) != LC_OK) return failed("cylinder");
  if (lc_pair_new(a, b, &pair) != LC_OK) return failed("pair");
  lc_geometry_free(a); /* the pair keeps it */
  lc_geometry_free(b);

  const lc_pose here = {{0, 0, 0}, {0, 0, 0, 1}};
  int wrong = 0;
  for (int frame = 0; frame <= 10; ++frame) {
    const lc_pose there = {{1.5 - 0.1 * frame, 0.1, 0.2}, {0, 0, 0, 1}};
    lc_answer answer;
    if (lc_pair_ask(pair, &here, &there, LC_DISTANCE | LC_POINTS, &answer, sizeof answer) != LC_OK) return failed("ask");
    const double expected = there.translation[0] - 0.75; /* at the faces along x; a depth below zero */
    if (frame < 8) wrong += answer.lower > expected + 1e-12 || answer.upper < expected - 1e-12;
    printf("x = %.1f: distance %9.6f in [%.15f, %.15f], state %u, witness on B at x = %.6f\n", there.translation[0],
           answer.distance, answer.lower, answer.upper, (unsigned)answer.state, answer.point_on_b[0]);
  }
  if (lc_pair_free(pair) != LC_OK) return failed("free");
  return wrong || lc_live() != 0;
}
