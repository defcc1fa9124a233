// A study built in code: what a file need not say is filled, what cannot be is refused by name, nothing crashes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "solvers/idim.h"
#include "tests/support/pendulum_study.h"

namespace idim::study_in_memory_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::MakePendulumStudy;
using testing::PendulumStudy;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(StudyInMemory, DefaultsAreFilled) {
  const Result<Study> study = CheckedStudy(MakePendulumStudy().study);
  ASSERT_TRUE(study.ok()) << study.status().message();
  EXPECT_EQ(study->gains, Eigen::VectorXd::Ones(2));
  EXPECT_EQ(study->robot.transmission, Eigen::MatrixXd::Identity(2, 2));
  EXPECT_EQ(study->recordings[0].name, "recording1");
  EXPECT_EQ(study->recordings[1].name, "recording2");
  EXPECT_EQ(study->path, "study");
}

// Four standard deviations a parameter: false alarm 6e-5 each. Encoders of 1e-6 rad bias nothing that could be seen.
TEST(StudyInMemory, EveryEstimatorFindsTheTruthAndIsJudged) {
  const PendulumStudy built = MakePendulumStudy();
  const Result<PreparedStudy> prepared = PrepareStudy(built.study, built.recordings);
  ASSERT_TRUE(prepared.ok()) << prepared.status().message();
  const Result<EstimatorRunner> runner = EstimatorRunner::Create(&*prepared);
  ASSERT_TRUE(runner.ok());
  for (const std::string& name : EstimatorNames(GainsMode::kKnown)) {
    const Result<Identification> found = runner->Run(name, 0.0);
    ASSERT_TRUE(found.ok()) << found.status().message();
    ASSERT_TRUE(found->estimate.status.ok()) << name << ": " << found->estimate.status.message();
    ASSERT_EQ(found->estimate.parameters.size(), static_cast<size_t>(built.base.size()));
    for (Eigen::Index k = 0; k < built.base.size(); ++k) {
      const ParameterEstimate& p = found->estimate.parameters[static_cast<size_t>(k)];
      EXPECT_NEAR(p.value, built.base[k], 4.0 * p.standard_deviation) << name << " " << p.parameter.name;
    }
    const Result<Validation> validation = Validate(*prepared, ReferenceOf(found->estimate));
    ASSERT_TRUE(validation.ok()) << validation.status().message();
    ASSERT_EQ(validation->recordings.size(), 1u);
    EXPECT_LT(validation->recordings[0].fit->relative_error_percent_all, 2.0) << name;
  }
}

// Same bytes from two threads at once on one study.
TEST(StudyInMemory, TwoThreadsShareAStudy) {
  const PendulumStudy built = MakePendulumStudy();
  const Result<PreparedStudy> shared = PrepareStudy(built.study, built.recordings);
  ASSERT_TRUE(shared.ok());
  std::vector<std::string> json(3);
  const auto run = [&](size_t k) {
    const Result<EstimatorRunner> runner = EstimatorRunner::Create(&*shared);
    Result<Identification> found = runner->Run("eiv", 0.0);
    found->estimate.seconds = 0.0;
    json[k] = EstimateToJson(found->estimate);
  };
  run(0);
  std::thread one(run, 1), two(run, 2);
  one.join(), two.join();
  EXPECT_FALSE(json[0].empty());
  EXPECT_EQ(json[1], json[0]);
  EXPECT_EQ(json[2], json[0]);
}

struct BadStudyInMemory {
  const char* name;
  std::function<void(PendulumStudy*)> spoil;
  std::vector<std::string> message;
};
void PrintTo(const BadStudyInMemory& bad, std::ostream* os) { *os << bad.name; }

class BadStudyInMemoryTest : public ::testing::TestWithParam<BadStudyInMemory> {};

TEST_P(BadStudyInMemoryTest, IsRefusedByName) {
  PendulumStudy built = MakePendulumStudy();
  GetParam().spoil(&built);
  const Status status = PrepareStudy(built.study, built.recordings).status();
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.code(), StatusCode::kBadInput);
  EXPECT_THAT(status.message(), AllOf(HasSubstr("study: "), HasSubstr("expected ")));
  for (const std::string& part : GetParam().message) EXPECT_THAT(status.message(), HasSubstr(part));
}

