#include "core/estimate/estimate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/estimate/estimate_json.h"
#include "core/estimate/reference.h"
#include "core/estimate/series.h"
#include "tests/support/temp_folder.h"

namespace idim::estimate_test {
namespace {

using Eigen::VectorXd;
using ::testing::HasSubstr;
using Json = nlohmann::json;

Estimate Example() {
  Estimate e;
  e.robot = "arm \"A\"";
  e.estimator = "wls";
  ParameterEstimate p;
  p.parameter = {"ZZ1R", ParameterKind::kBase, 1, "kg.m^2"};
  p.value = 1.28;
  p.standard_deviation = 0.02;
  p.regrouping = "ZZ1 + Ia1";
  SetInterval95(10.0, &p);
  e.parameters.push_back(p);
  e.covariance = Eigen::MatrixXd::Constant(1, 1, 0.0004);
  e.position_noise = VectorXd::Constant(1, 1e-5);
  e.signal_noise = VectorXd::Constant(1, 0.1);
  e.recordings.push_back({"free", "identification", 896, VectorXd::Constant(1, 7.2), 8.8, VectorXd::Constant(1, 2.0),
                          VectorXd::Constant(1, 3.0), VectorXd::Constant(1, 0.4)});
  e.condition_number = 2177.0;
  return e;
}

// The keys that scripts outside read.
TEST(EstimateToJson, HoldsTheContract) {
  const Json json = Json::parse(EstimateToJson(Example()));
  EXPECT_EQ(json.at("schema"), "idim.estimate.1");
  EXPECT_EQ(json.at("status"), "ok");
  EXPECT_EQ(json.at("message"), "");
  EXPECT_EQ(json.at("robot"), "arm \"A\"");
  const Json& p = json.at("parameters").at(0);
  EXPECT_EQ(p.at("name"), "ZZ1R");
  EXPECT_EQ(p.at("kind"), "base");
  EXPECT_EQ(p.at("joint"), 1);
  EXPECT_EQ(p.at("value"), 1.28);
  EXPECT_EQ(p.at("unit"), "kg.m^2");
  EXPECT_EQ(p.at("regrouping"), "ZZ1 + Ia1");
  // Student's t with 10 degrees of freedom: 2.228 (any table).
  EXPECT_NEAR(p.at("interval95").at(0).get<double>(), 1.28 - 2.228 * 0.02, 1e-5);
  EXPECT_NEAR(p.at("interval95").at(1).get<double>(), 1.28 + 2.228 * 0.02, 1e-5);
  EXPECT_EQ(json.at("covariance").at(0).at(0), 0.0004);
  EXPECT_EQ(json.at("noise").at("position").size(), 1u);
  const Json& r = json.at("recordings").at(0);
  EXPECT_EQ(r.at("name"), "free");
  EXPECT_EQ(r.at("use"), "identification");
  EXPECT_EQ(r.at("samples"), 896);
  EXPECT_EQ(r.at("relative_error_percent").at(0), 7.2);
  EXPECT_EQ(r.at("relative_error_percent_all"), 8.8);
  EXPECT_EQ(r.at("rms_torque").at(0), 2.0);
  EXPECT_EQ(json.at("condition_number"), 2177.0);
  EXPECT_TRUE(json.at("seconds").is_number());
}

TEST(EstimateToJson, AnUntrustedEstimateSaysSo) {
  Estimate e;
  e.status = Status::Untrusted("not identifiable: Fv3");
  const Json json = Json::parse(EstimateToJson(e));
  EXPECT_EQ(json.at("status"), "untrusted");
  EXPECT_EQ(json.at("message"), "not identifiable: Fv3");
  EXPECT_TRUE(json.at("parameters").empty());
}

TEST(Reference, AnEstimateIsAReferenceItself) {
  const std::string path = ::testing::TempDir() + "/reference.json";
  FILE* file = fopen(path.c_str(), "w");
  ASSERT_NE(file, nullptr);
  const std::string text = EstimateToJson(Example());
  fwrite(text.data(), 1, text.size(), file);
  fclose(file);
  const Result<Reference> reference = ReadReference(path);
  ASSERT_TRUE(reference.ok()) << reference.status().message();
  EXPECT_EQ(reference->name, "wls");
  ASSERT_NE(reference->Find("ZZ1R"), nullptr);
  EXPECT_EQ(reference->Find("Fv1"), nullptr);
  Estimate other = Example();
  other.parameters[0].value = 1.36;
  // 0.08 apart, 0.02 each: 0.08 / (sqrt(2) 0.02).
  EXPECT_NEAR(DifferenceInSigmas(other.parameters[0], *reference->Find("ZZ1R")), 2.8284, 1e-4);
  EXPECT_THAT(BesideReference(other, *reference), HasSubstr("+2.8"));
  remove(path.c_str());
}

TEST(Reference, EffectsComeBack) {
  Estimate e = Example();
  EXPECT_FALSE(Json::parse(EstimateToJson(e)).contains("effects"));
  EXPECT_FALSE(Json::parse(EstimateToJson(e)).contains("velocity_zero_at_rest"));
  e.effects = {{"presliding", {2}, {{"x_s", 0.1 / 3.0}}}, {"base_tilt", {}}};
  e.velocity_zero_at_rest = true;
  const Json json = Json::parse(EstimateToJson(e));
  EXPECT_EQ(json.at("effects").dump(),
            "[{\"id\":\"presliding\",\"joints\":[3],\"shape\":{\"x_s\":" + Json(0.1 / 3.0).dump() +
                "}},{\"id\":\"base_tilt\",\"joints\":[],\"shape\":{}}]");
  EXPECT_EQ(json.at("velocity_zero_at_rest"), true);
  const TempFolder folder;
  const Result<Reference> read = ReadReference(folder.Write("estimate.json", EstimateToJson(e)));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_TRUE(read->velocity_zero_at_rest);
  ASSERT_EQ(read->effects.size(), 2u);
  EXPECT_EQ(read->effects[0].id, "presliding");
  EXPECT_EQ(read->effects[0].joints, std::vector<int>{2});
  EXPECT_EQ(read->effects[0].shape, e.effects[0].shape);
  EXPECT_TRUE(read->effects[1].joints.empty());
}

TEST(Reference, RefusesEffectsThatAreNone) {
  const TempFolder folder;
  const auto message = [&](const std::string& keys) {
    return ReadReference(folder.Write("e.json", "{\"parameters\":[{\"name\":\"a\",\"value\":1}]," + keys + "}"))
        .status()
        .message();
  };
  EXPECT_EQ(message("\"effects\":[]"), "");
  EXPECT_THAT(message("\"effects\":{}"), HasSubstr("key 'effects'"));
  EXPECT_THAT(message("\"effects\":[1]"), HasSubstr("effects[0]: key 'id'"));
  EXPECT_THAT(message("\"effects\":[{\"id\":\"b\",\"joints\":[0]}]"), HasSubstr("effects[0]: key 'joints'"));
  EXPECT_THAT(message("\"effects\":[{\"id\":\"b\",\"joints\":[1.5]}]"), HasSubstr("key 'joints'"));
  EXPECT_THAT(message("\"effects\":[{\"id\":\"b\",\"shape\":[]}]"), HasSubstr("key 'shape'"));
  EXPECT_THAT(message("\"effects\":[{\"id\":\"b\",\"shape\":{\"x\":null}}]"), HasSubstr("key 'shape.x'"));
  EXPECT_THAT(message("\"velocity_zero_at_rest\":1"), HasSubstr("true or false"));
}

TEST(Reference, RefusesWhatIsNone) {
  const std::string path = ::testing::TempDir() + "/bad_reference.json";
  const std::pair<const char*, const char*> cases[] = {
      {"", "not a JSON object"},
      {"[1]", "not a JSON object"},
      {"{}", "key 'parameters'"},
      {"{\"parameters\": [{\"value\": 1}]}", "parameters[0]: key 'name'"},
      {"{\"parameters\": [{\"name\": \"a\", \"value\": \"x\"}]}", "parameters[0]: key 'value'"},
      {"{\"parameters\": [{\"name\": \"a\", \"value\": 1, \"standard_deviation\": null}]}", "key 'standard_deviation'"},
  };
  for (const auto& [text, message] : cases) {
    FILE* file = fopen(path.c_str(), "w");
    ASSERT_NE(file, nullptr);
    fputs(text, file);
    fclose(file);
    const Result<Reference> reference = ReadReference(path);
    EXPECT_EQ(reference.status().code(), StatusCode::kBadInput);
    EXPECT_THAT(reference.status().message(), HasSubstr(message));
    EXPECT_THAT(reference.status().message(), HasSubstr(path));
  }
  remove(path.c_str());
  EXPECT_THAT(ReadReference("/nowhere.json").status().message(), HasSubstr("/nowhere.json"));
}

TEST(ResidualsToCsv, OneLineADecimatedSample) {
  RecordingSeries s;
  s.name = "free";
  s.use = "identification";
  s.torque = s.model = Eigen::MatrixXd::Zero(4, 2);
  s.decimated_t = VectorXd::LinSpaced(2, 0.5, 1.0);
  s.decimated_q = Eigen::MatrixXd::Constant(2, 2, 0.1);
  s.decimated_dq = Eigen::MatrixXd::Constant(2, 2, 0.2);
  s.decimated_torque = Eigen::MatrixXd::Constant(2, 2, 3.0);
  s.decimated_model = Eigen::MatrixXd::Constant(2, 2, 1.0);
  EXPECT_EQ(ResidualsToCsv({s}),
            "recording,use,t,q1,q2,dq1,dq2,tau1,tau2,model1,model2,residual1,residual2\n"
            "free,identification,0.5,0.1,0.1,0.2,0.2,3,3,1,1,2,2\n"
            "free,identification,1,0.1,0.1,0.2,0.2,3,3,1,1,2,2\n");
}

TEST(Reference, SaysWhoseItIsAndWhetherItTrustsItself) {
  const TempFolder folder;
  const std::string parameters = "\"parameters\": [{\"name\": \"g1\", \"value\": 2}]}";
  const auto read = [&](const std::string& head) { return ReadReference(folder.Write("r/e.json", head + parameters)); };
  EXPECT_EQ(read("{")->name, "e.json");
  EXPECT_EQ(read("{\"estimator\": \"wls\",")->name, "wls");
  EXPECT_EQ(read("{\"name\": \"Table I\", \"estimator\": \"wls\",")->name, "Table I");
  EXPECT_EQ(read("{\"robot\": \"tx40\",")->robot, "tx40");
  EXPECT_EQ(read("{\"status\": \"ok\", \"message\": \"\",")->warning, "");
  EXPECT_EQ(read("{\"status\": \"untrusted\", \"message\": \"g1 is weak\",")->warning, "g1 is weak");
  EXPECT_THAT(read("{\"name\": 5,").status().message(), HasSubstr("'name': expected a text"));
}

TEST(Reference, OfTheSameNameAreToldApartByTheirPaths) {
  const TempFolder folder;
  const auto write = [&](const std::string& file, const std::string& name) {
    return folder.Write(file, "{\"name\": \"" + name + "\", \"parameters\": [{\"name\": \"g1\", \"value\": 2}]}");
  };
  const std::string a = write("a.json", "wls"), b = write("b.json", "wls"), c = write("c.json", "ls");
  const Result<std::vector<Reference>> references = ReadReferences(a + "," + c + "," + b);
  ASSERT_TRUE(references.ok());
  EXPECT_EQ((*references)[0].name, "wls (" + a + ")");
  EXPECT_EQ((*references)[1].name, "ls");
  EXPECT_EQ((*references)[2].name, "wls (" + b + ")");
}

TEST(EstimateToText, NamesItsEstimatorAndItsDoubts) {
  Estimate e = Example();
  e.estimator = "wtls";
  e.preprocessing = std::string(900, 'x') + " end";
  EXPECT_THAT(EstimateToText(e, "N.m, N"), ::testing::AllOf(HasSubstr("IDIM-WTLS"), HasSubstr("x end\n")));
  EXPECT_THAT(EstimateToText(e, "N.m, N"), ::testing::Not(HasSubstr("TRUSTED")));
  e.status = Status::Untrusted("g1 is weak");
  EXPECT_THAT(EstimateToText(e, "N.m, N"), HasSubstr("NOT TO BE TRUSTED: g1 is weak"));
}

}  // namespace
}  // namespace idim::estimate_test
