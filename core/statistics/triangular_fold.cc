#include "core/statistics/triangular_fold.h"

#include <cmath>
#include <cstddef>
#include <cstring>

namespace idim {
namespace {

#define IDIM_ALWAYS_INLINE inline __attribute__((always_inline))

// Generic vectors: the compiler turns them into the instructions of the function into which all of this is inlined.
// Arguments go by reference, since a vector by value has no fixed calling convention across instruction sets.
template <int kLanes>
struct Lanes {
  typedef double Vector __attribute__((vector_size(8 * kLanes)));
};

template <typename Vector>
IDIM_ALWAYS_INLINE void Load(const double* from, Vector& v) {
  std::memcpy(&v, from, sizeof(v));
}
template <typename Vector>
IDIM_ALWAYS_INLINE void Store(const Vector& v, double* to) {
  std::memcpy(to, &v, sizeof(v));
}

// Reflectors of a panel: V = [diag(d) on the panel's rows of R; X in the panel's place], H_1 ... H_P = I - V T V'.
template <int kPanel>
struct Reflectors {
  double d[kPanel] = {};
  double t[kPanel][kPanel] = {};  // upper triangular
};

// products: x_j times each column of the panel, x_j itself among them. Sets reflector j and returns in `s` by how much
// of x_j each later column falls. r: the panel's diagonal block in R.
template <int kPanel>
IDIM_ALWAYS_INLINE void SetReflector(int j, const double* products, double* r, Reflectors<kPanel>* h, double* s) {
  double* row = r + 8 * std::ptrdiff_t{j};
  const double alpha = row[j], tail = products[j], squared = alpha * alpha + tail;
  for (int k = 0; k < kPanel; ++k) s[k] = 0.0;
  // Nothing below the diagonal but what rounding would lose: d and T stay zero, no reflector. A NaN goes on.
  if (tail < 1e-290 || tail <= 1e-40 * squared) return;
  const double beta = std::sqrt(squared);
  const double d = -tail / (alpha + beta), tau = -1.0 / (beta * d);
  row[j] = beta;
  for (int k = j + 1; k < kPanel; ++k) {
    s[k] = tau * (d * row[k] + products[k]);
    row[k] -= d * s[k];
  }
  h->d[j] = d;
  h->t[j][j] = tau;
  for (int k = 0; k < j; ++k) {
    double sum = 0.0;
    for (int m = k; m < j; ++m) sum += h->t[k][m] * products[m];
    h->t[k][j] = -tau * sum;
  }
}

// panel: kPanel columns, row i at panel + 8 i. rows: a multiple of four. count: columns that are not padding.
template <int kPanel, int kLanes>
IDIM_ALWAYS_INLINE void FactorPanel(double* panel, int rows, int count, double* r, Reflectors<kPanel>* h) {
  using Vector = typename Lanes<kLanes>::Vector;
  constexpr int kVectors = kPanel / kLanes;
  double products[kPanel], s[kPanel] = {};
  for (int j = -1; j < count; ++j) {
    // Applies reflector j (none at first) and multiplies by column j + 1 (none at last).
    if (j >= 0) {
      SetReflector<kPanel>(j, products, r, h, s);
      if (j + 1 == count) break;
    }
    Vector factor[kVectors], sum[4][kVectors] = {};
    for (int v = 0; v < kVectors; ++v) Load(s + kLanes * v, factor[v]);
    const double* x = panel + (j < 0 ? 0 : j);  // at first any column, since s is zero
    const double* next = panel + j + 1;
    for (std::ptrdiff_t i = 0; i < rows; i += 4) {
      Vector y[4][kVectors];
#pragma GCC unroll 4
      for (std::ptrdiff_t u = 0; u < 4; ++u) {
        const std::ptrdiff_t at = 8 * (i + u);
        const double xi = x[at];
#pragma GCC unroll 8
        for (int v = 0; v < kVectors; ++v) {
          Load(panel + at + kLanes * v, y[u][v]);
          y[u][v] -= xi * factor[v];
          Store(y[u][v], panel + at + kLanes * v);
        }
      }
      // Read back, not computed anew: x_{j+1} may be all rounding, and a reflector must be what its products are of.
#pragma GCC unroll 4
      for (std::ptrdiff_t u = 0; u < 4; ++u) {
        const double next_xi = next[8 * (i + u)];
#pragma GCC unroll 8
        for (int v = 0; v < kVectors; ++v) sum[u][v] += next_xi * y[u][v];
      }
    }
    for (int v = 0; v < kVectors; ++v) {
      const Vector total = (sum[0][v] + sum[1][v]) + (sum[2][v] + sum[3][v]);
      Store(total, products + kLanes * v);
    }
  }
}

// Applies the panel's reflectors to kVectors vectors of columns: columns[q] of the block, r[q] of the panel's rows.
template <int kPanel, int kLanes, int kVectors>
IDIM_ALWAYS_INLINE void UpdateStrip(const double* panel, int rows, const Reflectors<kPanel>& h, double* const* columns,
                                    double* const* r) {
  using Vector = typename Lanes<kLanes>::Vector;
  double* column[kVectors];
  for (int q = 0; q < kVectors; ++q) column[q] = columns[q];
  Vector z[kPanel][kVectors];  // V'C, then T'V'C
#pragma GCC unroll 8
  for (int p = 0; p < kPanel; ++p) {
#pragma GCC unroll 8
    for (int q = 0; q < kVectors; ++q) {
      Load(r[q] + 8 * std::ptrdiff_t{p}, z[p][q]);
      z[p][q] *= h.d[p];
    }
  }
  for (std::ptrdiff_t i = 0; i < rows; ++i) {
    Vector c[kVectors];
#pragma GCC unroll 8
    for (int q = 0; q < kVectors; ++q) Load(column[q] + 8 * i, c[q]);
#pragma GCC unroll 8
    for (int p = 0; p < kPanel; ++p) {
      const double x = panel[8 * i + p];
#pragma GCC unroll 8
      for (int q = 0; q < kVectors; ++q) z[p][q] += x * c[q];
    }
  }
#pragma GCC unroll 8
  for (int p = kPanel - 1; p >= 0; --p) {
#pragma GCC unroll 8
    for (int q = 0; q < kVectors; ++q) z[p][q] *= h.t[p][p];
#pragma GCC unroll 8
    for (int k = 0; k < p; ++k) {
#pragma GCC unroll 8
      for (int q = 0; q < kVectors; ++q) z[p][q] += h.t[k][p] * z[k][q];
    }
#pragma GCC unroll 8
    for (int q = 0; q < kVectors; ++q) {
      Vector y;
      Load(r[q] + 8 * std::ptrdiff_t{p}, y);
      y -= h.d[p] * z[p][q];
      Store(y, r[q] + 8 * std::ptrdiff_t{p});
    }
  }
  for (std::ptrdiff_t i = 0; i < rows; ++i) {
    Vector c[kVectors];
#pragma GCC unroll 8
    for (int q = 0; q < kVectors; ++q) Load(column[q] + 8 * i, c[q]);
#pragma GCC unroll 8
    for (int p = 0; p < kPanel; ++p) {
      const double x = panel[8 * i + p];
#pragma GCC unroll 8
      for (int q = 0; q < kVectors; ++q) c[q] -= x * z[p][q];
    }
#pragma GCC unroll 8
    for (int q = 0; q < kVectors; ++q) Store(c[q], column[q] + 8 * i);
  }
}

// kPanel and kLanes divide 8; kPanel x kStrip vectors of sums, kStrip of columns and one or two more are registers.
template <int kPanel, int kLanes, int kStrip>
IDIM_ALWAYS_INLINE void Fold(int columns, OctetMatrix* r, OctetMatrix* block, int rows) {
  static_assert(kStrip <= 3, "the switch below");
  const int vectors = (columns + kLanes - 1) / kLanes;
  for (int first = 0; first < columns; first += kPanel) {
    double* panel = block->octet(first / 8) + first % 8;
    Reflectors<kPanel> h;
    const int count = columns - first < kPanel ? columns - first : kPanel;
    FactorPanel<kPanel, kLanes>(panel, rows, count, r->octet(first / 8) + 8 * std::ptrdiff_t{first} + first % 8, &h);
    // Strips of nearly equal width: a single left-over vector would wait for its own sums.
    int vector = (first + kPanel) / kLanes;
    for (int strips = (vectors - vector + kStrip - 1) / kStrip; strips > 0; --strips) {
      const int width = (vectors - vector + strips - 1) / strips;
      double* in_block[kStrip] = {};
      double* in_r[kStrip] = {};
      for (int q = 0; q < width; ++q) {
        const int column = (vector + q) * kLanes;
        in_block[q] = block->octet(column / 8) + column % 8;
        in_r[q] = r->octet(column / 8) + 8 * std::ptrdiff_t{first} + column % 8;
      }
      switch (width) {
        case 1:
          UpdateStrip<kPanel, kLanes, 1>(panel, rows, h, in_block, in_r);
          break;
        case 2:
          UpdateStrip<kPanel, kLanes, 2>(panel, rows, h, in_block, in_r);
          break;
        default:
          UpdateStrip<kPanel, kLanes, kStrip>(panel, rows, h, in_block, in_r);
      }
      vector += width;
    }
  }
}

void FoldBaseline(int columns, OctetMatrix* r, OctetMatrix* block, int rows) { Fold<4, 2, 2>(columns, r, block, rows); }

#if defined(__x86_64__) && defined(__GNUC__)
#define IDIM_X86_VARIANTS
__attribute__((target("avx2,fma"))) void FoldAvx2(int columns, OctetMatrix* r, OctetMatrix* block, int rows) {
  Fold<4, 4, 3>(columns, r, block, rows);
}
__attribute__((target("avx512f,avx2,fma"))) void FoldAvx512(int columns, OctetMatrix* r, OctetMatrix* block, int rows) {
  Fold<8, 8, 3>(columns, r, block, rows);
}
#endif

}  // namespace

const std::vector<FoldVariant>& AvailableFoldVariants() {
  static const auto* const available = [] {
    auto* const variants = new std::vector<FoldVariant>{FoldVariant::kBaseline};
#ifdef IDIM_X86_VARIANTS
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
      variants->push_back(FoldVariant::kAvx2);
      if (__builtin_cpu_supports("avx512f")) variants->push_back(FoldVariant::kAvx512);
    }
#endif
    return variants;
  }();
  return *available;
}

void FoldIntoTriangle(FoldVariant variant, int columns, OctetMatrix* r, OctetMatrix* block, int rows) {
  // The panel's sums run over four rows at a time; zero rows add nothing.
  for (; rows % 4 != 0; ++rows) {
    for (int g = 0; g < block->octets(); ++g) {
      std::memset(block->octet(g) + 8 * std::ptrdiff_t{rows}, 0, sizeof(ColumnOctet));
    }
  }
  switch (variant) {
    case FoldVariant::kBaseline:
      return FoldBaseline(columns, r, block, rows);
#ifdef IDIM_X86_VARIANTS
    case FoldVariant::kAvx2:
      return FoldAvx2(columns, r, block, rows);
    case FoldVariant::kAvx512:
      return FoldAvx512(columns, r, block, rows);
#else
    default:
      return FoldBaseline(columns, r, block, rows);
#endif
  }
}

}  // namespace idim
