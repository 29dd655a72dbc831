// Numbers of contacts, shared between ranks

#include "contact_counts.h"

#include <gtest/gtest.h>

using Slope::ContactCounts;

TEST(ContactCounts, AStepLater)
{
  ContactCounts counts;
  counts.clear(2, true, true);
  counts.now = {1, 2};
  counts.clear(2, false, false);
  EXPECT_EQ(counts.before, (ContactCounts::Counts{1, 2}));
  EXPECT_EQ(counts.now, (ContactCounts::Counts{0, 0}));
  counts.now = {3, 4};
  counts.clear(3, true, false);    // a new list: those of a step ago are counted anew
  EXPECT_EQ(counts.before, (ContactCounts::Counts{0, 0, 0}));
}

// a ghost's count goes to its owner, is added up to 255, and comes back
TEST(ContactCounts, ThereAndBack)
{
  for (auto which : {ContactCounts::NOW, ContactCounts::BOTH, ContactCounts::ESTIMATED}) {
    ContactCounts owner, other;
    for (ContactCounts *counts : {&owner, &other}) {
      counts->clear(3, true, true);
      counts->shared = which;
    }
    owner.now = {1, 250, 0};
    other.now = {0, 0, 9};
    owner.before = {0, 7, 0};
    other.before = {0, 0, 2};
    other.estimated = {0, 0, 1};
    double buf[2];
    const int first[1] = {1};
    const int size = which == ContactCounts::BOTH ? 2 : 1;
    EXPECT_EQ(other.pack_reverse(1, 2, buf), size);
    owner.unpack_reverse(1, first, buf);
    EXPECT_EQ(owner.now[1], which == ContactCounts::ESTIMATED ? 250 : 255);
    EXPECT_EQ(owner.before[1], which == ContactCounts::BOTH ? 9 : 7);
    EXPECT_EQ(owner.is_estimated(1), which == ContactCounts::ESTIMATED);
    EXPECT_EQ(owner.pack_forward(1, first, buf), size);
    other.unpack_forward(1, 2, buf);
    EXPECT_EQ(other.now[2], which == ContactCounts::ESTIMATED ? 9 : 255);
    EXPECT_EQ(other.before[2], which == ContactCounts::BOTH ? 9 : 2);
    EXPECT_TRUE(other.is_estimated(2));
  }
  EXPECT_FALSE(ContactCounts().is_estimated(5));
}
