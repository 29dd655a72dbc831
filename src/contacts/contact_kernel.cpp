// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "contact_kernel.h"

#include <cstdlib>
#include <stdexcept>

using namespace Slope;

// each is the variable of a source of its own, compiled for its instructions
namespace Slope {
extern const ContactKernel contact_kernel_baseline;
#ifdef SLOPE_X86_KERNELS
extern const ContactKernel contact_kernel_x86_64_v3, contact_kernel_x86_64_v4;
#endif
}    // namespace Slope

const char *const ContactKernels::ENVIRONMENT = "SLOPE_KERNEL";

// what the x86-64 psABI's levels ask for, as far as the compiler makes use of it
static std::vector<ContactKernels::Choice> find_all()
{
  std::vector<ContactKernels::Choice> kernels;
#ifdef SLOPE_NATIVE
  kernels.push_back({"native", true, &contact_kernel_baseline});
#else
  kernels.push_back({"baseline", true, &contact_kernel_baseline});
#endif
#ifdef SLOPE_X86_KERNELS
  __builtin_cpu_init();
  const bool v3 = __builtin_cpu_supports("ssse3") && __builtin_cpu_supports("sse4.2") &&
      __builtin_cpu_supports("popcnt") && __builtin_cpu_supports("avx2") &&
      __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
      __builtin_cpu_supports("fma");
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl");
  kernels.push_back({"x86-64-v3", v3, &contact_kernel_x86_64_v3});
  kernels.push_back({"x86-64-v4", v4, &contact_kernel_x86_64_v4});
#endif
  return kernels;
}

const std::vector<ContactKernels::Choice> &ContactKernels::all()
{
  static const std::vector<Choice> kernels = find_all();
  return kernels;
}

int ContactKernels::choose(const char *name)
{
  const std::vector<Choice> &kernels = all();
  const bool named = name && *name;
  std::string here;
  int best = -1;
  for (size_t k = 0; k < kernels.size(); k++) {
    if (!kernels[k].runs_here) continue;
    here += (here.empty() ? "" : ", ") + std::string(kernels[k].name);
    if (!named || std::string(name) == kernels[k].name) best = static_cast<int>(k);
  }
  if (best < 0)
    throw std::invalid_argument(std::string("environment variable ") + ENVIRONMENT +
                                " must name a kernel that runs on this processor (" + here +
                                "), got " + name);
  return best;
}

static int in_use = -1;
static const ContactKernel *kernel = nullptr;    // that one's

const ContactKernel &ContactKernels::current()
{
  if (!kernel) set_current(choose(std::getenv(ENVIRONMENT)));
  return *kernel;
}

const char *ContactKernels::current_name()
{
  current();
  return all()[in_use].name;
}

void ContactKernels::set_current(int number)
{
  kernel = all().at(number).kernel;
  in_use = number;
}
