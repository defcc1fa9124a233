#include "solvers/consistent/plausible_parameters.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <Eigen/Eigenvalues>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/base/random.h"
#include "core/effects/simulated_effects.h"
#include "core/robot/log_cholesky.h"
#include "core/robot/robot_reader.h"
#include "core/simulation/scenario.h"
#include "core/simulation/simulate_scenario.h"
#include "residuals/base_parameter_residual.h"

namespace idim::plausible_parameters_test {
namespace {

namespace fs = std::filesystem;

const std::string kTx40 = std::string(IDIM_SOURCE_DIR) + "/datasets/tx40_synthetic/";

double SmallestEigenvalue(const InertialVector& x) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(PseudoInertia(x)).eigenvalues()[0];
}

InertialVector LinkOf(const StandardModel& model, const Eigen::VectorXd& chi, int link) {
  return chi.segment<kNumInertial>(model.Find("XX" + std::to_string(link + 1)));
}

BaseParameters Tx40() {
  Result<Robot> robot = ReadRobot(kTx40 + "robot.yaml");
  EXPECT_TRUE(robot.ok()) << robot.status().message();
  return BaseParameters(StandardModel(*robot, FrictionModel()));
}

// Everything that makes a body or a drive impossible.
void ExpectConsistent(const StandardModel& model, const Eigen::VectorXd& chi) {
  for (int link = 0; link < model.dof(); ++link) EXPECT_GT(SmallestEigenvalue(LinkOf(model, chi, link)), 0.0) << link;
  for (int c = 0; c < model.columns(); ++c) {
    const Parameter& parameter = model.parameters()[c];
    const bool offset = parameter.name.rfind("off", 0) == 0;
    if (parameter.kind == ParameterKind::kBase || offset) continue;
    EXPECT_GE(chi[c], 0.0) << parameter.name;
  }
}

TEST(LogCholesky, ZeroIsTheReferenceBody) {
  const Eigen::Vector3d centre(0.1, -0.2, 0.05), radii(0.03, 0.08, 0.05);
  const Eigen::Matrix4d factor = PseudoInertiaFactor(4.0, centre, radii);
  const double theta[kNumInertial] = {};
  InertialVector x;
  InertialFromLogCholesky(factor, theta, x.data());
  const Eigen::Array3d r2 = radii.array().square();
  const Eigen::Matrix3d tensor = Eigen::Vector3d(4.0 * (r2.sum() - r2)).asDiagonal();
  EXPECT_TRUE(x.isApprox(InertialFromCentreOfMass(4.0, centre, tensor), 1e-14));
}

TEST(LogCholesky, EveryThetaIsAConsistentBodyWithThePseudoInertiaOfItsFactors) {
  Random random(1);
  const Eigen::Matrix4d factor = PseudoInertiaFactor(2.0, {0.1, 0.0, -0.1}, {0.05, 0.06, 0.07});
  for (int k = 0; k < 200; ++k) {
    double theta[kNumInertial];
    for (double& value : theta) value = 2.0 * random.Normal();
    InertialVector x;
    InertialFromLogCholesky(factor, theta, x.data());
    EXPECT_NEAR(x[kM], 2.0 * std::exp(2.0 * theta[0]), 1e-12 * x[kM]);
    Eigen::Matrix4d v = Eigen::Matrix4d::Zero();
    v << std::exp(theta[1]), theta[4], theta[6], theta[7], 0, std::exp(theta[2]), theta[5], theta[8], 0, 0,
        std::exp(theta[3]), theta[9], 0, 0, 0, 1;
    const Eigen::Matrix4d u = std::exp(theta[0]) * factor * v;
    EXPECT_TRUE(PseudoInertia(x).isApprox(u * u.transpose(), 1e-12));
    EXPECT_GT(Eigen::LLT<Eigen::Matrix4d>(PseudoInertia(x)).matrixL().determinant(), 0.0);
  }
}

TEST(BaseParameterResidual, IsTheWhitenedDifference) {
  const BaseParameters base = Tx40();
  const StandardModel& model = base.model();
  Eigen::MatrixXd map(2, model.columns());
  map.row(0) = base.projection().row(4);  // XX2R
  map.row(1).setZero();
  map(1, model.Find("Ia2")) = 1.0;
  std::vector<Eigen::Matrix4d> references(6, PseudoInertiaFactor(3.0, {0.1, 0.0, 0.0}, {0.1, 0.1, 0.1}));
  std::vector<int> begin;
  for (int link = 1; link <= 6; ++link) begin.push_back(model.Find("XX" + std::to_string(link)));
  const std::vector<int> drives = {model.Find("Ia2")};
  const std::unique_ptr<ceres::CostFunction> cost(BaseParameterResidual::Create(std::make_unique<BaseParameterResidual>(
      map, Eigen::Vector2d(0.5, 0.2), Eigen::Vector2d(0.1, 0.01), references, begin, drives)));
  const double theta[kNumInertial] = {}, ia2 = 0.23;
  const double* blocks[] = {theta, theta, theta, theta, theta, theta, &ia2};
  double residuals[2];
  ASSERT_TRUE(cost->Evaluate(blocks, residuals, nullptr));
  // XX2R = XX2 - YY2 - 0.225^2 (M3 + M4 + M5 + M6); of this body XX - YY = -M 0.1^2.
  const double xx2r = -3.0 * 0.01 - 0.050625 * 12.0;
  EXPECT_NEAR(residuals[0], (xx2r - 0.5) / 0.1, 1e-9);
  EXPECT_NEAR(residuals[1], (0.23 - 0.2) / 0.01, 1e-12);
}

TEST(PlausibleParameters, SummaryDoesNotClaimAnythingBeforeTheCall) {
  const PlausibleSummary summary;
  EXPECT_FALSE(summary.IsSolutionUsable());
  EXPECT_LT(summary.largest_distance, 0.0);
}

// Base parameters of a robot that exists are reached, from rough bodies that differ from its own.
TEST(PlausibleParameters, ReachesThoseOfAnExistingRobot) {
  const BaseParameters base = Tx40();
  const StandardModel& model = base.model();
  PlausibleRequest request;
  Random random(7);
  Eigen::VectorXd chi(model.columns());
  for (double& value : chi) value = random.Uniform(0.1, 1.0);  // drives; links follow
  for (int link = 0; link < 6; ++link) {
    RoughBody body;
    body.mass = random.Uniform(1.0, 6.0);
    body.centre = 0.1 * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
    body.radii = Eigen::Vector3d(0.05, 0.07, 0.1);
    double theta[kNumInertial];
    for (double& value : theta) value = 0.3 * random.Normal();
    InertialFromLogCholesky(PseudoInertiaFactor(body.mass, body.centre, body.radii), theta,
                            &chi[model.Find("XX" + std::to_string(link + 1))]);
    request.bodies.push_back(body);
  }
  const Eigen::VectorXd truth = base.projection() * chi;
  for (int k = 0; k < base.size(); ++k) request.base.push_back({k, truth[k], 1e-3});
  const PlausibleSummary summary = FindPlausibleParameters(base, request);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_LT(summary.largest_distance, 0.5);
  EXPECT_TRUE(summary.base.isApprox(base.projection() * summary.chi, 1e-12));
  ExpectConsistent(model, summary.chi);
}

TEST(PlausibleParameters, WhatNoBodyHasIsNotReachedAndTheDistanceSaysSo) {
  const BaseParameters base = Tx40();
  PlausibleRequest request;
  request.bodies.assign(6, RoughBody{2.0, Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(0.05)});
  for (int k = 0; k < base.size(); ++k) {
    const std::string& name = base.parameters()[k].name;
    if (name == "ZZ6") request.base.push_back({k, -0.05, 0.01});  // an inertia below zero
    if (name == "Fv3") request.base.push_back({k, -0.3, 0.1});    // friction that drives
  }
  const PlausibleSummary summary = FindPlausibleParameters(base, request);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  ExpectConsistent(base.model(), summary.chi);
  EXPECT_EQ(summary.chi[base.model().Find("Fv3")], 0.0);
  ASSERT_EQ(summary.distance.size(), 2);
  EXPECT_GT(summary.distance.minCoeff(), 2.9);
  EXPECT_EQ(summary.largest_distance, summary.distance.maxCoeff());
}

class Tx40Plausible : public ::testing::Test {
 protected:
  Tx40Plausible() : base_(Tx40()) {
    Result<PlausibleRequest> request = ReadPlausibleRequest(kTx40 + "base_parameters.yaml", base_);
    EXPECT_TRUE(request.ok()) << request.status().message();
    request_ = std::move(request).value();
    Result<Scenario> scenario = ReadScenario(kTx40 + "scenario.yaml", EffectEquations());
    EXPECT_TRUE(scenario.ok()) << scenario.status().message();
    scenario_ = std::move(scenario).value();
  }

