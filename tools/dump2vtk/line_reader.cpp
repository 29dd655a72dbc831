/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "line_reader.h"

#include <cerrno>
#include <cstring>
#include <sys/stat.h>
#include <zlib.h>

using namespace Slope;

static constexpr size_t CHUNK = 1 << 20;      // bytes per read
static constexpr size_t MAXLINE = 1 << 20;    // a longer line is no dump's: do not collect it

static bool is_blank(char c)
{
  return c == ' ' || c == '\t' || c == '\r';
}

/* ---------------------------------------------------------------------- */

LineReader::LineReader(const std::string &_path) :
    path(_path), gz(nullptr), begin(0), end(0), nline(0), ended(true), held(false), finished(false),
    cut(false)
{
  struct stat info;
  errno = 0;
  if (stat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode)) errno = EISDIR;
  if (errno == 0) gz = gzopen(path.c_str(), "rb");    // reads plain files as they are
  if (!gz) throw std::runtime_error("cannot read " + path + ": " + strerror(errno));
  gzbuffer(gz, CHUNK / 4);
  buffer.resize(2 * CHUNK);
}

LineReader::~LineReader()
{
  gzclose(gz);
}

/* ---------------------------------------------------------------------- */

void LineReader::refill()
{
  std::memmove(buffer.data(), buffer.data() + begin, end - begin);
  end -= begin;
  begin = 0;
  if (end > MAXLINE) {
    nline++;
    fail("must be a line of text, got more than " + std::to_string(MAXLINE) + " characters");
  }

  // On a compressed file that is cut short, zlib gives what there is and then the error

  const int n = gzread(gz, &buffer[end], CHUNK);
  if (n > 0) end += n;
  if (n == (int) CHUNK) return;
  int code;
  const char *message = gzerror(gz, &code);
  if (code == Z_BUF_ERROR)
    finished = cut = true;
  else if (n < 0)
    throw std::runtime_error(path + ", after line " + std::to_string(nline) +
                             ": cannot read on: " + (code == Z_ERRNO ? strerror(errno) : message));
  else if (n == 0)
    finished = true;
}

/* ---------------------------------------------------------------------- */

bool LineReader::next()
{
  if (held) {
    held = false;
    return true;
  }

  size_t seen = 0;    // of the unread text, without a line break
  while (true) {
    const char *from = buffer.data() + begin;
    const void *at = memchr(from + seen, '\n', end - begin - seen);
    if (at) {
      text = std::string_view(from, static_cast<const char *>(at) - from);
      begin += text.size() + 1;
      ended = true;
      nline++;
      return true;
    }
    seen = end - begin;
    if (!finished) {
      refill();
      continue;
    }
    if (seen == 0) {
      if (!cut) return false;
      cut = false;    // said once, then it is the end of the file
      throw CutShort(path + ", after line " + std::to_string(nline) +
                     ": the compressed file is cut short");
    }
    text = std::string_view(buffer.data() + begin, seen);
    begin = end;
    ended = false;
    nline++;
    return true;
  }
}

/* ---------------------------------------------------------------------- */

const std::vector<std::string_view> &LineReader::words()
{
  split.clear();
  size_t i = 0;
  while (true) {
    while (i < text.size() && is_blank(text[i])) i++;
    if (i == text.size()) return split;
    const size_t first = i;
    while (i < text.size() && !is_blank(text[i])) i++;
    split.push_back(text.substr(first, i - first));
  }
}

/* ---------------------------------------------------------------------- */

std::string LineReader::where(const std::string &what) const
{
  return path + ", line " + std::to_string(nline) + ": " + what;
}

void LineReader::fail(const std::string &what) const
{
  throw std::runtime_error(where(what));
}

int64_t LineReader::bytes() const
{
  return gzoffset(gz);
}
