// The last right singular vector of a tall matrix whose rows arrive in blocks: TriangularFactor beside LAPACK.
//
//   tsqr_benchmark [--rows=1000000] [--columns=70] [--repetitions=5] [--nofull_svd]
//
// Each route runs in a process of its own, so that peaks of memory do not mix, the routes in turn, --repetitions times.
// Making the rows is not part of any time, and filling the array of the routes that need W whole is not either.
// OpenBLAS takes recent processors for old ones, which would handicap the peer: OPENBLAS_CORETYPE is set here to the
// processor's instruction set unless the caller has set it. One thread everywhere.

#include <gflags/gflags.h>
#include <glog/logging.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "apps/program.h"
#include "core/statistics/triangular_factor.h"

DEFINE_int32(rows, 1000000, "rows of W");
DEFINE_int32(columns, 70, "columns of W, from 2 to 250");
DEFINE_int32(repetitions, 5, "how often each route runs; the table shows minima, and medians of ratios");
DEFINE_bool(full_svd, true, "also the economy SVD of W itself, which needs twice the memory of W");

extern "C" {
void dgemm_(const char*, const char*, const int*, const int*, const int*, const double*, const double*, const int*,
            const double*, const int*, const double*, double*, const int*);
void dgeqrf_(const int*, const int*, double*, const int*, double*, double*, const int*, int*);
void dtpqrt_(const int*, const int*, const int*, const int*, double*, const int*, double*, const int*, double*,
             const int*, double*, int*);
void dgesdd_(const char*, const int*, const int*, double*, const int*, double*, double*, const int*, double*,
             const int*, double*, const int*, int*, int*);
char* openblas_get_corename();
}

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajorMatrix = idim::TriangularFactor::RowMajorMatrix;

constexpr int kMaxColumns = 250;
constexpr int kBlockRows = 256;  // of the rows that arrive together

