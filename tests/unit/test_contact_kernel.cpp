// Which kernel is chosen, and what an unknown name is answered with

#include "contact_kernel.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

using namespace Slope;

static int last_that_runs()
{
  int best = -1;
  for (size_t k = 0; k < ContactKernels::all().size(); k++)
    if (ContactKernels::all()[k].runs_here) best = static_cast<int>(k);
  return best;
}

TEST(ContactKernels, TheFirstOneRunsEverywhere)
{
  EXPECT_TRUE(ContactKernels::all().front().runs_here);
}

TEST(ContactKernels, WithoutANameTheLastOneThatRuns)
{
  EXPECT_EQ(ContactKernels::choose(nullptr), last_that_runs());
  EXPECT_EQ(ContactKernels::choose(""), last_that_runs());
}

TEST(ContactKernels, ByName)
{
  for (size_t k = 0; k < ContactKernels::all().size(); k++) {
    const ContactKernels::Choice &choice = ContactKernels::all()[k];
    if (!choice.runs_here) {
      EXPECT_THROW(ContactKernels::choose(choice.name), std::invalid_argument);
      continue;
    }
    EXPECT_EQ(ContactKernels::choose(choice.name), static_cast<int>(k));
    ContactKernels::set_current(static_cast<int>(k));
    EXPECT_STREQ(ContactKernels::current_name(), choice.name);
    EXPECT_EQ(&ContactKernels::current(), choice.kernel);
  }
}

TEST(ContactKernels, AnUnknownNameIsAnsweredWithThoseThatRun)
{
  try {
    ContactKernels::choose("x86-64-v9");
    FAIL() << "no error";
  } catch (const std::invalid_argument &e) {
    const std::string message = e.what();
    EXPECT_NE(message.find("SLOPE_KERNEL"), std::string::npos) << message;
    EXPECT_NE(message.find("x86-64-v9"), std::string::npos) << message;
    EXPECT_NE(message.find(ContactKernels::all().front().name), std::string::npos) << message;
  }
}
