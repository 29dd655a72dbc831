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

SLOPE_INLINE int bits(bool a)
{
  return a;
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

SLOPE_INLINE void join(const Four *fours, Eight &a)
{
  a = _mm512_insertf64x4(_mm512_castpd256_pd512(fours[0]), fours[1], 1);
}

SLOPE_INLINE Four four_of(Eight a, int which)
{
  return which ? _mm512_extractf64x4_pd(a, 1) : _mm512_castpd512_pd256(a);
}
#else
typedef Four Widest;
#endif

SLOPE_INLINE void join(const Four *fours, Four &a)
{
  a = fours[0];
}

SLOPE_INLINE Four four_of(Four a, int)
{
  return a;
}

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
