/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "style_argument.h"

#include "lammps_compat.h"

#include "atom.h"
#include "error.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <sstream>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

double LAMMPS_NS::number_argument(LAMMPS *lmp, const std::string &what, const char *text)
{
  double value;
  if (!Slope::read_number(text, value))
    lmp->error->all(FLERR, "{} must be a finite number, got {}", what, text);
  return value;
}

double LAMMPS_NS::positive_argument(LAMMPS *lmp, const std::string &what, const char *text)
{
  const double value = number_argument(lmp, what, text);
  if (!(value > 0.0)) lmp->error->all(FLERR, "{} must be > 0, got {}", what, text);
  return value;
}

int LAMMPS_NS::whole_number_argument(LAMMPS *lmp, const std::string &what, const char *text)
{
  char *end;
  errno = 0;
  const long value = strtol(text, &end, 10);
  const bool whole = *text && !isspace(static_cast<unsigned char>(*text)) && *end == '\0';
  if (!whole || errno != 0 || value > INT_MAX || value < INT_MIN)
    lmp->error->all(FLERR, "{} must be a whole number below 2^31, got {}", what, text);
  return (int) value;
}

int LAMMPS_NS::atom_type_argument(LAMMPS *lmp, const std::string &what, const char *text)
{
  const int type = whole_number_argument(lmp, what, text), most = lmp->atom->ntypes;
  if (type < 1 || type > most)
    lmp->error->all(FLERR, "{} must be 1 to {} (the atom types of the box), got {}", what, most,
                    text);
  return type;
}

Region *LAMMPS_NS::region_argument(LAMMPS *lmp, const std::string &what, const std::string &id)
{
  Region *region = compat::find_region(lmp, id);
  if (!region) lmp->error->all(FLERR, "{} region {} does not exist", what, id);
  region->init();
  if (region->dynamic_check())
    lmp->error->all(FLERR, "{} region {} must not move, got one that moves or varies", what, id);
  return region;
}

std::string LAMMPS_NS::listed(const std::vector<std::string> &words)
{
  std::string text;
  for (size_t k = 0; k < words.size(); k++)
    text += (k == 0 ? "" : k + 1 < words.size() ? ", " : " or ") + words[k];
  return text;
}

/* ---------------------------------------------------------------------- */

KeywordReader::KeywordReader(LAMMPS *lmp_in, const std::string &caller_in, int narg,
                             char **arg_in) :
    lmp(lmp_in),
    caller(caller_in), first(arg_in), arg(nullptr), last(arg_in + narg)
{
}

bool KeywordReader::next()
{
  arg = arg ? end() : first;
  names.clear();
  asked.clear();
  return arg < last;
}

bool KeywordReader::is(const std::string &keyword, const std::string &values)
{
  asked.push_back(keyword);
  if (keyword != *arg) return false;
  names.clear();
  more(values);
  return true;
}

void KeywordReader::more(const std::string &values)
{
  std::istringstream words(values);
  const size_t before = names.size(), left = last - arg - 1;
  for (std::string word; words >> word;) names.push_back(word);
  if (left < names.size())
    lmp->error->all(FLERR, "{} must be followed by {}, got {} of {} values",
                    choices(static_cast<int>(before)), values, left - before,
                    names.size() - before);
}

bool KeywordReader::value_follows() const
{
  return end() < last && !isalpha(static_cast<unsigned char>(**end()));
}

/* ---------------------------------------------------------------------- */

// the keyword, and which ones were chosen among its first k values: others follow these

std::string KeywordReader::choices(int k) const
{
  std::string text = caller + " " + *arg;
  for (int j = 0; j < k; j++)
    if (names[j].find('|') != std::string::npos) text += std::string(" ") + arg[j + 1];
  return text;
}

std::string KeywordReader::item(int k) const
{
  return choices(k - 1) + (names.size() > 1 ? " " + names[k - 1] : "");
}

int KeywordReader::choice(const std::vector<std::string> &words, int k) const
{
  const auto found = std::find(words.begin(), words.end(), arg[k]);
  must(found != words.end(), listed(words), k);
  return static_cast<int>(found - words.begin());
}

void KeywordReader::must(bool holds, const std::string &rule, int k) const
{
  if (!holds) lmp->error->all(FLERR, "{} must be {}, got {}", item(k), rule, arg[k]);
}

void KeywordReader::unknown() const
{
  lmp->error->all(FLERR, "{}: unknown keyword {}, must be {}", caller, *arg, listed(asked));
}
