// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Contacts of balls with a wall, stored by ball: what exchange and restart carry. No LAMMPS. */

#ifndef SLOPE_CONTACT_RECORDS_H
#define SLOPE_CONTACT_RECORDS_H

#include "contact_law.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace Slope {

// A record is the identity of a contact, one or more numbers, and its history.
class ContactRecords {
 public:
  explicit ContactRecords(int keys_in) : keys(keys_in), width(keys_in + HISTORY) {}

  void resize(int balls)    // as many as there may be
  {
    count.resize(balls, 0);
    start.resize(balls, 0);
  }

  void clear()    // all contacts
  {
    std::fill(count.begin(), count.end(), 0);
    numbers.clear();
  }

  int contacts(int i) const { return count[i]; }
  double *key(int i, int k) { return &numbers[start[i] + k * width]; }
  double *history(int i, int k) { return key(i, k) + keys; }

  // space for n contacts of ball i, which loses those that it had
  void make(int i, int n)
  {
    start[i] = numbers.size();
    count[i] = n;
    numbers.resize(numbers.size() + n * width);
  }

  void copy(int from, int to)    // both share the numbers
  {
    count[to] = count[from];
    start[to] = start[from];
  }

  // returns how many values of the buffer there are
  int pack(int i, double *buffer) const
  {
    buffer[0] = count[i];
    std::copy_n(numbers.begin() + start[i], count[i] * width, buffer + 1);
    return packed(count[i]);
  }

  int unpack(int i, const double *buffer)
  {
    const int n = static_cast<int>(buffer[0]);
    make(i, n);
    std::copy_n(buffer + 1, n * width, numbers.begin() + start[i]);
    return packed(n);
  }

  int packed(int contacts) const { return 1 + contacts * width; }
  int largest(int balls) const    // of the first balls, packed
  {
    return packed(balls ? *std::max_element(count.begin(), count.begin() + balls) : 0);
  }

  double memory_usage() const
  {
    return static_cast<double>(count.capacity()) * sizeof(int) +
        static_cast<double>(start.capacity()) * sizeof(size_t) +
        static_cast<double>(numbers.capacity()) * sizeof(double);
  }

 private:
  const int keys, width;
  std::vector<int> count;
  std::vector<size_t> start;
  std::vector<double> numbers;
};

}    // namespace Slope

#endif
