// Random numbers whose bytes do not depend on the standard library: the engines (std::mt19937_64, std::seed_seq) are
// fixed by the C++ standard, the distributions of <random> are not, so the two that simulation needs are written here.
// Uniform: the upper 53 bits of a draw. Normal: Box & Muller (1958), the cosine branch only, one pair of uniforms each.

#ifndef IDIM_CORE_SIMULATION_RANDOM_H_
#define IDIM_CORE_SIMULATION_RANDOM_H_

#include <cstdint>
#include <random>

namespace idim {

class Random {
 public:
  // Streams of one seed are independent of each other: `stream` says what is drawn (see the users).
  explicit Random(std::uint64_t seed, std::uint32_t stream = 0);

  double Uniform();  // [0, 1)
  double Uniform(double lower, double upper) { return lower + (upper - lower) * Uniform(); }
  double Normal();  // mean 0, standard deviation 1

 private:
  std::mt19937_64 engine_;
};

}  // namespace idim

#endif  // IDIM_CORE_SIMULATION_RANDOM_H_
