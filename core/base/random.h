// Random numbers whose bytes do not depend on the standard library: the engines (std::mt19937_64, std::seed_seq) are
// fixed by the C++ standard, the distributions of <random> are not, so those that idim needs are written here.
// Uniform: the upper 53 bits of a draw. Normal: Box & Muller (1958), the cosine branch only, one pair of uniforms each.

#ifndef IDIM_CORE_BASE_RANDOM_H_
#define IDIM_CORE_BASE_RANDOM_H_

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <random>

namespace idim {

class Random {
 public:
  // Streams of one seed are independent of each other: `stream` says what is drawn (see the users).
  explicit Random(std::uint64_t seed, std::uint32_t stream = 0);
  // Of a seed sequence with any words.
  static Random FromWords(std::initializer_list<std::uint32_t> words);

  double Uniform();  // [0, 1)
  double Uniform(double lower, double upper) { return lower + (upper - lower) * Uniform(); }
  double LogUniform(double lower, double upper);  // 0 < lower <= upper
  double Sign() { return Uniform() < 0.5 ? -1.0 : 1.0; }
  int Below(int count);                            // 0 to count - 1
  double Normal();                                 // mean 0, standard deviation 1
  Eigen::VectorXd Vector(int size, double limit);  // each uniform within -limit and limit

 private:
  Random() = default;

  std::mt19937_64 engine_;
};

}  // namespace idim

#endif  // IDIM_CORE_BASE_RANDOM_H_
