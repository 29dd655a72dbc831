// Numbers of contacts, shared between ranks

#include "contact_counts.h"

#include <gtest/gtest.h>

using Slope::ContactCounts;

// a ghost's count goes to its owner, is added up to 255, and comes back
TEST(ContactCounts, ThereAndBack)
{
  ContactCounts owner, other;
  for (ContactCounts *counts : {&owner, &other}) {
    counts->now = {9, 9};
    counts->clear(3);
    EXPECT_EQ(counts->now, (std::vector<unsigned char>{0, 0, 0}));
  }
  owner.now = {1, 250, 0};
  other.now = {0, 0, 9};
  double buf[1];
  const int first[1] = {1};
  EXPECT_EQ(other.pack_reverse(1, 2, buf), 1);
  owner.unpack_reverse(1, first, buf);
  EXPECT_EQ(owner.now[1], 255);
  EXPECT_EQ(owner.pack_forward(1, first, buf), 1);
  other.unpack_forward(1, 2, buf);
  EXPECT_EQ(other.now[2], 255);
}
