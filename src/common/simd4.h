// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Four doubles at a time, by the vector extensions that GCC and Clang have for any processor, or eight, and
   the functions that the contact law needs of one double and of several alike */

#ifndef SLOPE_SIMD4_H
#define SLOPE_SIMD4_H

#include "instruction_set.h"

#include <cmath>
#ifdef __AVX__
#include <immintrin.h>
#endif

namespace Slope {
inline namespace SLOPE_INSTRUCTIONS {

typedef double Four __attribute__((vector_size(32)));
typedef decltype(Four() < Four()) FourFlags;    // 0 or -1 each

// in memory, at any double
typedef double FourThere __attribute__((vector_size(32), aligned(8), may_alias));
typedef double TwoThere __attribute__((vector_size(16), aligned(8), may_alias));

SLOPE_INLINE const FourThere &four(const double *p)
{
  return *reinterpret_cast<const FourThere *>(p);
}

SLOPE_INLINE FourThere &four(double *p)
{
  return *reinterpret_cast<FourThere *>(p);
}

SLOPE_INLINE TwoThere &two_at(double *p)
{
  return *reinterpret_cast<TwoThere *>(p);
}

#if defined(__clang__) || __GNUC__ >= 12
#define SLOPE_SHUFFLE(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
#define SLOPE_SHUFFLE(a, b, i, j, k, l) __builtin_shuffle(a, b, FourFlags{i, j, k, l})
#endif

// rows a, b, c, d to columns: x = a[0] b[0] c[0] d[0] and so on
struct Columns {
  Four x, y, z, w;

  SLOPE_INLINE Columns(Four a, Four b, Four c, Four d)
  {
    const Four ab_even = SLOPE_SHUFFLE(a, b, 0, 4, 2, 6), ab_odd = SLOPE_SHUFFLE(a, b, 1, 5, 3, 7);
    const Four cd_even = SLOPE_SHUFFLE(c, d, 0, 4, 2, 6), cd_odd = SLOPE_SHUFFLE(c, d, 1, 5, 3, 7);
    x = SLOPE_SHUFFLE(ab_even, cd_even, 0, 1, 4, 5);
    y = SLOPE_SHUFFLE(ab_odd, cd_odd, 0, 1, 4, 5);
    z = SLOPE_SHUFFLE(ab_even, cd_even, 2, 3, 6, 7);
    w = SLOPE_SHUFFLE(ab_odd, cd_odd, 2, 3, 6, 7);
  }
};

// the same of as many rows as T has lanes
template <class T> struct ColumnsOf;
template <> struct ColumnsOf<Four> : Columns {
  SLOPE_INLINE explicit ColumnsOf(const Four *rows) : Columns(rows[0], rows[1], rows[2], rows[3]) {}
};

// a[0] b[0] a[2] b[2] and so on; and of the odd lanes
SLOPE_INLINE Four even_pairs(Four a, Four b)
{
  return SLOPE_SHUFFLE(a, b, 0, 4, 2, 6);
}

SLOPE_INLINE Four odd_pairs(Four a, Four b)
{
  return SLOPE_SHUFFLE(a, b, 1, 5, 3, 7);
}

// a everywhere
template <class T> SLOPE_INLINE T all(double a)
{
  return T() + a;
}

// bit k: whether flag k is set
SLOPE_INLINE int bits(FourFlags a)
{
#ifdef __AVX__
  return _mm256_movemask_pd(reinterpret_cast<__m256d>(a));
#else
  return (a[0] & 1) | (a[1] & 2) | (a[2] & 4) | (a[3] & 8);
#endif
}

SLOPE_INLINE Four root(Four a)
{
#ifdef __AVX__
  return _mm256_sqrt_pd(a);
#else
  return Four{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
#endif
}

SLOPE_INLINE double root(double a)
{
  return std::sqrt(a);
}

SLOPE_INLINE Four choose(FourFlags which, Four a, Four b)
{
  return which ? a : b;
}

SLOPE_INLINE double choose(bool which, double a, double b)
{
  return which ? a : b;
}

// a / sqrt(b): root and division do not wait for each other; and sqrt(b), where 1 / sqrt(b) is known
template <class T> SLOPE_INLINE T over_root(T a, T b)
{
  return a / b * root(b);
}

template <class T> SLOPE_INLINE T root_by(T b, T /*inverse*/)
{
  return root(b);
}

// eight at a time, where the processor has registers for them: two fours

#ifdef __AVX512F__
typedef double Eight __attribute__((vector_size(64)));
typedef decltype(Eight() < Eight()) EightFlags;
typedef Eight Widest;

SLOPE_INLINE Eight root(Eight a)
{
  return _mm512_sqrt_pd(a);
}

SLOPE_INLINE Eight choose(EightFlags which, Eight a, Eight b)
{
  return which ? a : b;
}

// Eight roots and divisions keep the divider busy for 40 cycles: from a root that is right to 2^-14, by Newton's steps
SLOPE_INLINE Eight over_root(Eight a, Eight b)
{
  Eight inverse = _mm512_rsqrt14_pd(b);
  for (int k = 0; k < 2; k++) inverse += 0.5 * inverse * (1.0 - b * inverse * inverse);
  return a * inverse;
}

SLOPE_INLINE Eight root_by(Eight b, Eight inverse)
{
  return b * inverse;
}

SLOPE_INLINE Eight even_pairs(Eight a, Eight b)
{
  return _mm512_unpacklo_pd(a, b);
}

SLOPE_INLINE Eight odd_pairs(Eight a, Eight b)
{
  return _mm512_unpackhi_pd(a, b);
}

template <> struct ColumnsOf<Eight> {
  Eight x, y, z, w;

  SLOPE_INLINE explicit ColumnsOf(const Four *rows)
  {
    const Eight a = join(rows[0], rows[2]), b = join(rows[1], rows[3]);
    const Eight c = join(rows[4], rows[6]), d = join(rows[5], rows[7]);
    const Eight ab_even = even_pairs(a, b), ab_odd = odd_pairs(a, b);
    const Eight cd_even = even_pairs(c, d), cd_odd = odd_pairs(c, d);
    x = _mm512_shuffle_f64x2(ab_even, cd_even, 0x88);    // pairs 0 and 2 of both
    y = _mm512_shuffle_f64x2(ab_odd, cd_odd, 0x88);
    z = _mm512_shuffle_f64x2(ab_even, cd_even, 0xdd);    // pairs 1 and 3
    w = _mm512_shuffle_f64x2(ab_odd, cd_odd, 0xdd);
  }

 private:
  SLOPE_INLINE static Eight join(Four low, Four high)
  {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1);
  }
};
#else
typedef Four Widest;
#endif

// the numbers of two columns side by side: row m
template <class T> struct PairsOf {
  T even, odd;

  SLOPE_INLINE PairsOf(T a, T b) : even(even_pairs(a, b)), odd(odd_pairs(a, b)) {}
  SLOPE_INLINE TwoThere pair(int m) const
  {
    const T &rows = m % 2 ? odd : even;
    return TwoThere{rows[m & ~1], rows[m | 1]};
  }
};

// four columns as rows to where those are
SLOPE_INLINE void scatter(const Four *columns, double *const *to)
{
  const Columns rows(columns[0], columns[1], columns[2], columns[3]);
  four(to[0]) = rows.x;
  four(to[1]) = rows.y;
  four(to[2]) = rows.z;
  four(to[3]) = rows.w;
}

#ifdef __AVX512F__
SLOPE_INLINE void scatter(const Eight *columns, double *const *to)
{
  const PairsOf<Eight> first(columns[0], columns[1]), last(columns[2], columns[3]);
  for (int m = 0; m < 8; m++) {
    two_at(to[m]) = first.pair(m);
    two_at(to[m] + 2) = last.pair(m);
  }
}
#endif

// the second one if one of them is not a number
template <class T> SLOPE_INLINE T larger(T a, T b)
{
  return choose(a > b, a, b);
}

template <class T> SLOPE_INLINE T smaller(T a, T b)
{
  return choose(a < b, a, b);
}

}    // namespace SLOPE_INSTRUCTIONS
}    // namespace Slope

#endif