double Seconds(clockid_t clock) {
  timespec t;
  CHECK_EQ(clock_gettime(clock, &t), 0);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// What a route measures of itself: sums over start() to stop().
struct Measurement {
  double cpu = 0.0, wall = 0.0;
  double error = 0.0;  // of the routes that have no singular vector
  double vector[kMaxColumns] = {};

  void Start() {
    cpu -= Seconds(CLOCK_PROCESS_CPUTIME_ID);
    wall -= Seconds(CLOCK_MONOTONIC);
  }
  void Stop() {
    cpu += Seconds(CLOCK_PROCESS_CPUTIME_ID);
    wall += Seconds(CLOCK_MONOTONIC);
  }
  void SetVector(VectorXd v) {
    Eigen::Index largest = 0;
    v.cwiseAbs().maxCoeff(&largest);
    if (v[largest] < 0.0) v = -v;
    Eigen::Map<VectorXd>(vector, v.size()) = v;
  }
};

// Uniform entries; the last column is a combination of the others and a little noise, as the torque of a regression.
class Rows {
 public:
  explicit Rows(int columns) : x_(columns - 1), columns_(columns) {
    for (int j = 0; j + 1 < columns; ++j) x_[j] = Uniform();
  }
  void Fill(RowMajorMatrix* block) {
    for (Eigen::Index i = 0; i < block->rows(); ++i) {
      double last = 1e-3 * Uniform();
      double* row = &(*block)(i, 0);
      for (int j = 0; j + 1 < columns_; ++j) {
        row[j] = Uniform();
        last += x_[j] * row[j];
      }
      row[columns_ - 1] = last;
    }
  }

 private:
  double Uniform() {  // xorshift64 (Marsaglia 2003)
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<double>(static_cast<std::int64_t>(state_)) * 0x1p-63;
  }
  std::uint64_t state_ = 88172645463325252u;
  std::vector<double> x_;
  int columns_;
};

// Calls consume(block) with all the rows.
void Stream(int rows, int columns, const std::function<void(const RowMajorMatrix&)>& consume) {
  Rows source(columns);
  RowMajorMatrix block(kBlockRows, columns);
  for (int done = 0; done < rows; done += static_cast<int>(block.rows())) {
    if (rows - done < kBlockRows) block.resize(rows - done, columns);
    source.Fill(&block);
    consume(block);
  }
}

MatrixXd Whole(int rows, int columns) {
  MatrixXd w(rows, columns);
  Eigen::Index filled = 0;
  Stream(rows, columns, [&](const RowMajorMatrix& block) {
    w.middleRows(filled, block.rows()) = block;
    filled += block.rows();
  });
  return w;
}

// The last right singular vector by dgesdd, jobz as LAPACK has it; destroys w.
VectorXd LapackLastVector(const char* jobz, MatrixXd* w) {
  const int rows = static_cast<int>(w->rows()), columns = static_cast<int>(w->cols());
  MatrixXd u(rows, columns), vt(columns, columns);
  VectorXd s(columns);
  std::vector<int> integers(8 * static_cast<std::size_t>(columns));
  int info = 0, size = -1;
  double best = 0.0;
  dgesdd_(jobz, &rows, &columns, w->data(), &rows, s.data(), u.data(), &rows, vt.data(), &columns, &best, &size,
          integers.data(), &info);
  size = static_cast<int>(best);
  std::vector<double> work(size);
  dgesdd_(jobz, &rows, &columns, w->data(), &rows, s.data(), u.data(), &rows, vt.data(), &columns, work.data(), &size,
          integers.data(), &info);
  CHECK_EQ(info, 0);
  return vt.row(columns - 1);
}

void LapackQr(MatrixXd* w) {
  const int rows = static_cast<int>(w->rows()), columns = static_cast<int>(w->cols());
  VectorXd tau(columns);
  int info = 0, size = -1;
  double best = 0.0;
  dgeqrf_(&rows, &columns, w->data(), &rows, tau.data(), &best, &size, &info);
  size = static_cast<int>(best);
  std::vector<double> work(size);
  dgeqrf_(&rows, &columns, w->data(), &rows, tau.data(), work.data(), &size, &info);
  CHECK_EQ(info, 0);
}

MatrixXd UpperTriangle(const MatrixXd& w) { return w.topRows(w.cols()).triangularView<Eigen::Upper>(); }

VectorXd EigenLastVector(const MatrixXd& r) {
  return Eigen::BDCSVD<MatrixXd>(r, Eigen::ComputeFullV).matrixV().rightCols(1);
}

void NoRoute(Measurement*) {
  double sum = 0.0;
  Stream(FLAGS_rows, FLAGS_columns, [&](const RowMajorMatrix& block) { sum += block(0, 0); });
  CHECK_LT(sum, FLAGS_rows);
}

enum class Timed { kAll, kFactor, kSvd };

void Tsqr(idim::FoldVariant variant, bool row_by_row, Timed timed, Measurement* m) {
  idim::TriangularFactor factor(FLAGS_columns, variant);
  const auto time = [&](bool on, const std::function<void()>& work) {
    if (on) m->Start();
    work();
    if (on) m->Stop();
  };
  Stream(FLAGS_rows, FLAGS_columns, [&](const RowMajorMatrix& block) {
    time(timed != Timed::kSvd, [&] {
      if (!row_by_row) return factor.AddRows(block);
      for (Eigen::Index i = 0; i < block.rows(); ++i) factor.AddRow(block.row(i));
    });
  });
  MatrixXd r;
  VectorXd v;
  time(timed != Timed::kSvd, [&] { r = factor.R(); });
  time(timed != Timed::kFactor, [&] { v = EigenLastVector(r); });
  m->SetVector(v);
}

// LAPACK's own folding of rows into a triangle, block by block: the same workspace.
void LapackStreamed(Measurement* m) {
  const int columns = FLAGS_columns, none = 0, panel = std::min(8, columns);  // the fastest of 4 to 35 where measured
  MatrixXd r = MatrixXd::Zero(columns, columns), t(panel, columns), work(panel, columns), copy;
  Stream(FLAGS_rows, columns, [&](const RowMajorMatrix& block) {
    m->Start();
    copy = block;
    const int rows = static_cast<int>(copy.rows());
    int info = 0;
    dtpqrt_(&rows, &columns, &none, &panel, r.data(), &columns, copy.data(), &rows, t.data(), &panel, work.data(),
            &info);
    m->Stop();
    CHECK_EQ(info, 0);
  });
  m->Start();
  MatrixXd triangle = UpperTriangle(r);
  const VectorXd v = LapackLastVector("S", &triangle);
  m->Stop();
  m->SetVector(v);
}

void LapackWhole(Measurement* m) {
  MatrixXd w = Whole(FLAGS_rows, FLAGS_columns);
  m->Start();
  LapackQr(&w);
  MatrixXd r = UpperTriangle(w);
  const VectorXd v = LapackLastVector("S", &r);
  m->Stop();
  m->SetVector(v);
}

void LapackSvd(Measurement* m) {
  MatrixXd w = Whole(FLAGS_rows, FLAGS_columns);
  m->Start();
  const VectorXd v = LapackLastVector("S", &w);
  m->Stop();
  m->SetVector(v);
}

// As long as the 2 r c^2 operations of the reflections take at the speed of a matrix product.
void MatrixProduct(Measurement* m) {
  const int n = 768;
  const double one = 1.0, zero = 0.0;
  const MatrixXd a = MatrixXd::Random(n, n), b = MatrixXd::Random(n, n);
  MatrixXd c = MatrixXd::Zero(n, n);
  const auto multiply = [&] { dgemm_("N", "N", &n, &n, &n, &one, a.data(), &n, b.data(), &n, &zero, c.data(), &n); };
  multiply();
  const int times = 10;
  m->Start();
  for (int k = 0; k < times; ++k) multiply();
  m->Stop();
  m->error = (c.col(0) - a * b.col(0)).norm() / c.col(0).norm();
  const double floor = 2.0 * FLAGS_rows * FLAGS_columns * FLAGS_columns / (times * 2.0 * n * n * n);
  m->cpu *= floor;
  m->wall *= floor;
}

// Six joints of 900 rows x 62 columns, as one identification of a 6R arm has them; 100 times.
constexpr int kJoints = 6, kSmallRows = 900, kSmallColumns = 62, kSmallTimes = 100;

void Small(const std::function<MatrixXd(const RowMajorMatrix&)>& factor, Measurement* m) {
  RowMajorMatrix w(kSmallRows, kSmallColumns);
  Rows(kSmallColumns).Fill(&w);
  MatrixXd r = factor(w);
  m->Start();
  for (int k = 0; k < kSmallTimes * kJoints; ++k) r = factor(w);
  m->Stop();
  m->cpu /= kSmallTimes;
  m->wall /= kSmallTimes;
  m->error = (r.transpose() * r - w.transpose() * w).norm() / w.squaredNorm();
}

void SmallTsqr(Measurement* m) {
  Small(
      [](const RowMajorMatrix& w) {
        idim::TriangularFactor factor(kSmallColumns);
        for (int i = 0; i < kSmallRows; ++i) factor.AddRow(w.row(i));
        return factor.R();
      },
      m);
}

void SmallEigen(Measurement* m) {
  Small([](const RowMajorMatrix& w) { return UpperTriangle(Eigen::HouseholderQR<MatrixXd>(w).matrixQR()); }, m);
}

void SmallLapack(Measurement* m) {
  Small(
      [](const RowMajorMatrix& w) {
        MatrixXd copy = w;
        LapackQr(&copy);
        return UpperTriangle(copy);
      },
      m);
}

struct Route {
  std::string name;
  std::function<void(Measurement*)> run;
  std::vector<Measurement> measurements = {};
  double peak_mb = 0.0;
};

void RunOnce(Route* route) {
  int channel[2];
  CHECK_EQ(pipe(channel), 0);
  const pid_t child = fork();
  CHECK_GE(child, 0);
  if (child == 0) {
    Measurement m;
    route->run(&m);
    _exit(write(channel[1], &m, sizeof(m)) == sizeof(m) ? 0 : 1);
  }
  Measurement m;
  close(channel[1]);
  const bool complete = read(channel[0], &m, sizeof(m)) == sizeof(m);
  close(channel[0]);
  int status = 0;
  rusage usage;
  CHECK_EQ(wait4(child, &status, 0, &usage), child);
  CHECK(complete && status == 0) << route->name << " failed, by lack of memory perhaps";
  route->measurements.push_back(m);
  route->peak_mb = std::max(route->peak_mb, static_cast<double>(usage.ru_maxrss) / 1024.0);
}

double Least(const Route& route, double Measurement::*time) {
  double least = route.measurements[0].*time;
  for (const Measurement& m : route.measurements) least = std::min(least, m.*time);
  return least;
}

double MedianRatio(const Route& route, const Route& reference) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k < route.measurements.size(); ++k) {
    ratios.push_back(route.measurements[k].cpu / reference.measurements[k].cpu);
  }
  std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
  return ratios[ratios.size() / 2];
}

