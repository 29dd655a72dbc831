/* Files that appear together: all of them, or none. */

#include "atomic_file.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

using namespace Slope;

// a folder of this test alone, with two names in it
class Folder : public ::testing::Test {
 protected:
  Folder() : folder("test_file_set." + std::to_string(getpid()))
  {
    mkdir(folder.c_str(), 0777);
    a = folder + "/a";
    b = folder + "/b";
    std::ofstream(a) << "old";
  }

  ~Folder() override
  {
    for (const std::string &path : {a, b, beside(a), beside(b), folder}) remove(path.c_str());
  }

  std::string folder, a, b;

  static std::string beside(const std::string &path) { return path + "." + std::to_string(getpid()) + ".tmp"; }

  static std::string text(const std::string &path)
  {
    std::ifstream in(path);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  static bool there(const std::string &path) { return access(path.c_str(), F_OK) == 0; }

  // what is thrown
  static std::string problem(const std::function<void()> &work)
  {
    try {
      work();
    } catch (std::exception &e) {
      return e.what();
    }
    return "none";
  }
};

TEST_F(Folder, AllAppear)
{
  FileSet files;
  files.add(a).write("new a");
  files.add(b).write("new b");
  EXPECT_EQ(text(a), "old");
  EXPECT_FALSE(there(b));
  files.commit();
  EXPECT_EQ(text(a), "new a");
  EXPECT_EQ(text(b), "new b");
  EXPECT_EQ(files.names(), (std::vector<std::string>{"a", "b"}));
}

TEST_F(Folder, NoneAppearsWhereOneIsAFolder)
{
  mkdir(b.c_str(), 0777);
  EXPECT_EQ(problem([&] {
              FileSet files;
              files.add(a).write("new a");
              files.add(b).write("new b");
              files.commit();
            }),
            "cannot write " + b + ": Is a directory");
  EXPECT_EQ(text(a), "old");
  EXPECT_FALSE(there(beside(a)) || there(beside(b)));
}

TEST_F(Folder, NoneAppearsWhereOneBecomesAFolder)
{
  EXPECT_EQ(problem([&] {
              FileSet files;
              files.add(a).write("new a");
              files.add(b).write("new b");
              mkdir(b.c_str(), 0777);
              files.commit();
            }),
            "cannot write " + b + ": Is a directory");
  EXPECT_EQ(text(a), "old");
  EXPECT_FALSE(there(beside(a)) || there(beside(b)));
}

TEST_F(Folder, ProbeLeavesNothing)
{
  FileSet::probe({a, b});
  EXPECT_EQ(text(a), "old");
  EXPECT_FALSE(there(b) || there(beside(a)) || there(beside(b)));
  EXPECT_EQ(problem([&] { FileSet::probe({a, folder + "/none/b"}); }),
            "cannot write " + folder + "/none/b: No such file or directory");
  mkdir(b.c_str(), 0777);
  EXPECT_EQ(problem([&] { FileSet::probe({a, b}); }), "cannot write " + b + ": Is a directory");
}
