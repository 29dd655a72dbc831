// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "prefix_lock.h"

#include <cerrno>
#include <cstring>
#include <ctime>
#include <list>
#include <stdexcept>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

using namespace Slope;

namespace Slope {
struct HeldLock {
  std::string path;
  int fd;
  const void *run;
  struct stat info;
  bool left;    // the file

  void remove_file()    // before the lock is released, so that it is never that of another run
  {
    if (left) unlink(path.c_str());
    left = false;
  }

  ~HeldLock()
  {
    remove_file();
    close(fd);
  }
};
}    // namespace Slope

// the locks of this process; an error ends it by exit(), where no writer is destroyed
struct AllLocks {
  std::list<std::weak_ptr<HeldLock>> list;
  ~AllLocks()
  {
    for (auto &weak : list)
      if (const auto lock = weak.lock()) lock->remove_file();
  }
};
static AllLocks all;

/* ---------------------------------------------------------------------- */

static void refuse(const std::string &prefix, const std::string &who)
{
  throw std::runtime_error(
      "output " + prefix + " must be that of one run at a time, got " +
      (who.empty() ? "another run" : who) +
      ", which is still there: wait for its end, or give this run another output");
}

static std::string read_text(int fd)
{
  char text[500];
  const ssize_t n = pread(fd, text, sizeof(text), 0);
  const std::string found(text, n > 0 ? n : 0);
  return found.substr(0, found.find('\n'));
}

static std::string this_run()
{
  char host[256] = "", since[32] = "";
  if (gethostname(host, sizeof(host) - 1) != 0) host[0] = '\0';
  const time_t now = time(nullptr);
  struct tm local;
  if (localtime_r(&now, &local)) strftime(since, sizeof(since), "%Y-%m-%d %H:%M:%S", &local);
  return std::string("a run on host ") + host + ", process " + std::to_string(getpid()) +
      ", since " + since + "\n";
}

static bool same_file(const struct stat &a, const struct stat &b)
{
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

/* ---------------------------------------------------------------------- */

void PrefixLock::take(const std::string &prefix, const void *run)
{
  const std::string path = prefix + ".lock";
  if (held && held->path == path) return;
  held.reset();
  for (;;) {
    const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    struct stat info, now;
    if (fd < 0 || fstat(fd, &info) != 0)
      throw std::runtime_error("cannot write " + path + ": " + strerror(errno));

    all.list.remove_if([](const std::weak_ptr<HeldLock> &weak) {
      return weak.expired();
    });
    for (auto &weak : all.list) {
      const auto lock = weak.lock();
      if (!same_file(lock->info, info)) continue;
      close(fd);
      if (lock->run != run) refuse(prefix, this_run().substr(0, this_run().find(", since")));
      held = lock;
      return;
    }

    if (flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      const std::string who = read_text(fd);
      close(fd);
      refuse(prefix, who);
    }
    if (stat(path.c_str(), &now) != 0 || !same_file(info, now)) {
      close(fd);    // the one that had it has just removed it
      continue;
    }
    held.reset(new HeldLock{path, fd, run, info, true});
    all.list.push_back(held);
    const std::string text = this_run();
    const bool named = ftruncate(fd, 0) == 0 && pwrite(fd, text.data(), text.size(), 0) > 0;
    (void) named;    // without a name on a full disk
    return;
  }
}
