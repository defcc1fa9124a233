#include "core/base/random.h"

#include <algorithm>
#include <cmath>

namespace idim {

Random::Random(std::uint64_t seed, std::uint32_t stream) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), stream};
  engine_.seed(sequence);
}

Random Random::FromWords(std::initializer_list<std::uint32_t> words) {
  std::seed_seq sequence(words);
  Random random;
  random.engine_.seed(sequence);
  return random;
}

double Random::Uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

double Random::LogUniform(double lower, double upper) { return lower * std::pow(upper / lower, Uniform()); }

int Random::Below(int count) { return std::min(count - 1, static_cast<int>(count * Uniform())); }

double Random::Normal() {
  constexpr double kTwoPi = 6.283185307179586476925;
  const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));  // 1 - u is never 0
  return radius * std::cos(kTwoPi * Uniform());
}

Eigen::VectorXd Random::Vector(int size, double limit) {
  Eigen::VectorXd values(size);
  for (double& value : values) value = Uniform(-limit, limit);
  return values;
}

}  // namespace idim