// reference: whose singular vector the others are compared with, or null.
void Print(const char* title, const char* last, const std::vector<Route>& routes, const Route& own,
           const Route* reference) {
  std::printf("\n%s\n%-44s %10s %10s %8s %9s  %s\n", title, "route", "CPU [ms]", "wall [ms]", "ratio", "peak [MB]",
              last);
  for (const Route& route : routes) {
    const Measurement& m = route.measurements.front();
    const double cpu = Least(route, &Measurement::cpu);
    std::printf("%-44s ", route.name.c_str());
    if (cpu == 0.0) {
      std::printf("%10s %10s %8s %9.1f\n", "", "", "", route.peak_mb);
      continue;
    }
    double difference = m.error;
    if (reference && m.vector[0] != 0.0) {
      const Measurement& r = reference->measurements.front();
      for (int j = 0; j < kMaxColumns; ++j) difference = std::max(difference, std::abs(m.vector[j] - r.vector[j]));
    }
    std::printf("%10.2f %10.2f %8.2f %9.1f  %.1e\n", 1e3 * cpu, 1e3 * Least(route, &Measurement::wall),
                MedianRatio(route, own), route.peak_mb, difference);
  }
}

void Main() {
  using idim::FoldVariant;
  const std::vector<FoldVariant>& variants = idim::AvailableFoldVariants();
  const char* const names[] = {"baseline", "AVX2", "AVX-512"};
  const FoldVariant best = variants.back();
  std::vector<Route> routes = {
      {"rows made, nothing done", NoRoute},
      {"TriangularFactor + SVD of R (Eigen)", [=](Measurement* m) { Tsqr(best, false, Timed::kAll, m); }},
  };
  for (const FoldVariant v : variants) {
    routes.push_back({std::string("  without the SVD, ") + names[static_cast<int>(v)],
                      [v](Measurement* m) { Tsqr(v, false, Timed::kFactor, m); }});
  }
  routes.push_back({"  the SVD of R alone", [=](Measurement* m) { Tsqr(best, false, Timed::kSvd, m); }});
  routes.push_back({"  without the SVD, row by row", [=](Measurement* m) { Tsqr(best, true, Timed::kFactor, m); }});
  routes.push_back({"LAPACK, streamed: dtpqrt + dgesdd of R", LapackStreamed});
  routes.push_back({"LAPACK, W whole: dgeqrf + dgesdd of R", LapackWhole});
  if (FLAGS_full_svd) routes.push_back({"LAPACK, W whole: dgesdd of W", LapackSvd});
  const std::size_t reference = routes.size() - 1;
  routes.push_back({"2 r c^2 operations as dgemm does them", MatrixProduct});
  std::vector<Route> small = {{"TriangularFactor, row by row", SmallTsqr},
                              {"Eigen::HouseholderQR", SmallEigen},
                              {"LAPACK dgeqrf", SmallLapack}};
  for (int k = 0; k < FLAGS_repetitions; ++k) {
    for (Route& route : routes) RunOnce(&route);
    for (Route& route : small) RunOnce(&route);
  }
  std::printf("OpenBLAS as %s (OPENBLAS_CORETYPE=%s), one thread; TriangularFactor as %s; %d repetitions.\n",
              openblas_get_corename(), std::getenv("OPENBLAS_CORETYPE"), names[static_cast<int>(best)],
              FLAGS_repetitions);
  std::printf("Times: least of all. Ratio: CPU time to that of TriangularFactor, median over the repetitions.\n");
  const std::string title =
      std::to_string(FLAGS_rows) + " x " + std::to_string(FLAGS_columns) + ": last right singular vector v";
  Print(title.c_str(), FLAGS_full_svd ? "max |v - v(dgesdd of W)|" : "max |v - v(dgeqrf)|", routes, routes[1],
        &routes[reference]);
  Print("6 x (900 x 62): R", "|R'R - W'W| / |W'W|", small, small[0], nullptr);
}

// The library reads the environment before main: set it, and start anew.
void SetPeerUp(char** argv) {
  if (std::getenv("OPENBLAS_CORETYPE") && std::getenv("OPENBLAS_NUM_THREADS")) return;
  const char* core = "";
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl")) {
    core = "SkylakeX";
  } else if (__builtin_cpu_supports("avx2")) {
    core = "Haswell";
  }
#endif
  setenv("OPENBLAS_CORETYPE", core, 0);
  setenv("OPENBLAS_NUM_THREADS", "1", 0);
  execv("/proc/self/exe", argv);
  LOG(FATAL) << "cannot start anew";
}

}  // namespace

int main(int argc, char** argv) {
  SetPeerUp(argv);
  google::InitGoogleLogging(argv[0]);
  idim::ParseFlags({"tsqr_benchmark", {}, {}, "times TriangularFactor beside LAPACK"}, &argc, &argv);
  if (FLAGS_columns < 2 || FLAGS_columns > kMaxColumns || FLAGS_rows < FLAGS_columns || FLAGS_repetitions < 1) {
    std::fprintf(stderr, "expected 2 <= columns <= %d, rows >= columns, repetitions >= 1\n", kMaxColumns);
    return 1;
  }
  Main();
  return 0;
}
