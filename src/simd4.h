/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Four doubles at a time, by the vector extensions that GCC and Clang have for any processor */

#ifndef SLOPE_SIMD4_H
#define SLOPE_SIMD4_H

namespace Slope {

typedef double Four __attribute__((vector_size(32), aligned(8), may_alias));
typedef long long FourIndices __attribute__((vector_size(32)));

#if defined(__clang__) || __GNUC__ >= 12
#define SLOPE_SHUFFLE(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
#define SLOPE_SHUFFLE(a, b, i, j, k, l) __builtin_shuffle(a, b, FourIndices{i, j, k, l})
#endif

inline const Four &four(const double *p)
{
  return *reinterpret_cast<const Four *>(p);
}

inline Four &four(double *p)
{
  return *reinterpret_cast<Four *>(p);
}

// rows a, b, c, d to columns: x = a[0] b[0] c[0] d[0] and so on
struct Columns {
  Four x, y, z, w;

  Columns(const Four &a, const Four &b, const Four &c, const Four &d)
  {
    const Four ab_even = SLOPE_SHUFFLE(a, b, 0, 4, 2, 6), ab_odd = SLOPE_SHUFFLE(a, b, 1, 5, 3, 7);
    const Four cd_even = SLOPE_SHUFFLE(c, d, 0, 4, 2, 6), cd_odd = SLOPE_SHUFFLE(c, d, 1, 5, 3, 7);
    x = SLOPE_SHUFFLE(ab_even, cd_even, 0, 1, 4, 5);
    y = SLOPE_SHUFFLE(ab_odd, cd_odd, 0, 1, 4, 5);
    z = SLOPE_SHUFFLE(ab_even, cd_even, 2, 3, 6, 7);
    w = SLOPE_SHUFFLE(ab_odd, cd_odd, 2, 3, 6, 7);
  }
};

}    // namespace Slope

#endif
