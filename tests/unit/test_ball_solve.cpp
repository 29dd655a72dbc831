// A ball whose dashpots are solved for, against Gaussian elimination of the 6 x 6 system made contact by contact

#include "ball_solve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace Slope;

static std::mt19937 generator(7);
static double uniform(double low, double high)
{
  return std::uniform_real_distribution<double>(low, high)(generator);
}

// x of a x = b, b replaced
static void eliminate(double a[6][6], double *b)
{
  for (int k = 0; k < 6; k++) {
    int pivot = k;
    for (int i = k; i < 6; i++)
      if (std::fabs(a[i][k]) > std::fabs(a[pivot][k])) pivot = i;
    std::swap_ranges(a[k], a[k] + 6, a[pivot]);
    std::swap(b[k], b[pivot]);
    for (int i = 0; i < 6; i++) {
      if (i == k) continue;
      const double factor = a[i][k] / a[k][k];
      for (int j = k; j < 6; j++) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (int k = 0; k < 6; k++) b[k] /= a[k][k];
}

TEST(BallSolve, IsTheSolutionOfItsSixEquations)
{
  const int X[6] = {0, 1, 2, 1, 0, 0}, Y[6] = {0, 1, 2, 2, 2, 1};
  for (int test = 0; test < 200; test++) {
    const double m = uniform(0.1, 10.0), r = uniform(0.1, 3.0);
    double a[6][6] = {{0.0}}, normal[6] = {0.0}, tangential[6] = {0.0}, sum[3] = {0.0}, t = 0.0, roll = 0.0;
    for (int d = 0; d < 3; d++) {
      a[d][d] = m;
      a[3 + d][3 + d] = 0.4 * m * r * r;
    }
    for (int contact = 0; contact < test % 13; contact++) {
      double n[3] = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
      const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      for (double &c : n) c /= length;
      const double bn = uniform(0, 5), bt = contact % 3 ? uniform(0, 5) : 0.0, br = uniform(0, 2);

      // velocity of the contact point as rows: v + r n x w; its normal part costs bn, the rest bt
      const double cross[3][3] = {{0, -n[2], n[1]}, {n[2], 0, -n[0]}, {-n[1], n[0], 0}};
      double rows[3][6];
      for (int d = 0; d < 3; d++)
        for (int k = 0; k < 3; k++) {
          rows[d][k] = d == k;
          rows[d][3 + k] = r * cross[d][k];
        }
      for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
          for (int d = 0; d < 3; d++)
            for (int k = 0; k < 3; k++)
              a[i][j] += rows[d][i] * rows[k][j] * (bn * n[d] * n[k] + bt * ((d == k) - n[d] * n[k]));
      for (int d = 0; d < 3; d++) a[3 + d][3 + d] += br;

      for (int q = 0; q < 6; q++) {
        normal[q] += (bn - bt) * n[X[q]] * n[Y[q]];
        tangential[q] += bt * n[X[q]] * n[Y[q]];
      }
      for (int d = 0; d < 3; d++) sum[d] += bt * n[d];
      t += bt;
      roll += br;
    }
    double p[3], q[3], b[6], dv[3], dw[3];
    for (int d = 0; d < 3; d++) {
      b[d] = p[d] = uniform(-1, 1);
      b[3 + d] = q[d] = uniform(-1, 1);
    }
    eliminate(a, b);
    solve_ball(m, r, normal, tangential, sum, t, roll, p, q, dv, dw);
    for (int d = 0; d < 3; d++) {
      EXPECT_NEAR(dv[d], b[d], 1e-12 * (1.0 + std::fabs(b[d])));
      EXPECT_NEAR(dw[d], b[3 + d], 1e-10 * (1.0 + std::fabs(b[3 + d])));
    }
  }
}

// the sum of BallDashpots is sent between ranks, and loaded four at a time, as plain numbers
TEST(BallDashpots, HasNoGaps)
{
  EXPECT_EQ(sizeof(BallDashpots), BallDashpots::SIZE * sizeof(double));
  EXPECT_EQ(BallDashpots::SIZE % 4, 0);
}
