// Room for the contacts of a ball in messages between ranks, known before it comes

#include "deck.h"
#include "exchange_size.h"
#include "lammps_compat.h"

#include <algorithm>

using namespace LAMMPS_NS;

// the largest on any rank, times the fixes that ask in a run
TEST(ExchangeSize, OfAllRanksAndFixes)
{
  Deck deck;
  LAMMPS *lmp = deck.lmp.get();
  for (const char *id : {"a", "b", "c"}) deck.one(std::string("fix ") + id + " all nve/sphere");
  for (const char *id : {"a", "c"}) compat::fix_by_id(lmp, id)->maxexchange_dynamic = 1;
  const int most = 100 + lmp->comm->nprocs - 1;
  EXPECT_EQ(exchange_size(lmp, 100 + deck.me()), 2 * most);
}

// three balls in a row: the middle one has two contacts, and every rank has room for it
TEST(ExchangeSize, OfContacts)
{
  Deck deck;
  for (double x : {4.0, 4.99, 5.98}) deck.add_ball(1, x, 1.0, 2000.0);
  deck.one("pair_style gran/restitution");
  deck.one("pair_coeff * * stiffness 1e6 1e6 restitution 0.5 friction 30");
  deck.one("fix move all nve/sphere");
  deck.one("timestep 1e-4");
  deck.one("run 1");
  LAMMPS *lmp = deck.lmp.get();
  Fix *contacts = nullptr;
  for (Fix *fix : compat::fixes_of_style(lmp, "CONTACT_HISTORY")) contacts = fix;
  ASSERT_NE(contacts, nullptr);
  int i, mine = 0, size;
  std::vector<double> numbers(1000);
  if (deck.with(2, i)) mine = contacts->pack_exchange(i, numbers.data());
  MPI_Allreduce(&mine, &size, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  EXPECT_GT(size, 2 * 7);    // histories
  EXPECT_GE(contacts->maxexchange, size);
}
