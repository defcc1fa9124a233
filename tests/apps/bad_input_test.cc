// Every kind of bad input, as a user meets it: one clear message, the right exit code, nothing written.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <vector>

#include "tests/apps/small_study.h"
#include "tests/support/program.h"

namespace idim::bad_input_test {
namespace {

using ::testing::HasSubstr;
using testing::Replace;
using testing::SmallStudy;

struct BadInput {
  std::string name;
  int exit_code;
  std::vector<std::string> message;  // all of these
  std::function<void(SmallStudy*)> spoil;
};

void PrintTo(const BadInput& input, std::ostream* os) { *os << input.name; }

// The zero-based line of the recording (0: header) replaced.
std::function<void(SmallStudy*)> Line(int line, const std::string& text) {
  return [=](SmallStudy* s) {
    size_t begin = 0;
    for (int k = 0; k < line; ++k) begin = s->csv.find('\n', begin) + 1;
    s->csv.replace(begin, s->csv.find('\n', begin) - begin, text);
  };
}

std::function<void(SmallStudy*)> Urdf(const std::string& joint) {
  return [=](SmallStudy* s) {
    s->robot = "name: arm\nurdf: arm.urdf\n";
    s->folder.Write("arm.urdf",
                    "<robot name='arm'><link name='a'/><link name='b'/><link name='c'/>"
                    "<joint name='one' type='revolute'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/>"
                    "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>" +
                        joint + "</robot>");
  };
}

const std::vector<BadInput> kTable = {
    {"MissingStudy", 1, {"study.yaml"}, [](SmallStudy* s) { s->flags = ""; }},
    {"MissingRecording", 1, {"a.csv", "no such file"}, [](SmallStudy* s) { s->csv.clear(); }},
    {"MissingRobot", 1, {"nowhere.yaml"}, [](SmallStudy* s) { Replace("robot.yaml", "nowhere.yaml", &s->study); }},
    {"UnknownStudyKey",
     1,
     {"study.yaml:5", "frictoin", "friction"},
     [](SmallStudy* s) { s->study += "frictoin: [viscous]\n"; }},
    {"UnknownRobotKey",
     1,
     {"robot.yaml:2", "gravitation"},
     [](SmallStudy* s) { Replace("gravity", "gravitation", &s->robot); }},
    {"TooFewColumns", 1, {"a.csv:102", "4", "5"}, Line(101, "0.5,1,2,3")},
    {"TooManyColumns", 1, {"a.csv:102", "6", "5"}, Line(101, "0.5,1,2,3,4,5")},
    {"NotANumber", 1, {"a.csv:11", "q2", "nan"}, Line(10, "0.045,1,nan,3,4")},
    {"Infinite", 1, {"a.csv:11", "v1", "inf"}, Line(10, "0.045,1,2,-inf,4")},
    {"Text", 1, {"a.csv:11", "v2", "'abc'"}, Line(10, "0.045,1,2,3,abc")},
    {"EmptyField", 1, {"a.csv:11", "q1"}, Line(10, "0.045,,2,3,4")},
    {"RepeatedTime", 1, {"a.csv:11", "time", "0.04"}, Line(10, "0.040,0.5,0.5,3,4")},
    {"BackwardTime", 1, {"a.csv:11", "time"}, Line(10, "0.001,0.5,0.5,3,4")},
    {"TruncatedLastLine", 1, {"a.csv:801", "truncated"}, [](SmallStudy* s) { s->csv.erase(s->csv.rfind(',')); }},
    {"Garbage", 1, {"a.csv:11", "q1", "1e300"}, Line(10, "0.045,1e300,2,3,4")},
    {"EmptyFile",
     1,
     {"a.csv", "empty"},
     [](SmallStudy* s) {
       s->csv.clear();
       s->write_empty_csv = true;
     }},
    {"HeaderOnly", 1, {"a.csv"}, [](SmallStudy* s) { s->csv = "t,q1,q2,v1,v2\n"; }},
    {"OneSample", 1, {"a.csv", "1 sample"}, [](SmallStudy* s) { s->csv = "t,q1,q2,v1,v2\n0,1,2,3,4\n"; }},
    {"TooShortForTheFilter", 1, {"a.csv", "samples"}, [](SmallStudy* s) { s->csv.resize(s->csv.find("\n0.050") + 1); }},
    {"JointNeverMoves",
     2,
     {"a.csv", "joint 2 never moves", "Fv2"},
     [](SmallStudy* s) { s->csv = testing::SmallCsv(false); }},
    {"SingularTransmission",
     1,
     {"robot.yaml:6", "transmission", "singular"},
     [](SmallStudy* s) { s->robot += "transmission: [[1, 2], [2, 4]]\n"; }},
    {"TransmissionOfTheWrongSize",
     1,
     {"robot.yaml:6", "transmission"},
     [](SmallStudy* s) { s->robot += "transmission: [[1, 2, 3], [2, 4, 5]]\n"; }},
    {"UrdfMimic",
     1,
     {"arm.urdf", "two", "mimic"},
     Urdf("<joint name='two' type='revolute'><parent link='b'/><child link='c'/><axis xyz='0 0 1'/>"
          "<limit lower='-1' upper='1' effort='1' velocity='1'/><mimic joint='one' multiplier='1' "
          "offset='0'/></joint>")},
    {"UrdfFloating",
     1,
     {"arm.urdf", "two", "floating"},
     Urdf("<joint name='two' type='floating'><parent link='b'/><child link='c'/></joint>")},
    {"FewerJointsInTheRecording",
     1,
     {"a.csv", "q3"},
     [](SmallStudy* s) { s->robot += "  - {type: revolute, alpha: 0, d: 0.5, theta: 0, r: 0}\n"; }},
    {"MoreJointsInTheRecording", 1, {"a.csv", "q2"}, [](SmallStudy* s) { s->robot.erase(s->robot.rfind("  - ")); }},
    {"CutoffAboveNyquist",
     1,
     {"study.yaml", "cutoff_hz is 150", "200 Hz"},
     [](SmallStudy* s) { Replace("cutoff_hz: 20", "cutoff_hz: 150", &s->study); }},
    {"NoSuchEstimator", 1, {"--estimator=magic", "ls"}, [](SmallStudy* s) { s->flags = "--estimator=magic"; }},
    {"LossOfAClosedForm", 1, {"--huber", "wls"}, [](SmallStudy* s) { s->flags = "--estimator=wls --huber=2"; }},
    {"NegativeLoss", 1, {"--huber", "-2"}, [](SmallStudy* s) { s->flags = "--huber=-2"; }},
    {"PriorOnNothing",
     1,
     {"study.yaml:", "priors[1]", "'ZZ77'", "not identified", "ZZ1R"},
     [](SmallStudy* s) { s->study += "priors:\n  - {parameter: ZZ77, value: 1, standard_deviation: 1}\n"; }},
    {"PriorWithoutDeviation",
     1,
     {"study.yaml:", "priors[1]", "standard_deviation"},
     [](SmallStudy* s) { s->study += "priors:\n  - {parameter: ZZ1R, value: 1}\n"; }},
    {"PriorOfDeviationZero",
     1,
     {"study.yaml:", "priors[1].standard_deviation"},
     [](SmallStudy* s) { s->study += "priors:\n  - {parameter: ZZ1R, value: 1, standard_deviation: 0}\n"; }},
    {"PriorTwice",
     1,
     {"study.yaml:", "priors[2]", "twice"},
     [](SmallStudy* s) {
       s->study +=
           "priors:\n  - {parameter: ZZ1R, value: 1, standard_deviation: 1}\n"
           "  - {parameter: ZZ1R, value: 2, standard_deviation: 1}\n";
     }},
    {"DeviationOfAnUnknownMass",
     1,
     {"study.yaml:", "payloads.p.standard_deviation.M", "no M"},
     [](SmallStudy* s) { s->study += "payloads: {p: {MX: 1, standard_deviation: {M: 0.1}}}\n"; }},
    {"UnknownEffect",
     1,
     {"study.yaml:6", "effects[1].id", "stribek", "stribeck"},
     [](SmallStudy* s) { s->study += "effects:\n  - {id: stribek, joints: [1]}\n"; }},
    {"FrictionAmongEffects",
     1,
     {"study.yaml:5", "effects[1].id", "'friction'"},
     [](SmallStudy* s) { s->study += "effects: [{id: viscous, joints: [1]}]\n"; }},
    {"EffectAtNoJoint",
     1,
     {"study.yaml:5", "effects[1].joints", "out of range"},
     [](SmallStudy* s) { s->study += "effects: [{id: stribeck, joints: [3]}]\n"; }},
    {"EffectTwice",
     1,
     {"study.yaml:5", "effects[2]", "twice"},
     [](SmallStudy* s) { s->study += "effects: [{id: base_tilt}, {id: base_tilt}]\n"; }},
    {"UnknownShape",
     1,
     {"study.yaml:5", "effects[1].shape.x_s", "'stribeck' has no such shape parameter", "vs"},
     [](SmallStudy* s) { s->study += "effects: [{id: stribeck, joints: [1], shape: {x_s: 0.1}}]\n"; }},
    {"ShapeOfAnEffectWithout",
     1,
     {"study.yaml:5", "effects[1].shape.k", "expected none"},
     [](SmallStudy* s) { s->study += "effects: [{id: load_friction, joints: [1], shape: {k: 1}}]\n"; }},
    {"ShapeBeyondTheMotion",
     1,
     {"study.yaml:6", "effects[1].shape.vs", "100 is outside", "rad/s"},
     [](SmallStudy* s) { s->study += "effects:\n  - {id: stribeck, joints: [1], shape: {vs: 100}}\n"; }},
    {"PriorOnAShape",
     1,
     {"study.yaml:6", "priors[1]", "stribeck_vs_1", "no prior"},
     [](SmallStudy* s) {
       s->study +=
           "effects: [{id: stribeck, joints: [1]}]\n"
           "priors: [{parameter: stribeck_vs_1, value: 1, standard_deviation: 1}]\n";
     }},
    {"NoSuchFlag", 1, {"extimator"}, [](SmallStudy* s) { s->flags = "--extimator=ls"; }},
    {"RatioOfNothing", 1, {"--r_sigma", "0.5"}, [](SmallStudy* s) { s->flags = "--r_sigma=0.5"; }},
    {"MissingReference", 1, {"nowhere.json"}, [](SmallStudy* s) { s->flags = "--reference=nowhere.json"; }},
    {"GainsWithoutAKnownPayload",
     1,
     {"study.yaml", "payloads"},
     [](SmallStudy* s) { s->study += "gains: {mode: identify}\n"; }},
    {"TlsWithKnownGains",
     1,
     {"--estimator=tls", "gains.mode", "ls, wls"},
     [](SmallStudy* s) { s->flags = "--estimator=tls"; }},
    {"ValidationPayloadUnknown",
     1,
     {"'b'", "payload 'p'"},
     [](SmallStudy* s) {
       Replace("preprocessing",
               "  - {file: a.csv, name: b, payload: p, use: validation}\npayloads: {p: {M: 1}}\n"
               "preprocessing",
               &s->study);
     }},
    {"OnlyValidation",
     1,
     {"identification"},
     [](SmallStudy* s) { Replace("identification", "validation", &s->study); }},
};

class Spoilt : public ::testing::TestWithParam<BadInput> {};
INSTANTIATE_TEST_SUITE_P(Table, Spoilt, ::testing::ValuesIn(kTable),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(Spoilt, SaysWhatIsWrongAndWritesNothing) {
  SmallStudy study;
  GetParam().spoil(&study);
  std::string arguments = study.Arguments();
  if (GetParam().name == "MissingStudy") std::filesystem::remove(study.folder / "study.yaml");
  const testing::ProgramRun run = testing::RunProgram("idim_identify", arguments);
  EXPECT_EQ(run.exit_code, GetParam().exit_code) << run.err;
  for (const std::string& part : GetParam().message) EXPECT_THAT(run.err, HasSubstr(part));
  EXPECT_EQ(run.out, "");
  EXPECT_FALSE(study.OutputExists());
  // One message, not a cascade.
  if (GetParam().name != "NoSuchFlag") {
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
}

// The file that the table spoils is good.
TEST(Spoilt, TheBaseIsSound) {
  SmallStudy study;
  const testing::ProgramRun run = testing::RunProgram("idim_identify", study.Arguments());
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_TRUE(study.OutputExists());
}

}  // namespace
}  // namespace idim::bad_input_test
