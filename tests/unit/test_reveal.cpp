// What is known of the members of a class that are not public, and of one that has other members than expected.

#include "reveal.h"

#include <gtest/gtest.h>

class Base {
 protected:
  int inherited = 4;
};

class Closed : public Base {
 public:
  virtual ~Closed() = default;
  virtual void none() = 0;    // no object can be made of it alone

 private:
  double length = 1.5;
  double normal[3] = {0.0, 0.6, 0.8};
  const char *retyped = "number";
};

class Open : public Closed {
  void none() override {}
};

typedef double Vector3[3];
SLOPE_REVEAL(Closed, double, length)
SLOPE_REVEAL(Closed, Vector3, normal)
SLOPE_REVEAL(Closed, int, inherited)
SLOPE_REVEAL(Closed, double, retyped)
SLOPE_REVEAL(Closed, double, renamed)

TEST(reveal, members_that_are_not_public)
{
  Open object;
  EXPECT_EQ(object.*Closed_length::at(), 1.5);
  EXPECT_EQ((object.*Closed_normal::at())[2], 0.8);
  EXPECT_TRUE((Slope::revealed<Closed_length, Closed_normal>()));
}

TEST(reveal, members_that_have_moved_to_a_base_class)
{
  Open object;
  ASSERT_NE(Closed_inherited::at(), nullptr);
  EXPECT_EQ(object.*Closed_inherited::at(), 4);
}

TEST(reveal, another_type_and_another_name_are_not_known)
{
  EXPECT_EQ(Closed_retyped::at(), nullptr);
  EXPECT_EQ(Closed_renamed::at(), nullptr);
  EXPECT_FALSE((Slope::revealed<Closed_length, Closed_renamed>()));
}
