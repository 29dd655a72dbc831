/* One run at a time has PREFIX.lock, in this process and beside it; that of a process that has ended means nothing. */

#include "prefix_lock.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

using namespace Slope;

class Locks : public ::testing::Test {
 protected:
  Locks() : prefix("test_prefix_lock." + std::to_string(getpid())), file(prefix + ".lock") {}
  ~Locks() override { remove(file.c_str()); }

  const std::string prefix, file;
  const int one = 0, two = 0;    // addresses of two runs

  bool there() const { return access(file.c_str(), F_OK) == 0; }

  // what is thrown
  static std::string problem(PrefixLock &lock, const std::string &prefix, const void *run)
  {
    try {
      lock.take(prefix, run);
    } catch (std::runtime_error &e) {
      return e.what();
    }
    return "none";
  }

  // a process that has the lock, until it is killed; when it has it, it says so through a pipe
  pid_t start_other() const
  {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    const pid_t pid = fork();
    if (pid == 0) {
      PrefixLock lock;
      lock.take(prefix, &one);
      if (write(ends[1], "x", 1) != 1) _exit(1);
      for (;;) pause();
    }
    close(ends[1]);
    char said;
    EXPECT_EQ(read(ends[0], &said, 1), 1);
    close(ends[0]);
    return pid;
  }

  static void kill_other(pid_t pid)
  {
    int status;
    kill(pid, SIGKILL);
    waitpid(pid, &status, 0);
  }
};

TEST_F(Locks, AreReleasedWithTheLastWriter)
{
  {
    PrefixLock a;
    a.take(prefix, &one);
    {
      PrefixLock b;
      b.take(prefix, &one);
      b.take("./" + prefix, &one);    // the same file
      b.take(prefix, &one);
    }
    EXPECT_TRUE(there());
    a.take(prefix, &one);    // again, in the next run of a deck
    EXPECT_TRUE(there());
  }
  EXPECT_FALSE(there());
}

TEST_F(Locks, AnotherRunOfThisProcess)
{
  PrefixLock a, b;
  a.take(prefix, &one);
  const std::string text = problem(b, prefix, &two);
  EXPECT_NE(text.find("output " + prefix + " must be"), std::string::npos) << text;
  EXPECT_NE(text.find("process " + std::to_string(getpid())), std::string::npos) << text;
  b.take(prefix + "_other", &two);
  a = PrefixLock();
  EXPECT_FALSE(there());
  b.take(prefix, &two);
  EXPECT_EQ(access((prefix + "_other.lock").c_str(), F_OK), -1);    // given back for the new one
}

TEST_F(Locks, AnotherProcess)
{
  const pid_t other = start_other();
  PrefixLock lock;
  const std::string text = problem(lock, prefix, &one);
  kill_other(other);
  EXPECT_NE(text.find("output " + prefix + " must be"), std::string::npos) << text;
  EXPECT_NE(text.find("process " + std::to_string(other) + ", since 2"), std::string::npos) << text;
  EXPECT_TRUE(there());    // of a process that is no longer there
  lock.take(prefix, &one);
  lock = PrefixLock();
  EXPECT_FALSE(there());
}

TEST_F(Locks, WhereNothingCanBeWritten)
{
  PrefixLock lock;
  EXPECT_EQ(problem(lock, "none/x", &one), "cannot write none/x.lock: No such file or directory");
}
