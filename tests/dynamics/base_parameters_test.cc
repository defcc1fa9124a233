// Base parameters found by QR against the closed-form grouping rules, which share no code with it.

#include "core/dynamics/base_parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <set>
#include <string>

#include "core/base/decompositions.h"
#include "tests/support/random_arm.h"

namespace idim::base_parameters_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajorMatrix = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;

struct DhRow {
  char type;
  double alpha, d, theta, r;
};

// The grouping rules of Gautier & Khalil (1990), also Khalil & Dombre (2002), 9.4.2, for serial arms in which no
// prismatic joint lies between the first revolute joint and the first not parallel to it. Returns the map from
// standard parameters to grouped ones; rows of eliminated parameters are zero.
MatrixXd ClosedFormRules(const std::vector<DhRow>& dh, bool first_axis_along_gravity, bool second_axis_orthogonal,
                         const StandardModel& model) {
  const int n = static_cast<int>(dh.size());
  MatrixXd map = MatrixXd::Identity(model.columns(), model.columns());
  const auto row = [&](const std::string& name, int joint) { return model.Find(name + std::to_string(joint + 1)); };
  const auto group = [&](int target, double factor, int source) { map.row(target) += factor * map.row(source); };
  const auto eliminate = [&](const std::string& name, int joint) { map.row(row(name, joint)).setZero(); };
  int r1 = 0;
  while (dh[r1].type != 'R') ++r1;
  for (int j = n - 1; j >= 0; --j) {
    const double ca = std::cos(dh[j].alpha), sa = std::sin(dh[j].alpha), d = dh[j].d, r = dh[j].r;
    if (dh[j].type == 'R') {
      const int yy = row("YY", j), mz = row("MZ", j), m = row("M", j);
      group(row("XX", j), -1.0, yy);
      if (j > 0) {
        const struct {
          const char* name;
          double yy, mz, m;
        } rules[] = {
            {"XX", 1.0, 2 * r, r * r},
            {"XY", 0.0, d * sa, d * r * sa},
            {"XZ", 0.0, -d * ca, -d * r * ca},
            {"YY", ca * ca, 2 * r * ca * ca, d * d + r * r * ca * ca},
            {"YZ", ca * sa, 2 * r * ca * sa, r * r * ca * sa},
            {"ZZ", sa * sa, 2 * r * sa * sa, d * d + r * r * sa * sa},
            {"MX", 0.0, 0.0, d},
            {"MY", 0.0, -sa, -r * sa},
            {"MZ", 0.0, ca, r * ca},
            {"M", 0.0, 0.0, 1.0},
        };
        for (const auto& rule : rules) {
          const int target = row(rule.name, j - 1);
          group(target, rule.yy, yy);
          group(target, rule.mz, mz);
          group(target, rule.m, m);
        }
      }
      for (const char* name : {"YY", "MZ", "M"}) eliminate(name, j);
    } else {
      // The tensor of a link that only slides turns with the link before it: I(j-1) += R I(j) R'.
      const Eigen::Matrix3d rotation =
          JointFromModifiedDh(JointType::kPrismatic, dh[j].alpha, 0, dh[j].theta, 0).rotation;
      const char* names[] = {"XX", "XY", "XZ", "YY", "YZ", "ZZ"};
      const int at[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
      for (int source = 0; source < 6; ++source) {
        InertialVector unit = InertialVector::Zero();
        unit[source] = 1.0;
        const Eigen::Matrix3d turned = rotation * InertiaTensor(unit) * rotation.transpose();
        for (int target = 0; j > 0 && target < 6; ++target) {
          group(row(names[target], j - 1), turned(at[target][0], at[target][1]), row(names[source], j));
        }
      }
      for (const char* name : names) eliminate(name, j);
      if (j < r1) {
        for (const char* name : {"MX", "MY", "MZ"}) eliminate(name, j);
        if (j == 0) group(row("M", 0), 1.0, row("Ia", 0)), eliminate("Ia", 0);
      }
    }
    if (j == r1) {
      for (const char* name : {"XX", "XY", "XZ", "YZ"}) eliminate(name, j);
      if (first_axis_along_gravity) {
        for (const char* name : {"MX", "MY"}) eliminate(name, j);
      }
      group(row("ZZ", j), 1.0, row("Ia", j));
      eliminate("Ia", j);
    }
    if (j == r1 + 1 && second_axis_orthogonal) {
      group(row("ZZ", j), 1.0, row("Ia", j));
      eliminate("Ia", j);
    }
  }
  return map;
}

struct Case {
  std::string name;
  std::vector<DhRow> dh;
  Eigen::Vector3d gravity;
  bool first_axis_along_gravity, second_axis_orthogonal;
  int expected;  // number of base parameters where the literature states it, else -1
};

std::vector<Case> Cases() {
  Random random(41);
  const auto arm = [&](const std::string& types) {
    std::vector<DhRow> dh;
    for (const char type : types) {
      dh.push_back(
          {type, random.Uniform(0.3, 1.2), random.Uniform(0.1, 0.5), random.Uniform(-3, 3), random.Uniform(-0.5, 0.5)});
    }
    return dh;
  };
  const Eigen::Vector3d down(0, 0, -9.81), tilted(3.0, -2.0, -9.0);
  // A first prismatic joint groups its drive inertia with the mass only where gravity is across its axis.
  const std::vector<DhRow> sliding = arm("PRRRRR");
  const Eigen::Vector3d across(-9.0, 3.0 * std::cos(sliding[0].alpha), 3.0 * std::sin(sliding[0].alpha));
  const double h = M_PI_2;
  return {
      {"Tx40",
       {{'R', 0, 0, 0, 0},
        {'R', -h, 0, -h, 0},
        {'R', 0, .225, h, .035},
        {'R', h, 0, 0, .225},
        {'R', -h, 0, 0, 0},
        {'R', h, 0, M_PI, 0}},
       down,
       true,
       true,
       61 - 3},  // 61 with the three parameters of the 5-6 coupling
      {"Random6R", arm("RRRRRR"), tilted, false, false, -1},
      {"RandomPrismaticThird", arm("RRPRRR"), tilted, false, false, -1},
      {"RandomPrismaticLast", arm("RRRRRP"), tilted, false, false, -1},
      {"RandomPrismaticFirst", sliding, across, false, false, -1},
      {"Random12", arm("RRRPRRRRPRRR"), tilted, false, false, -1},
  };
}

class ClosedForm : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Arms, ClosedForm, ::testing::ValuesIn(Cases()),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(ClosedForm, SameParametersKeptAndSameRegroupings) {
  const Case& c = GetParam();
  Robot robot;
  for (const DhRow& row : c.dh) {
    robot.joints.push_back(JointFromModifiedDh(row.type == 'R' ? JointType::kRevolute : JointType::kPrismatic,
                                               row.alpha, row.d, row.theta, row.r));
  }
  robot.gravity = c.gravity;
  const BaseParameters base{StandardModel(robot, FrictionModel{})};
  const MatrixXd rules = ClosedFormRules(c.dh, c.first_axis_along_gravity, c.second_axis_orthogonal, base.model());
  MatrixXd found = MatrixXd::Zero(rules.rows(), rules.cols());
  for (int k = 0; k < base.size(); ++k) found.row(base.kept()[k]) = base.projection().row(k);
  if (c.expected >= 0) {
    EXPECT_EQ(base.size(), c.expected);
  }
  for (int p = 0; p < rules.rows(); ++p) {
    EXPECT_LT((found.row(p) - rules.row(p)).norm(), 1e-9)
        << base.model().parameters()[p].name << "\nQR    " << found.row(p) << "\nrules " << rules.row(p);
  }
  EXPECT_GT(base.smallest_kept(), 1e3 * base.largest_dropped());
}

// The torque of a state does not care which set of base parameters describes it.
TEST(BaseParameters, TorqueIsThatOfTheStandardParameters) {
  Random random(9);
  for (const std::string types : {"R", "P", "RRRRRR", "RPRRPR", "PPP", "RRRRRRRRRRRR"}) {
    StandardModel model(testing::RandomArm(types, &random), FrictionModel{});
    const BaseParameters base(model);
    const int n = model.dof();
    const VectorXd chi_st = random.Vector(model.columns(), 1.0);
    const VectorXd chi = base.projection() * chi_st;
    RowMajorMatrix w(n, model.columns());
    for (int trial = 0; trial < 10; ++trial) {
      const VectorXd q = random.Vector(n, M_PI), dq = random.Vector(n, 3.0), ddq = random.Vector(n, 10.0);
      model.Regressor(q.data(), dq.data(), ddq.data(), nullptr, w.data());
      VectorXd tau = VectorXd::Zero(n);
      for (int k = 0; k < base.size(); ++k) tau += w.col(base.kept()[k]) * chi[k];
      EXPECT_LT((tau - w * chi_st).norm(), 1e-11 * tau.norm()) << types;
    }
  }
}

// Another basis of the same columns, picked by QR with free pivoting, describes the same torque.
TEST(BaseParameters, TorqueDoesNotDependOnTheirChoice) {
  Random random(31);
  StandardModel model(testing::Tx40(), FrictionModel{});
  const BaseParameters base(model);
  const int n = 6, states = 100;
  const auto sample = [&](int count) {
    RowMajorMatrix all(n * count, model.columns()), w(n, model.columns());
    for (int k = 0; k < count; ++k) {
      const VectorXd q = random.Vector(n, M_PI), dq = random.Vector(n, 3.0), ddq = random.Vector(n, 10.0);
      model.Regressor(q.data(), dq.data(), ddq.data(), nullptr, w.data());
      all.middleRows(n * k, n) = w;
    }
    return all;
  };
  const RowMajorMatrix w = sample(states);
  Eigen::ColPivHouseholderQR<MatrixXd> qr(w);
  qr.setThreshold(1e-10);
  ASSERT_EQ(qr.rank(), base.size());
  const VectorXd chi_st = random.Vector(model.columns(), 1.0);
  const VectorXd other = qr.solve(w * chi_st);  // basic solution: zero but for its own choice of columns
  std::set<int> mine(base.kept().begin(), base.kept().end());
  int not_mine = 0;
  for (Eigen::Index k = 0; k < other.size(); ++k) not_mine += other[k] != 0.0 && mine.count(static_cast<int>(k)) == 0;
  EXPECT_GT(not_mine, 0) << "the other choice should differ";
  const RowMajorMatrix elsewhere = sample(20);
  VectorXd by_base = VectorXd::Zero(elsewhere.rows());
  const VectorXd chi = base.projection() * chi_st;
  for (int k = 0; k < base.size(); ++k) by_base += elsewhere.col(base.kept()[k]) * chi[k];
  EXPECT_LT((by_base - elsewhere * other).norm(), 1e-10 * by_base.norm());
}

TEST(BaseParameters, OtherRandomStatesGiveTheSameSet) {
  BaseParameterOptions other;
  other.seed = 987654321;
  const StandardModel model(testing::Tx40(), FrictionModel{});
  const BaseParameters a(model), b(model, other);
  EXPECT_EQ(a.kept(), b.kept());
  EXPECT_LT((a.projection() - b.projection()).norm(), 1e-9);
  EXPECT_EQ(a.regroupings(), b.regroupings());
}

// Counts and names of the paper's robot: 61 with the coupling and Fv, Fs, offset; every name of Tables I and III.
TEST(BaseParameters, Tx40HasThePapersNames) {
  const BaseParameters base{StandardModel(testing::Tx40(), FrictionModel{})};
  EXPECT_EQ(base.size(), 61);
  std::vector<std::string> names;
  for (const Parameter& p : base.parameters()) names.push_back(p.name);
  for (const char* name : {"ZZ1R", "XX2R", "XZ2R", "ZZ2R", "MX2R", "XX3R", "ZZ3R", "MX3",  "MY3R", "Ia3",
                           "XY4",  "MX4",  "Ia4",  "MY5R", "Ia5",  "Ia6",  "Iam6", "Fvm6", "Fsm6", "off6"}) {
    EXPECT_THAT(names, ::testing::Contains(name));
  }
  EXPECT_THAT(base.regroupings()[0], ::testing::HasSubstr("ZZ1 + Ia1 + YY2 + YY3"));
}

}  // namespace
}  // namespace idim::base_parameters_test
