/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_STYLE_ARGUMENT_H
#define SLOPE_STYLE_ARGUMENT_H

#include "decimal_number.h"

#include "lammps.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class Region;

// Numbers among the arguments of a style. LAMMPS' own errors do not say which argument it was; here
// what names style and argument: "Fix deposit/grid cell".
double number_argument(LAMMPS *, const std::string &what, const char *text);
double positive_argument(LAMMPS *, const std::string &what, const char *text);
int whole_number_argument(LAMMPS *, const std::string &what, const char *text);
int atom_type_argument(LAMMPS *, const std::string &what, const char *text);

// a region that exists and stands still, as a run begins with it
Region *region_argument(LAMMPS *, const std::string &what, const std::string &id);

// "a, b or c"
std::string listed(const std::vector<std::string> &);

// Keywords among the arguments, each with its values. Wrong ones end the run with one line, as below.
//
//   for (KeywordReader word(lmp, caller, narg, arg); word.next();)
//     if (word.is("cell", "S"))
//       cell = word.positive();
//     else
//       word.unknown();
//
// Values are counted from 1 on; messages name them where a keyword has several.
class KeywordReader {
 public:
  KeywordReader(LAMMPS *, const std::string &caller, int narg, char **arg);

  bool next();    // go to the first keyword, then to the next one; false: there is none

  // whether it is this one, which has these values: "xlo xhi"; more of them, where they are optional
  bool is(const std::string &keyword, const std::string &values);
  void more(const std::string &values);
  bool value_follows() const;    // one more, as it is no keyword, which begins with a letter

  const char *text(int k = 1) const { return arg[k]; }
  double number(int k = 1) const { return number_argument(lmp, item(k), arg[k]); }
  double positive(int k = 1) const { return positive_argument(lmp, item(k), arg[k]); }
  int whole_number(int k = 1) const { return whole_number_argument(lmp, item(k), arg[k]); }
  int choice(const std::vector<std::string> &words, int k = 1) const;    // which one of these
  void must(bool holds, const std::string &rule,
            int k = 1) const;    // "ITEM must be RULE, got VALUE"
  void unknown() const;          // it is none of those that were asked for

  char **begin() const { return arg; }    // the keyword and its values
  char **end() const { return arg + 1 + names.size(); }

 private:
  LAMMPS *const lmp;
  const std::string caller;
  char **const first, **arg, **const last;
  std::vector<std::string> names, asked;    // of the values; keywords

  std::string choices(int k) const;
  std::string item(int k) const;
};

}    // namespace LAMMPS_NS

#endif
