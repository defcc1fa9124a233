// All that a program needs to run idim from memory: robot, recordings and study are built in code, no file is read.
//
//   Study study;                                          // study.robot, study.recordings, ...: core/recording/study.h
//   std::vector<Recording> recordings;                    // one an entry of study.recordings
//   Result<PreparedStudy> prepared = PrepareStudy(study, recordings);
//   Result<EstimatorRunner> runner = EstimatorRunner::Create(&*prepared);
//   Result<Identification> result = runner->Run("wls", 0.0);
//   Result<Validation> validation = Validate(*prepared, ReferenceOf(result->estimate));
//   Result<LoopResult> loop = CloseLoop(*prepared, LoopOptions());
//
// tests/house/consumer/main.cc is a complete program.

#ifndef IDIM_SOLVERS_IDIM_H_
#define IDIM_SOLVERS_IDIM_H_

#include "core/estimate/estimate.h"
#include "core/estimate/estimate_json.h"
#include "core/estimate/reference.h"
#include "core/model/model.h"
#include "core/recording/check_study.h"
#include "core/recording/recording.h"
#include "core/recording/study.h"
#include "core/robot/check_robot.h"
#include "core/robot/robot.h"
#include "solvers/estimators/estimators.h"
#include "solvers/judge/monte_carlo.h"
#include "solvers/judge/validation.h"
#include "solvers/loop/close_loop.h"
#include "solvers/loop/declared_effects.h"

#endif  // IDIM_SOLVERS_IDIM_H_
