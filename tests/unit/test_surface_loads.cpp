/* Loads of a surface: sums over ranks and steps, files; contacts stored by ball. */

#include "contact_records.h"
#include "surface_loads.h"
#include "triangle_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

using namespace Slope;

static TriangleMesh two()
{
  return TriangleMesh({{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}});
}

TEST(SurfaceLoads, AddsUpBallsAndRanksInAStep)
{
  SurfaceLoads loads;
  std::vector<SurfaceLoads::Record> records = {{7, 1, 3.0, 0.3}, {6, 1, 8.0, 0.8}, {7, 0, 2.0, 0.2},
                                               {7, 1, 4.0, 0.4}, {5, 1, 1.0, 0.1}};
  loads.take(records);
  const TriangleMesh mesh = two();
  EXPECT_EQ(loads.triangles(mesh, 7.0),
            "triangle,x,y,z,area,last_pressure,largest_pressure,impulse\n"
            "1,0.6666666667,0.6666666667,0,2,1,1,0.1\n"
            "2,0.3333333333,0.3333333333,1,0.5,14,16,3.2\n");
  // a triangle that nothing touches in the last step has no pressure
  EXPECT_NE(loads.triangles(mesh, 8.0).find("1,0.5,0,16,3.2\n"), std::string::npos);
  records = {{9, 0, 6.0, 0.6}};
  loads.take(records);
  EXPECT_NE(loads.triangles(mesh, 9.0).find("0,2,3,3,0.4\n"), std::string::npos);
}

TEST(SurfaceLoads, GoesThroughARestartFile)
{
  SurfaceLoads loads, other;
  std::vector<SurfaceLoads::Record> records = {{7, 1, 3.0, 0.3}, {6, 0, 8.0, 0.8}};
  loads.take(records);
  loads.add_row({7, 0.5, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}, 2, {10, 11}});
  other.add_row({1, 0.1, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, 0, {0, 0}});
  const std::vector<double> numbers = loads.pack();
  other.unpack(numbers.data(), numbers.size(), 3.0);
  const TriangleMesh mesh = two();
  EXPECT_EQ(loads.series(), "step,time,fx,fy,fz,mx,my,mz,jx,jy,jz,contacts,largest_force,"
                            "largest_moment\n"
                            "7,0.5,1,2,3,4,5,6,7,8,9,2,10,11\n");
  EXPECT_EQ(other.series(), loads.series());

  // of a damaged file: other numbers of loads or rows, a triangle that is not there, an end that is missing

  const auto damaged = [&](size_t at, double value) {
    std::vector<double> wrong = numbers;
    wrong[at] = value;
    EXPECT_THROW(other.unpack(wrong.data(), wrong.size(), 3.0), std::runtime_error) << at << " " << value;
  };
  for (double value : {-1.0, 1e300, 3.0, 1.5, double(NAN)}) {
    damaged(0, value);
    damaged(1, value);
  }
  damaged(2, 3.0);
  damaged(2, -1.0);
  EXPECT_THROW(other.unpack(numbers.data(), numbers.size() - 1, 3.0), std::runtime_error);
  EXPECT_THROW(other.unpack(numbers.data(), 0, 3.0), std::runtime_error);
  EXPECT_EQ(other.series(), loads.series());
  EXPECT_EQ(other.triangles(mesh, 7.0), loads.triangles(mesh, 7.0));
  EXPECT_EQ(other.polydata(mesh, 7.0), loads.polydata(mesh, 7.0));
  EXPECT_NE(loads.polydata(mesh, 7.0).find("NumberOfPolys=\"2\""), std::string::npos);
}

TEST(ContactRecords, KeepsPacksAndCopies)
{
  ContactRecords store(3), other(3);
  store.resize(3);
  other.resize(5);
  store.make(1, 2);
  for (int k = 0; k < 2; k++)
    for (int m = 0; m < 3 + HISTORY; m++) store.key(1, k)[m] = 100 * k + m;
  std::vector<double> buffer(1 + 2 * (3 + HISTORY));
  EXPECT_EQ(store.pack(1, buffer.data()), static_cast<int>(buffer.size()));
  EXPECT_EQ(other.unpack(4, buffer.data()), static_cast<int>(buffer.size()));
  other.copy(4, 0);
  other.make(4, 0);
  EXPECT_EQ(other.contacts(4), 0);
  ASSERT_EQ(other.contacts(0), 2);
  EXPECT_EQ(other.history(0, 1)[0], 103.0);
  EXPECT_EQ(store.pack(0, buffer.data()), 1);
  EXPECT_EQ(store.largest(1), 1);
  EXPECT_EQ(store.largest(2), static_cast<int>(buffer.size()));
  store.clear();
  EXPECT_EQ(store.contacts(1), 0);
}
