// Fixed balls on a surface, of a file, and how one ground is told from another

#include "ball_placement.h"
#include "deck.h"
#include "surface_sampler.h"

#include <cstdio>

using namespace LAMMPS_NS;
using Slope::PlacedBall;

struct Ground {
  Deck deck;

  Ground()
  {
    deck.one("region flat block 0 10 0 10 0 2");
    deck.one("region high block 0 10 0 10 0 2.5");
    deck.one("region half block 5 10 0 10 INF INF");
    deck.one("region step block 5 10 0 10 0 8");
    deck.one("region stair union 2 flat step");
  }

  std::unique_ptr<BallPlacement> place(std::vector<std::string> words, double diameter = 0.5)
  {
    std::vector<char *> arg;
    for (std::string &word : words) arg.push_back(&word[0]);
    return std::unique_ptr<BallPlacement>(
        new BallPlacement(deck.lmp.get(), "test", diameter, 0.0, static_cast<int>(arg.size()), arg.data()));
  }
};

static bool same(const PlacedBall &a, const PlacedBall &b)
{
  return a.x == b.x && a.y == b.y && a.z == b.z && a.number == b.number;
}

// a ball on each of 21 x 21 nodes, its centre on the surface; less those of a filter
TEST(BallPlacement, Flat)
{
  Ground g;
  const auto placed = g.place({"surface", "flat", "upper", "spacing", "0.5"});
  EXPECT_EQ(placed->count(), 21 * 21);
  const auto all = placed->all();
  ASSERT_EQ(all.size(), 21u * 21);
  for (size_t k = 0; k < all.size(); k++) {
    EXPECT_DOUBLE_EQ(all[k].x, 0.5 * (k % 21));
    EXPECT_DOUBLE_EQ(all[k].y, 0.5 * (k / 21));
    EXPECT_EQ(all[k].z, 2.0);
  }
  EXPECT_EQ(placed->smallest(), 0.5);

  // up to x = 5, where a row of extra balls closes the half cell beyond the last nodes; and from there on
  for (const char *side : {"outside", "inside"}) {
    int nodes = 0, wrong = 0;
    for (const PlacedBall &b : g.place({"surface", "flat", "upper", "spacing", "0.5", side, "half"})->all()) {
      nodes += b.first_of_cell();
      wrong += side[0] == 'o' ? b.x > 5.0 : b.x < 5.0;
    }
    EXPECT_EQ(nodes, side[0] == 'o' ? 10 * 21 : 11 * 21);
    EXPECT_EQ(wrong, 0);
  }
}

// the tiles that any rank makes alone are what all ranks make together; a wall of 6 m gets balls of its own
TEST(BallPlacement, Tiles)
{
  Ground g;
  const auto placed = g.place({"surface", "stair", "upper", "spacing", "0.25"}, 0.25);
  const auto all = placed->all();
  EXPECT_EQ(placed->count(), static_cast<bigint>(all.size()));
  EXPECT_GT(all.size(), 41u * 41 + 500);
  std::vector<PlacedBall> made;
  const Slope::TilePlan plan = placed->tiles();
  EXPECT_EQ(plan.nx * plan.ny, 4);
  for (int tile = plan.nx * plan.ny - 1; tile >= 0; tile--) {
    placed->make(tile, made);
    placed->forget();
  }
  Slope::in_order(made);
  ASSERT_EQ(made.size(), all.size());
  for (size_t k = 0; k < all.size(); k++) ASSERT_TRUE(same(made[k], all[k])) << k;
}

TEST(BallPlacement, OneGroundAndAnother)
{
  Ground g;
  const auto flat = g.place({"surface", "flat", "upper", "spacing", "0.5"});
  const std::vector<double> marks = flat->fingerprint();
  EXPECT_EQ(flat->unlike(marks), "");
  EXPECT_EQ(g.place({"surface", "flat", "upper", "spacing", "0.5"})->unlike(marks), "");
  EXPECT_EQ(g.place({"surface", "high", "upper", "spacing", "0.5"})->unlike(marks), "another surface");
  EXPECT_EQ(g.place({"surface", "flat", "upper", "spacing", "0.4"})->unlike(marks), "441 there, 676 here");
  EXPECT_EQ(g.place({"surface", "flat", "upper", "spacing", "0.5"}, 0.6)->unlike(marks),
            "diameter 0.5 there, 0.6 here");
  EXPECT_EQ(flat->unlike({}), "no data of them");
}

// a file's balls in its order, on all ranks; two that change places make another ground
TEST(BallPlacement, File)
{
  Ground g;
  const std::string file = "balls_of_" + std::to_string(g.deck.lmp->comm->nprocs) + ".txt";    // ranks
  const auto write = [&](const char *text) {
    MPI_Barrier(MPI_COMM_WORLD);
    if (g.deck.me() == 0) {
      FILE *fp = fopen(file.c_str(), "w");
      fputs(text, fp);
      fclose(fp);
    }
    MPI_Barrier(MPI_COMM_WORLD);
  };
  write("# x y z\n1 2 3\n\n4 5 6 # the second\n7 8 9\n");
  const auto placed = g.place({"file", file});
  const std::vector<double> marks = placed->fingerprint();
  EXPECT_EQ(placed->count(), 3);
  EXPECT_EQ(g.place({"file", file, "outside", "half"})->count(), 2);
  write("4 5 6\n1 2 3\n7 8 9\n");
  EXPECT_EQ(g.place({"file", file})->unlike(marks), "other places, or another order, of 3");
  const auto all = placed->all();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[1].y, 5.0);
  EXPECT_EQ(all[2].number, 2);
  MPI_Barrier(MPI_COMM_WORLD);
  if (g.deck.me() == 0) remove(file.c_str());
}
