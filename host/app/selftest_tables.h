// The tables of `mica selftest` beside its checks: functions in ULP, hard cases, and random hard questions.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "host/device/device.h"
#include "host/verify/arithmetic.h"
#include "host/verify/hard_answers.h"
#include "host/verify/run_hard_case.h"

namespace mica::host::app {

void print_arithmetic(const std::vector<FunctionError>& errors);
nlohmann::json arithmetic_json(const std::vector<FunctionError>& errors);

/// Runs and prints every hard case on every evaluator; then more questions to each, until at least
/// `evaluations` answers were looked at. Between cases it checks for interrupts.
std::vector<HardResult> print_hard_cases(Device* device, std::uint64_t evaluations,
                                         const MethodRegistry& methods);
nlohmann::json hard_cases_json(const std::vector<HardResult>& results);

/// Asks random hard questions and prints what became of them. @param answers of each method; 0: none.
std::vector<HardAnswers> print_hard_answers(Device* device, std::uint64_t answers,
                                            const MethodRegistry& methods);
nlohmann::json hard_answers_json(const std::vector<HardAnswers>& answers);

}  // namespace mica::host::app
