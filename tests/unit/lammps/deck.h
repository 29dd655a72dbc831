// A LAMMPS of all ranks with a box of 10 x 10 x 10 m, for the tests of what needs LAMMPS

#ifndef SLOPE_TEST_DECK_H
#define SLOPE_TEST_DECK_H

#include "atom.h"
#include "comm.h"
#include "group.h"
#include "input.h"
#include "lammps.h"
#include "modify.h"
#include "update.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

struct Deck {
  std::unique_ptr<LAMMPS_NS::LAMMPS> lmp;

  explicit Deck(int types = 1)
  {
    std::vector<std::string> words = {"test", "-log", "none", "-screen", "none", "-nocite"};
    std::vector<char *> argv;
    for (std::string &word : words) argv.push_back(&word[0]);
    lmp.reset(new LAMMPS_NS::LAMMPS(static_cast<int>(argv.size()), argv.data(), MPI_COMM_WORLD));
    for (const char *line : {"units si", "atom_style sphere", "boundary f f f", "newton off", "comm_modify vel yes",
                             "region box block 0 10 0 10 0 10"})
      one(line);
    one("create_box " + std::to_string(types) + " box");
    one("neighbor 0.1 bin");
  }

  void one(const std::string &line) { lmp->input->one(line); }

  // at x in the middle of y and z; m, kg/m3
  void add_ball(int type, double x, double diameter, double density)
  {
    const std::string t = std::to_string(type);
    one("create_atoms " + t + " single " + std::to_string(x) + " 5 5");
    one("group new id " + std::to_string(lmp->atom->natoms));
    one("set group new diameter " + std::to_string(diameter) + " density " + std::to_string(density));
    one("group new delete");
    for (int i = 0; i < lmp->atom->nlocal; i++)    // before a run they are what is in the memory
      for (int d = 0; d < 3; d++) lmp->atom->f[i][d] = lmp->atom->torque[i][d] = 0.0;
  }

  static double mass(double diameter, double density) { return density * std::acos(-1.0) / 6.0 * std::pow(diameter, 3); }

  int me() const { return lmp->comm->me; }
  bool with(int ball, int &i) const    // whether this rank has it
  {
    const LAMMPS_NS::tagint *tag = lmp->atom->tag;
    for (i = 0; i < lmp->atom->nlocal; i++)
      if (tag[i] == ball) return true;
    return false;
  }
};

#endif
