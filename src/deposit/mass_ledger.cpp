// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "mass_ledger.h"

#include <algorithm>
#include <cstdio>

using namespace Slope;

/* ---------------------------------------------------------------------- */

void MassLedger::lose(const Mass &mass)
{
  here.number += mass.number;
  here.volume += mass.volume;
}

/* ---------------------------------------------------------------------- */

void MassLedger::note(const Loss &loss)
{
  if (notes.size() < MAXLOGGED) notes.push_back(loss);
}

/* ---------------------------------------------------------------------- */

void MassLedger::begin_command(const Mass &outside_in)
{
  outside = outside_in;
  outside_known = true;
}

/* ---------------------------------------------------------------------- */

void MassLedger::end_command(const Mass &still)
{
  here.number += outside.number - still.number;
  here.volume += outside.volume - still.volume;
  outside_known = false;
}

/* ---------------------------------------------------------------------- */

std::vector<MassLedger::Loss> MassLedger::take_notes()
{
  std::vector<Loss> taken;
  taken.swap(notes);
  return taken;
}

/* ---------------------------------------------------------------------- */

void MassLedger::take_here(const Mass &all)
{
  lost.number += all.number;
  lost.volume += all.volume;
  here = Mass();
}

/* ---------------------------------------------------------------------- */

std::vector<std::string> MassLedger::lines(std::vector<Loss> all, double before)
{
  std::sort(all.begin(), all.end(), earlier);
  std::vector<std::string> found;
  for (const Loss &loss : all) {
    if (!must_log()) break;
    nlogged++;
    char text[200];
    snprintf(text, sizeof(text),
             "ball %.0f left the box at %.8g %.8g %.8g, step %.0f, lost so far: %.0f%s", loss.tag,
             loss.x[0], loss.x[1], loss.x[2], loss.step, ++before,
             must_log() ? "" : ", more are only counted");
    found.push_back(text);
  }
  return found;
}