  BaseParameters base_;
  PlausibleRequest request_;
  Scenario scenario_;
};

TEST_F(Tx40Plausible, ScenarioHoldsWhatTheSolverFinds) {
  const PlausibleSummary summary = FindPlausibleParameters(base_, request_);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  // Written with six digits; the minimum is flat where only the rough bodies decide.
  EXPECT_LT((summary.chi - scenario_.chi).cwiseAbs().maxCoeff(), 1e-4 * scenario_.chi.cwiseAbs().maxCoeff());
}

TEST_F(Tx40Plausible, CouldExist) {
  const StandardModel& model = base_.model();
  ExpectConsistent(model, scenario_.chi);
  EXPECT_GT(SmallestEigenvalue(scenario_.payloads[0].inertial), 0.0);
  const auto value = [&](const char* name) { return scenario_.chi[model.Find(name)]; };
  // Kinetic energy and dissipation of the coupled drives of the wrist are positive: 2 x 2 matrices over joints 5 and 6.
  EXPECT_GT(value("Ia5") * value("Ia6"), std::pow(value("Iam6"), 2));
  EXPECT_GT(value("Fv5") * value("Fv6"), std::pow(value("Fvm6"), 2));
  double mass = 0.0;
  for (int link = 0; link < 6; ++link) {
    const InertialVector x = LinkOf(model, scenario_.chi, link);
    mass += x[kM];
    EXPECT_LT(x.segment<3>(kMX).norm() / x[kM], 0.2) << "centre of mass of link " << link + 1;  // [m]
    if (link == 0) continue;
    EXPECT_LT(x[kM], LinkOf(model, scenario_.chi, link - 1)[kM]);
  }
  EXPECT_LT(mass, 27.0);  // [kg] the maker's mass of the whole arm with its base
  EXPECT_GT(mass, 18.0);
}

// Table III of the paper, in its standard deviations: what README.md states.
TEST_F(Tx40Plausible, HasThePapersBaseParameters) {
  const Eigen::VectorXd reached = base_.projection() * scenario_.chi;
  EXPECT_EQ(request_.base.size(), 61u);
  for (const StatedParameter& stated : request_.base) {
    const std::string& name = base_.parameters()[stated.index].name;
    const double distance = std::abs(reached[stated.index] - stated.value) / stated.standard_deviation;
    const double bound = name == "XY4" ? 0.8 : name == "ZZ4R" ? 1.4 : stated.value == 0.0 ? 0.4 : 0.15;
    EXPECT_LT(distance, bound) << name;
  }
}

struct BadCase {
  const char* name;
  const char* from;
  const char* to;
  const char* expected;
  const char* word;
};

class BadRequest : public ::testing::TestWithParam<BadCase> {};

TEST_P(BadRequest, IsRefusedByTheProgramInOneLineAndNothingIsWritten) {
  std::string folder_name = (fs::temp_directory_path() / "idim_plausible_XXXXXX").string();
  const fs::path folder = ::mkdtemp(folder_name.data());
  std::stringstream text;
  text << std::ifstream(kTx40 + "base_parameters.yaml").rdbuf();
  std::string request = text.str();
  const size_t at = request.find(GetParam().from);
  ASSERT_NE(at, std::string::npos);
  request.replace(at, std::string(GetParam().from).size(), GetParam().to);
  std::ofstream(folder / "request.yaml") << request;
  const std::string command = std::string(IDIM_APPS_DIR) + "/idim_plausible " + kTx40 + "robot.yaml " +
                              (folder / "request.yaml").string() + " --output=" + (folder / "out").string() + " >" +
                              (folder / "table").string() + " 2>" + (folder / "errors").string();
  const int status = std::system(command.c_str());
  std::stringstream message;
  message << std::ifstream(folder / "errors").rdbuf();
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_NE(message.str().find(GetParam().expected), std::string::npos) << message.str();
  EXPECT_NE(message.str().find(GetParam().word), std::string::npos) << message.str();
  EXPECT_EQ(message.str().find('\n'), message.str().size() - 1) << message.str();
  EXPECT_FALSE(fs::exists(folder / "out"));
  fs::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadRequest,
    ::testing::Values(BadCase{"unknown_name", "ZZ1R", "ZZ1", "key 'base_parameters[1].name'", "ZZ1R"},
                      BadCase{"sigma_zero", "standard_deviation: 0.0261", "standard_deviation: 0",
                              "key 'base_parameters[1].standard_deviation'", "greater than 0"},
                      BadCase{"given_twice", "{name: Fv1", "{name: ZZ1R", "key 'base_parameters[2].name'", "twice"},
                      BadCase{"no_value", "value: 1.28, ", "", "key 'base_parameters[1].value': missing", "number"},
                      BadCase{"unknown_key", "spread: 0.7", "spreads: 0.7", "key 'spreads'", "spread"},
                      BadCase{"mass_negative", "mass: 7.0", "mass: -7.0", "key 'bodies[1].mass'", "greater than 0"},
                      BadCase{"radius_zero", "[0.07, 0.07, 0.08]", "[0.07, 0, 0.08]", "key 'bodies[1].radii'",
                              "greater than 0"},
                      BadCase{"a_body_too_few", "  - {mass: 0.8,", "  # {mass: 0.8,", "key 'bodies'", "has 5 entries"},
                      BadCase{"standard_name", "name: Ia1", "name: Ib1", "key 'standard_parameters[1].name'", "Ia1"}),
    [](const ::testing::TestParamInfo<BadCase>& case_info) { return case_info.param.name; });

}  // namespace
}  // namespace idim::plausible_parameters_test
