// W_tot of paper eq. (17): all drive gains, base parameters and unknown payload parameters in one homogeneous system,
//
//   [V | -W | -W_uL | -W_kL chi_kL] (g, chi, chi_uL, 1) = rho,
//
// held as one triangular factor a joint. Unknowns in this order: gains g1..gn, base parameters, unknown payload
// parameters; the last column is the torque of the known payload parameters, which alone sets the scale of
// everything. Signal on the motor side: tau = T' diag(g) v, so the column of a gain is T(m, j) v_m in the rows of every
// joint j that its motor drives; on the joint side V is block-diagonal (eq. (14)).
//
// Any number of recordings and payloads; any subset of the ten parameters of each payload known.

#ifndef IDIM_SOLVERS_LINEAR_GAIN_SYSTEM_H_
#define IDIM_SOLVERS_LINEAR_GAIN_SYSTEM_H_

#include <Eigen/Core>
#include <array>
#include <functional>
#include <utility>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/parameters.h"
#include "core/model/model.h"
#include "core/model/sample_stream.h"
#include "core/model/unknowns.h"
#include "core/statistics/triangular_factor.h"

namespace idim {

struct GainSystem {
  std::vector<Parameter> unknowns;
  std::vector<TriangularFactor> joints;  // one a joint; columns: unknowns, then the known torque, [N.m or N] a row
  // The rows of loaded recordings again, for the verdicts on gains: columns g1..gn, the known payload's torque, and
  // what of that is gravity (taken at the decimated positions).
  std::vector<TriangularFactor> loads;
  Eigen::VectorXd a_priori_gains;  // n, or empty

  GainSystem(std::vector<Parameter> unknowns_in, int dof)
      : unknowns(std::move(unknowns_in)),
        joints(dof, TriangularFactor(static_cast<int>(unknowns.size()) + 1)),
        loads(dof, TriangularFactor(dof + 2)) {}

  int dof() const { return static_cast<int>(joints.size()); }
  // Adds the rows of a system with the same unknowns: other recordings, other machines.
  void Merge(const GainSystem& other);
};

// The rows of W_tot, one decimated sample after the other.
class GainRows {
 public:
  using RowMajorMatrix = Observation::RowMajorMatrix;
  // BadInput as BuildGainSystem. `prepared` must outlive this.
  static Result<GainRows> Create(const PreparedStudy& prepared);

  const Unknowns& unknowns() const { return unknowns_; }
  // Calls `visit` with n x (unknowns + 1) for each sample of a recording of the data in order of time.
  void Stream(int recording, const std::function<void(const RowMajorMatrix& rows)>& visit) const;

 private:
  explicit GainRows(const PreparedStudy& prepared)
      : prepared_(prepared), unknowns_(prepared.model, UncertainPayload::kExact) {}

  const PreparedStudy& prepared_;
  const Unknowns unknowns_;
};

// BadInput: what BuildGainSystem refuses.
Status CheckGainStudy(const PreparedStudy& prepared);

// One pass over the identification recordings of a study with gains.mode identify.
// BadInput: gains that are known; no identification recording with a payload of which a parameter other than 0 is
// known, without which gains and parameters have no scale.
Result<GainSystem> BuildGainSystem(const PreparedStudy& prepared);

}  // namespace idim

#endif  // IDIM_SOLVERS_LINEAR_GAIN_SYSTEM_H_