using S = PendulumStudy;
INSTANTIATE_TEST_SUITE_P(
    Table, BadStudyInMemoryTest,
    ::testing::Values(
        BadStudyInMemory{"no_joints", [](S* s) { s->study.robot.joints.clear(); }, {"robot: joints"}},
        BadStudyInMemory{
            "no_rotation", [](S* s) { s->study.robot.joints[1].rotation(0, 0) = kNaN; }, {"joints[1].rotation"}},
        BadStudyInMemory{"translation",
                         [](S* s) { s->study.robot.joints[0].translation[1] = kNaN; },
                         {"joints[0].translation", "not finite"}},
        BadStudyInMemory{"gravity", [](S* s) { s->study.robot.gravity[2] = kNaN; }, {"gravity", "not finite"}},
        BadStudyInMemory{"transmission_size",
                         [](S* s) { s->study.robot.transmission.setIdentity(3, 3); },
                         {"transmission", "3 x 3", "2 x 2"}},
        BadStudyInMemory{"transmission_singular",
                         [](S* s) { s->study.robot.transmission.setOnes(2, 2); },
                         {"transmission", "not invertible"}},
        BadStudyInMemory{"coupling_joint",
                         [](S* s) { s->study.robot.couplings = {{0, {0, 2}, {}}}; },
                         {"couplings[0].joints", "holds 2"}},
        BadStudyInMemory{"coupling_alone",
                         [](S* s) { s->study.robot.couplings = {{0, {0}, {}}}; },
                         {"couplings[0].joints", "two or more"}},
        BadStudyInMemory{"inertials",
                         [](S* s) { s->study.robot.declared_inertials.resize(1); },
                         {"declared_inertials", "has 1 bodies"}},
        BadStudyInMemory{"no_recordings",
                         [](S* s) { s->study.recordings.clear(), s->recordings.clear(); },
                         {"recordings is empty"}},
        BadStudyInMemory{"none_for_identification",
                         [](S* s) { s->study.recordings[0].use = Use::kValidation; },
                         {"none for identification"}},
        BadStudyInMemory{"fewer_recordings", [](S* s) { s->recordings.pop_back(); }, {"1 recordings for the 2"}},
        BadStudyInMemory{"name_twice",
                         [](S* s) { s->study.recordings[0].name = s->study.recordings[1].name = "a"; },
                         {"recordings[1].name", "'a' is given twice"}},
        BadStudyInMemory{"payload_index",
                         [](S* s) { s->study.recordings[0].payload = 0; },
                         {"recordings[0].payload", "is 0"}},
        BadStudyInMemory{"payload_nan",
                         [](S* s) {
                           s->study.payloads.resize(1);
                           s->study.payloads[0].name = "p";
                           s->study.payloads[0].known[kMX] = kNaN;
                         },
                         {"payloads[0].known[MX]"}},
        BadStudyInMemory{"payload_mass",
                         [](S* s) {
                           s->study.payloads.resize(1);
                           s->study.payloads[0].name = "p";
                           s->study.payloads[0].known[kM] = -1.0;
                         },
                         {"payloads[0].known[M]", "above 0"}},
        BadStudyInMemory{"gains_size", [](S* s) { s->study.gains.setOnes(3); }, {"gains", "has 3 values"}},
        BadStudyInMemory{"gains_nan", [](S* s) { s->study.gains = Eigen::Vector2d(1.0, kNaN); }, {"gains"}},
        BadStudyInMemory{"gains_zero", [](S* s) { s->study.gains = Eigen::Vector2d(1.0, 0.0); }, {"gains"}},
        BadStudyInMemory{"prior",
                         [](S* s) { s->study.priors = {{"ZZ1R", 1.0, 0.0, ""}}; },
                         {"priors[0].standard_deviation"}},
        BadStudyInMemory{"effect_joint",
                         [](S* s) {
                           s->study.effects.resize(1);
                           s->study.effects[0].id = "stribeck";
                           s->study.effects[0].joints = {2};
                         },
                         {"effects[0].joints", "holds 2"}},
        BadStudyInMemory{"effect_id",
                         [](S* s) {
                           s->study.effects.resize(1);
                           s->study.effects[0].id = "stribek";
                         },
                         {"effects[0].id", "nearest: stribeck"}},
        BadStudyInMemory{"position_noise", [](S* s) { s->study.position_noise.setOnes(3); }, {"position_noise"}},
        BadStudyInMemory{
            "signal_noise", [](S* s) { s->study.signal_noise = Eigen::Vector2d(1.0, -1.0); }, {"signal_noise"}},
        BadStudyInMemory{"cutoff", [](S* s) { s->study.preprocessing.cutoff_hz = kNaN; }, {"cutoff_hz"}},
        BadStudyInMemory{"decimation", [](S* s) { s->study.preprocessing.decimation = 0; }, {"decimation", "is 0"}},
        BadStudyInMemory{"one_sample",
                         [](S* s) { s->recordings[0].t.conservativeResize(1); },
                         {"'recording1'", "1 samples"}},
        BadStudyInMemory{"columns",
                         [](S* s) { s->recordings[1].q.conservativeResize(2000, 3); },
                         {"'recording2'", "q is 2000 x 3", "2000 x 2"}},
        BadStudyInMemory{"rows", [](S* s) { s->recordings[0].signal.conservativeResize(10, 2); }, {"signal is 10 x 2"}},
        BadStudyInMemory{"nan", [](S* s) { s->recordings[0].signal(5, 1) = kNaN; }, {"signal", "not finite"}},
        BadStudyInMemory{"time_nan", [](S* s) { s->recordings[0].t[5] = kNaN; }, {"t does not increase"}},
        BadStudyInMemory{"time_back", [](S* s) { s->recordings[0].t[5] = 0.0; }, {"t does not increase"}},
        BadStudyInMemory{"logged", [](S* s) { s->recordings[0].logged_dq.setZero(3, 2); }, {"logged_dq is 3 x 2"}},
        BadStudyInMemory{"torque_with_gains",
                         [](S* s) {
                           s->study.gains = Eigen::Vector2d(2.0, 1.0);
                           s->recordings[0].signal_is_torque = true;
                         },
                         {"signal is torque"}}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace idim::study_in_memory_test
